"""The curve of folds in a second parameter: jump speeds over clearance, friction, unbalance.

At a fold R_x is singular. With two fixed vectors b, c the function g of

    R_x v + b g = 0,    c^T v = 1,    R_x^T w + c g = 0,    b^T w = 1

is 0 there (Govaerts 2000, ch. 3), and R = 0, g = 0 are continued for (x, lambda) over the second
parameter. g's gradient is -w^T R_xx v, a difference of tangents along v.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from . import arclength, newton
from .arclength import ContinuationEquations, ContinuationSteps
from .balance import HarmonicBalance, Orbit
from .branch import why_ended
from .newton import NotConverged

_STEP = 1e-5


class FoldCurve(NamedTuple):
    """Folds over a second parameter: values of the second and of the first parameter, shape (n,)
    each, and why the curve ends at either side."""

    second: np.ndarray
    first: np.ndarray
    ends: tuple[str, str]


class _Folds(ContinuationEquations):
    """R = 0 and g = 0 in X = (x, lambda over its scale), over the second parameter."""

    difference = _STEP

    def __init__(self, problem_at: Callable[[float], HarmonicBalance], scale: float) -> None:
        self._balance_at, self.scale = problem_at, scale
        self._b = self._c = np.zeros(0)

    def border(self, X: np.ndarray, second: float) -> None:
        """Take b and c from the singular vectors at a fold."""
        problem = self._balance_at(second)
        _, J = problem.linearized(X[:-1], X[-1] * problem.scale)
        left, _, right = np.linalg.svd(J)
        self._b, self._c = left[:, -1], right[-1]

    def _vectors(self, J: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        n = len(J)
        bordered = np.zeros((n + 1, n + 1))
        bordered[:n, :n], bordered[:n, n], bordered[n, :n] = J, self._b, self._c
        one = np.eye(n + 1)[n]
        v, w = np.linalg.solve(bordered, one), np.linalg.solve(bordered.T, one)
        return v[:n], w[:n], float(v[n])

    def residual(self, X: np.ndarray, second: float) -> np.ndarray:
        """Return the residual R and the fold condition g."""
        problem = self._balance_at(second)
        R, J = problem.linearized(X[:-1], X[-1] * problem.scale)
        return np.append(R, self._vectors(J)[2])

    def linearized(self, X: np.ndarray, second: float) -> tuple[np.ndarray, np.ndarray]:
        """Return R and g, and their derivative with respect to X."""
        problem = self._balance_at(second)
        x, value, scale = X[:-1], X[-1] * problem.scale, problem.scale
        R, J, by = problem.linearized_with_parameter(x, value)
        v, w, g = self._vectors(J)
        n = len(x)
        out = np.empty((n + 1, n + 1))
        out[:n, :n], out[:n, n] = J, by
        size = _STEP * (1.0 + np.linalg.norm(x)) / np.linalg.norm(v)
        along = problem.linearized(x + size * v, value)[1]
        along -= problem.linearized(x - size * v, value)[1]
        out[n, :n] = -(w @ along) / (2 * size)
        over = problem.linearized(x, value + _STEP * scale)[1]
        over -= problem.linearized(x, value - _STEP * scale)[1]
        out[n, n] = -(w @ over @ v) / (2 * _STEP)
        return np.append(R, g), out


def fold_curve(
    problem_at: Callable[[float], HarmonicBalance],
    fold: Orbit,
    start: float,
    low: float,
    high: float,
    steps: ContinuationSteps,
    report: Callable[[float], object],
) -> FoldCurve:
    """Return the curve of folds over [low, high] of the second parameter, through the fold at
    `start`.

    problem_at: the equations at a value of the second parameter; report: is called with that of
    each fold. Raises `NotConverged` if the first fold does not solve the equations.
    """
    equations = _Folds(problem_at, high - low)
    problem = problem_at(start)
    X = np.append(problem.join(fold), fold.parameter / problem.scale)
    equations.border(X, start)
    X = newton.solve(equations, X, start)
    sides, ends = [], []
    for direction in (-1.0, 1.0):
        point = arclength.with_tangent(equations, X, start, direction)
        result, last = [], start
        try:
            for near, _ in arclength.trace(equations, point, low, high, steps):
                result.append((near.value, near.x[-1] * problem.scale))
                equations.border(near.x, near.value)
                report(near.value)
                last = near.value
            end = why_ended(last, low, high, steps.max_points)
        except NotConverged:
            end = "lost: Newton's method does not converge with the shortest step"
        sides.append(result)
        ends.append(end)
    middle = [(start, float(X[-1]) * problem.scale)]
    table = np.array([*sides[0][::-1], *middle, *sides[1]])
    return FoldCurve(table[:, 0], table[:, 1], (ends[0], ends[1]))
