"""Periodic answers of a machine over its speed or another parameter: branches from both ends of the
range and from seeds, each followed as far as it goes."""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np

from ..machine.rotor import Rotor
from ..message_templates import Message
from ..one_thread import on_one_thread
from . import arclength
from .arclength import Lost, Point
from .balance import Orbit, Problem
from .branch import Branch, solution
from .branch_switching import follow_switched
from .checkpoint import Journal, Start, Started
from .continuation import LOST, Search, Tell, follow, is_known, start_at
from .method_switch import Motions
from .problem import SPEED, Machines, Note, PeriodicError, Response, Task, check, machines_of
from .self_excited import growing, rolling
from .shooting import Shooting
from .starting_points import guesses

_LINEAR_POINTS = 401  # of a machine without nonlinear parts
_BEYOND, _MOST_STARTS = 0.02, 12  # of the range: where a lost branch is taken up again


@on_one_thread
def response(
    rotor: Rotor, task: Task, tell: Tell = lambda _, __: None, journal: Journal | None = None
) -> Response:
    """All branches that a task reaches; `tell` hears of every point, and the journal of all that it
    takes to go on from there. A branch that is lost keeps what it has. KeyboardInterrupt ends it
    with what there is."""
    check(rotor, task)
    machines = machines_of(rotor, task)
    machines(task.low).check_held()
    result = Response(rotor, task)
    problem = _problem(machines, task, task.low)
    if problem.b == 0:
        result.branches.append(_linear(problem, task, tell))
        return result
    search = Search(result, machines, journal or Journal(), tell)
    try:
        if task.begin is not None:
            _from_orbit(search, task.begin)
        elif task.is_whirl:
            _whirl(search)
        else:
            _from_ends(search)
        if task.has_branches:
            follow_switched(search)
    except KeyboardInterrupt:
        result.is_stopped = True
        result.notes.append(Message("stopped: what was found until then is kept", "stopped"))
        if result.branches and not result.branches[-1].ends[1]:
            result.branches[-1].ends = "start", "stopped"
    return result


def _problem(machines: Machines, task: Task, at: float) -> Problem:
    H = max(task.accuracy.least, 3) * task.turns
    return task.problem(machines, at, H, turns=task.turns)


def _linear(problem: Problem, task: Task, tell: Tell) -> Branch:
    """A machine without nonlinear parts: at even values."""
    branch = Branch(ends=("end of the range", "end of the range"))
    for value in np.linspace(task.low, task.high, _LINEAR_POINTS):
        point = Point(np.zeros(0), float(value), np.zeros(0), 1.0)
        result = solution(problem, point, task.accuracy)
        branch.points.append(result)
        tell("linear", result)
    return branch


def _from_ends(search: Search) -> None:
    """From both ends of the range, from the seeds, and, where branches were lost, from beyond."""
    task = search.result.task
    todo = [(task.low, 1.0), (task.high, -1.0), *((s, 0.0) for s in task.seeds)]
    for value, direction in todo:
        if len(todo) < _MOST_STARTS:
            todo += [(s, 0.0) for s in _beyond(search.result) if s not in {v for v, _ in todo}]
        is_seed = value in task.seeds and direction == 0
        _follow_all(search, _new_at(search, value, direction, is_seed))


Notes = list[Message]


def _follow_all(search: Search, new: Generator[Start, None, Notes]) -> None:
    """Follow the branches from starts, each before the next is looked for."""
    while True:
        started = search.journal.recall(Started)
        if started is None:
            try:
                started = Started(next(new), [])
            except StopIteration as end:
                started = Started(None, end.value)
            search.journal.add(started)
        search.result.notes += started.notes
        if started.start is None:
            return
        follow(search, started.start)


