"""Periodic answers of a machine over its speed or another parameter: branches from both ends of the
range and from seeds, each followed as far as it goes."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..machine.rotor import Rotor
from ..one_thread import on_one_thread
from ..simulation import EquilibriumError, StepFailure
from . import arclength
from .arclength import Lost, Point
from .balance import Orbit, Problem
from .branch import Branch, solution
from .continuation import LOST, Tell, follow, is_known
from .seeds import time_seed
from .task import SPEED, Machines, PeriodicError, Response, Task, check, machines_of
from .whirl import rolling

_LINEAR_POINTS = 401  # of a machine without nonlinear parts
_BEYOND, _MOST_STARTS = 0.02, 12  # of the range: where a lost branch is taken up again


@on_one_thread
def response(rotor: Rotor, task: Task, tell: Tell = lambda _, __: None) -> Response:
    """All branches that a task reaches; `tell` hears of every point. A branch that is lost keeps
    what it has. KeyboardInterrupt ends it with what there is."""
    check(rotor, task)
    machines = machines_of(rotor, task)
    machines(task.low).check_held()
    result = Response(rotor, task)
    problem = _problem(machines, task, task.low)
    if problem.b == 0:
        result.branches.append(_linear(problem, task, tell))
        return result
    try:
        if task.begin is not None:
            _from_orbit(result, machines, task.begin, tell)
        elif task.is_whirl:
            _whirl(result, machines, tell)
        else:
            _from_ends(result, machines, tell)
    except KeyboardInterrupt:
        result.notes.append("stopped: what was found until then is kept")
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


def _from_ends(result: Response, machines: Machines, tell: Tell) -> None:
    """From both ends of the range, from the seeds, and, where branches were lost, from beyond."""
    task = result.task
    todo = [(task.low, 1.0), (task.high, -1.0), *((s, 0.0) for s in task.seeds)]
    for value, direction in todo:
        if len(todo) < _MOST_STARTS:
            todo += [(s, 0.0) for s in _beyond(result) if s not in {v for v, _ in todo}]
        _from_start(result, machines, value, direction, tell)


def _from_orbit(result: Response, machines: Machines, begin: Orbit, tell: Tell) -> None:
    """Both ways from an orbit that is given."""
    task = result.task
    own = {str(n): value for n, _, value in result.rotor.parameters()}
    value = begin.speed if task.name == SPEED else own[task.name]
    if not task.low <= value <= task.high:
        raise PeriodicError(
            f"{task.name} = {value:g}, where the orbit begins: must be in the range"
        )
    problem = _problem(machines, task, value).like(begin.H)
    try:
        x = arclength.solve(problem, problem.join(begin), value)
    except Lost as error:
        raise PeriodicError(f"the orbit given is none at {task.name} = {value:g}") from error
    follow(result, problem, x, value, 0.0, tell)


def _whirl(result: Response, machines: Machines, tell: Tell) -> None:
    """Whirls that roll along a wall at the ends of the range, in its middle, and at the seeds."""
    task = result.task
    for value in (*task.seeds, 0.5 * (task.low + task.high), task.high, task.low):
        speed = task.speed_at(value)
        of_scale = task.problem(machines, value, 3, is_autonomous=True, omega=speed)
        for guess in rolling(of_scale, value):
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
            if _moves(problem, orbit) and not is_known(result.branches, orbit, value):
                follow(result, problem, x, value, 0.0, tell)
    if not result.branches:
        result.notes.append(
            "no whirl was found that rolls along a wall: friction or speed may be too small"
        )


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


def _from_start(
    result: Response, machines: Machines, value: float, direction: float, tell: Tell
) -> None:
    """A branch from what is found at a value, unless one passes there already."""
    task = result.task
    for guess in _guesses(result, machines, value):
        H = min(max(guess.H, task.accuracy.least), task.accuracy.most)
        problem = _problem(machines, task, value).like(H)
        try:
            x = arclength.solve(problem, problem.join(guess), value)
        except Lost:
            continue
        orbit = problem.split(x, value)
        if not is_known(result.branches, orbit, value):
            follow(result, problem, x, value, direction, tell)
        break
    else:
        result.notes.append(
            f"no periodic motion was found at {task.name} = {value:g}: neither from rest, nor "
            "from a run in time, which may be no periodic one"
        )


def _guesses(result: Response, machines: Machines, value: float) -> Iterator[Orbit]:
    """Orbits to start from: that of open contacts, then what the machine comes to in time."""
    task = result.task
    problem = _problem(machines, task, value)
    yield problem.split(np.zeros(problem.size), value)
    rotor, speed = task.rotor_at(result.rotor, value), task.speed_at(value)
    for turns in (30, 200):
        try:
            yield time_seed(rotor, machines(value), speed, task.turns, task.loads, 60, turns)
        except (StepFailure, EquilibriumError) as error:
            result.notes.append(str(error))
            return
