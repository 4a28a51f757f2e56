"""Continuation of a curve of solutions R(x, lambda) = 0 by its arclength (Keller 1977).

The length of a step is measured in (x, (lambda - lambda_0) / scale). The predictor goes along the
tangent, bent as the curve was in the last step, or along the tangent beyond where it jumps (a
corner of a force law); Newton's method corrects at right angles to it.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np

from ..quantities import QuantityError

TOLERANCE = 1e-9  # of Newton's last correction, where equations are as exact as that
_SLOW = 0.3  # of the last correction: beyond, a correction is damped
_ITERATIONS, _AIM = 12, 4
_LEAST_SHARE, _ROUNDING = 1e-3, 1e-9  # of a damped correction; residuals that are rounding
_LEAST_AHEAD = 0.05  # of a damped correction after a predictor, which a shorter step spares
_SMALL, _MARGIN = 1e-4, 10.0  # a correction after which the next is foretold, with a margin
_LARGEST_CHANGE = 0.5  # of x in one correction, as a share of its size: beyond, a step was too long
_TURN = 0.9  # least cosine of two tangents one after another
_GROW, _SHRINK = 1.5, 0.5
_FARTHEST = 2.0  # of a step: how far the next point of a curve may be


class Equations(Protocol):
    """What is solved at a value of lambda; tolerance: of the last correction, in the units of x;
    damped_beyond: corrections of what size are damped if they do not shrink."""

    tolerance: float
    damped_beyond: float

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """What the equations lack."""

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Residual and its derivative by x."""


