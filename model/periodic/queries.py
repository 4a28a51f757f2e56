"""Evaluations of a response: its motions at a value, whether they persist in time, and its folds
over a second parameter."""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ..machine.rotor import Rotor
from . import newton
from .arclength import CurvePoint
from .balance import HarmonicBalance, Orbit
from .branch import FOLD, Bifurcation, Branch, Solution, solution
from .folds import FoldCurve, fold_curve
from .fourier import repeated, resized
from .method_switch import PeriodicEquations
from .newton import NotConverged
from .problem import KEPT, SPEED, Machines, PeriodicError, Response, Task, check_range, machines_of
from .shooting import Shooting
from .starting_points import Persistence, integrate_from_orbit

_ROUNDING = 1e-9  # of the range
_SAME = 1e-7  # share of a motion
_STEPS = 1, 4, 16  # from a point to a value beside it, until Newton's method converges


def motions_at(result: Response, value: float) -> list[Solution]:
    """Return all motions of the branches at a value of the parameter, by Newton's method from the
    neighbouring points."""
    return [motion for each in result.branches for motion in motions_of(result, each, value)]


def motions_of(result: Response, branch: Branch, value: float) -> list[Solution]:
    """Return the same of one branch."""
    outcome = list[Solution]()
    near = _ROUNDING * (result.task.high - result.task.low)
    ends = branch.points[:1] + branch.points[-1:]
    for a, b in zip(branch.points, branch.points[1:], strict=False):
        if a.value == value and a is not branch.points[0]:
            continue  # the previous segment ends there
        low, high = sorted((a.value, b.value))
        is_at_end = any(p is end for p in (a, b) for end in ends if abs(end.value - value) <= near)
        if not is_at_end and not low <= value <= high:
            continue
        solved = _between(result, a, b, value)
        # a closed branch goes a part of a step beyond its start
        if solved is not None and not any(_is_same(solved, other) for other in outcome):
            outcome.append(solved)
    return outcome


def _is_same(a: Solution, b: Solution) -> bool:
    """Return whether two motions at one value, each solved for, differ by rounding alone."""
    _, (first, second) = over_common_period(a.orbit, b.orbit)
    return bool(np.linalg.norm(second - first) <= _SAME * np.linalg.norm(first))


def over_common_period(*orbits: Orbit) -> tuple[int, list[np.ndarray]]:
    """Return the turns of a period of all orbits, and the series of b of each over it, with as many
    harmonics as the finest has."""
    turns = math.lcm(*(orbit.turns for orbit in orbits))
    H = max(orbit.H * turns // orbit.turns for orbit in orbits)
    return turns, [resized(repeated(orbit.b, turns // orbit.turns), H) for orbit in orbits]


def _between(result: Response, a: Solution, b: Solution, value: float) -> Solution | None:
    task = result.task
    H = max(a.orbit.H, b.orbit.H)
    balance = task.problem(result.machines(), value, H, a.orbit.turns, a.orbit.omega)
    share = (value - a.value) / (b.value - a.value)
    problem: PeriodicEquations = balance
    try:
        if task.needs_shooting(a.orbit) or task.needs_shooting(b.orbit):
            near = a.orbit if abs(share) < 0.5 else b.orbit
            problem = Shooting(balance.modified(task.accuracy.most), near)
        points = [(problem.join(point.orbit), point.value) for point in (a, b)]
        problem.fix_phase(points[0][0])
    except NotConverged:
        return None
    # along the line between both, from the nearer one on
    (begin, start), (end, last) = sorted(points, key=lambda point: abs(value - point[1]))
    for steps in _STEPS:
        x, step = begin, (end - begin) * (value - start) / ((last - start) * steps)
        try:
            for at_value in np.linspace(start, value, steps + 1)[1:]:
                x = newton.solve(problem, x + step, float(at_value))
        except NotConverged:
            continue
        return solution(problem, CurvePoint(x, value, x, 1.0), task.accuracy)
    return None


def persists_in_time(result: Response, point: Solution, turns: int) -> Persistence:
    """Return whether the integrator, started on a motion, is still there after some turns."""
    task = result.task
    if task.is_whirl:
        raise PeriodicError(
            "check: not available for self-excited whirl, which is computed without unbalance"
        )
    rotor, machine = task.rotor_at(result.rotor, point.value), result.machines()(point.value)
    return integrate_from_orbit(rotor, machine, point.orbit, point.motion, task.loads, turns)


def check_second(rotor: Rotor, task: Task, name: str, low: float, high: float) -> None:
    """Raise `PeriodicError` or `QuantityError` for a second parameter, one of the machine's, that
    is the first one, or whose range lacks the machine's own value or one that it can have."""
    if name == task.name:
        raise PeriodicError(f"{name}: must be another quantity than the one of the curve")
    start = rotor.numbers()[name].value
    if not low <= start <= high:
        raise PeriodicError(f"{name} = {low:g}:{high:g}: must hold the machine's own, {start:g}")
    check_range(rotor, name, low, high)


def folds_over(
    result: Response,
    fold: Bifurcation,
    name: str,
    low: float,
    high: float,
    report: Callable[[float], object] = lambda _: None,
) -> FoldCurve:
    """Return the curve of folds through one of a response, over a second parameter; report: see
    `fold_curve`.

    Raises `PeriodicError` if the machine's own value of it lies outside the range, or the
    bifurcation is no smooth fold.
    """
    task, rotor = result.task, result.rotor
    check_second(rotor, task, name, low, high)
    start = rotor.numbers()[name].value
    if fold.kind != FOLD:
        raise PeriodicError(f"{fold.kind} at {fold.value:g}: must be a fold")
    if task.needs_shooting(fold.orbit):
        raise PeriodicError(
            f"fold at {fold.value:g}: its motion has more than {task.accuracy.most} harmonics, of "
            f"which no curve of folds is made; a study of responses over {name} finds each"
        )
    first = result.machines()
    about = fold.value, fold.orbit.H, fold.orbit.turns, fold.orbit.omega
    base = task.problem(first, *about)

    @lru_cache(KEPT)
    def problem_at(value: float) -> HarmonicBalance:
        """Return the equations about the fold, at a value of the second parameter."""
        changed = rotor.with_value(name, value)
        if task.name == SPEED:
            machine = first(0.0).with_rotor(changed)
            machines: Machines = lambda _: machine  # noqa: E731
        else:
            machines = machines_of(changed, task)
        problem = task.problem(
            machines, *about, state_scale=base.state_scale, length_scale=base.length_scale
        )
        problem.row_scale = base.row_scale
        problem.fix_phase(problem.join(fold.orbit))
        return problem

    return fold_curve(problem_at, fold.orbit, start, low, high, task.steps, report)
