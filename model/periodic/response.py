"""Periodic responses of a machine over its speed or another parameter: branches from both ends of
the range and from seeds."""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from ..machine.rotor import Rotor
from ..message_templates import Message
from ..one_thread import on_one_thread
from ..simulation import HYSTERETIC_AS_SLOWER
from . import arclength, newton
from .balance import HarmonicBalance, Orbit
from .branch import Solution
from .branch_switching import follow_switched
from .checkpoint import EventLog, Starts
from .continuation import (
    LOST,
    RESTING,
    BranchSearch,
    ReportPoint,
    follow,
    follow_all,
    is_known,
    start_along,
    start_at,
)
from .harmonic_count import counts_to_solve_with, with_enough_harmonics
from .method_switch import PeriodicEquations
from .newton import NotConverged
from .problem import SPEED, Note, PeriodicError, Response, Task, check, machines_of
from .self_excited import beginning_whirls, growing_whirls, rolling_whirls
from .shooting import Shooting
from .starting_points import guesses

_NO_START = "no-start"  # a note's code
_BEYOND, _MOST_STARTS = 0.02, 12  # of the range: where a lost branch is taken up again


@on_one_thread
def response(
    rotor: Rotor,
    task: Task,
    report_point: ReportPoint = lambda _, __: None,
    log: EventLog | None = None,
) -> Response:
    """Return all branches that a task reaches; `report_point` is called with every point, and the
    log records what a restart needs. A branch that is lost keeps its points. KeyboardInterrupt ends
    the computation with the points so far."""
    beyond = check(rotor, task)
    machines = machines_of(rotor, task)
    machines(task.low).check_supported()
    if machines(task.low).laws.count == 0:  # a step may be as long as the motion is large
        task = replace(task, steps=replace(task.steps, large=task.steps.longest))
    result = Response(rotor, task)
    result.notes += beyond
    if rotor.eta_h > 0.0:
        result.notes.append(HYSTERETIC_AS_SLOWER)
    search = BranchSearch(result, machines, log or EventLog(), report_point)
    try:
        if task.start_orbit is not None:
            _from_orbit(search, task.start_orbit)
        elif task.is_whirl:
            _from_whirls(search)
        else:
            _from_ends(search)
        if task.follows_bifurcations:
            follow_switched(search)
    except KeyboardInterrupt:
        result.is_stopped = True
        result.notes.append(Message("stopped: what was found until then is kept", "stopped"))
        if result.branches and not result.branches[-1].ends[1]:
            result.branches[-1].ends = "start", "stopped"
    return result


def _from_ends(search: BranchSearch) -> None:
    """Follow branches from both ends of the range, from the seeds, and from beyond the places where
    branches were lost."""
    task = search.result.task
    todo = [(task.low, 1.0), (task.high, -1.0), *((s, 0.0) for s in task.seeds)]
    for value, direction in todo:
        if len(todo) < _MOST_STARTS:
            todo += [
                (s, 0.0) for s in _beyond_lost_ends(search.result) if s not in {v for v, _ in todo}
            ]
        is_seed = value in task.seeds and direction == 0
        follow_all(search, _starts_at(search, value, direction, is_seed))
    search.result.notes = [n for n in search.result.notes if not _is_reached(search.result, n)]


def _is_reached(result: Response, note: Message) -> bool:
    """Return whether a note says that no start was found where a branch from elsewhere has come
    to."""
    if note.code != _NO_START or not isinstance(note, Note):
        return False
    values = [[p.value for p in branch.points] for branch in result.branches]
    return any(each and min(each) <= float(note.parts[1]) <= max(each) for each in values)


def _from_orbit(search: BranchSearch, begin: Orbit) -> None:
    """Follow the branch through a given orbit in both directions."""
    task = search.result.task
    own = search.result.rotor.numbers()
    value = begin.speed if task.name == SPEED else own[task.name].value
    if not task.low <= value <= task.high:
        raise PeriodicError(
            f"{task.name} = {value:g}, where the orbit begins: must be in the range"
        )
    begin = begin._replace(parameter=value)
    problem = search.equations_of(begin)
    x = problem.join(begin)
    problem.fix_phase(x)
    try:
        # where a branch has many motions at one value, Newton's method would go to another one
        if not newton.is_solution(problem, x, value):
            x = newton.solve(problem, x, value)
        orbit = problem.split(x, value)
        if task.is_whirl and not _is_forward_whirl(problem.balance, orbit):
            raise NotConverged()
    except NotConverged as error:
        raise PeriodicError(
            f"the given orbit is not a solution at {task.name} = {value:g}"
        ) from error
    follow(search, start_at(problem, x, value, 0.0))


