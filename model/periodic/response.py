"""Periodic answers of a machine over its speed or another parameter: branches from both ends of the
range and from seeds, each followed as far as it goes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..machine.rotor import Rotor
from ..machine.speed_tables import tables_of
from ..one_thread import on_one_thread
from ..quantities import QuantityError
from ..simulation import EquilibriumError, StepFailure
from . import arclength
from .arclength import Lost, Point, Steps
from .balance import Orbit, Parameter, Problem, cached
from .branch import FOLD, Accuracy, Bifurcation, Branch, Solution, Tracer, solution
from .condensed import Condensed
from .folds import FoldCurve, fold_curve
from .fourier import basis, resized
from .seeds import Stay, stay, time_seed
from .whirl import rolling

SPEED = "speed"
_LINEAR_POINTS = 401  # of a machine without nonlinear parts
LOST = "lost: "
_BEYOND, _MOST_STARTS = 0.02, 12  # of the range: where a lost branch is taken up again
_SAME = 0.02  # distance of two orbits that are one, as a share of their size

Tell = Callable[[str, Solution], None]


class PeriodicError(QuantityError):
    """A periodic answer that cannot be had; says why."""


@dataclass(frozen=True)
class Task:
    """What is asked for: the parameter over [low, high], `speed` [rad/s] where it is another one,
    constant `loads` on the ports [N], `turns` in a period, how exact, how long the steps are,
    values at which runs in time seed further branches; is_whirl: of the machine
    without unbalance, that which whirls by itself; begin: an orbit
    from which alone branches are followed, at the machine's own value of the parameter."""

    low: float
    high: float
    name: str = SPEED
    speed: float = 0.0
    turns: int = 1
    loads: np.ndarray | None = None
    accuracy: Accuracy = field(default_factory=Accuracy)
    steps: Steps = field(default_factory=lambda: Steps(most=0.1))
    seeds: tuple[float, ...] = ()
    is_whirl: bool = False
    begin: Orbit | None = None


@dataclass
class Response:
    """Branches of a task, and what is to be said of them, a line each."""

    rotor: Rotor
    task: Task
    branches: list[Branch] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def machine_at(self, value: float) -> Condensed:
        """The machine at a value of the parameter."""
        return _machines(self.rotor, self.task)(value)


def check(rotor: Rotor, task: Task) -> None:
    """Raise `PeriodicError` or `QuantityError` for what cannot be asked of a machine."""
    if not task.low < task.high:
        raise PeriodicError(f"{task.name} = {task.low:g}:{task.high:g}: FROM must be below TO")
    speeds = (task.low, task.high) if task.name == SPEED else (task.speed,)
    for speed in speeds:
        if not 0 < speed < math.inf:
            raise PeriodicError(f"speed = {speed:g} rad/s: must be > 0 and finite")
        for allowed in tables_of(rotor):
            if not allowed.low <= speed <= allowed.high:
                raise PeriodicError(allowed.beyond.format(speed=speed))
    if task.name != SPEED:
        for value in (task.low, task.high):
            rotor.with_value(task.name, value)


def _machines(rotor: Rotor, task: Task) -> Callable[[float], Condensed]:
    if task.name == SPEED:
        machine = Condensed(rotor, task.loads)
        return lambda _: machine
    first = Condensed(rotor.with_value(task.name, task.low), task.loads)
    return cached(lambda value: first.with_rotor(rotor.with_value(task.name, value)))


@on_one_thread
def response(rotor: Rotor, task: Task, tell: Tell = lambda _, __: None) -> Response:
    """All branches that a task reaches; `tell` hears of every point. A branch that is lost keeps
    what it has. KeyboardInterrupt ends it with what there is."""
    check(rotor, task)
    machines = _machines(rotor, task)
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


def _problem(machines: Callable[[float], Condensed], task: Task, at: float) -> Problem:
    H = max(task.accuracy.least, 3) * task.turns
    parameter = Parameter(task.name, task.high - task.low)
    return Problem(machines, parameter, at, H, speed=task.speed, turns=task.turns)


def _linear(problem: Problem, task: Task, tell: Tell) -> Branch:
    """A machine without nonlinear parts: at even values."""
    branch = Branch(ends=("end of the range", "end of the range"))
    for value in np.linspace(task.low, task.high, _LINEAR_POINTS):
        point = Point(np.zeros(0), float(value), np.zeros(0), 1.0)
        result = solution(problem, point, task.accuracy)
        branch.points.append(result)
        tell("linear", result)
    return branch


