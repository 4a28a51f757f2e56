"""Pseudo-arclength continuation of a curve of solutions R(x, lambda) = 0 (Keller 1977).

Step lengths are measured in (x, (lambda - lambda_0) / scale). The predictor goes along the tangent,
bent as the curve was in the last step, or along the tangent on the other side of a corner, where
the force law makes it jump; Newton's method corrects at right angles to it.
"""

import math
from collections.abc import Generator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from ..quantities import QuantityError
from .newton import (
    Equations,
    NotConverged,
    by_parameter,
    damping_factor,
    predicted_correction,
    solve,
)

_SLOW_CONVERGENCE = 0.3  # of the last correction: beyond, a correction is damped
_ITERATIONS, _DESIRED_ITERATIONS = 12, 4
_LEAST_DAMPING_AHEAD = 0.05  # of a damped correction after a predictor, which a shorter step spares
_LARGEST_CHANGE = 0.5  # of x in one correction, as a share of its size: beyond, a step was too long
_LEAST_COSINE = 0.9  # least cosine of two tangents one after another
_ERRORS = 1e3  # of a point: a change of x in which no resonance is looked for
# Share of a step that its end may lie aside of its begin's and its end's mean tangent, which a
# smooth curve does by the third power of the step: beyond, something lies between.
_ASIDE = 0.03
_UNSEEN = 1e-4  # of x: the highest harmonics' error; a touch that moves by a sample changes x less
SAME_PIECE = 1e-4  # difference of cosines within which two tangents are of one smooth piece
_ACROSS_STEP = 4.0  # times as large is 1 less the cosine of the tangents at both ends of a way
_GROW, _SHRINK = 1.5, 0.5
_LARGEST_DISTANCE = 2.0  # of a step: how far the next point of a curve may be


