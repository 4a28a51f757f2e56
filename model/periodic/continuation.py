"""A branch continued from one of its motions to its ends, and why it ends there."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from .arclength import Lost
from .balance import Orbit, Problem
from .branch import Branch, Solution, Tracer
from .fourier import basis, resized
from .task import Response

LOST = "lost: "
_SAME = 0.02  # distance of two orbits that are one, as a share of their size

Tell = Callable[[str, Solution], None]


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
            ends[1] = LOST + _why_lost(tracer, branch)
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


def _why_lost(tracer: Tracer, branch: Branch) -> str:
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


def is_known(branches: Sequence[Branch], orbit: Orbit, value: float) -> bool:
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
