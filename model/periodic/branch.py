"""A branch of periodic motions: continued, with as many harmonics as it needs, its stability, and
the bifurcations on it located.

A fold is where the curve turns in the parameter; elsewhere the number of Floquet multipliers beyond
the unit circle changes: at -1 the period doubles, a pair makes a torus (Neimark and Sacker), at +1
another branch passes through.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from . import arclength
from .arclength import Lost, Point, Steps
from .balance import Orbit, Problem, last_share
from .floquet import multipliers
from .fourier import amplitudes
from .harmonic_count import Accuracy, refined
from .method_switch import Motions, fitted, shot
from .shooting import Shooting

BIFURCATIONS = FOLD, DOUBLING, TORUS, BRANCHING, GRAZING = (
    "fold",
    "period doubling",
    "Neimark-Sacker",
    "branch point",
    "grazing",
)
CLOSED = "the branch is closed"
_UNIT = 1e-6  # of a multiplier beyond the unit circle
_VERTICAL = 0.05  # of the curve's direction along the parameter: a fold is near
_DOUBLE = 1e-2  # how far from 1 two multipliers there are, which rounding parts
_LOCATED = 40  # evaluations of a test function at most
_CLOSED = 0.5  # of a step: how near a branch has come to its start
_PATIENCE = 4  # so many short steps with too few harmonics, and a whirl is not followed further

Walk = Generator[tuple[Point, float], tuple[Motions, Point] | None, None]


class Solution(NamedTuple):
    """A point of a branch: value of the parameter, the orbit, complex amplitudes of all dofs, x and
    y in turn, shape (H + 1, 2 size) [m, rad], multipliers, the largest first (of an autonomous
    motion without the one that is 1), whether it is stable, share of the highest harmonics,
    Newton's corrections."""

    value: float
    orbit: Orbit
    motion: np.ndarray
    multipliers: np.ndarray
    is_stable: bool
    last_share: float
    corrections: tuple[float, ...]


class Bifurcation(NamedTuple):
    """Where a branch changes: its kind, the value of the parameter, the orbit there, the multiplier
    that crosses the unit circle (nan at grazing, where it jumps, and where none were computed), and
    behind which point of the branch."""

    kind: str
    value: float
    orbit: Orbit
    multiplier: complex
    behind: int

    def is_pair_of(self, other: Bifurcation) -> bool:
        """Whether both are of one pair of multipliers."""
        apart = abs(abs(self.multiplier.imag) - abs(other.multiplier.imag))
        return self.kind == other.kind == TORUS and apart < 1e-3


@dataclass
class Branch:
    """Points in their order along the curve, bifurcations, and why it ends where it does."""

    points: list[Solution] = field(default_factory=list)
    bifurcations: list[Bifurcation] = field(default_factory=list)
    ends: tuple[str, str] = ("", "")


def solution(problem: Motions, point: Point, accuracy: Accuracy) -> Solution:
    """What a point of the curve is as a motion."""
    orbit = problem.split(point.x, point.value)
    result = np.zeros(0, complex)
    if accuracy.has_stability:
        result = crossing(problem, point, orbit)
    stable = bool(len(result) == 0 or np.abs(result[0]) <= 1.0 + _UNIT)
    share, none = last_share(orbit.b), np.zeros((0, 0))
    made = Solution(point.value, orbit, none, result, stable, share, point.corrections)
    return with_motion(problem, made)


def with_motion(problem: Motions, result: Solution) -> Solution:
    """A solution with the amplitudes of all dofs, which follow from its orbit."""
    orbit = result.orbit
    parts = problem.harmonics(result.value, orbit.omega)
    machine = problem.machine_at(result.value)
    return result._replace(motion=machine.expanded(parts, amplitudes(orbit.b)))


def crossing(problem: Motions, point: Point, orbit: Orbit) -> np.ndarray:
    """The multipliers by which stability is judged."""
    if isinstance(problem, Shooting):
        return problem.multipliers(point.x, point.value)
    values = multipliers(problem.machine_at(point.value), orbit).values
    if problem.is_autonomous:
        return np.delete(values, np.argmin(np.abs(values - 1.0)))
    return values


def _is_one(multiplier: complex) -> bool:
    """Whether a multiplier is 1, as far as two of them there can be told."""
    return abs(multiplier - 1.0) < _DOUBLE