def _from_ends(result: Response, machines, tell: Tell) -> None:
    """From both ends of the range, from the seeds, and, where branches were lost, from beyond."""
    task = result.task
    todo = [(task.low, 1.0), (task.high, -1.0), *((s, 0.0) for s in task.seeds)]
    for value, direction in todo:
        if len(todo) < _MOST_STARTS:
            todo += [(s, 0.0) for s in _beyond(result) if s not in {v for v, _ in todo}]
        _from_start(result, machines, value, direction, tell)


def _from_orbit(result: Response, machines, begin: Orbit, tell: Tell) -> None:
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


def _whirl(result: Response, machines, tell: Tell) -> None:
    """Whirls that roll along a wall at the ends of the range, in its middle, and at the seeds."""
    task = result.task
    for value in (*task.seeds, 0.5 * (task.low + task.high), task.high, task.low):
        speed = value if task.name == SPEED else task.speed
        parameter = Parameter(task.name, task.high - task.low)
        of_scale = Problem(
            machines, parameter, value, 3, speed=task.speed, is_autonomous=True, omega=speed
        )
        for guess in rolling(of_scale, value):
            problem = Problem(
                machines,
                parameter,
                value,
                max(task.accuracy.least, 3),
                speed=task.speed,
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
            if _moves(problem, orbit) and not _is_known(result.branches, orbit, value):
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


def _from_start(result: Response, machines, value: float, direction: float, tell: Tell) -> None:
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
        if not _is_known(result.branches, orbit, value):
            follow(result, problem, x, value, direction, tell)
        break
    else:
        result.notes.append(
            f"no periodic motion was found at {task.name} = {value:g}: neither from rest, nor "
            "from a run in time, which may be no periodic one"
        )


def _guesses(result: Response, machines, value: float):
    """Orbits to start from: that of open contacts, then what the machine comes to in time."""
    task = result.task
    problem = _problem(machines, task, value)
    yield problem.split(np.zeros(problem.size), value)
    rotor = result.rotor if task.name == SPEED else result.rotor.with_value(task.name, value)
    speed = value if task.name == SPEED else task.speed
    for turns in (30, 200):
        try:
            yield time_seed(rotor, machines(value), speed, task.turns, task.loads, 60, turns)
        except (StepFailure, EquilibriumError) as error:
            result.notes.append(str(error))
            return


def follow(
    result: Response, problem: Problem, x: np.ndarray, value: float, direction: float, tell: Tell
) -> Branch:
    """A branch from a solution on, one way (1, -1), or both (0); it is among the result's at
    once."""
    task, branch = result.task, Branch()
    result.branches.append(branch)
    label = f"branch {len(result.branches)}"
    ends = ["start", "start"]
    for side, way in enumerate((-1.0, 1.0) if direction == 0 else (direction,)):
        tracer = Tracer(
            problem, x, value, task.low, task.high, steps=task.steps, accuracy=task.accuracy
        )
        try:
            for outcome, passed in tracer.follow(way):
                tell(label, outcome)
                if side and not passed and outcome.value == value:
                    continue  # the start, which is there already
                branch.points.append(outcome)
                branch.bifurcations += [b._replace(behind=len(branch.points) - 2) for b in passed]
            ends[1] = tracer.end
        except Lost:
            ends[1] = LOST + why_lost(tracer, branch)
            result.notes.append(
                f"{label} ends at {task.name} = {_last(branch, value):g}: {ends[1]}"
            )
        if direction == 0 and side == 0:
            _turn_round(branch)
            ends = [ends[1], ""]
            if ends[0] == "the branch is closed":
                ends[1] = ends[0]
                break
    branch.ends = ends[0], ends[1]
    coarse = [p.value for p in branch.points if p.last_share > task.accuracy.share]
    if coarse:
        result.notes.append(
            f"{label} has more than {task.accuracy.most} harmonics from {task.name} = "
            f"{min(coarse):g} to {max(coarse):g}: amplitudes are less exact there"
        )
    return branch


def _last(branch: Branch, value: float) -> float:
    return branch.points[-1].value if branch.points else value


def _turn_round(branch: Branch) -> None:
    last = len(branch.points) - 2
    branch.points.reverse()
    branch.bifurcations = [b._replace(behind=last - b.behind) for b in branch.bifurcations[::-1]]


def at(result: Response, value: float) -> list[Solution]:
    """All motions of the branches at a value of the parameter, by Newton's method from their
    neighbours."""
    outcome = []
    for branch in result.branches:
        for a, b in zip(branch.points, branch.points[1:], strict=False):
            low, high = sorted((a.value, b.value))
            if not low <= value < high and not (value == high and b is branch.points[-1]):
                continue
            solved = _between(result, a, b, value)
            if solved is not None:
                outcome.append(solved)
    return outcome


def _between(result: Response, a: Solution, b: Solution, value: float) -> Solution | None:
    task = result.task
    machines = _machines(result.rotor, task)
    problem = Problem(
        machines,
        Parameter(task.name, task.high - task.low),
        value,
        max(a.orbit.H, b.orbit.H),
        speed=task.speed,
        turns=task.turns,
        is_autonomous=task.is_whirl,
        omega=a.orbit.omega,
    )
    share = (value - a.value) / (b.value - a.value)
    first, second = problem.join(a.orbit), problem.join(b.orbit)
    if task.is_whirl:
        problem.fix_phase(first)
    try:
        x = arclength.solve(problem, first + share * (second - first), value)
    except Lost:
        return None
    return solution(problem, Point(x, value, x, 1.0), task.accuracy)


def stays(result: Response, point: Solution, turns: int) -> Stay:
    """Whether the integrator, started on a motion, is still there after some turns."""
    task = result.task
    rotor = result.rotor
    if task.is_whirl:
        raise PeriodicError("a whirl by itself is of the machine without its unbalance: no check")
    if task.name != SPEED:
        rotor = rotor.with_value(task.name, point.value)
    machine = _machines(result.rotor, task)(point.value)
    return stay(rotor, machine, point.orbit, point.motion, task.loads, turns)


def folds_over(
    result: Response, fold: Bifurcation, name: str, low: float, high: float
) -> FoldCurve:
    """The curve of folds through one of a response, over a second parameter.

    Raises `PeriodicError` where the machine's own value of it lies outside, or what is given is no
    fold of a smooth branch.
    """
    task, rotor = result.task, result.rotor
    start = {str(n): value for n, _, value in rotor.parameters()}[name]
    if not low <= start <= high:
        raise PeriodicError(f"{name} = {low:g}:{high:g}: must hold the machine's own, {start:g}")
    if fold.kind != FOLD:
        raise PeriodicError(f"{fold.kind} at {fold.value:g}: must be a fold")
    for end in (low, high):
        rotor.with_value(name, end)
    first = _machines(rotor, task)

    @cached
    def problem_at(value: float) -> Problem:
        changed = rotor.with_value(name, value)
        machines = _machines(changed, task)
        if task.name == SPEED:
            machine = first(0.0).with_rotor(changed)
            machines = lambda _: machine  # noqa: E731
        orbit = fold.orbit
        problem = Problem(
            machines,
            Parameter(task.name, task.high - task.low),
            fold.value,
            orbit.H,
            speed=task.speed,
            turns=task.turns,
            is_autonomous=task.is_whirl,
            omega=orbit.omega,
            length=lengths,
        )
        problem.row_scale = row_scale
        if task.is_whirl:
            problem.fix_phase(problem.join(orbit))
        return problem

    base = _problem(first, task, fold.value).like(fold.orbit.H)
    lengths, row_scale = base.lengths, base.row_scale
    return fold_curve(problem_at, fold.orbit, start, low, high, task.steps)


def why_lost(tracer: Tracer, branch: Branch) -> str:
    """Where a branch that does not converge ends, and why."""
    if not branch.points:
        return "Newton's method does not converge there"
    last = branch.points[-1]
    accuracy = tracer.accuracy
    if accuracy.most <= last.orbit.H and last.last_share > accuracy.share:
        return (
            f"the motion has more than {accuracy.most} harmonics: the highest are "
            f"{last.last_share:.1g} of it; ask for more, or soften the wall"
        )
    machine = tracer.problem.machine_at(last.value)
    value, _ = basis(last.orbit.H, np.linspace(0, 2 * math.pi, 1000))
    opening = machine.laws.openings(value @ last.orbit.b @ machine.B.T)
    if (np.abs(opening).min(axis=0) < 1e-3 * machine.laws.length).any():
        return "a corner of a law: a contact just opens or closes there"
    return "Newton's method does not converge with the shortest step"


def _is_known(branches: Sequence[Branch], orbit: Orbit, value: float) -> bool:
    """Whether a branch passes through an orbit."""
    for branch in branches:
        for a, b in zip(branch.points, branch.points[1:], strict=False):
            if not min(a.value, b.value) <= value <= max(a.value, b.value) or a.value == b.value:
                continue
            share = (value - a.value) / (b.value - a.value)
            H = max(a.orbit.H, b.orbit.H, orbit.H)
            first, second, own = (resized(o.b, H) for o in (a.orbit, b.orbit, orbit))
            gap = np.linalg.norm(first + share * (second - first) - own)
            if gap <= _SAME * np.linalg.norm(own) + 0.5 * np.linalg.norm(second - first):
                return True
    return False
