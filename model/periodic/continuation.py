"""Continuation of a branch from one of its motions to its ends, and why it ends there."""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from . import arclength
from .arclength import CurvePoint
from .balance import Orbit
from .branch import CLOSED, UNFINISHED, Branch, Solution, with_motion
from .checkpoint import BranchStart, EndEvent, EventLog, StartEvent, Starts
from .fourier import amplitudes, resized, shifted
from .harmonic_count import Accuracy
from .method_switch import PeriodicEquations
from .newton import NotConverged
from .problem import Machines, Note, Response
from .queries import motions_of, over_common_period
from .shooting import Shooting
from .tracer import TracedPoint, Tracer

LOST = "lost: "
JOINED = "joins a branch of a shorter period"
RESTING = "the whirl begins there, at rest"
_SAME = 0.02  # distance of two orbits that are one, as a share of their size,
_ONE = 1e-3  # or of two motions, each solved for

ReportPoint = Callable[[str, Solution], None]


@dataclass
class BranchSearch:
    """The state of a response computation: its result so far, the machine over the parameter, the
    event log, and a function that is called with every point."""

    result: Response
    machines: Machines
    log: EventLog
    report_point: ReportPoint

    def problem(self, start: BranchStart) -> PeriodicEquations:
        """Return the equations of a start."""
        task, size = self.result.task, start.length_scale
        H = start.H or task.accuracy.most
        balance = task.problem(
            self.machines, start.reference, H, start.turns, start.omega_scale, length_scale=size
        )
        return Shooting(balance, start.orbit) if start.orbit is not None else balance

    def equations_of(self, orbit: Orbit) -> PeriodicEquations:
        """Return the equations (balance or shooting) with which an orbit was found, with its
        period."""
        task, H = self.result.task, orbit.H
        if needs_shooting := task.needs_shooting(orbit):
            H = task.accuracy.most * orbit.turns // task.turns
        size = float(np.abs(orbit.b[1:]).max(initial=0.0)) if task.is_whirl else 0.0
        balance = task.problem(
            self.machines, orbit.parameter, H, orbit.turns, orbit.omega, length_scale=size
        )
        return Shooting(balance, orbit) if needs_shooting else balance


def start_at(
    problem: PeriodicEquations, x: np.ndarray, value: float, direction: float
) -> BranchStart:
    """Return a start at unknowns that solve the equations, in one direction (1, -1) or both (0)."""
    problem.fix_phase(x)
    directions = []
    for sign in (-1.0, 1.0) if direction == 0 else (direction,):
        point = arclength.with_tangent(problem, x, value, sign)
        directions.append(point.direction)
    return start_along(problem, x, value, directions)


def start_along(
    problem: PeriodicEquations, x: np.ndarray, value: float, directions: list[np.ndarray]
) -> BranchStart:
    """Return a start at unknowns that solve the equations, along the given tangents."""
    of, orbit = problem.balance, None if problem.balanced_H else problem.split(x, value)
    scales = problem.reference, problem.turns, of.omega_scale, of.length_scale
    return BranchStart(problem.balanced_H, *scales, x, value, directions, orbit)


def follow_all(search: BranchSearch, new: Starts) -> None:
    """Follow the branches from starts, each before the next start is searched for."""
    while True:
        started = search.log.replay(StartEvent)
        if started is None:
            try:
                started = StartEvent(next(new), [])
            except StopIteration as end:
                started = StartEvent(None, end.value)
            search.log.add(started)
        search.result.notes += started.notes
        if started.start is None:
            return
        follow(search, started.start)