def _from_whirls(search: BranchSearch) -> None:
    """Follow whirls that roll along a wall or grow from rest, from the ends of the range, its
    middle, and the seeds, and those that begin at rest within the range."""
    follow_all(search, _whirl_starts(search))
    if not search.result.branches:
        text = (
            "no whirl was found that rolls along a wall or grows from rest: friction or speed may "
            "be too small, or the range begin above the threshold of stability"
        )
        search.result.notes.append(Message(text, "no-motion"))


def _whirl_starts(search: BranchSearch) -> Starts:
    task, machines = search.result.task, search.machines
    for value in (*task.seeds, 0.5 * (task.low + task.high), task.high, task.low):
        speed = task.speed_at(value)
        coarse = task.problem(machines, value, 3, omega=abs(speed))
        for guess in (*rolling_whirls(coarse, value), *growing_whirls(coarse, value)):
            problem, x = _of_whirl(search, guess, coarse.length_scale)
            try:
                x = newton.solve(problem, x, value)
            except NotConverged:
                continue
            if _is_forward_whirl(problem, problem.split(x, value)):
                new = _if_new(search, problem, x, value)
                if new is not None:
                    yield start_at(*new, value, 0.0)
    beginnings = list(beginning_whirls(coarse, task.low, task.high))
    for rest, guess in beginnings:
        if _has_come_to_rest(search, guess, beginnings):
            continue
        problem, x = _of_whirl(search, guess, coarse.length_scale)
        away = np.append(x - problem.join(rest), 0.0)  # from rest, at whatever value that is
        try:
            point = arclength.correct(problem, x, guess.parameter, away / np.linalg.norm(away))
        except NotConverged:
            continue
        orbit = problem.split(point.x, point.value)
        is_new = not is_known(search.result.branches, orbit, point.value, is_whirl=True)
        if is_new and task.low <= point.value <= task.high and _is_forward_whirl(problem, orbit):
            directions = sorted((point.direction, -point.direction), key=lambda d: float(d[-1]))
            yield start_along(problem, point.x, point.value, directions)
    return []


def _has_come_to_rest(
    search: BranchSearch, guess: Orbit, beginnings: Sequence[tuple[Orbit, Orbit]]
) -> bool:
    """Return whether a branch ends at rest where this guess begins, less than a step from it and
    nearer than to the other beginnings: there the value may be the same for every size, so that no
    interpolation between the points of a branch tells whether a motion is on it."""
    task = search.result.task

    def apart(small: Orbit, end: Solution) -> float:
        change = abs(small.omega - end.orbit.omega) / small.omega
        return abs(small.parameter - end.value) / (task.high - task.low) + change

    return any(
        why == RESTING
        and apart(guess, end) <= task.steps.longest
        and min((small for _, small in beginnings), key=lambda small: apart(small, end)) is guess
        for branch in search.result.branches
        for why, end in zip(branch.ends, (branch.points[0], branch.points[-1]), strict=True)
    )


def _of_whirl(
    search: BranchSearch, guess: Orbit, least_scale: float
) -> tuple[HarmonicBalance, np.ndarray]:
    """Return the equations of a whirl and its unknowns; least_scale: the smallest scale of length
    [m]."""
    task = search.result.task
    size, H = max(float(np.abs(guess.b).max()), least_scale), max(task.accuracy.least, 3)
    problem = task.problem(
        search.machines, guess.parameter, H, omega=guess.omega, length_scale=size
    )
    x = problem.join(guess)
    problem.fix_phase(x)
    return problem, x


