"""ROSS's Newmark integrator on the same matrices and contact law.

`ross.utils.newmark` starts from zero and takes the nonlinear forces from the state before the step,
so displacements are counted from rest and the contacts enter explicitly.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..forces import fill_force, machine
from ..problem import RATE, SPEED, Diverged, Method, Missing, Orbit, Problem, orbit
from .quiet import quiet

PROGRAM = "ROSS"


def methods() -> list[Method]:
    """Newmark at several steps; raises `Missing`."""
    _newmark()
    return [
        Method(PROGRAM, f"Newmark, h = {h:g} s", partial(solve, h), only_short=True)
        for h in (1e-4, 1e-5, 2e-6)
    ]


def _newmark() -> Callable[..., Any]:
    try:
        with quiet():
            from ross.utils import newmark
    except Exception as error:  # its many dependencies raise all kinds
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise Missing(f"ROSS: {reason} (pip install ross-rotordynamics)") from error
    return newmark


def solve(h: float, problem: Problem) -> Orbit:
    """From rest to the problem's end in steps of h [s]; raises `Diverged` and `Missing`."""
    newmark = _newmark()
    given = machine(problem.rotor, SPEED, RATE)
    held = given.K @ given.rest
    times = np.linspace(0.0, problem.stop, round(problem.stop / h) + 1)
    size = len(given.M)
    force = np.zeros(size)

    def system(step, dt, y, ydot, y2dot):
        if not np.abs(y).max() < 0.1 * problem.rotor.length:
            raise Diverged(f"diverged at t = {times[step]:.3g} s")
        t = times[step]
        fill_force(t, y + given.rest, ydot, given.forces, force)
        return given.M, given.C + (SPEED + RATE * t) * given.G, given.K, force - held

    result = newmark(system, times, size) + given.rest
    disc = result[:, given.disc] + 1j * result[:, given.disc + size // 2]
    return orbit(problem, times, disc, len(times) - 1)