def _from_orbit(search: Search, begin: Orbit) -> None:
    """Both ways from an orbit that is given."""
    task = search.result.task
    own = {str(n): value for n, _, value in search.result.rotor.parameters()}
    value = begin.speed if task.name == SPEED else own[task.name]
    if not task.low <= value <= task.high:
        raise PeriodicError(
            f"{task.name} = {value:g}, where the orbit begins: must be in the range"
        )
    problem = _problem(search.machines, task, value).like(begin.H)
    try:
        x = arclength.solve(problem, problem.join(begin), value)
    except Lost as error:
        raise PeriodicError(f"the orbit given is none at {task.name} = {value:g}") from error
    follow(search, start_at(problem, x, value, 0.0))


def _whirl(search: Search) -> None:
    """Whirls that roll along a wall or grow from rest, at the ends of the range, in its middle,
    and at the seeds."""
    _follow_all(search, _new_whirls(search))
    if not search.result.branches:
        said = (
            "no whirl was found that rolls along a wall or grows from rest: friction or speed may "
            "be too small"
        )
        search.result.notes.append(Message(said, "no-motion"))


def _new_whirls(search: Search) -> Generator[Start, None, Notes]:
    task, machines = search.result.task, search.machines
    for value in (*task.seeds, 0.5 * (task.low + task.high), task.high, task.low):
        speed = task.speed_at(value)
        of_scale = task.problem(machines, value, 3, is_autonomous=True, omega=speed)
        for guess in (*rolling(of_scale, value), *growing(of_scale, value)):
            problem = task.problem(
                machines,
                value,
                max(task.accuracy.least, 3),
                is_autonomous=True,
                omega=guess.omega,
                length=max(float(np.abs(guess.b).max()), of_scale.lengths),
            )
            start = problem.join(guess)
            problem.fix_phase(start)
            try:
                x = arclength.solve(problem, start, value)
            except Lost:
                continue
            orbit = problem.split(x, value)
            known = search.result.branches
            if _moves(problem, orbit) and not is_known(known, orbit, value, is_whirl=True):
                yield start_at(problem, x, value, 0.0)
    return []


def _moves(problem: Problem, orbit: Orbit) -> bool:
    """Whether an autonomous orbit is a motion, and turns the way it was looked for."""
    return float(np.linalg.norm(orbit.b[1:])) > 0.1 * problem.lengths and orbit.omega > 0


def _beyond(result: Response) -> list[float]:
    """Values a little beyond the places where branches were lost."""
    task, outcome = result.task, []
    for branch in result.branches:
        for end, a, b in ((branch.ends[0], 1, 0), (branch.ends[1], -2, -1)):
            if end.startswith(LOST) and len(branch.points) > 1:
                way = math.copysign(1.0, branch.points[b].value - branch.points[a].value)
                beyond = branch.points[b].value + way * _BEYOND * (task.high - task.low)
                if task.low < beyond < task.high:
                    outcome.append(beyond)
    return outcome


def _new_at(
    search: Search, value: float, direction: float, is_seed: bool
) -> Generator[Start, None, Notes]:
    """Motions at a value through which no branch passes yet: the first that is found, at a seed all
    of them."""
    result, task, machines = search.result, search.result.task, search.machines
    notes: Notes = []
    is_found = is_new = False
    for guess in guesses(result.rotor, task, machines, value, is_seed, notes):
        H = min(max(guess.H, task.accuracy.least), task.accuracy.most)
        series = _problem(machines, task, value).like(H)
        problem: Motions = series
        try:
            x = arclength.solve(problem, problem.join(guess), value)
        except Lost:
            if not task.is_shot(guess):
                continue
            guess = guess._replace(parameter=value)
            try:
                problem = Shooting(series, guess)
                x = arclength.solve(problem, problem.join(guess), value)
            except Lost:
                continue
        orbit, is_found = problem.split(x, value), True
        if not is_known(result.branches, orbit, value):
            is_new = True
            yield start_at(problem, x, value, direction)
        if not is_seed:
            break
    if not is_found:
        how = ": neither from rest, nor from a run in time, which may be no periodic one"
        said = (f"no periodic motion was found at {task.name} = ", value, how)
        notes.append(Note("no-motion", result.unit, *said))
    elif is_seed and not is_new:
        text = f"no further motion was found at the seed {task.name} = "
        notes.append(Note("no-motion", result.unit, text, value))
    return notes
