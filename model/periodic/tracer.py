"""Tracing a branch of periodic motions in one direction, with as many harmonics as needed."""

from collections.abc import Generator, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from . import arclength
from .arclength import ContinuationSteps, CurvePoint, distance
from .balance import HarmonicBalance
from .bifurcation_search import bifurcations_between, count_outside
from .branch import CLOSED, Bifurcation, Solution, solution, why_ended
from .harmonic_count import Accuracy, with_enough_harmonics
from .method_switch import PeriodicEquations, as_shooting, in_other_equations, suitable_equations
from .newton import NotConverged

_NEAR_START = 0.5  # share of a step: the branch has come back to its start
_COARSE_STEPS = 4  # short steps with too few harmonics after which a whirl is not followed

CurveTrace = Generator[tuple[CurvePoint, float], tuple[PeriodicEquations, CurvePoint] | None, None]


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
        self.balance = problem.balance
        self.steps, self.accuracy = steps, accuracy
        self.end = ""
        # parts whose film is thinner than its roughness at the next point
        self.broken: list[str] = []

    def follow(self, point: CurvePoint) -> Iterator[TracedPoint]:
        """Yield the points, each with the bifurcations before it, from the start on; raises
        `NotConverged` where the branch is lost."""
        problem = self.problem
        problem.fix_phase(point.x)
        if isinstance(problem, HarmonicBalance):
            is_end = point.value in (self.low, self.high)
            problem, point = with_enough_harmonics(problem, point, self.accuracy, is_end)
        last = self._solution(problem, point)
        state = TracerState(problem.reference, problem.balanced_H, point, self.steps.initial)
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
            now = self._solution(problem, result)
            bifurcations = bifurcations_between(problem, before, result, last, now)
            is_end = result.value in (self.low, self.high)
            here, point, is_coarse = suitable_equations(
                problem, result, now.orbit, accuracy, is_end
            )
            here.fix_phase(point.x)
            if here is not problem:
                few, now = now, self._solution(here, point)
                if (count_outside(now.multipliers) != count_outside(few.multipliers)).any():
                    with suppress(NotConverged):
                        begin = in_other_equations(problem, before, here, last.orbit)
                        bifurcations = bifurcations_between(here, begin, point, last, now)
                problem = here
            coarse_steps = coarse_steps + 1 if is_coarse and length < self.steps.initial else 0
            at = problem.reference, problem.balanced_H, point, length, coarse_steps
            yield TracedPoint(now, bifurcations, TracerState(*at))
            if self._is_closed(problem, start.point, before, point):
                self.end = CLOSED
                return
            last = now
        self.end = why_ended(point.value, self.low, self.high, self.steps.max_points)

    def _solution(self, problem: PeriodicEquations, point: CurvePoint) -> Solution:
        """Return the motion at a point; raises `NotConverged` where a film breaks."""
        result = solution(problem, point, self.accuracy)
        machine = problem.machine_at(point.value)
        self.broken = machine.broken_films(result.orbit.b, result.orbit.states)
        if self.broken:
            raise NotConverged()
        return result

    def _trace(self, problem: PeriodicEquations, point: CurvePoint, length: float) -> CurveTrace:
        steps = replace(self.steps, initial=length)
        return arclength.trace(problem, point, self.low, self.high, steps)

    def _is_closed(
        self, problem: PeriodicEquations, start: CurvePoint, before: CurvePoint, point: CurvePoint
    ) -> bool:
        if len(start.x) != len(point.x) or len(before.x) != len(point.x):
            return False
        step, away = (distance(a, point, problem.scale) for a in (before, start))
        is_same = start.cosine(point) > 0.9 and before.x is not start.x
        return 0 < away < _NEAR_START * step and is_same