def follow(search: BranchSearch, start: BranchStart) -> Branch:
    """Follow a branch from a start and return it; it is added to the result at once, and taken out
    again where it is lost without a point."""
    result, task, branch = search.result, search.result.task, Branch()
    result.branches.append(branch)
    label = f"branch {len(result.branches)}"
    accuracy = replace(task.accuracy, most=task.accuracy.most * start.turns // task.turns)
    ends = ["start", "start"]
    for side, direction in enumerate(start.directions):
        problem = search.problem(start)
        point = CurvePoint(start.x, start.value, direction[:-1], float(direction[-1]))
        tracer = Tracer(problem, task.low, task.high, steps=task.steps, accuracy=accuracy)
        for i, traced in enumerate(_traced_points(search, tracer, point)):
            search.report_point(label, traced.solution)
            if side and i == 0:
                continue  # the start is there already
            branch.points.append(traced.solution)
            behind = len(branch.points) - 2
            branch.bifurcations += [b._replace(behind=behind) for b in traced.bifurcations]
            if (task.is_whirl or start.turns > task.turns) and _has_joined(branch, task.is_whirl):
                tracer.end = RESTING if task.is_whirl else JOINED
            elif joined := None if task.is_whirl else _joined(result):
                tracer.end = f"joins branch {joined}"
                branch.points.pop()
            else:
                continue
            # where it turns is that branch's period doubling, or where rest loses its stability
            branch.bifurcations = [b for b in branch.bifurcations if b.behind != behind]
            break
        ended = search.log.replay(EndEvent)
        if ended is None:
            why = tracer.end or LOST + _reason_lost(tracer, branch, accuracy)
            ended = search.log.add(EndEvent(why))
        ends[1] = ended.why
        if ended.why.startswith((LOST, UNFINISHED)):
            last = branch.points[-1].value if branch.points else start.value
            begin = f"{label} ends" if branch.points else "no branch can begin"
            at = f"{begin} at {task.name} = ", last
            is_lost = ended.why.startswith(LOST)
            code = "branch-lost" if is_lost else "branch-unfinished"
            advice = "" if is_lost else "; ask for a longer step or a shorter range"
            note = Note(code, result.unit, *at, f": {ended.why}{advice}")
            if note not in result.notes:  # another guess may lead to the same place
                result.notes.append(note)
        if len(start.directions) > 1 and side == 0:
            last = len(branch.points) - 2
            branch.points.reverse()
            found = branch.bifurcations[::-1]
            branch.bifurcations = [b._replace(behind=last - b.behind) for b in found]
            ends = [ends[1], ""]
            if ends[0] == CLOSED:
                ends[1] = ends[0]
                break
    branch.ends = ends[0], ends[1]
    if not branch.points:
        result.branches.pop()
    coarse = [
        p.value
        for p in branch.points
        if p.last_share > accuracy.share and accuracy.most >= p.orbit.H
    ]
    if coarse:
        many = f"{label} has more than {accuracy.most} harmonics from {task.name} = "
        parts = (many, min(coarse), " to ", max(coarse), ": amplitudes are less exact there")
        result.notes.append(Note("few-harmonics", result.unit, *parts))
    return branch


def _traced_points(
    search: BranchSearch, tracer: Tracer, point: CurvePoint
) -> Iterator[TracedPoint]:
    """Yield the points of a branch in one direction, first those of an earlier call, then new ones;
    `tracer.end` stays empty if the branch is lost."""
    first = last = None
    skipped = 0  # the last place from which it can be gone on with
    while (traced := search.log.replay(TracedPoint)) is not None:
        if traced.state.H:
            first, last, skipped = first or traced, traced, 0
        skipped += 1
        equations = partial(tracer.balance.modified, reference=traced.state.reference)
        solution = with_motion(equations(traced.solution.orbit.H), traced.solution)
        bifurcations = [with_motion(equations(b.orbit.H), b) for b in traced.bifurcations]
        yield TracedPoint(solution, bifurcations, traced.state)
    if search.log.next_is(EndEvent):
        return
    if first is None or last is None:
        trace = tracer.follow(point)
    else:
        trace, skipped = tracer.resume(first.state, last.state, last.solution), skipped - 1
    try:
        for traced in itertools.islice(trace, skipped, None):
            search.log.add(traced)
            yield traced
    except NotConverged:
        tracer.end = ""


def _has_joined(branch: Branch, is_whirl: bool) -> bool:
    """Return whether a branch of a longer period has just passed a motion of the shorter one, or a
    whirl the machine at rest: the harmonics that only the longer period has, or all harmonics,
    change sign there."""
    if len(branch.points) < 2:
        return False
    turns = branch.points[-1].orbit.turns
    first, second = (resized(p.orbit.b, 2 * turns) for p in branch.points[-2:])
    k = np.arange(1, 2 * turns + 1)
    odd = np.repeat((k % turns != 0) | is_whirl, 2)
    return float(np.sum(first[1:][odd] * second[1:][odd])) < 0


def _reason_lost(tracer: Tracer, branch: Branch, accuracy: Accuracy) -> str:
    """Return the message for a branch that ends because a film breaks at the next point, or
    Newton's method does not converge."""
    if tracer.broken:
        return f"the film of {tracer.broken[0]} becomes thinner than its roughness there"
    if not branch.points:
        return "Newton's method does not converge there"
    last = branch.points[-1]
    machine = tracer.balance.machine_at(last.value)
    if accuracy.most == last.orbit.H and last.last_share > accuracy.share:
        advice = "ask for more, or soften the wall" if machine.laws.rubbing else "ask for more"
        return (
            f"the motion has more than {accuracy.most} harmonics: the highest are "
            f"{last.last_share:.1g} of it; {advice}"
        )
    gap = machine.gaps_along(last.orbit.b)
    if (np.abs(gap).min(axis=0) < 1e-3 * machine.laws.length).any():
        return "a corner of a law: a contact just opens or closes there"
    return "Newton's method does not converge with the shortest step"


def is_known(
    branches: Sequence[Branch], orbit: Orbit, value: float, is_whirl: bool = False
) -> bool:
    """Return whether a branch passes through an orbit, at the same phase or whole revolutions
    later, or, for self-excited whirl, at any phase."""
    return any(_gap(branch, orbit, value, is_whirl) is not None for branch in branches)


def _gap(branch: Branch, orbit: Orbit, value: float, is_whirl: bool = False) -> np.ndarray | None:
    """Return what a branch lacks to an orbit, a series of b [m], where it passes through it; else
    None."""
    for a, b in zip(branch.points, branch.points[1:], strict=False):
        if not min(a.value, b.value) <= value <= max(a.value, b.value) or a.value == b.value:
            continue
        share = (value - a.value) / (b.value - a.value)
        turns, (first, second, b_of_orbit) = over_common_period(a.orbit, b.orbit, orbit)
        middle, near = first + share * (second - first), 0.5 * np.linalg.norm(second - first)
        angles = [2 * math.pi * turn / turns for turn in range(turns)]
        if is_whirl:  # whose phase is free
            once = amplitudes(middle)[1].conj() @ amplitudes(b_of_orbit)[1]
            angles = [-float(np.angle(once))]
        for angle in angles:
            gap = middle - shifted(b_of_orbit, angle)
            if np.linalg.norm(gap) <= _SAME * np.linalg.norm(b_of_orbit) + near:
                return gap
    return None


def is_one_of(motions: Sequence[Solution], orbit: Orbit) -> bool:
    """Return whether an orbit is one of some motions, each solved for, also whole revolutions
    later. What counts is the size of the motion, not how far off the middle it is, as by a sag."""
    for own in motions:
        turns, (first, second) = over_common_period(own.orbit, orbit)
        for turn in range(turns):
            apart = np.linalg.norm(first - shifted(second, 2 * math.pi * turn / turns))
            size = max(np.linalg.norm(first[1:]), _ONE * np.linalg.norm(first))
            if apart <= _ONE * size:
                return True
    return False


def _joined(result: Response) -> int | None:
    """Return the number, from 1, of a branch along which the last one has just gone on, since that
    branch was lost, or a step led over to it near a bifurcation: the last two motions lie on it,
    and move there as it does, which those on the other side of a fold do not; None where there is
    none."""
    *branches, branch = result.branches
    pair = branch.points[-2:]
    for number, other in enumerate(branches, 1):
        if len(pair) < 2 or {point.orbit.turns for point in other.points} != {pair[0].orbit.turns}:
            continue  # or it was lost at its start, without a point
        before, after = (_gap(other, point.orbit, point.value) for point in pair)
        if before is None or after is None:
            continue
        H = max(len(before), len(after)) // 2
        first, second = (resized(point.orbit.b, H) for point in pair)
        change = np.linalg.norm(resized(after, H) - resized(before, H))
        if change >= 0.5 * np.linalg.norm(second - first):
            continue
        is_lost = any(end.startswith(LOST) for end in other.ends)
        if is_lost or is_one_of(motions_of(result, other, pair[1].value), pair[1].orbit):
            return number
    return None
