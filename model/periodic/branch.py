"""A branch of periodic motions: continued with as many harmonics as needed, with its stability and
its bifurcations.

At a fold the curve turns in the parameter. At other bifurcations Floquet multipliers cross the unit
circle: at -1 the period doubles, a complex pair begins a torus (Neimark-Sacker), at +1 another
branch passes through.
"""

import math
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.optimize import brentq

from . import arclength
from .arclength import ContinuationSteps, CurvePoint, NotConverged
from .balance import HarmonicBalance, Orbit, last_share
from .floquet import multipliers
from .fourier import amplitudes
from .harmonic_count import Accuracy, with_enough_harmonics
from .method_switch import PeriodicEquations, as_shooting, suitable_equations
from .shooting import Shooting

BIFURCATIONS = FOLD, DOUBLING, TORUS, BRANCHING, GRAZING = (
    "fold",
    "period doubling",
    "Neimark-Sacker",
    "branch point",
    "grazing",
)
CLOSED = "the branch is closed"
UNFINISHED = "unfinished: "
NO_MOTION = np.zeros((0, 0))
_UNIT = 1e-6  # of a multiplier beyond the unit circle
_VERTICAL = 0.05  # a smaller component of the tangent along the parameter: a fold is near
_NEAR_ONE = 1e-2  # distance from 1 within which rounding may separate a double multiplier
_EVALUATIONS = 40  # evaluations of a test function at most
_PRECISE = 1e-9  # of a step along the curve
_NEAR_START = 0.5  # share of a step: the branch has come back to its start
_COARSE_STEPS = 4  # short steps with too few harmonics after which a whirl is not followed

CurveTrace = Generator[tuple[CurvePoint, float], tuple[PeriodicEquations, CurvePoint] | None, None]


class Solution(NamedTuple):
    """A point of a branch: value of the parameter, the orbit, complex amplitudes of all dofs, x and
    y in turn, shape (H + 1, 2 size) [m, rad], Floquet multipliers, the largest first (for a
    self-excited motion without the trivial one), whether the motion is stable, relative amplitude
    of the highest harmonics, Newton's corrections."""

    value: float
    orbit: Orbit
    motion: np.ndarray
    multipliers: np.ndarray
    is_stable: bool
    last_share: float
    corrections: tuple[float, ...]


class Bifurcation(NamedTuple):
    """A bifurcation: its kind, value of the parameter, orbit and motion as of a `Solution`,
    multiplier that crosses the unit circle (nan at grazing, where it jumps, and where multipliers
    are not computed), and the index of the branch point before it."""

    kind: str
    value: float
    orbit: Orbit
    motion: np.ndarray
    multiplier: complex
    behind: int


@dataclass
class Branch:
    """The points and the bifurcations, each in their order along the curve, and why the branch ends
    at either side."""

    points: list[Solution] = field(default_factory=list)
    bifurcations: list[Bifurcation] = field(default_factory=list)
    ends: tuple[str, str] = ("", "")


def solution(problem: PeriodicEquations, point: CurvePoint, accuracy: Accuracy) -> Solution:
    """Return the motion at a point of the curve."""
    orbit = problem.split(point.x, point.value)
    result = np.zeros(0, complex)
    if accuracy.has_stability:
        result = stability_multipliers(problem, point, orbit)
    stable = bool(len(result) == 0 or np.abs(result[0]) <= 1.0 + _UNIT)
    share = last_share(orbit.b)
    made = Solution(point.value, orbit, NO_MOTION, result, stable, share, point.corrections)
    return with_motion(problem, made)


_M = TypeVar("_M", Solution, Bifurcation)


def with_motion(problem: PeriodicEquations, result: _M) -> _M:
    """Return the result with the amplitudes of all dofs, which follow from its orbit."""
    orbit = result.orbit
    parts = problem.dynamic_stiffness(result.value, orbit.omega)
    machine = problem.machine_at(result.value)
    return result._replace(motion=machine.expanded(parts, amplitudes(orbit.b)))


def stability_multipliers(
    problem: PeriodicEquations, point: CurvePoint, orbit: Orbit
) -> np.ndarray:
    """Return the multipliers that decide on stability, the largest first."""
    if isinstance(problem, Shooting):
        return problem.multipliers(point.x, point.value)
    values = multipliers(problem.machine_at(point.value), orbit).values
    if problem.is_autonomous:
        return np.delete(values, np.argmin(np.abs(values - 1.0)))
    return values