class Continued(Equations, Protocol):
    """What is continued in lambda."""

    def evaluate(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, its derivative by x, and by lambda over its scale."""


@dataclass(frozen=True)
class Steps:
    """Lengths of steps: first, least and most; how many points at most."""

    first: float = 0.02
    least: float = 1e-6
    most: float = 0.05
    points: int = 2000


class Point(NamedTuple):
    """A point of a curve: unknowns, lambda, the unit tangent by x and by lambda over its scale,
    Newton's corrections on the way to it, and by how much the tangent turned per length on that
    way, shape (n + 1,), or (0,) where it is not known."""

    x: np.ndarray
    value: float
    tangent: np.ndarray
    by_value: float
    corrections: tuple[float, ...] = ()
    bend: np.ndarray = np.zeros(0)

    @property
    def direction(self) -> np.ndarray:
        """The tangent by the unknowns and by lambda over its scale."""
        return np.append(self.tangent, self.by_value)


class Lost(RuntimeError):
    """A corrector that does not converge; `corrections` says how it went."""

    def __init__(self, corrections: list[float]) -> None:
        self.corrections = corrections
        super().__init__("Newton's method does not converge")


def solve(equations: Equations, x: np.ndarray, value: float, iterations: int = 40) -> np.ndarray:
    """The unknowns at a fixed lambda, by Newton's method, damped; raises `Lost`."""
    x, corrections = x.copy(), []
    for _ in range(iterations):
        residual, jacobian = equations.linearized(x, value)
        step = -_solved(jacobian, residual)
        size = float(np.linalg.norm(step))
        if not np.isfinite(size):
            break
        limit = 0.5 * (1.0 + float(np.linalg.norm(x)))
        most = min(1.0, limit / size) if size > 0 else 1.0
        relax = _relaxed(equations, residual, x, value, step, 0.0, most)
        corrections.append(relax * size)
        x += relax * step
        if size <= equations.tolerance * (1.0 + np.linalg.norm(x)):
            return x
    raise Lost(corrections)


def _relaxed(
    equations: Equations,
    residual: np.ndarray,
    x: np.ndarray,
    value: float,
    step: np.ndarray,
    of_value: float,
    relax: float,
    least: float = _LEAST_SHARE,
) -> float:
    """Share of a correction of x and of lambda after which the residual is smaller (Armijo), or the
    least tried."""
    size = float(np.linalg.norm(residual))
    while relax > least:
        ahead = equations.residual(x + relax * step, value + relax * of_value)
        left = float(np.linalg.norm(ahead))
        if left <= (1.0 - 0.1 * relax) * size or size < _ROUNDING:
            break
        relax *= 0.5
    return relax


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The least solution, where a matrix is singular to rounding."""
    try:
        result = np.linalg.solve(matrix, right)
        if np.isfinite(result).all() and np.abs(result).max(initial=0.0) < 1e12:
            return result
    except np.linalg.LinAlgError:
        pass
    return np.linalg.lstsq(matrix, right, rcond=1e-12)[0]


def _next(corrections: list[float]) -> float:
    """How large the next correction would be, if the last ones converge quadratically, with a
    margin; the last one itself if they do not."""
    if len(corrections) < 2 or corrections[-1] > _SMALL:
        return corrections[-1]
    last = corrections[-3:]
    rate = max(after / (before * before) for before, after in pairwise(last) if before > 0)
    is_shrinking = all(after < before for before, after in pairwise(last))
    return min(last[-1], _MARGIN * rate * last[-1] ** 2) if is_shrinking else last[-1]


def begin(equations: Continued, x: np.ndarray, value: float, direction: float) -> Point:
    """The point at unknowns that solve the equations, its tangent towards larger (1) or smaller
    (-1) lambda."""
    _, jacobian, by = equations.evaluate(x, value)
    tangent = np.append(-_solved(jacobian, by), 1.0)
    tangent *= direction / np.linalg.norm(tangent)
    return Point(x, value, tangent[:-1], float(tangent[-1]))


def correct(
    equations: Continued,
    x: np.ndarray,
    value: float,
    plane: np.ndarray,
    scale: float,
    before: np.ndarray,
    iterations: int = _ITERATIONS,
) -> Point:
    """Newton's method at right angles to `plane`; the tangent is that which goes on from `before`.
    Raises `Lost`, also where it leads to a value that no machine can have."""
    try:
        return _corrected(equations, x, value, plane, scale, before, iterations)
    except QuantityError as error:
        raise Lost([]) from error


def _corrected(
    equations: Continued,
    x: np.ndarray,
    value: float,
    plane: np.ndarray,
    scale: float,
    before: np.ndarray,
    iterations: int,
) -> Point:
    """Newton's method at right angles to a plane."""
    x, corrections = x.copy(), []
    n = len(x)
    bordered = np.zeros((n + 1, n + 1))
    right = np.zeros((n + 1, 2))
    limit = _LARGEST_CHANGE * (1.0 + float(np.linalg.norm(x)))
    for _ in range(iterations):
        residual, jacobian, by = equations.evaluate(x, value)
        bordered[:n, :n], bordered[:n, n], bordered[n] = jacobian, by, plane
        right[:n, 0], right[n, 1] = -residual, 1.0
        step, tangent = _solved(bordered, right).T
        size = float(np.linalg.norm(step))
        corrections.append(size)
        if not size < limit:
            break
        relax = 1.0
        if len(corrections) > 1 and size > max(_SLOW * corrections[-2], equations.damped_beyond):
            relax = _relaxed(
                equations, residual, x, value, step[:n], scale * step[n], 1.0, _LEAST_AHEAD
            )
            if relax < _LEAST_AHEAD:
                break
        x += relax * step[:n]
        value += scale * relax * step[n]
        of_x = 1.0 + float(np.linalg.norm(x))
        if relax == 1.0 and _next(corrections) <= equations.tolerance * of_x:
            tangent = tangent / np.linalg.norm(tangent)
            if tangent @ before < 0:
                tangent = -tangent
            return Point(x, float(value), tangent[:n], float(tangent[n]), tuple(corrections))
    raise Lost(corrections)


def onward(equations: Continued, point: Point, length: float, scale: float) -> Point:
    """The point a step along the tangent away; raises `Lost`."""
    plane = way = point.direction
    if len(point.bend):
        way = plane + 0.5 * length * point.bend
    return correct(
        equations,
        point.x + length * way[:-1],
        point.value + length * scale * way[-1],
        plane,
        scale,
        plane,
    )


def trace(
    equations: Continued, start: Point, scale: float, low: float, high: float, steps: Steps
) -> Generator[tuple[Point, float], tuple[Continued, Point] | None, None]:
    """Points of the curve from `start` on, each with the length of the next step, until lambda
    leaves [low, high]: the last point is at that end. Raises `Lost` where no step is short enough.

    What is sent in, (equations, point), takes the place of the equations and of the last point:
    with other harmonics.
    """
    point, length = start, steps.first
    for _ in range(steps.points):
        try:
            ahead = point.value + length * scale * point.by_value
            if not low <= ahead <= high:
                end = low if ahead < low else high
                if point.value == end:
                    return
                share = (end - point.value) / (scale * point.by_value)
                yield _at_end(equations, point, share, end), length
                return
            result = onward(equations, point, length, scale)
            turned = float(result.tangent @ point.tangent + result.by_value * point.by_value)
            if not low <= result.value <= high:
                raise Lost(list(result.corrections))
            moved = np.append(result.x - point.x, (result.value - point.value) / scale)
            way = float(np.linalg.norm(moved))
            if way > _FARTHEST * length:  # another branch
                raise Lost(list(result.corrections))
            if turned < _TURN and length > 64 * steps.least:
                raise Lost(list(result.corrections))
            if turned >= _TURN and way > 0:
                result = result._replace(bend=(result.direction - point.direction) / way)
        except Lost as error:
            length *= _SHRINK
            if length >= steps.least:
                continue
            corner = _around_corner(equations, point, steps, scale)
            if corner is None:
                raise Lost(error.corrections) from None
            result, length = corner, 16 * steps.least
        of_x = 1.0 + float(np.linalg.norm(result.x))
        # one that was foretold counts
        iterations = len(result.corrections) + (result.corrections[-1] > equations.tolerance * of_x)
        if iterations < _AIM:
            length *= _GROW
        elif iterations > _AIM + 1:
            length *= 0.7
        length = min(length, steps.most)
        point = result
        taken = yield point, length
        if taken is not None:
            equations, point = taken


def _around_corner(equations: Continued, point: Point, steps: Steps, scale: float) -> Point | None:
    """A point beyond a corner of the curve, where its tangent jumps: in the tangent's direction a
    little way on, where the forces are others; None where there is none."""
    plane = point.direction
    for length in (4 * steps.least, 64 * steps.least, 1e3 * steps.least):
        x = point.x + length * point.tangent
        value = point.value + length * scale * point.by_value
        _, jacobian, by = equations.evaluate(x, value)
        beyond = np.append(-_solved(jacobian, by), 1.0)
        beyond /= np.linalg.norm(beyond)
        for direction in (beyond, -beyond):
            try:
                result = correct(
                    equations,
                    point.x + length * direction[:-1],
                    point.value + length * scale * direction[-1],
                    direction,
                    scale,
                    direction,
                )
            except Lost:
                continue
            moved = np.append(result.x - point.x, (result.value - point.value) / scale)
            if moved @ plane > 0.05 * np.linalg.norm(moved) > 0:
                return result
    return None


def _at_end(equations: Continued, point: Point, length: float, value: float) -> Point:
    """The point at an end, about so long a step away; raises `Lost`."""
    x = solve(equations, point.x + length * point.tangent, value, _ITERATIONS)
    if np.linalg.norm(x - point.x) > 3.0 * length + equations.tolerance:
        raise Lost([])
    return point._replace(x=x, value=value)
