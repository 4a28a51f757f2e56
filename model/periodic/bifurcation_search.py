"""Search for the bifurcations between two points of a branch, each where its condition is met."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from . import arclength
from .arclength import CurvePoint, NotConverged, distance
from .branch import (
    BRANCHING,
    DOUBLING,
    FOLD,
    GRAZING,
    NO_MOTION,
    TORUS,
    UNIT,
    Bifurcation,
    Solution,
    stability_multipliers,
    with_motion,
)
from .method_switch import PeriodicEquations

_VERTICAL = 0.05  # a smaller component of the tangent along the parameter: a fold is near
_NEAR_ONE = 1e-2  # distance from 1 within which rounding may separate a double multiplier
_EVALUATIONS = 40  # evaluations of a test function at most
_PRECISE = 1e-9  # of a step along the curve
_CLOSE = 1e-5  # of a step: a test function changes little so close to its root
_LITTLE = 1e-2  # of its larger value at the ends of the step


class _Located(NamedTuple):
    """A bifurcation located on a step: its kind, where, the multiplier that crosses, and whether
    what is 0 there is smooth."""

    kind: str
    point: CurvePoint
    multiplier: complex
    is_smooth: bool

    def is_one_with(self, other: "_Located") -> bool:
        """Return whether both are one bifurcation: of a complex pair of multipliers, or of several
        that jump."""
        apart = abs(abs(self.multiplier.imag) - abs(other.multiplier.imag))
        is_pair = self.kind == other.kind == TORUS and apart < 1e-3
        return is_pair or self.kind == other.kind == GRAZING


def _bifurcation(problem: PeriodicEquations, located: _Located) -> Bifurcation:
    """Return a bifurcation with its motion; what is behind it, its branch knows."""
    point = located.point
    orbit = problem.split(point.x, point.value)
    made = Bifurcation(located.kind, point.value, orbit, NO_MOTION, located.multiplier, -1)
    return with_motion(problem, made)


def bifurcations_between(
    problem: PeriodicEquations, before: CurvePoint, after: CurvePoint, last: Solution, now: Solution
) -> list[Bifurcation]:
    """Return the bifurcations between two points, at which the motions are `last` and `now`, in
    their order along the curve; where these have no multipliers, the folds alone."""
    located = list[_Located]()
    turns = before.tangent_value * after.tangent_value < 0
    if turns:
        located.append(_locate_fold(problem, before, after, len(now.multipliers) > 0))
    few, many = sorted(int((np.abs(s.multipliers) > UNIT).sum()) for s in (last, now))
    for k in range(few + 1, many + 1):
        crossed = _locate_crossing(problem, before, after, k)
        if crossed is None or any(crossed.is_one_with(each) for each in located):
            continue
        # where the curve turns in a corner multipliers jump
        is_one = abs(crossed.multiplier - 1.0) < _NEAR_ONE
        is_at_one = crossed.kind == BRANCHING or (problem.is_autonomous and is_one)
        if not turns or (crossed.is_smooth and not is_at_one):
            located.append(crossed)
    located.sort(key=lambda each: distance(before, each.point, problem.parameter.scale))
    return [_bifurcation(problem, each) for each in located]


def _locate_fold(
    problem: PeriodicEquations, before: CurvePoint, after: CurvePoint, has_stability: bool
) -> _Located:
    """Return the fold, where the tangent has no component along the parameter."""
    ends = before.tangent_value, after.tangent_value
    point, is_smooth = _locate_root(problem, before, after, lambda p: p.tangent_value, *ends)
    multiplier = complex(math.nan)
    if is_smooth and has_stability:
        values = _multipliers(problem, point)
        multiplier = complex(values[np.argmin(np.abs(values - 1.0))])
    return _Located(FOLD if is_smooth else GRAZING, point, multiplier, is_smooth)


def _multipliers(problem: PeriodicEquations, point: CurvePoint) -> np.ndarray:
    return stability_multipliers(problem, point, problem.split(point.x, point.value))


def _locate_crossing(
    problem: PeriodicEquations, before: CurvePoint, after: CurvePoint, k: int
) -> _Located | None:
    """Return where the k-th largest multiplier crosses the unit circle, or None."""

    def size(point: CurvePoint) -> float:
        value = _multipliers(problem, point)[k - 1]
        return math.log(max(abs(value), 1e-300)) - math.log(UNIT)

    first, second = size(before), size(after)
    if first * second >= 0:
        return None
    point, is_smooth = _locate_root(problem, before, after, size, first, second)
    value = complex(_multipliers(problem, point)[k - 1])
    real = abs(value.imag) < 1e-6 * abs(value)
    kind = TORUS if not real else DOUBLING if value.real < 0 else BRANCHING
    steepest = max(abs(before.tangent_value), abs(after.tangent_value))
    if kind == BRANCHING and abs(point.tangent_value) < _VERTICAL * steepest:
        return None  # a fold, in this step or beside it
    if kind == BRANCHING and not is_smooth:
        return _Located(GRAZING, point, complex(math.nan), is_smooth)
    return _Located(kind, point, value, is_smooth)


def _locate_root(
    problem: PeriodicEquations,
    before: CurvePoint,
    after: CurvePoint,
    test: Callable[[CurvePoint], float],
    at_before: float,
    at_after: float,
) -> tuple[CurvePoint, bool]:
    """Return the root of a test function along the step, by Brent's method, and whether the
    function is smooth there."""
    scale = problem.parameter.scale
    along = before.tangent_value * ((after.value - before.value) / scale)
    end = float(before.tangent @ (after.x - before.x) + along)
    known = {0.0: (before, at_before), end: (after, at_after)}  # points, values by distance

    def tested(s: float) -> float:
        if s not in known:
            point = arclength.step_along(problem, before, s, scale)
            known[s] = point, test(point)
        return known[s][1]

    little = _LITTLE * max(abs(at_before), abs(at_after))
    try:
        options = {"xtol": _PRECISE * abs(end), "maxiter": _EVALUATIONS, "disp": False}
        root = brentq(tested, 0.0, end, **options)
        point, _ = known[root]
        # not at the root alone: within rounding of a corner a function has any value
        beside = np.clip([root - _CLOSE * end, root + _CLOSE * end], min(0.0, end), max(0.0, end))
        return point, all(abs(tested(float(s))) < little for s in beside)
    except NotConverged:
        return list(known.values())[-1][0], False