def _is_one(multiplier: complex) -> bool:
    """Return whether a multiplier is 1 within the precision of a double multiplier."""
    return abs(multiplier - 1.0) < _NEAR_ONE


class TracerState(NamedTuple):
    """What a tracer needs to resume from a point of a branch: the reference value of the equations,
    the number of harmonics (0 while shooting: it resumes from the last point with harmonics), the
    point, the length of the next step, and the number of successive steps that were short for want
    of harmonics."""

    reference: float
    H: int
    point: CurvePoint
    length: float
    coarse_steps: int = 0


class TracedPoint(NamedTuple):
    """A point of a branch, the bifurcations before it, and the tracer's state."""

    solution: Solution
    bifurcations: list[Bifurcation]
    state: TracerState


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


def _distance(problem: PeriodicEquations, a: CurvePoint, b: CurvePoint) -> float:
    """Return the distance of two points, with the parameter over its scale."""
    along = (b.value - a.value) / problem.parameter.scale
    return math.hypot(float(np.linalg.norm(b.x - a.x)), along)


class Tracer:
    """Follows a branch in one direction from a point."""

    def __init__(
        self,
        problem: PeriodicEquations,
        low: float,
        high: float,
        *,
        steps: ContinuationSteps,
        accuracy: Accuracy,
    ) -> None:
        self.problem, self.low, self.high = problem, low, high
        self.balance = problem.balance if isinstance(problem, Shooting) else problem
        self.steps, self.accuracy = steps, accuracy
        self.end = ""

    def follow(self, point: CurvePoint) -> Iterator[TracedPoint]:
        """Yield the points, each with the bifurcations before it, from the start on; raises
        `NotConverged` where the branch is lost."""
        problem = self.problem
        problem.fix_phase(point.x)
        if isinstance(problem, HarmonicBalance):
            is_end = point.value in (self.low, self.high)
            problem, point = with_enough_harmonics(problem, point, self.accuracy, is_end)
        last = solution(problem, point, self.accuracy)
        H = problem.H if isinstance(problem, HarmonicBalance) else 0
        state = TracerState(problem.reference, H, point, self.steps.initial)
        yield TracedPoint(last, [], state)
        yield from self.resume(state, state, last)

    def resume(
        self, start: TracerState, state: TracerState, last: Solution
    ) -> Iterator[TracedPoint]:
        """Yield further points from a state of the tracer, at which the motion is `last`; start:
        the first state of the branch, with which a closed branch is recognized."""
        accuracy, point = self.accuracy, state.point
        problem: PeriodicEquations = (
            self.balance.modified(state.H, reference=state.reference) if state.H else self.problem
        )
        problem.fix_phase(point.x)
        trace = self._trace(problem, point, state.length)
        step, coarse_steps = None, state.coarse_steps
        while True:
            try:
                if coarse_steps > (_COARSE_STEPS if problem.is_autonomous else 0):
                    raise NotConverged()
                step = next(trace) if step is None else trace.send((problem, point))
            except StopIteration:
                break
            except NotConverged:
                problem, point = as_shooting(problem, point, last.orbit)
                trace, step, coarse_steps = self._trace(problem, point, self.steps.initial), None, 0
                continue
            before, (result, length) = point, step
            now = solution(problem, result, accuracy)
            bifurcations = self._bifurcations_between(problem, before, result, last, now)
            is_end = result.value in (self.low, self.high)
            here, point, is_coarse = suitable_equations(
                problem, result, now.orbit, accuracy, is_end
            )
            here.fix_phase(point.x)
            if here is not problem:
                problem, now = here, solution(here, point, accuracy)
            coarse_steps = coarse_steps + 1 if is_coarse and length < self.steps.initial else 0
            H = problem.H if isinstance(problem, HarmonicBalance) else 0
            yield TracedPoint(
                now, bifurcations, TracerState(problem.reference, H, point, length, coarse_steps)
            )
            if self._is_closed(problem, start.point, before, point):
                self.end = CLOSED
                return
            last = now
        self.end = self._why_ended(point)

    def _trace(self, problem: PeriodicEquations, point: CurvePoint, length: float) -> CurveTrace:
        steps = replace(self.steps, initial=length)
        scale = problem.parameter.scale
        return arclength.trace(problem, point, scale, self.low, self.high, steps)

    def _why_ended(self, point: CurvePoint) -> str:
        inside = self.low < point.value < self.high
        most = f"{UNFINISHED}{self.steps.max_points} steps were taken, the most in one direction"
        return most if inside else "end of the range"

    def _is_closed(
        self, problem: PeriodicEquations, start: CurvePoint, before: CurvePoint, point: CurvePoint
    ) -> bool:
        if len(start.x) != len(point.x) or len(before.x) != len(point.x):
            return False
        step, distance = (_distance(problem, a, point) for a in (before, start))
        same = float(start.tangent @ point.tangent + start.tangent_value * point.tangent_value)
        return 0 < distance < _NEAR_START * step and same > 0.9 and before.x is not start.x

    def _bifurcations_between(
        self,
        problem: PeriodicEquations,
        before: CurvePoint,
        after: CurvePoint,
        last: Solution,
        now: Solution,
    ) -> list[Bifurcation]:
        """Return the bifurcations between two points, in their order along the curve."""
        located = list[_Located]()
        turns = before.tangent_value * after.tangent_value < 0
        if turns:
            located.append(self._locate_fold(problem, before, after))
        few = many = 0
        if self.accuracy.has_stability:
            few, many = sorted(int((np.abs(s.multipliers) > 1 + _UNIT).sum()) for s in (last, now))
        for k in range(few + 1, many + 1):
            crossed = self._locate_crossing(problem, before, after, k)
            if crossed is None or any(crossed.is_one_with(each) for each in located):
                continue
            # where the curve turns in a corner multipliers jump
            is_at_one = crossed.kind == BRANCHING or (
                problem.is_autonomous and _is_one(crossed.multiplier)
            )
            if not turns or (crossed.is_smooth and not is_at_one):
                located.append(crossed)
        located.sort(key=lambda each: _distance(problem, before, each.point))
        return [_bifurcation(problem, each) for each in located]

    def _locate_fold(
        self, problem: PeriodicEquations, before: CurvePoint, after: CurvePoint
    ) -> _Located:
        """Return the fold, where the tangent has no component along the parameter."""
        point, is_smooth = self._locate_root(
            problem,
            before,
            after,
            lambda p: p.tangent_value,
            before.tangent_value,
            after.tangent_value,
        )
        multiplier = complex(math.nan)
        if is_smooth and self.accuracy.has_stability:
            values = self._multipliers(problem, point)
            multiplier = complex(values[np.argmin(np.abs(values - 1.0))])
        return _Located(FOLD if is_smooth else GRAZING, point, multiplier, is_smooth)

    def _multipliers(self, problem: PeriodicEquations, point: CurvePoint) -> np.ndarray:
        return stability_multipliers(problem, point, problem.split(point.x, point.value))

    def _locate_crossing(
        self, problem: PeriodicEquations, before: CurvePoint, after: CurvePoint, k: int
    ) -> _Located | None:
        """Return where the k-th largest multiplier crosses the unit circle, or None."""

        def size(point: CurvePoint) -> float:
            value = self._multipliers(problem, point)[k - 1]
            return math.log(max(abs(value), 1e-300)) - math.log1p(_UNIT)

        first, second = size(before), size(after)
        if first * second >= 0:
            return None
        point, is_smooth = self._locate_root(problem, before, after, size, first, second)
        value = complex(self._multipliers(problem, point)[k - 1])
        real = abs(value.imag) < 1e-6 * abs(value)
        kind = TORUS if not real else DOUBLING if value.real < 0 else BRANCHING
        steepest = max(abs(before.tangent_value), abs(after.tangent_value))
        if kind == BRANCHING and abs(point.tangent_value) < _VERTICAL * steepest:
            return None  # a fold, in this step or beside it
        if kind == BRANCHING and not is_smooth:
            return _Located(GRAZING, point, complex(math.nan), is_smooth)
        return _Located(kind, point, value, is_smooth)

    def _locate_root(
        self,
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

        try:
            options = {"xtol": _PRECISE * abs(end), "maxiter": _EVALUATIONS, "disp": False}
            point, value = known[brentq(tested, 0.0, end, **options)]
        except NotConverged:
            point, value = list(known.values())[-1]
        whole = max(abs(at_before), abs(at_after))
        return point, abs(value) < 1e-3 * whole