class ContinuationEquations(Equations):
    """Equations whose solutions are continued in lambda; scale: unit of lambda, the length of its
    range; difference: step of differences by lambda, as a share of its scale, to both sides where
    is_central."""

    scale: float
    difference: float
    is_central = False

    def linearized_with_parameter(
        self, x: np.ndarray, value: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the residual, the Jacobian, and the derivative with respect to lambda over its
        scale."""
        residual, jacobian = self.linearized(x, value)
        beside, is_across = partial(self.residual, x), partial(self.is_across, x, value)
        options = self.scale, self.difference, is_across, self.is_central
        return residual, jacobian, by_parameter(beside, value, residual, *options)

    def is_across(self, x: np.ndarray, value: float, other: float) -> bool:
        """Return whether the residual has a corner between two values of lambda."""
        return False

    def motion(self, x: np.ndarray, value: float) -> np.ndarray:
        """Return the motion of a solution, shape (n,), by which the longest step is measured: by
        default the unknowns themselves."""
        return x

    def of_motion(self, way: np.ndarray) -> np.ndarray:
        """Return the components of a way that are smooth between corners: by default all."""
        return way

    def seen(
        self, x: np.ndarray, value: float, direction: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return what a reader of the curve sees of a solution beside lambda, shape (n,), in any
        unit, and its derivative along a direction of the curve (see `CurvePoint.direction`)."""
        return np.zeros(0), np.zeros(0)


@dataclass(frozen=True)
class ContinuationSteps:
    """Step lengths of a continuation: initial and shortest, in the units of x; longest, and the
    size of a motion from which on it grows with that, in those of `ContinuationEquations.motion`;
    and the largest number of steps in one direction."""

    initial: float = 0.02
    shortest: float = 1e-6
    longest: float = 0.05
    large: float = 10.0
    max_points: int = 2000


class CurvePoint(NamedTuple):
    """A point of a curve: unknowns, lambda, the components of the unit tangent in x and in lambda
    over its scale, Newton's corrections on the way to the point, and the change of the tangent per
    length on that way, shape (n + 1,), or (0,) where it is not known."""

    x: np.ndarray
    value: float
    tangent: np.ndarray
    tangent_value: float
    corrections: tuple[float, ...] = ()
    curvature: np.ndarray = np.zeros(0)

    @property
    def direction(self) -> np.ndarray:
        """The unit tangent, its component in lambda over its scale last."""
        return np.append(self.tangent, self.tangent_value)

    def cosine(self, other: "CurvePoint") -> float:
        """Return the cosine of the tangents of two points."""
        return float(self.tangent @ other.tangent + self.tangent_value * other.tangent_value)


def chord(a: CurvePoint, b: CurvePoint, scale: float) -> np.ndarray:
    """Return the way from one point to another, that in lambda over its scale last."""
    return np.append(b.x - a.x, (b.value - a.value) / scale)


def distance(a: CurvePoint, b: CurvePoint, scale: float) -> float:
    """Return the distance of two points, with lambda over its scale."""
    return float(np.hypot(np.linalg.norm(b.x - a.x), (b.value - a.value) / scale))


def with_tangent(
    equations: ContinuationEquations, x: np.ndarray, value: float, direction: float
) -> CurvePoint:
    """Return the point at a solution, its tangent to larger (1) or smaller (-1) lambda."""
    tangent = direction * _along(equations, x, value)
    return CurvePoint(x, value, tangent[:-1], float(tangent[-1]))


def _along(equations: ContinuationEquations, x: np.ndarray, value: float) -> np.ndarray:
    """Return the direction of the curve, of length 1, towards larger lambda: that at right angles
    to all rows of the derivatives, also where lambda stays."""
    _, jacobian, by_lambda = equations.linearized_with_parameter(x, value)
    rows = np.column_stack([jacobian, by_lambda])
    tangent = np.linalg.qr(rows.T, mode="complete")[0][:, -1]
    return np.asarray(math.copysign(1.0, tangent[-1]) * tangent)


def correct(
    equations: ContinuationEquations,
    x: np.ndarray,
    value: float,
    plane: np.ndarray,
    before: np.ndarray | None = None,
) -> CurvePoint:
    """Return the point that Newton's method finds at right angles to `plane`; its tangent continues
    in the direction of `before`, by default that of `plane`. Raises `NotConverged`, also where the
    iteration leads to a value that no machine can have."""
    x, corrections = x.copy(), list[float]()
    n, scale = len(x), equations.scale
    bordered = np.zeros((n + 1, n + 1))
    right = np.zeros((n + 1, 2))
    limit = _LARGEST_CHANGE * (1.0 + float(np.linalg.norm(x)))
    for _ in range(_ITERATIONS):
        try:
            residual, jacobian, by_lambda = equations.linearized_with_parameter(x, value)
            bordered[:n, :n], bordered[:n, n], bordered[n] = jacobian, by_lambda, plane
            right[:n, 0], right[n, 1] = -residual, 1.0
            step, tangent = equations.solve_linear(bordered, right).T
            size = float(np.linalg.norm(step))
            corrections.append(size)
            if not size < limit:
                break
            damping = 1.0
            if len(corrections) > 1 and size > max(
                _SLOW_CONVERGENCE * corrections[-2], equations.damped_beyond
            ):
                by_x, by_value = step[:n], scale * step[n]
                damping = damping_factor(
                    equations, residual, x, value, by_x, by_value, 1.0, _LEAST_DAMPING_AHEAD
                )
                if damping < _LEAST_DAMPING_AHEAD:
                    break
        except QuantityError as error:
            raise NotConverged() from error
        x += damping * step[:n]
        value += scale * damping * step[n]
        of_x = 1.0 + float(np.linalg.norm(x))
        if damping == 1.0 and predicted_correction(corrections) <= equations.tolerance * of_x:
            tangent = tangent / np.linalg.norm(tangent)
            if tangent @ (plane if before is None else before) < 0:
                tangent = -tangent
            return CurvePoint(x, float(value), tangent[:n], float(tangent[n]), tuple(corrections))
    raise NotConverged(corrections)


def step_along(equations: ContinuationEquations, point: CurvePoint, length: float) -> CurvePoint:
    """Return the point so far away along the tangent; raises `NotConverged`."""
    plane = predictor = point.direction
    if len(point.curvature):
        predictor = plane + 0.5 * length * point.curvature
        predictor /= predictor @ plane  # the bend changes no length along the tangent
    x = point.x + length * predictor[:-1]
    value = point.value + length * equations.scale * predictor[-1]
    return correct(equations, x, value, plane)


def trace(
    equations: ContinuationEquations,
    start: CurvePoint,
    low: float,
    high: float,
    steps: ContinuationSteps,
) -> Generator[tuple[CurvePoint, float], tuple[ContinuationEquations, CurvePoint] | None, None]:
    """Yield the points of the curve from `start` on, each with the length of the next step, until
    lambda leaves [low, high]; the last point lies at that end. Raises `NotConverged` where no step
    is short enough.

    A pair (equations, point) that is sent in replaces the equations and the last point, so that the
    number of harmonics can change on the way.
    """
    point, length, bend, scale = start, steps.initial, math.inf, equations.scale
    motion = equations.motion(point.x, point.value)
    for _ in range(steps.max_points):
        try:
            ahead = point.value + length * scale * point.tangent_value
            if not low <= ahead <= high:
                end = low if ahead < low else high
                if point.value == end:
                    return
                share = (end - point.value) / (scale * point.tangent_value)
                yield _end_point(equations, point, share, end), length
                return
            result = step_along(equations, point, length)
            cosine = result.cosine(point)
            if not low <= result.value <= high:
                raise NotConverged(result.corrections)
            distance = float(np.linalg.norm(chord(point, result, scale)))
            if distance > _LARGEST_DISTANCE * length:  # another branch
                raise NotConverged(result.corrections)
            is_far = cosine < _LEAST_COSINE or _passes_over(equations, point, result)
            if is_far and length > 64 * steps.shortest:
                raise NotConverged(result.corrections)
            if cosine >= _LEAST_COSINE and distance > 0:
                result = result._replace(curvature=(result.direction - point.direction) / distance)
        except NotConverged as error:
            length *= _SHRINK
            if length >= steps.shortest:
                continue
            corner = _beyond_corner(equations, point, bend, steps)
            if corner is None:
                raise NotConverged(error.corrections) from None
            result, length = corner, 16 * steps.shortest
        of_x = 1.0 + float(np.linalg.norm(result.x))
        # a correction that was predicted rather than computed counts as one
        iterations = len(result.corrections) + (result.corrections[-1] > equations.tolerance * of_x)
        if iterations < _DESIRED_ITERATIONS:
            length *= _GROW
        elif iterations > _DESIRED_ITERATIONS + 1:
            length *= 0.7
        way, before = chord(point, result, scale), motion
        motion = equations.motion(result.x, result.value)
        moved, of_x = (float(np.linalg.norm(each)) for each in (motion - before, way[:-1]))
        size = float(np.linalg.norm(motion))
        length = min(length, _longest(steps, result, size, moved / of_x if of_x else 1.0))
        bend = 1.0 - float(result.direction @ way / np.linalg.norm(way)) if way.any() else math.inf
        point = result
        replacement = yield point, length
        if replacement is not None:
            equations, point = replacement
            motion = equations.motion(point.x, point.value)


def _passes_over(equations: ContinuationEquations, before: CurvePoint, after: CurvePoint) -> bool:
    """Return whether the way between two points is not the mean of their tangents, or the change of
    what is seen does not lie between those along them: a step passes over an S-bend, over a narrow
    resonance, beyond which x has another sign, or back to where the curve came from. What is seen,
    measured by its own size, must not turn far either: a resonance may lie where x hardly moves."""
    error, points = _ERRORS * equations.tolerance, (before, after)
    way = chord(before, after, equations.scale)
    length = float(np.linalg.norm(way))
    off = way - 0.5 * length * (before.direction + after.direction)
    aside = np.linalg.norm(equations.of_motion(off))
    if aside > _ASIDE * length + _UNSEEN * (1.0 + np.linalg.norm(after.x)):
        return True
    seen, slopes = zip(*(equations.seen(p.x, p.value, p.direction) for p in points), strict=True)
    size = max(float(np.linalg.norm(each)) for each in seen)
    if size == 0.0:
        return False
    first, last = (np.append(p.direction, s / size) for p, s in zip(points, slopes, strict=True))
    cosine = first @ last / (np.linalg.norm(first) * np.linalg.norm(last))
    off = np.linalg.norm(seen[1] - seen[0] - 0.5 * length * sum(slopes))
    most = 0.5 * length * sum(np.linalg.norm(slope) for slope in slopes)
    return bool(cosine < _LEAST_COSINE or off > most + error * size)


def _longest(steps: ContinuationSteps, point: CurvePoint, size: float, rate: float) -> float:
    """Return the longest step from a point: of a large motion it is a share of its size, while that
    in lambda stays the same; rate: of the motion's change to that of x."""
    along = abs(point.tangent_value)
    longest = steps.longest * max(1.0, size / steps.large)
    longest /= math.sqrt(1.0 + (rate**2 - 1.0) * (1.0 - along**2))
    return longest if along * longest <= steps.longest else steps.longest / along


def _beyond_corner(
    equations: ContinuationEquations, point: CurvePoint, bend: float, steps: ContinuationSteps
) -> CurvePoint | None:
    """Return a point beyond a corner of the curve, a short way along the tangent that holds on the
    other side of the corner, or None if there is no such point; bend: 1 less the cosine of the way
    to this point and the tangent here, which is large where a difference across the corner
    falsifies that tangent."""
    plane, scale = point.direction, equations.scale
    # where lambda turns the curve may double back, on another piece by its tangent
    same_piece = SAME_PIECE + _ACROSS_STEP * bend
    for length in (4 * steps.shortest, 64 * steps.shortest, 1e3 * steps.shortest):
        x = point.x + length * point.tangent
        value = point.value + length * scale * point.tangent_value
        beyond = _along(equations, x, value)
        for direction in (beyond, -beyond):
            ahead = x + length * direction[:-1], value + length * scale * direction[-1]
            try:
                result = correct(equations, *ahead, direction)
            except NotConverged:
                continue
            way = chord(point, result, scale)
            by_beyond, by_plane = (abs(result.direction @ each) for each in (beyond, plane))
            is_ahead = way @ plane > 0.05 * np.linalg.norm(way)
            is_other = by_beyond > by_plane + same_piece
            if (is_ahead or is_other) and way.any():
                return result
    return None


def _end_point(
    equations: ContinuationEquations, point: CurvePoint, length: float, value: float
) -> CurvePoint:
    """Return the point at an end of the range, about that length away; raises `NotConverged`."""
    x = solve(equations, point.x + length * point.tangent, value, _ITERATIONS)
    end = with_tangent(equations, x, value, math.copysign(1.0, point.tangent_value))
    if _passes_over(equations, point, end):
        raise NotConverged()
    return end
