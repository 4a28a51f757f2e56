"""IDA of SUNDIALS through scikit-sundae: backward differentiation of y' - f(t, y) = 0.

Residual and Jacobian are compiled, the linear solver is the direct dense one; every call passes
through Python, so that it is given the beginning of the run-down only.
"""

from functools import partial

import numba
from scipy.interpolate import CubicHermiteSpline

from ..equations import jacobian, slope
from ..problem import Diverged, Method, Missing, Orbit, Problem, orbit
from .cvode import MODES, absolute

PROGRAM = "scikit-sundae, IDA"
_MOST_STEPS = 10_000_000


@numba.njit(cache=True)
def _residual(t, y, y_dot, out, coefficients):
    slope(t, y, out, coefficients)
    for i in range(len(y)):
        out[i] = y_dot[i] - out[i]


@numba.njit(cache=True)
def _jacobian(t, y, by_rate, out, coefficients):
    jacobian(t, y, out, coefficients)
    for i in range(len(y)):
        for j in range(len(y)):
            out[i, j] = -out[i, j]
        out[i, i] += by_rate


def methods() -> list[Method]:
    """Order 2, of all of the shaft and of four modes; raises `Missing`."""
    _class()
    return [
        Method(
            f"{PROGRAM} on {modes} modes" if modes else PROGRAM,
            f"order 2, rtol = {rtol:g}",
            partial(solve, rtol, modes=modes),
            only_short=True,
        )
        for modes in (0, MODES)
        for rtol in (1e-4, 1e-6)
    ]


def solve(rtol: float, problem: Problem, modes: int = 0) -> Orbit:
    """From rest to the problem's end; raises `Diverged` and `Missing`."""
    machine = problem.machine(modes)
    start = problem.start(modes)
    solver = _class()(
        lambda t, y, yp, out: _residual(t, y, yp, out, machine.coefficients),
        jacfn=lambda t, y, yp, res, cj, out: _jacobian(t, y, cj, out, machine.coefficients),
        rtol=rtol,
        atol=absolute(machine, rtol),
        max_order=2,
        max_num_steps=_MOST_STEPS,
    )
    result = solver.solve([0.0, problem.stop], start, machine.slope(0.0, start))
    if not result.success:
        raise Diverged(f"gave up at t = {result.t[-1]:.3g} s")
    seen = CubicHermiteSpline(result.t, machine.disc(result.y), machine.disc(result.yp))
    return orbit(problem, problem.times, seen(problem.times), len(result.t) - 1)


def _class() -> type:
    try:
        from sksundae.ida import IDA
    except ImportError as error:
        raise Missing(f"scikit-sundae: not installed ({error})") from error
    return IDA
