"""Branches that begin at bifurcations of others: at period doublings and branch points.

There the Jacobian has a null vector v. The motion a little along it, x_0 + eps v, is corrected at
right angles to v, and to the branch that is left: of a doubled period v holds but what alternates
from turn to turn, and the arms along v and -v are one motion, a period apart.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..message_templates import Message
from . import arclength
from .arclength import Lost, Point
from .balance import Orbit, Problem
from .branch import BRANCHING, DOUBLING, Bifurcation, Branch
from .checkpoint import Start, Started
from .continuation import Search, follow, is_known, start_along
from .fourier import repeated
from .method_switch import Motions
from .problem import Task
from .shooting import Shooting

_AWAY = (0.05, 0.02, 0.1, 0.2, 0.005)  # in lengths of the interfaces: how far the first motion is
_MOST_BRANCHES = 24


def follow_switched(search: Search) -> None:
    """Follow the branches from all bifurcations, from those on the new ones too."""
    branches = search.result.branches
    if search.result.task.is_whirl:
        said = "branches that begin at bifurcations of a whirl by itself are not followed"
        search.result.notes.append(Message(said, "few-branches"))
        return
    for branch in branches:  # which grows
        for bifurcation in branch.bifurcations:
            if bifurcation.kind not in (DOUBLING, BRANCHING):
                continue
            if len(branches) >= _MOST_BRANCHES:
                said = f"there are more than {_MOST_BRANCHES} branches: not all were followed"
                search.result.notes.append(Message(said, "few-branches"))
                return
            _follow_from(search, branch, bifurcation)


def _follow_from(search: Search, branch: Branch, bifurcation: Bifurcation) -> None:
    """Follow what begins at a bifurcation of a branch."""
    new = _new(search, branch, bifurcation)
    while True:
        started = search.journal.recall(Started)
        if started is None:
            started = search.journal.add(Started(next(new, None), []))
        if started.start is None:
            return
        follow(search, started.start)


def _new(search: Search, branch: Branch, bifurcation: Bifurcation) -> Iterator[Start]:
    """Starts of branches at a bifurcation that no branch has come through yet."""
    task, orbit, value = search.result.task, bifurcation.orbit, bifurcation.value
    is_doubling = bifurcation.kind == DOUBLING
    if is_doubling:
        both = repeated(orbit.b, 2), repeated(orbit.own, 2)
        orbit = Orbit(*both, 0.5 * orbit.omega, 2 * orbit.turns, orbit.speed, orbit.parameter)
    problem = _equations(search, orbit, value)
    x = problem.join(orbit)
    across = np.append(_null_vector(problem, x, value, is_doubling), 0.0)
    if not is_doubling:
        a, b = branch.points[bifurcation.behind : bifurcation.behind + 2]
        along = np.append(
            problem.join(b.orbit) - problem.join(a.orbit),
            (b.value - a.value) / problem.parameter.scale,
        )
        along /= np.linalg.norm(along)
        across -= (across @ along) * along
        across /= np.linalg.norm(across)
    for sign in (1.0,) if is_doubling else (1.0, -1.0):
        point = _beside(task, problem, x, value, sign * across)
        if point is None:
            continue
        if not is_known(search.result.branches, problem.split(point.x, point.value), point.value):
            way = np.append(point.tangent, point.by_value)
            yield start_along(problem, point.x, point.value, [way])


def _equations(search: Search, orbit: Orbit, value: float) -> Motions:
    """Those by which an orbit was found, with its period."""
    task = search.result.task
    H = orbit.H
    if is_shot := task.is_shot(orbit):
        H = task.accuracy.most * orbit.turns // task.turns
    series = task.problem(search.machines, value, H, turns=orbit.turns)
    return Shooting(series, orbit) if is_shot else series


def _beside(
    task: Task, problem: Motions, x: np.ndarray, value: float, across: np.ndarray
) -> Point | None:
    """A motion a little away, within the range, its tangent further away."""
    scale = problem.parameter.scale
    for away in _AWAY:
        far = value + away * scale * across[-1]
        try:
            point = arclength.correct(problem, x + away * across[:-1], far, across, scale, across)
        except Lost:
            continue
        if task.low <= point.value <= task.high:
            return point
    return None


def _null_vector(problem: Motions, x: np.ndarray, value: float, alternates: bool) -> np.ndarray:
    """The unit vector that the Jacobian takes to 0; alternates: of odd harmonics alone, as by
    itself it is of a state at the begin of a doubled period."""
    _, jacobian = problem.linearized(x, value)
    which = np.ones(len(x), bool)
    if alternates and isinstance(problem, Problem):
        k = (np.arange(2 * problem.H + 1) + 1) // 2
        which = np.concatenate([np.repeat(k % 2 == 1, n) for n in (problem.b, problem.s)])
    _, _, right = np.linalg.svd(jacobian[np.ix_(which, which)])
    vector = np.zeros(len(x))
    vector[which] = right[-1]
    return vector
