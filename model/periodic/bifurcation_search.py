"""Search for the bifurcations between two points of a branch, each where its condition is met."""

import math
from collections.abc import Callable
from contextlib import suppress
from copy import copy
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import linear_sum_assignment

from .arclength import CurvePoint, distance
from .balance import Orbit
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
from .newton import NotConverged
from .piece import PiecePoints

_NEAR_ONE = 1e-2  # distance from 1 within which rounding may separate a double multiplier
_STILL = 1e-9  # component of a tangent along the parameter that is rounding
_ROUGH = 1e-3  # error of a multiplier where few harmonics, or steps that change, give it
_HALVINGS = 10  # of a step with more than one bifurcation, at most
_LOOKS = 2  # halvings of a step in which multipliers only come near to the unit circle,
_NEAR_CIRCLE, _TINY = 0.1, 1e-300  # in the logarithm of their sizes,
_NEAR_IF_FAST = 0.3  # or those that meet on the real axis, or where a wall is touched once more,
_AND_BACK = 4.0  # which may move a multiplier to and fro by so many times its change in the step


class _Located(NamedTuple):
    """A bifurcation located on a step: its kind, where, the multiplier that crosses, and whether
    what is 0 there is smooth."""

    kind: str
    point: CurvePoint
    multiplier: complex
    is_smooth: bool

    def is_split_of(self, fold: "_Located") -> bool:
        """Return whether this is where the multiplier that is 1 at a fold of a whirl, and the one
        that is always 1, leave the unit circle as the pair that few harmonics make of them."""
        one, other = (complex(m.real, abs(m.imag)) for m in (self.multiplier, fold.multiplier))
        return self.kind == TORUS and abs(one - other) < _NEAR_ONE

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
    their order along the curve; where these have no multipliers, those at which it turns."""
    step = _Piece(before, after, last.multipliers, now.multipliers, last.orbit, now.orbit)
    looked_at = copy(problem)  # the search must not change the steps with which the curve goes on
    located = _located_on(looked_at, step, _HALVINGS)
    if problem.is_autonomous:
        folds = [each for each in located if each.kind == FOLD]
        located = [each for each in located if not any(map(each.is_split_of, folds))]
    return [_bifurcation(looked_at, each) for each in located]


class _Piece(NamedTuple):
    """A piece of a step between two points, with the multipliers at both, the largest first, and
    both orbits."""

    before: CurvePoint
    after: CurvePoint
    first: np.ndarray
    second: np.ndarray
    first_orbit: Orbit
    second_orbit: Orbit

    @property
    def turns(self) -> bool:
        """Whether the parameter turns in it, and does not just stop to change."""
        first, second = self.before.tangent_value, self.after.tangent_value
        return first * second < 0 and min(abs(first), abs(second)) > _STILL

    @property
    def least_count(self) -> int:
        """How many bifurcations show, at least. Kinds are counted apart, since a multiplier that
        enters the unit circle hides another one that leaves it."""
        return int(np.abs(count_outside(self.second) - count_outside(self.first)).sum())

    def is_simple(self, problem: PeriodicEquations, halvings: int) -> bool:
        """Return whether not more than one bifurcation is expected; halvings: that are left."""
        if self.least_count or not len(self.second):
            return self.least_count <= 1
        touches = [_touches(problem, each) for each in (self.first_orbit, self.second_orbit)]
        # of two that cancel each other, one may be the begin of a contact
        if ((touches[0] > 0) != (touches[1] > 0)).any():
            return False
        both = np.zeros((2, max(len(self.first), len(self.second))), complex)
        both[0, : len(self.first)], both[1, : len(self.second)] = self.first, self.second
        both[1] = both[1, linear_sum_assignment(np.abs(both[0][:, None] - both[1]))[1]]
        first, second = np.log(np.maximum(np.abs(both), _TINY))
        moved, nearest = np.abs(second - first), np.minimum(np.abs(first), np.abs(second))
        crosses = (moved > _ROUGH) & (first * second < 0)
        # where a step was halved for one that comes near, its halves are looked at for any
        reach = moved if halvings == _HALVINGS else np.inf
        comes_near = (moved > _ROUGH) & (nearest < np.minimum(reach, _NEAR_CIRCLE))
        # two that meet on the real axis move as a root there, faster than the ends show
        may_move_fast = nearest < _NEAR_IF_FAST
        comes_near |= (_is_real(both[0]) != _is_real(both[1])) & may_move_fast
        # as where a motion touches a wall once more: on one side of it, and back on the other
        if (touches[0] != touches[1]).any():
            crosses |= (moved > _ROUGH) & (nearest < _AND_BACK * moved) & may_move_fast
        return not crosses.any() and not (comes_near.any() and halvings > _HALVINGS - _LOOKS)

    def is_explained_by(self, located: list["_Located"]) -> bool:
        """Return whether these bifurcations leave as many multipliers outside as there are at the
        end: real ones beyond -1 come and go in pairs but for those that cross there."""
        kinds = [each.kind for each in located]
        if GRAZING in kinds or not len(self.second):
            return True
        above, below, pairs = count_outside(self.second) - count_outside(self.first)
        doublings, tori = kinds.count(DOUBLING), kinds.count(TORUS)
        if (below - doublings) % 2:
            return False
        # with real ones that cross, which are folds above all, pairs may come and go at any number
        return bool(above % 2 or doublings or (above + below + 2 * pairs - 2 * tori) % 4 == 0)

    def is_branching(self, problem: PeriodicEquations) -> bool:
        """Return whether a branch passes through it, or the curve has a corner in it: the
        determinant of the Jacobian, bordered by the tangent, changes its sign. A multiplier by few
        harmonics passes 1 beside a fold instead of in it."""
        first, second = (
            np.linalg.slogdet(problem.linearized(point.x, point.value)[1])[0]
            * np.sign(point.tangent_value)
            for point in (self.before, self.after)
        )
        return bool(first != second)


def _touches(problem: PeriodicEquations, orbit: Orbit) -> np.ndarray:
    """Return how often each interface comes into contact along an orbit, and 1 more where it is in
    contact at all."""
    closed = problem.machine_at(orbit.parameter).gaps_along(orbit.b) < 0
    return np.asarray((closed & ~np.roll(closed, 1, axis=0)).sum(axis=0) + closed.any(axis=0))


def count_outside(multipliers: np.ndarray) -> np.ndarray:
    """Return how many multipliers are outside the unit circle: real ones above 1, real ones below
    -1, and complex pairs."""
    outside = multipliers[np.abs(multipliers) > UNIT]
    real = _is_real(outside)
    above = int((real & (outside.real > 0)).sum())
    return np.array([above, int(real.sum()) - above, int((~real).sum()) // 2])


def _is_real(multiplier: Any) -> Any:
    """Return whether each multiplier is real."""
    return np.abs(np.imag(multiplier)) < 1e-6 * np.abs(multiplier)


def _located_on(problem: PeriodicEquations, piece: _Piece, halvings: int) -> list[_Located]:
    """Return the bifurcations of a piece in their order; one that is not simple, or in which those
    that are located do not explain how many multipliers are outside, is halved, so many times at
    most. Where the parameter does not change there are none: of a whirl at the threshold of a
    machine that is linear until it touches, every size is a motion, and a multiplier of each is
    1."""
    changed = abs(piece.after.value - piece.before.value)
    if changed <= problem.tolerance * problem.scale and not piece.turns:
        return []
    if halvings and not piece.is_simple(problem, halvings):
        with suppress(NotConverged):
            return _located_on_halves(problem, piece, halvings)
    located = _located_at_once(problem, piece)
    if halvings and not piece.is_explained_by(located):
        with suppress(NotConverged):
            return _located_on_halves(problem, piece, halvings)
    return located


def _located_on_halves(problem: PeriodicEquations, piece: _Piece, halvings: int) -> list[_Located]:
    """Return the bifurcations of both halves of a piece; raises `NotConverged`."""
    middle = PiecePoints(problem, piece.before, piece.after).at(0.5)
    at_middle = _multipliers(problem, middle) if len(piece.second) else piece.second
    orbit = problem.split(middle.x, middle.value)
    halves = (
        piece._replace(after=middle, second=at_middle, second_orbit=orbit),
        piece._replace(before=middle, first=at_middle, first_orbit=orbit),
    )
    return [each for half in halves for each in _located_on(problem, half, halvings - 1)]


def _located_at_once(problem: PeriodicEquations, piece: _Piece) -> list[_Located]:
    """Return the bifurcations of a piece in their order, for each multiplier that is outside at
    one of its ends one."""
    located = list[_Located]()
    points = PiecePoints(problem, piece.before, piece.after)
    known = {0.0: piece.first, 1.0: piece.second}

    def multipliers_at(share: float) -> np.ndarray:
        if share not in known:
            known[share] = _multipliers(problem, points.motion_at(share))
        return known[share]

    if piece.turns:
        located.append(_locate_turn(problem, piece, points))
    few, many = sorted(
        int(2 * n[2] + n[:2].sum()) for n in map(count_outside, (piece.first, piece.second))
    )
    for k in range(few + 1, many + 1):
        crossed = _locate_crossing(problem, piece, points, multipliers_at, k)
        if crossed is None or any(crossed.is_one_with(each) for each in located):
            continue
        # where the curve turns in a corner multipliers jump
        is_one = abs(crossed.multiplier - 1.0) < _NEAR_ONE
        is_at_one = crossed.kind == BRANCHING or (problem.is_autonomous and is_one)
        if not piece.turns or (crossed.is_smooth and not is_at_one):
            located.append(crossed)
    located.sort(key=lambda each: distance(piece.before, each.point, problem.scale))
    return located


def _locate_turn(problem: PeriodicEquations, piece: _Piece, points: PiecePoints) -> _Located:
    """Return where the tangent has no component along the parameter: a fold, or the branch point at
    which motions without a symmetry of the machine meet their mirror images."""
    kind, point_at = FOLD, points.at

    def slope_at(share: float) -> float:
        return point_at(share).tangent_value

    if piece.is_branching(problem):
        with suppress(NotConverged):
            points.narrow(slope_at)
        if points.is_smooth_about(slope_at):
            kind, point_at = BRANCHING, points.motion_at
    point, is_smooth = points.root(slope_at)
    multiplier = complex(math.nan)
    if is_smooth and len(piece.second):
        values = _multipliers(problem, point)
        multiplier = complex(values[np.argmin(np.abs(values - 1.0))])
    return _Located(kind if is_smooth else GRAZING, point, multiplier, is_smooth)


def _multipliers(problem: PeriodicEquations, point: CurvePoint) -> np.ndarray:
    return stability_multipliers(problem, point, problem.split(point.x, point.value))


def _locate_crossing(
    problem: PeriodicEquations,
    piece: _Piece,
    points: PiecePoints,
    multipliers_at: Callable[[float], np.ndarray],
    k: int,
) -> _Located | None:
    """Return where the k-th largest multiplier crosses the unit circle, or None."""

    def size_at(share: float) -> float:
        return math.log(max(abs(multipliers_at(share)[k - 1]), _TINY)) - math.log(UNIT)

    if size_at(0.0) * size_at(1.0) >= 0:
        return None
    with suppress(NotConverged):
        points.narrow(size_at)
    point, is_smooth = points.root(size_at)
    value = complex(_multipliers(problem, point)[k - 1])
    kind = TORUS if not _is_real(value) else DOUBLING if value.real < 0 else BRANCHING
    if kind == BRANCHING and not piece.is_branching(problem):
        return None  # a fold, in this step or beside it
    if not is_smooth and (kind == BRANCHING or abs(abs(value) - 1.0) > _ROUGH):
        return _Located(GRAZING, point, complex(math.nan), False)  # it jumps past the circle
    return _Located(kind, point, value, is_smooth)
