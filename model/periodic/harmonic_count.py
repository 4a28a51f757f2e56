"""The number of harmonics of a motion: increased while the highest are not small, reduced where
they are far below the accuracy."""

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from . import arclength
from .arclength import ContinuationEquations, CurvePoint
from .balance import HarmonicBalance, Orbit
from .fourier import last_share, resized
from .newton import NotConverged

_LARGE_FACTOR, _SMALL_FACTOR = 1.4, 1.1  # times the harmonics, at once; where these are too many
_BESIDE_FOLD = 0.01  # longest way along the curve to the other side of a fold


@dataclass(frozen=True)
class Accuracy:
    """Number of harmonics, `least` to `most`, such that the highest are below `share` of the
    motion; has_stability: whether multipliers are computed."""

    share: float = 1e-5
    least: int = 3
    most: int = 60
    has_stability: bool = True


def counts_to_solve_with(orbit: Orbit, accuracy: Accuracy) -> Iterator[int]:
    """Yield numbers of harmonics with which to solve for a motion near an orbit: those that the
    accuracy demands of it, then all that it has, with which Newton's method converges more often
    and takes far longer."""
    every = min(max(orbit.H, accuracy.least), accuracy.most)
    for H in range(accuracy.least * orbit.turns, every):
        if last_share(resized(orbit.b, H)) <= accuracy.share:
            yield H
            break
    yield every


def with_enough_harmonics(
    problem: HarmonicBalance, point: CurvePoint, accuracy: Accuracy, keeps_value: bool = False
) -> tuple[HarmonicBalance, CurvePoint]:
    """Return equations and point with as many harmonics as the accuracy demands; keeps_value: solve
    at the same value of the parameter instead of at right angles to the curve. Raises
    `NotConverged`."""

    def with_more(factor: float) -> tuple[HarmonicBalance, CurvePoint]:
        H = min(accuracy.most, math.ceil(factor * problem.H) + problem.turns)
        other = problem.modified(H, reference=point.value)
        return other, _solved_by(other, problem, point, keeps_value)

    while problem.last_share(point.x) > accuracy.share and accuracy.most > problem.H:
        try:
            problem, point = with_more(_LARGE_FACTOR)
        except NotConverged:
            problem, point = with_more(_SMALL_FACTOR)
    return problem, point


def _solved_by(
    other: HarmonicBalance, problem: HarmonicBalance, point: CurvePoint, keeps_value: bool = False
) -> CurvePoint:
    """Return a point of the equations `problem` as one of the equations `other`, with another
    number of harmonics; raises `NotConverged`."""
    before = _converted_direction(problem, point.direction, other)
    before /= np.linalg.norm(before)
    x = problem.converted(point.x, other)
    if keeps_value:
        plane = np.append(np.zeros(len(before) - 1), 1.0)
        result = arclength.correct(other, x, point.value, plane, before)
    else:
        result = transferred(other, x, point, before)
    curvature = _converted_direction(problem, point.curvature, other)
    return result._replace(corrections=point.corrections, curvature=curvature)


def transferred(
    other: ContinuationEquations, x: np.ndarray, point: CurvePoint, tangent: np.ndarray
) -> CurvePoint:
    """Return a point as one of other equations, near x and with nearly this tangent, on the same
    side of a fold: that a step passes a fold is seen by the signs of lambda's component at its
    ends. Raises `NotConverged`."""
    result = near = arclength.correct(other, x, point.value, tangent)
    length = -abs(near.tangent_value)  # of the size of the distance of the fold
    while result.tangent_value * point.tangent_value < 0:
        if abs(length) > _BESIDE_FOLD:
            raise NotConverged()
        result = arclength.step_along(other, near, length)
        length *= -2.0  # back and on
    return result


def _converted_direction(
    problem: HarmonicBalance, direction: np.ndarray, other: HarmonicBalance
) -> np.ndarray:
    """Return a direction of the curve, which may be empty, with another number of harmonics."""
    if not len(direction):
        return direction
    return np.append(problem.converted(direction[:-1], other), direction[-1])


def with_fewer_harmonics(
    problem: HarmonicBalance, point: CurvePoint, accuracy: Accuracy
) -> tuple[HarmonicBalance, CurvePoint]:
    """Return equations and point without the harmonics that are far below the accuracy."""
    H = max(accuracy.least * problem.turns, math.ceil(0.6 * problem.H))
    if H < problem.H and problem.last_share(point.x) < 1e-3 * accuracy.share:
        other = problem.modified(H, reference=point.value)
        if other.last_share(problem.converted(point.x, other)) < 0.1 * accuracy.share:
            with suppress(NotConverged):
                return other, _solved_by(other, problem, point)
    return problem, point
