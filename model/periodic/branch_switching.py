"""Branch switching: the branches that begin at period doublings and branch points.

There the equations have a null vector v besides the tangent of the branch that is left. The
perturbed motion x_0 + eps v is corrected at right angles to v. For a period doubling v contains
only the harmonics that change sign from one period to the next; v and -v lead to the same motion,
one period apart.
"""

import numpy as np

from ..message_templates import Message
from . import arclength
from .arclength import CurvePoint
from .balance import HarmonicBalance, Orbit
from .branch import BRANCHING, DOUBLING, Bifurcation, Branch
from .checkpoint import Starts
from .continuation import BranchSearch, follow_all, is_known, is_one_of, start_along
from .fourier import repeated
from .method_switch import PeriodicEquations
from .newton import NotConverged
from .problem import Response, Task
from .queries import motions_of

# Distances of the first motion from the bifurcation, in lengths of the interfaces.
_PERTURBATIONS = (0.05, 0.02, 0.1, 0.2, 0.005, 1e-3, 2e-4)
_MOST_BRANCHES = 24


def follow_switched(search: BranchSearch) -> None:
    """Follow the branches from all bifurcations, also from those on the new branches."""
    branches = search.result.branches
    for branch in branches:  # which grows
        for bifurcation in branch.bifurcations:
            if bifurcation.kind not in (DOUBLING, BRANCHING):
                continue
            if len(branches) >= _MOST_BRANCHES:
                text = f"there are more than {_MOST_BRANCHES} branches: not all were followed"
                search.result.notes.append(Message(text, "few-branches"))
                return
            follow_all(search, _starts(search, branch, bifurcation))


def _starts(search: BranchSearch, branch: Branch, bifurcation: Bifurcation) -> Starts:
    """Yield the starts of branches at a bifurcation that lie on no known branch."""
    task, orbit, value = search.result.task, bifurcation.orbit, bifurcation.value
    is_doubling = bifurcation.kind == DOUBLING
    if is_doubling:
        both = repeated(orbit.b, 2), repeated(orbit.states, 2)
        orbit = Orbit(*both, 0.5 * orbit.omega, 2 * orbit.turns, orbit.speed, orbit.parameter)
    problem = search.equations_of(orbit)
    x = problem.join(orbit)
    if is_doubling:
        across = np.append(_alternating_null_vector(problem, x, value), 0.0)
    else:
        a, b = branch.points[bifurcation.behind : bifurcation.behind + 2]
        change = (b.value - a.value) / problem.scale
        along = np.append(problem.join(b.orbit) - problem.join(a.orbit), change)
        across = _other_direction(problem, x, value, along)
    for sign in (1.0,) if is_doubling else (1.0, -1.0):
        point = _perturbed(task, problem, x, value, sign * across)
        if point is None:
            continue
        if not _is_on_a_branch(search.result, problem.split(point.x, point.value), point.value):
            yield start_along(problem, point.x, point.value, [point.direction])
    return []


def _perturbed(
    task: Task, problem: PeriodicEquations, x: np.ndarray, value: float, across: np.ndarray
) -> CurvePoint | None:
    """Return a motion of the new branch near the bifurcation and within the range, its tangent
    leading away, or None."""
    for size in _PERTURBATIONS:
        far = value + size * problem.scale * across[-1]
        try:
            point = arclength.correct(problem, x + size * across[:-1], far, across)
        except NotConverged:
            continue
        if task.low <= point.value <= task.high:
            return point
    return None


def _is_on_a_branch(result: Response, orbit: Orbit, value: float) -> bool:
    """Return whether a motion is one of the branches, whose own motions are solved for where it is
    near: one that begins at a bifurcation is near to the branch that is left for long."""
    for branch in result.branches:
        if is_known([branch], orbit, value):
            own = motions_of(result, branch, value)
            if not own or is_one_of(own, orbit):
                return True
    return False


def _alternating_null_vector(problem: PeriodicEquations, x: np.ndarray, value: float) -> np.ndarray:
    """Return the unit null vector of the Jacobian in odd harmonics alone, which the state at the
    beginning of a doubled period fulfils by itself."""
    _, jacobian = problem.linearized(x, value)
    which = np.ones(len(x), bool)
    if isinstance(problem, HarmonicBalance):
        k = (np.arange(2 * problem.H + 1) + 1) // 2
        which = np.concatenate([np.repeat(k % 2 == 1, n) for n in (problem.b, problem.s)])
    _, _, right = np.linalg.svd(jacobian[np.ix_(which, which)])
    vector = np.zeros(len(x))
    vector[which] = right[-1]
    return vector


def _other_direction(
    problem: PeriodicEquations, x: np.ndarray, value: float, along: np.ndarray
) -> np.ndarray:
    """Return the unit direction at right angles to `along` in the plane of both branches that pass
    a branch point: there Jacobian and derivative by the parameter have two null vectors."""
    _, jacobian, by_lambda = problem.linearized_with_parameter(x, value)
    _, _, right = np.linalg.svd(np.column_stack([jacobian, by_lambda]))
    first, second = right[-2:]
    across = (second @ along) * first - (first @ along) * second
    return np.asarray(across / np.linalg.norm(across))
