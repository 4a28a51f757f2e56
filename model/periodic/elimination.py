"""Linear systems in which many unknowns form groups that act on each other through a few others
alone, such as the tilts of the pads of a bearing through its journal: the groups are eliminated one
by one."""

import numpy as np
from scipy.sparse.csgraph import connected_components

from .newton import solve_linear

_LEFT = 1e-8  # of the right side: as much residual as a solution by elimination may leave


def groups_of(acts: np.ndarray) -> list[np.ndarray]:
    """Return the groups of s things that act on one another, acts: whether each acts on each, shape
    (s, s)."""
    count, labels = connected_components(acts, directed=False)
    return [np.flatnonzero(labels == group) for group in range(count)]


def solve_by_elimination(matrix: np.ndarray, right: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Return the solution of a linear system, as `newton.solve_linear` does; own: the unknowns to
    be eliminated, and their equations, of s things in columns, shape (n, s)."""
    first, last = own[0, 0], own[-1, -1] + 1  # they lie side by side
    acts = (matrix[first:last, first:last] != 0.0).reshape(*own.shape, *own.shape).any(axis=(0, 2))
    groups = [own[:, group].ravel() for group in groups_of(acts)]
    columns = right.reshape(len(right), -1)
    try:
        result = _solution(matrix, columns, np.r_[:first, last : len(matrix)], groups)
    except np.linalg.LinAlgError:  # a group may be so alone, while the whole is regular
        return solve_linear(matrix, right)
    with np.errstate(invalid="ignore", over="ignore"):
        left = np.linalg.norm(matrix @ result - columns, axis=0)
    if not (left <= _LEFT * np.linalg.norm(columns, axis=0)).all():
        return solve_linear(matrix, right)
    return result.reshape(right.shape)


def _solution(
    matrix: np.ndarray, right: np.ndarray, rest: np.ndarray, groups: list[np.ndarray]
) -> np.ndarray:
    """Return the solution, shape as `right`, for the unknowns `rest` first; raises `LinAlgError`
    for a singular group."""
    reduced, load, solved = matrix[np.ix_(rest, rest)], right[rest], []
    for own in groups:
        by_rest, by_own = matrix[np.ix_(own, rest)], matrix[np.ix_(rest, own)]
        of, on = np.flatnonzero(by_rest.any(axis=0)), np.flatnonzero(by_own.any(axis=1))
        both = np.hstack([by_rest[:, of], right[own]])
        both = np.linalg.solve(matrix[np.ix_(own, own)], both)
        by, at = both[:, : len(of)], both[:, len(of) :]
        reduced[np.ix_(on, of)] -= by_own[on] @ by
        load[on] -= by_own[on] @ at
        solved.append((own, of, by, at))
    result = np.empty(right.shape)
    result[rest] = among = solve_linear(reduced, load)
    for own, of, by, at in solved:
        result[own] = at - by @ among[of]
    return result
