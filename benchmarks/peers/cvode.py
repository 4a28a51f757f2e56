"""CVODE of SUNDIALS: backward differentiation with error control, order held to 2 or up to 5."""

from __future__ import annotations

from functools import partial

import numpy as np
from rotor_fmu.model.rest import rest

from ..equations import real_state
from ..problem import Diverged, Method, Missing, Orbit, Problem, orbit

PROGRAM = "CVODE"
REFERENCE_RTOL = 1e-8
# absolute tolerances for each unit of the relative one: of displacements [m] and velocities [m/s];
# of those tried these gave the least work for an error of the orbit, or came close to it
_OF_DISPLACEMENTS, _OF_VELOCITIES = 1e-3, 10.0
_FINE_SAMPLE = 1e-3  # for the peaks [s]


def methods() -> list[Method]:
    """Orders 2 and 5 at their tolerances; raises `Missing`."""
    _solver()
    chosen = [(2, rtol) for rtol in (1e-3, 1e-4, 3e-5, 1e-5, 1e-6, 1e-7)]
    chosen += [(5, 1e-5)]
    return [
        Method(PROGRAM, f"order {order}, rtol = {rtol:g}", partial(solve, order, rtol))
        for order, rtol in chosen
    ]


def solve(order: int, rtol: float, problem: Problem) -> Orbit:
    """From rest to the problem's end; raises `Diverged` and `Missing`."""
    sundials = _solver()
    machine = problem.machine()
    still = rest(problem.rotor)
    finer = max(1, round(problem.sample / _FINE_SAMPLE))
    times = np.linspace(0.0, problem.stop, finer * (len(problem.times) - 1) + 1)
    atol = rtol * np.repeat([_OF_DISPLACEMENTS, _OF_VELOCITIES], machine.size)
    start = real_state(still, 0 * still)
    try:
        result = sundials.solve(machine, start, times, rtol, atol, order)
    except sundials.SundialsError as error:
        raise Diverged(str(error)) from error
    return orbit(problem, times, machine.disc(result.states), result.steps)


def reference(problem: Problem) -> Orbit:
    """The converged orbit: full order at a tolerance far below every other's."""
    return solve(5, REFERENCE_RTOL, problem)


def _solver() -> object:
    try:
        from . import sundials

        sundials.load()
    except (ImportError, OSError) as error:
        raise Missing(f"scikit-sundae: {error}") from error
    return sundials