def _is_forward_whirl(problem: HarmonicBalance, orbit: Orbit) -> bool:
    """Return whether a self-excited orbit is a motion, and whirls in the sense that was searched
    for."""
    return float(np.linalg.norm(orbit.b[1:])) > 0.1 * problem.length_scale and orbit.omega > 0


def _if_new(
    search: BranchSearch, problem: PeriodicEquations, x: np.ndarray, value: float
) -> tuple[PeriodicEquations, np.ndarray] | None:
    """Return the equations of a motion and its unknowns, or None where a branch passes through it.
    With too few harmonics a motion may be far from itself: it is compared with as many as the
    branches have."""
    branches, task = search.result.branches, search.result.task

    def passes(equations: PeriodicEquations, x: np.ndarray, value: float) -> bool:
        return is_known(branches, equations.split(x, value), value, is_whirl=task.is_whirl)

    if passes(problem, x, value):
        return None
    if branches and isinstance(problem, HarmonicBalance):
        point = arclength.with_tangent(problem, x, value, 1.0)
        with suppress(NotConverged):
            try:
                other, at = with_enough_harmonics(problem, point, task.accuracy, True)
                problem, x = other, at.x
            except NotConverged:  # where few harmonics have a fold elsewhere: along the curve
                other, at = with_enough_harmonics(problem, point, task.accuracy)
            if passes(other, at.x, at.value):
                return None
    return problem, x


def _beyond_lost_ends(result: Response) -> list[float]:
    """Return values of the parameter a little beyond the places where branches were lost."""
    task, outcome = result.task, []
    for branch in result.branches:
        for end, a, b in ((branch.ends[0], 1, 0), (branch.ends[1], -2, -1)):
            if end.startswith(LOST) and len(branch.points) > 1:
                way = math.copysign(1.0, branch.points[b].value - branch.points[a].value)
                beyond = branch.points[b].value + way * _BEYOND * (task.high - task.low)
                if task.low < beyond < task.high:
                    outcome.append(beyond)
    return outcome


def _solved_from(
    guess: Orbit, coarse: HarmonicBalance, value: float, task: Task
) -> tuple[PeriodicEquations, np.ndarray]:
    """Return the motion that Newton's method finds near an orbit; raises `NotConverged`."""
    for H in counts_to_solve_with(guess, task.accuracy):
        series = coarse.modified(H)
        with suppress(NotConverged):
            return series, newton.solve(series, series.join(guess), value)
    if not task.needs_shooting(guess):
        raise NotConverged()
    shooting = Shooting(series, guess._replace(parameter=value))
    return shooting, newton.solve(shooting, shooting.join(guess), value)


def _starts_at(search: BranchSearch, value: float, direction: float, is_seed: bool) -> Starts:
    """Yield starts at motions through which no branch passes yet: the first one found, at a seed
    all of them."""
    result, task, machines = search.result, search.result.task, search.machines
    failures = list[str]()
    is_found = is_new = False
    for guess in guesses(result.rotor, task, machines, value, is_seed, failures):
        try:
            problem, x = _solved_from(guess, task.coarse_problem(machines, value), value, task)
        except NotConverged:
            continue
        orbit = problem.split(x, value)
        broken = problem.machine_at(value).broken_films(orbit.b, orbit.states)
        if broken:
            failures.append(f"the film of {broken[0]} would be thinner than its roughness")
            continue
        if direction and isinstance(problem, HarmonicBalance):
            point = arclength.with_tangent(problem, x, value, direction)
            try:
                with_enough_harmonics(problem, point, task.accuracy, True)
            except NotConverged:
                continue  # it is a motion of few harmonics alone
        is_found = True
        new = _if_new(search, problem, x, value)
        if new is not None:
            is_new = True
            yield start_at(*new, value, direction)
        if not is_seed:
            break
    why = [f": {failure}" for failure in failures[:1]]
    if not is_found:
        text = f"no periodic motion was found at {task.name} = "
        how = ": neither from rest, nor from a run in time"
        why = why or [", which may be no periodic one"]
        return [Note(_NO_START, result.unit, text, value, how, *why)]
    if is_seed and not is_new:
        text = f"no further motion was found at the seed {task.name} = "
        return [Note("no-motion", result.unit, text, value, *why)]
    return []