class Place(NamedTuple):
    """Where on a branch a tracer is, with all that it takes to go on from there: the value about
    which the equations are scaled, harmonics, 0 of a motion in time, which is gone on with from
    the last place that has some, the point, the length of the next step, and how many
    steps in a row were short for want of harmonics."""

    at: float
    H: int
    point: Point
    length: float
    short: int = 0


class Passed(NamedTuple):
    """A point of a branch, the bifurcations before it, and the tracer's place."""

    solution: Solution
    bifurcations: list[Bifurcation]
    place: Place


class Tracer:
    """Follows a branch one way from a point, its tangent ahead."""

    def __init__(
        self,
        problem: Motions,
        low: float,
        high: float,
        *,
        steps: Steps,
        accuracy: Accuracy,
    ) -> None:
        self.problem, self.low, self.high = problem, low, high
        self.series = problem.series if isinstance(problem, Shooting) else problem
        self.steps, self.accuracy = steps, accuracy
        self.end = ""

    def follow(self, point: Point) -> Iterator[Passed]:
        """Points and the bifurcations before each, from the start on; ends with `Lost` where it
        does not converge."""
        problem = self.problem
        problem.fix_phase(point.x)
        if isinstance(problem, Problem):
            is_end = point.value in (self.low, self.high)
            problem, point = refined(problem, point, self.accuracy, is_end)
        last = solution(problem, point, self.accuracy)
        H = problem.H if isinstance(problem, Problem) else 0
        place = Place(problem.at, H, point, self.steps.first)
        yield Passed(last, [], place)
        yield from self.go_on(place, place, last)

    def go_on(self, start: Place, place: Place, last: Solution) -> Iterator[Passed]:
        """Further points from a place, at which the motion is `last`; start: the first place of the
        branch, by which it is seen that it is closed."""
        accuracy, point = self.accuracy, place.point
        problem: Motions = self.series.like(place.H, at=place.at) if place.H else self.problem
        problem.fix_phase(point.x)
        walk = self._walk(problem, point, place.length)
        step, short = None, place.short
        while True:
            try:
                if short > (_PATIENCE if problem.is_autonomous else 0):
                    raise Lost([])
                step = next(walk) if step is None else walk.send((problem, point))
            except StopIteration:
                break
            except Lost:
                problem, point = shot(problem, point, last.orbit)
                walk, step, short = self._walk(problem, point, self.steps.first), None, 0
                continue
            before, (result, length) = point, step
            now = solution(problem, result, accuracy)
            passed = self._between(problem, before, result, last, now)
            is_end = result.value in (self.low, self.high)
            here, point, is_coarse = fitted(problem, result, now.orbit, accuracy, is_end)
            here.fix_phase(point.x)
            if here is not problem:
                problem, now = here, solution(here, point, accuracy)
            short = short + 1 if is_coarse and length < self.steps.first else 0
            H = problem.H if isinstance(problem, Problem) else 0
            yield Passed(now, passed, Place(problem.at, H, point, length, short))
            if self._is_closed(problem, start.point, before, point):
                self.end = CLOSED
                return
            last = now
        self.end = self._why_ended(point)

    def _walk(self, problem: Motions, point: Point, length: float) -> Walk:
        steps = replace(self.steps, first=length)
        scale = problem.parameter.scale
        return arclength.trace(problem, point, scale, self.low, self.high, steps)

    def _why_ended(self, point: Point) -> str:
        inside = self.low < point.value < self.high
        return f"{self.steps.points} points" if inside else "end of the range"

    def _is_closed(self, problem: Motions, start: Point, before: Point, point: Point) -> bool:
        if len(start.x) != len(point.x) or len(before.x) != len(point.x):
            return False
        scale = problem.parameter.scale
        step = math.hypot(
            float(np.linalg.norm(point.x - before.x)), (point.value - before.value) / scale
        )
        way = math.hypot(
            float(np.linalg.norm(point.x - start.x)), (point.value - start.value) / scale
        )
        same = float(start.tangent @ point.tangent + start.by_value * point.by_value)
        return 0 < way < _CLOSED * step and same > 0.9 and before.x is not start.x

    def _between(
        self, problem: Motions, before: Point, after: Point, last: Solution, now: Solution
    ) -> list[Bifurcation]:
        """What is passed between two points."""
        result = []
        turns = before.by_value * after.by_value < 0
        if turns:
            located = self._fold(problem, before, after)
            result.append(located)
        if not self.accuracy.has_stability:
            return result
        few, many = sorted(int((np.abs(s.multipliers) > 1 + _UNIT).sum()) for s in (last, now))
        for k in range(few + 1, many + 1):
            crossed, is_smooth = self._crossing(problem, before, after, k)
            # where the curve turns in a corner multipliers jump
            is_at_one = crossed and (
                crossed.kind == BRANCHING or (problem.is_autonomous and _is_one(crossed.multiplier))
            )
            is_of_turn = turns and (not is_smooth or is_at_one)
            is_new = crossed is not None and not is_of_turn
            if crossed is not None and is_new and not any(crossed.is_pair_of(b) for b in result):
                result.append(crossed)
        return result

    def _at(self, problem: Motions, before: Point, length: float) -> Point:
        return arclength.onward(problem, before, length, problem.parameter.scale)

    def _length(self, problem: Motions, before: Point, after: Point) -> float:
        scale = problem.parameter.scale
        way = after.x - before.x, (after.value - before.value) / scale
        return float(before.tangent @ way[0] + before.by_value * way[1])

    def _fold(self, problem: Motions, before: Point, after: Point) -> Bifurcation:
        """The turn, where the tangent has no part along the parameter."""
        point, is_smooth = self._root(
            problem, before, after, lambda p: p.by_value, before.by_value, after.by_value
        )
        kind = FOLD if is_smooth else GRAZING
        multiplier = complex(math.nan)
        if is_smooth and self.accuracy.has_stability:
            values = self._multipliers(problem, point)
            multiplier = complex(values[np.argmin(np.abs(values - 1.0))])
        return Bifurcation(kind, point.value, problem.split(point.x, point.value), multiplier, -1)

    def _multipliers(self, problem: Motions, point: Point) -> np.ndarray:
        return crossing(problem, point, problem.split(point.x, point.value))

    def _crossing(
        self, problem: Motions, before: Point, after: Point, k: int
    ) -> tuple[Bifurcation | None, bool]:
        """Where the k-th largest multiplier crosses the unit circle, and whether it does so
        smoothly."""

        def size(point: Point) -> float:
            value = self._multipliers(problem, point)[k - 1]
            return math.log(max(abs(value), 1e-300)) - math.log1p(_UNIT)

        first, second = size(before), size(after)
        if first * second >= 0:
            return None, True
        point, is_smooth = self._root(problem, before, after, size, first, second)
        value = complex(self._multipliers(problem, point)[k - 1])
        real = abs(value.imag) < 1e-6 * abs(value)
        kind = TORUS if not real else DOUBLING if value.real < 0 else BRANCHING
        steepest = max(abs(before.by_value), abs(after.by_value))
        if kind == BRANCHING and abs(point.by_value) < _VERTICAL * steepest:
            return None, True  # a fold, in this step or beside it
        orbit = problem.split(point.x, point.value)
        return Bifurcation(kind, point.value, orbit, value, -1), is_smooth

    def _root(
        self,
        problem: Motions,
        before: Point,
        after: Point,
        test: Callable[[Point], float],
        at_before: float,
        at_after: float,
    ) -> tuple[Point, bool]:
        """The point where a test function is 0, by the Illinois rule, and whether it is smooth
        there."""
        low, high = 0.0, self._length(problem, before, after)
        f_low, f_high = at_before, at_after
        whole = max(abs(f_low), abs(f_high))
        point, value, width = after, f_high, high
        for _ in range(_LOCATED):
            s = (low * f_high - high * f_low) / (f_high - f_low)
            if not low < s < high:
                s = 0.5 * (low + high)
            try:
                point = self._at(problem, before, s)
            except Lost:
                break
            value = test(point)
            if abs(value) < 1e-9 * whole or high - low < 1e-9 * width:
                break
            if (value > 0) == (f_low > 0):
                low, f_low, f_high = s, value, 0.5 * f_high
            else:
                high, f_high, f_low = s, value, 0.5 * f_low
        return point, abs(value) < 1e-3 * whole
