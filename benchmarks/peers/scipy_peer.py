"""SciPy's stiff solvers with error control, on compiled right-hand side and Jacobian."""

from __future__ import annotations

from functools import partial

import numpy as np
import scipy.integrate
from rotor_fmu.model.rest import rest

from ..equations import real_state
from ..problem import Diverged, Method, Orbit, Problem, orbit

PROGRAM = "SciPy"
# absolute tolerances for each unit of the relative one: of displacements [m], velocities [m/s]
_OF_DISPLACEMENTS, _OF_VELOCITIES = 1e-3, 10.0


def methods() -> list[Method]:
    """Radau, BDF and LSODA; too slow for more than the beginning of the run-down."""
    return [
        Method(PROGRAM, f"{name}, rtol = {rtol:g}", partial(solve, name, rtol), only_short=True)
        for name in ("Radau", "BDF", "LSODA")
        for rtol in (1e-3, 1e-5)
    ]


def solve(name: str, rtol: float, problem: Problem) -> Orbit:
    """From rest to the problem's end; raises `Diverged`."""
    machine = problem.machine()
    still = rest(problem.rotor)
    atol = rtol * np.repeat([_OF_DISPLACEMENTS, _OF_VELOCITIES], machine.size)
    steps = 0
    solver = getattr(scipy.integrate, name)(
        machine.slope,
        0.0,
        real_state(still, 0 * still),
        problem.stop,
        rtol=rtol,
        atol=atol,
        jac=machine.jacobian,
    )
    times = problem.times
    states = np.empty((len(times), len(atol)))
    done = 0
    with np.errstate(all="ignore"):
        while solver.status == "running":
            solver.step()
            steps += 1
            if solver.status == "failed":
                raise Diverged(f"gave up at t = {solver.t:.3g} s")
            reached = np.searchsorted(times, solver.t, side="right")
            if reached > done:
                states[done:reached] = solver.dense_output()(times[done:reached]).T
                done = reached
    return orbit(problem, times, machine.disc(states), steps)
