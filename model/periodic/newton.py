"""Damped Newton's method for R(x, lambda) = 0 at a value of lambda, and what continuation shares
with it."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import pairwise

import numpy as np
import scipy.linalg

from ..quantities import QuantityError

_LEAST_DAMPING = 1e-3  # factor of a correction
_MOST_LEAST = 4  # corrections with it: the residual has a minimum near by, or a corner, but no root
# Corrections over which the residual must fall below this share of what it was: else they cycle, as
# where a touch passes from sample to sample.
_STALLED, _FALLEN = 14, 0.75
_ROUNDING_RESIDUAL = 1e-9  # a smaller residual is rounding
_SMALL_CORRECTION, _MARGIN = 1e-4, 10.0  # after a smaller one, the next is predicted, with a margin


class Equations(ABC):
    """Equations to be solved at a value of lambda; tolerance: of Newton's last correction, in the
    units of x; damped_beyond: size of the corrections beyond which they are damped if they do not
    shrink."""

    tolerance = 1e-9
    damped_beyond = 0.0

    @abstractmethod
    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual and the Jacobian."""

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """Return the residual of the equations."""
        return self.linearized(x, value)[0]

    def solve_linear(self, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Return the solution of a linear system with the Jacobian, which may be bordered by
        further rows and columns."""
        return solve_linear(matrix, right)


class NotConverged(RuntimeError):
    """Newton's method did not converge; corrections: the sizes of its corrections."""

    def __init__(self, corrections: Sequence[float] = ()) -> None:
        self.corrections = corrections
        super().__init__("Newton's method does not converge")


def is_solution(equations: Equations, x: np.ndarray, value: float) -> bool:
    """Return whether the equations hold within rounding."""
    return _norm(equations.residual(x, value)) < _ROUNDING_RESIDUAL


def solve(equations: Equations, x: np.ndarray, value: float, iterations: int = 40) -> np.ndarray:
    """Return the unknowns at a fixed lambda, by damped Newton's method; raises `NotConverged`,
    also where corrections along which the residual does not decrease recur, or it hardly decreases
    in many."""
    x, corrections, failed = x.copy(), [], 0
    residuals = list[float]()
    for _ in range(iterations):
        residual, jacobian = equations.linearized(x, value)
        step = -equations.solve_linear(jacobian, residual)
        size = float(np.linalg.norm(step))
        if not np.isfinite(size):
            break
        limit = 0.5 * (1.0 + float(np.linalg.norm(x)))
        most = min(1.0, limit / size) if size > 0 else 1.0
        damping = damping_factor(equations, residual, x, value, step, 0.0, most)
        corrections.append(damping * size)
        residuals.append(_norm(residual))
        x += damping * step
        failed += most > damping <= _LEAST_DAMPING
        if size <= equations.tolerance * (1.0 + np.linalg.norm(x)):
            return x
        before, lately = residuals[:-_STALLED], residuals[-_STALLED:]
        if failed == _MOST_LEAST or (before and min(lately) > _FALLEN * min(before)):
            break
    raise NotConverged(corrections)


def damping_factor(
    equations: Equations,
    residual: np.ndarray,
    x: np.ndarray,
    value: float,
    step: np.ndarray,
    value_step: float,
    damping: float,
    smallest: float = _LEAST_DAMPING,
) -> float:
    """Return the factor for a correction of x and lambda with which the residual decreases
    (Armijo's rule), or the smallest one tried."""
    size = _norm(residual)
    while damping > smallest:
        ahead = equations.residual(x + damping * step, value + damping * value_step)
        left = _norm(ahead)
        if left <= (1.0 - 0.1 * damping) * size or size < _ROUNDING_RESIDUAL:
            break
        damping *= 0.5
    return damping


def _norm(residual: np.ndarray) -> float:
    """Return the length of a residual, inf of one as far from 0 as that of a law far beyond its
    wall may be."""
    with np.errstate(over="ignore"):
        return float(np.linalg.norm(residual))


def solve_linear(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the solution of a linear system, the least-squares one if the matrix is singular to
    rounding."""
    try:
        result = np.linalg.solve(matrix, right)
        if np.isfinite(result).all() and np.abs(result).max(initial=0.0) < 1e12:
            return result
    except np.linalg.LinAlgError:
        pass
    # by a complete orthogonal factorization, several times as fast as by singular values
    return scipy.linalg.lstsq(matrix, right, 1e-12, check_finite=False, lapack_driver="gelsy")[0]


def by_parameter(
    residual_at: Callable[[float], np.ndarray],
    value: float,
    residual: np.ndarray,
    scale: float,
    step: float,
    is_across: Callable[[float], bool] = lambda _: False,
    is_central: bool = False,
) -> np.ndarray:
    """Return the derivative of a residual with respect to a parameter over its scale, by a
    difference over a step, as a share of the scale, upwards where that is possible, or where
    is_central to both sides; is_across: whether the residual has a corner between its value and
    another one."""
    result, ends = np.zeros(0), [value + side * scale for side in (step, -step)]
    with suppress(QuantityError):
        if is_central and not any(map(is_across, ends)):
            above, below = map(residual_at, ends)
            return (above - below) / (2 * step)
    for side, end in zip((step, -step), ends, strict=True):
        with suppress(QuantityError):  # beyond what the machine can have
            result = (residual_at(end) - residual) / side
            if not is_across(end):
                break
    return result


def predicted_correction(corrections: list[float]) -> float:
    """Return the predicted size of the next correction, with a margin, if the last ones converge
    quadratically, otherwise the size of the last one."""
    if len(corrections) < 2 or corrections[-1] > _SMALL_CORRECTION:
        return corrections[-1]
    last = corrections[-3:]
    rate = max(after / (before * before) for before, after in pairwise(last) if before > 0)
    is_shrinking = all(after < before for before, after in pairwise(last))
    return min(last[-1], _MARGIN * rate * last[-1] ** 2) if is_shrinking else last[-1]
