"""CVODE of SUNDIALS: backward differentiation with error control, order held to 2 or up to 5."""

from functools import partial
from types import ModuleType

import numpy as np

from ..equations import Equations
from ..problem import Diverged, Method, Missing, Orbit, Problem, orbit

PROGRAM = "CVODE"
MODES = 4  # whose error, 12 nm (`benchmarks.reduction`), is below that of most settings
REDUCED = f"CVODE on {MODES} modes"
REFERENCE_RTOL = 1e-8
# absolute tolerances for each unit of the relative one: of displacements [m] and velocities [m/s];
# of those tried these gave the least work for an error of the orbit, or came close to it
_OF_DISPLACEMENTS, _OF_VELOCITIES = 1e-3, 10.0
_FINE_SAMPLE = 1e-3  # for the peaks [s]


def methods() -> list[Method]:
    """Orders 2 and 5 at their tolerances; raises `Missing`."""
    _solver()
    tolerances = (1e-3, 1e-4, 3e-5, 1e-5, 1e-6, 1e-7)
    whole = [(2, rtol) for rtol in tolerances] + [(5, 1e-5)]
    return [
        Method(PROGRAM, f"order {order}, rtol = {rtol:g}", partial(solve, order, rtol))
        for order, rtol in whole
    ] + [
        Method(REDUCED, f"order 2, rtol = {rtol:g}", partial(solve, 2, rtol, modes=MODES))
        for rtol in (*tolerances[1:], 1e-8)  # fewer fast motions shorten its steps
    ]


def solve(order: int, rtol: float, problem: Problem, modes: int = 0) -> Orbit:
    """From rest to the problem's end, on all of the shaft or so many component modes; raises
    `Diverged` and `Missing`."""
    sundials = _solver()
    machine = problem.machine(modes)
    finer = max(1, round(problem.sample / _FINE_SAMPLE))
    times = np.linspace(0.0, problem.stop, finer * (len(problem.times) - 1) + 1)
    atol = absolute(machine, rtol)
    start = problem.start(modes)
    try:
        result = sundials.solve(machine, start, times, rtol, atol, order)
    except sundials.SundialsError as error:
        raise Diverged(str(error)) from error
    return orbit(problem, times, machine.disc(result.states), result.steps)


def absolute(machine: Equations, rtol: float) -> np.ndarray:
    """Absolute tolerances of a state that go with a relative one, shape (2N,) [m], [m/s]."""
    return rtol * np.repeat([_OF_DISPLACEMENTS, _OF_VELOCITIES], machine.size)


def reference(problem: Problem) -> Orbit:
    """The converged orbit: full order at a tolerance far below every other's."""
    return solve(5, REFERENCE_RTOL, problem)


def _solver() -> ModuleType:
    try:
        from . import sundials

        sundials.load()
    except (ImportError, OSError) as error:
        raise Missing(f"scikit-sundae: {error}") from error
    return sundials
