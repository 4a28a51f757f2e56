"""A branch continued from one of its motions to its ends, and why it ends there."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from . import arclength
from .arclength import Lost, Point
from .balance import Orbit
from .branch import CLOSED, Branch, Passed, Solution, Tracer, with_motion
from .checkpoint import Ended, Journal, Start
from .fourier import amplitudes, basis, repeated, resized, shifted
from .harmonic_count import Accuracy
from .method_switch import Motions
from .problem import Machines, Note, Response
from .shooting import Shooting

LOST = "lost: "
JOINED = "joins a branch of a shorter period"
RESTING = "the whirl begins there, at rest"
_SAME = 0.02  # distance of two orbits that are one, as a share of their size

Tell = Callable[[str, Solution], None]


@dataclass
class Search:
    """A response in the making: its result, the machine over the parameter, the journal, and who
    hears of every point."""

    result: Response
    machines: Machines
    journal: Journal
    tell: Tell

    def problem(self, start: Start) -> Motions:
        """The equations of a start."""
        series = self.result.task.problem(
            self.machines,
            start.at,
            start.H or self.result.task.accuracy.most,
            turns=start.turns,
            is_autonomous=self.result.task.is_whirl,
            omega=start.omega,
            length=start.length,
        )
        return Shooting(series, start.orbit) if start.orbit is not None else series


def start_at(problem: Motions, x: np.ndarray, value: float, direction: float) -> Start:
    """A start at unknowns that solve the equations, one way (1, -1), or both (0)."""
    problem.fix_phase(x)
    ways = []
    for way in (-1.0, 1.0) if direction == 0 else (direction,):
        point = arclength.begin(problem, x, value, way)
        ways.append(np.append(point.tangent, point.by_value))
    return start_along(problem, x, value, ways)


def start_along(problem: Motions, x: np.ndarray, value: float, ways: list[np.ndarray]) -> Start:
    """A start at unknowns that solve the equations, along tangents."""
    if isinstance(problem, Shooting):
        of, orbit, H = problem.series, problem.split(x, value), 0
    else:
        of, orbit, H = problem, None, problem.H
    return Start(H, problem.at, problem.turns, of.omega_scale, of.lengths, x, value, ways, orbit)


def follow(search: Search, start: Start) -> Branch:
    """A branch from a start on; it is among the result's at once."""
    result, task, branch = search.result, search.result.task, Branch()
    result.branches.append(branch)
    label = f"branch {len(result.branches)}"
    accuracy = replace(task.accuracy, most=task.accuracy.most * start.turns // task.turns)
    ends = ["start", "start"]
    for side, way in enumerate(start.ways):
        problem = search.problem(start)
        point = Point(start.x, start.value, way[:-1], float(way[-1]))
        tracer = Tracer(problem, task.low, task.high, steps=task.steps, accuracy=accuracy)
        for passed in _passed(search, tracer, point):
            search.tell(label, passed.solution)
            is_start = not passed.bifurcations and passed.solution.value == start.value
            if side and is_start:
                continue  # it is there already
            branch.points.append(passed.solution)
            behind = len(branch.points) - 2
            branch.bifurcations += [b._replace(behind=behind) for b in passed.bifurcations]
            if (task.is_whirl or start.turns > task.turns) and _is_joining(branch, task.is_whirl):
                tracer.end = RESTING if task.is_whirl else JOINED
                # where it turns is that branch's period doubling, or where rest loses its stability
                branch.bifurcations = [b for b in branch.bifurcations if b.behind != behind]
                break
        ended = search.journal.recall(Ended)
        if ended is None:
            why = tracer.end or LOST + _why_lost(tracer, branch, accuracy)
            ended = search.journal.add(Ended(why))
        ends[1] = ended.why
        if ended.why.startswith(LOST):
            at = f"{label} ends at {task.name} = ", _last(branch, start.value)
            result.notes.append(Note("branch-lost", result.unit, *at, f": {ended.why}"))
        if len(start.ways) > 1 and side == 0:
            _turn_round(branch)
            ends = [ends[1], ""]
            if ends[0] == CLOSED:
                ends[1] = ends[0]
                break
    branch.ends = ends[0], ends[1]
    coarse = [
        p.value
        for p in branch.points
        if p.last_share > accuracy.share and accuracy.most >= p.orbit.H
    ]
    if coarse:
        many = f"{label} has more than {accuracy.most} harmonics from {task.name} = "
        said = (many, min(coarse), " to ", max(coarse), ": amplitudes are less exact there")
        result.notes.append(Note("few-harmonics", result.unit, *said))
    return branch


def _passed(search: Search, tracer: Tracer, point: Point) -> Iterator[Passed]:
    """The points of a branch one way: those of an earlier call, then new ones; where it is lost it
    ends with nothing in `tracer.end`."""
    first = last = None
    since = 0  # the last place from which it can be gone on with
    while (passed := search.journal.recall(Passed)) is not None:
        if passed.place.H:
            first, last, since = first or passed, passed, 0
        since += 1
        problem = tracer.series.like(passed.solution.orbit.H, at=passed.place.at)
        yield passed._replace(solution=with_motion(problem, passed.solution))
    if search.journal.holds(Ended):
        return
    if first is None or last is None:
        walk = tracer.follow(point)
    else:
        walk, since = tracer.go_on(first.place, last.place, last.solution), since - 1
    try:
        for passed in itertools.islice(walk, since, None):
            search.journal.add(passed)
            yield passed
    except Lost:
        tracer.end = ""


def _is_joining(branch: Branch, is_whirl: bool) -> bool:
    """Whether a branch whose period is longer has just passed a motion of the shorter one, or a
    whirl the machine at rest: what the longer period adds, or all that moves, turns into its
    opposite there."""
    if len(branch.points) < 2:
        return False
    turns = branch.points[-1].orbit.turns
    first, second = (resized(p.orbit.b, 2 * turns) for p in branch.points[-2:])
    k = np.arange(1, 2 * turns + 1)
    odd = np.repeat((k % turns != 0) | is_whirl, 2)
    return float(np.sum(first[1:][odd] * second[1:][odd])) < 0


def _last(branch: Branch, value: float) -> float:
    return branch.points[-1].value if branch.points else value


def _turn_round(branch: Branch) -> None:
    last = len(branch.points) - 2
    branch.points.reverse()
    branch.bifurcations = [b._replace(behind=last - b.behind) for b in branch.bifurcations[::-1]]


def _why_lost(tracer: Tracer, branch: Branch, accuracy: Accuracy) -> str:
    """Where a branch that does not converge ends, and why."""
    if not branch.points:
        return "Newton's method does not converge there"
    last = branch.points[-1]
    if accuracy.most == last.orbit.H and last.last_share > accuracy.share:
        return (
            f"the motion has more than {accuracy.most} harmonics: the highest are "
            f"{last.last_share:.1g} of it; ask for more, or soften the wall"
        )
    machine = tracer.series.machine_at(last.value)
    value, _ = basis(last.orbit.H, np.linspace(0, 2 * math.pi, 1000))
    opening = machine.laws.openings(value @ last.orbit.b @ machine.B.T)
    if (np.abs(opening).min(axis=0) < 1e-3 * machine.laws.length).any():
        return "a corner of a law: a contact just opens or closes there"
    return "Newton's method does not converge with the shortest step"


def is_known(
    branches: Sequence[Branch], orbit: Orbit, value: float, is_whirl: bool = False
) -> bool:
    """Whether a branch passes through an orbit, at the same time, whole turns later, or, of a whirl
    by itself, at any time."""
    for branch in branches:
        for a, b in zip(branch.points, branch.points[1:], strict=False):
            if not min(a.value, b.value) <= value <= max(a.value, b.value) or a.value == b.value:
                continue
            share = (value - a.value) / (b.value - a.value)
            turns = math.lcm(a.orbit.turns, orbit.turns)
            H = max(o.H * turns // o.turns for o in (a.orbit, b.orbit, orbit))
            first, second, own = (
                resized(repeated(o.b, turns // o.turns), H) for o in (a.orbit, b.orbit, orbit)
            )
            middle, near = first + share * (second - first), 0.5 * np.linalg.norm(second - first)
            angles = [2 * math.pi * turn / turns for turn in range(turns)]
            if is_whirl:  # whose phase is free
                once = amplitudes(middle)[1].conj() @ amplitudes(own)[1]
                angles = [-float(np.angle(once))]
            for angle in angles:
                gap = np.linalg.norm(middle - shifted(own, angle))
                if gap <= _SAME * np.linalg.norm(own) + near:
                    return True
    return False
