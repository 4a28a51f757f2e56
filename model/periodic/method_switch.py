"""From harmonic balance to shooting, and back: which equations suit a point of a curve."""

from __future__ import annotations

import numpy as np

from . import arclength
from .arclength import Lost, Point
from .balance import Orbit, Problem, last_share
from .fourier import resized
from .harmonic_count import Accuracy, refined, thinned
from .shooting import Shooting

_FEW = 0.3  # of the share of the highest harmonics with which a motion is balanced again
_AHEAD = 1e-4  # of the length of a curve: a difference by which its tangent is taken over

Motions = Problem | Shooting


def fitted(
    problem: Motions, point: Point, orbit: Orbit, accuracy: Accuracy, is_end: bool
) -> tuple[Motions, Point, bool]:
    """The equations that suit a point with this orbit, the point by them, and whether it lacks
    harmonics."""
    if isinstance(problem, Shooting):
        few = last_share(resized(orbit.b, accuracy.most)) < _FEW * accuracy.share
        if few and not is_end:
            series = problem.series.like(accuracy.most)
            try:
                return series, _taken_over(problem, point, series, orbit), False
            except Lost:
                pass
        return problem, point, False
    series = problem
    try:
        series, point = refined(series, point, accuracy, is_end)
        is_coarse = series.last_share(point.x) > accuracy.share
    except Lost:  # with more harmonics: it is followed with those that it has
        is_coarse = True
    if not is_end:
        series, point = thinned(series, point, accuracy)
    return series, point, is_coarse


def shot(problem: Motions, point: Point, orbit: Orbit) -> tuple[Shooting, Point]:
    """Shooting's equations of a motion from which those of its harmonics lead no further, and its
    point by them; raises `Lost` where these are them, and for whirl by itself."""
    if isinstance(problem, Shooting) or problem.is_autonomous:
        raise Lost([])
    other = Shooting(problem, orbit)
    return other, _taken_over(problem, point, other, orbit)


def _taken_over(problem: Motions, point: Point, other: Motions, orbit: Orbit) -> Point:
    """A point of the curve, whose orbit this is, by other equations; raises `Lost`."""
    scale = problem.parameter.scale
    far = point.value + _AHEAD * scale * point.by_value
    ahead = problem.split(point.x + _AHEAD * point.tangent, far)
    x = other.join(orbit)
    plane = np.append((other.join(ahead) - x) / _AHEAD, point.by_value)
    plane /= np.linalg.norm(plane)
    return arclength.correct(other, x, point.value, plane, scale, plane)
