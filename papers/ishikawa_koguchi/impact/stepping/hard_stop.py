"""Closures of a step by hard stops: which contacts are closed, and with what force.

Every one of them is the linear complementarity problem  z >= 0, A z + b >= 0, z (A z + b) = 0  with
a symmetric positive definite A: for the forces of a step, for the impulses of an impact and for the
accelerations after it.
"""

import numpy as np
from rotor_fmu.model.kernels.jit import jit
from rotor_fmu.model.step.interface_problem import solve_columns

from .contacts import Contacts, RoundStops
from .round_stop import hold_on_circle, push_inside
from .stepper import FreeStep

_ROUNDING = 1e-12
_PATIENCE = 10
_MOST_PIVOTS = 10000


def complementarity(A: np.ndarray, b: np.ndarray, is_active: np.ndarray) -> tuple[np.ndarray, bool]:
    """Solve z >= 0, w = A z + b >= 0, z w = 0; A: symmetric positive definite, shape (m, m).

    is_active: where to start, shape (m,); overwritten by the solution's active set. Returns z and
    whether it was found. Active set by block principal pivoting, by Murty's single pivots where
    that cycles (Judice and Pires 1994).
    """
    m = len(b)
    z, w, x = np.zeros((3, m))
    index, order = np.zeros(m, dtype=np.int64), np.arange(m)
    is_found = _pivot(A, b, is_active, z, w, x, np.zeros((m, m)), index, order)
    return np.maximum(z, 0.0), is_found


@jit
def _solve_active(A, b, is_active, z, w, x, part, index, order):
    """z of the active set, w = A z + b of the others; False if the set's matrix is singular."""
    m = len(b)
    count = 0
    for i in range(m):
        z[i] = 0.0
        if is_active[i]:
            index[count] = i
            count += 1
    for i in range(count):
        x[i] = -b[index[i]]
        for j in range(count):
            part[i, j] = A[index[i], index[j]]
    if not solve_columns(part[:count, :count], order[:count], x[:count]):
        return False
    for i in range(count):
        z[index[i]] = x[i]
    for i in range(m):
        w[i] = b[i]
        for j in range(count):
            w[i] += A[i, index[j]] * x[j]
    for i in range(count):
        w[index[i]] = 0.0
    return True


@jit
def _is_wrong(A, is_active, z, w, i, scale):
    if is_active[i]:
        return z[i] * A[i, i] < -_ROUNDING * scale
    return w[i] < -_ROUNDING * scale


@jit
def _pivot(A, b, is_active, z, w, x, part, index, order):
    """`complementarity` with its scratch; False if no solution was found."""
    m = len(b)
    scale = 0.0
    for i in range(m):
        scale = max(scale, abs(b[i]))
    least, patience = m + 1, _PATIENCE
    for _ in range(_MOST_PIVOTS):
        if not _solve_active(A, b, is_active, z, w, x, part, index, order):
            return False
        wrong, last = 0, -1
        for i in range(m):
            if _is_wrong(A, is_active, z, w, i, scale):
                wrong += 1
                last = i
        if wrong == 0:
            return True
        if wrong < least:
            least, patience = wrong, _PATIENCE
        else:
            patience -= 1
        for i in range(0 if patience > 0 else last, m):
            if _is_wrong(A, is_active, z, w, i, scale):
                is_active[i] = not is_active[i]
    return False


def unilateral(
    free: FreeStep, contacts: Contacts, closed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Gradient N and contact forces [N] with which no opening is negative at the end of the step.

    closed: where the search for the closed contacts begins, shape (m,).
    Raises `ArithmeticError` if no such forces are found.
    """
    N = contacts.gradient(free.p)
    if isinstance(contacts, RoundStops):
        return push_inside(free, contacts, closed)
    A = N.T @ free.W @ N + np.diag(contacts.compliance / free.b)
    b = contacts.openings(free.p) / free.b + N.T @ free.w
    force, is_found = complementarity(A, b, closed.copy())
    if not is_found:
        raise ArithmeticError("the contact problem has no solution")
    return N, force


def held(
    free: FreeStep,
    contacts: Contacts,
    closed: np.ndarray,
    rest: np.ndarray,
    by_acceleration: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Gradient N and contact forces [N], of either sign, that hold the closed contacts at the
    openings `rest`, shape (m,) [m].

    by_acceleration: hold the openings' accelerations at zero instead, for steps so short that the
    rounding errors of the openings would be amplified.
    """
    N = contacts.gradient(free.p)
    force = np.zeros(len(closed))
    if not closed.any():
        return N, force
    if by_acceleration:
        b = N.T @ free.w + contacts.bend(free.p, free.p_dot)
    elif isinstance(contacts, RoundStops):
        return hold_on_circle(free, contacts, closed, rest)
    else:
        b = (contacts.openings(free.p) - rest) / free.b + N.T @ free.w
    part = N[:, closed].T @ free.W @ N[:, closed]
    force[closed] = np.linalg.solve(part, -b[closed])
    return N, force
