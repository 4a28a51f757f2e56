"""Closures of a step by round stops: journals that must stay inside, or on, a circle.

With F_j = -(nu_j / b) p_j the relative displacements at the end of a step are linear for given nu,

    p = (1 + W diag(nu))^-1 p_free,      |p_j| <= clearance_j,   nu_j >= 0,

the conditions of a projection onto discs, which has one solution. As with a trust region (More and
Sorensen 1983), 1 / |p_j| is nearly linear in nu, and Newton's method takes a few iterations.
"""

import numpy as np

from .contacts import RoundStops
from .stepper import FreeStep

_ITERATIONS = 50
_CHANGES = 20
_TOLERANCE = 1e-13  # of 1 / radius, relative


def push_inside(
    free: FreeStep, contacts: RoundStops, closed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """See `hard_stop.unilateral`, `ArithmeticError` included."""
    reached = free.p + free.b * free.w
    active = closed | (contacts.openings(reached) < 0)
    radius = contacts.clearance
    for _ in range(_CHANGES):
        p, nu = _on_circles(free.W, reached, active, radius)
        retained = active & (nu > 0)
        wanted = retained | (~active & (contacts.openings(p) < 0))
        if (wanted == active).all():
            return _forces(free, contacts, p, nu)
        active = wanted
    raise ArithmeticError("which journals touch was not found")


def hold_on_circle(
    free: FreeStep, contacts: RoundStops, closed: np.ndarray, rest: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """See `hard_stop.held`."""
    reached = free.p + free.b * free.w
    return _forces(free, contacts, *_on_circles(free.W, reached, closed, contacts.clearance - rest))


def _forces(free, contacts, p, nu) -> tuple[np.ndarray, np.ndarray]:
    return contacts.gradient(p), nu / free.b * np.hypot(p[::2], p[1::2])


def _on_circles(
    W: np.ndarray, reached: np.ndarray, active: np.ndarray, radius: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """p and nu with |p_j| = radius_j for the active journals, nu_j = 0 for the others."""
    m = len(active)
    nu = np.zeros(m)
    index = np.flatnonzero(active)
    p = reached
    for _ in range(_ITERATIONS):
        A = np.eye(2 * m) + W * np.repeat(nu, 2)
        p = np.linalg.solve(A, reached)
        r = np.hypot(p[::2], p[1::2])
        gap = 1 / r[index] - 1 / radius[index]
        if (np.abs(gap) * radius[index] <= _TOLERANCE).all():
            return p, nu
        jacobian = np.empty((len(index), len(index)))
        for column, k in enumerate(index):
            turned = np.zeros(2 * m)
            turned[2 * k : 2 * k + 2] = p[2 * k : 2 * k + 2]
            dp = -np.linalg.solve(A, W @ turned)
            outwards = (p[::2] * dp[::2] + p[1::2] * dp[1::2]) / r
            jacobian[:, column] = -(outwards / r**2)[index]
        nu[index] -= np.linalg.solve(jacobian, gap)
    raise ArithmeticError("a journal does not come to rest on its circle")
