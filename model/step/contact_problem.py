"""The small nonlinear problem that is left of a step: the contact forces of all bearings at once.

    w = w_free + W F(d, d'),   d = d0 + b_d w,   d' = d0' + b_v w

w: relative accelerations of journal and housing [m/s2], one complex number a bearing; W:
flexibility of the step [1/kg]; d0, d0': predicted displacement and velocity; b_d = beta h^2,
b_v = gamma h.
Accelerations, not displacements, are the unknowns: with displacements very short steps lose digits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..kernels.compiled import compiled
from ..parts.clearance_contact import contact_tangent

EXPECTED, OPEN, WALL = 0, 1, 2
# Attempts, one after another: where Newton starts, its relaxation, its iterations. The first does
# in all but one of some hundred steps; the damped ones do not cycle between open and closed.
ATTEMPTS = (
    (EXPECTED, 1.0, 20),
    (OPEN, 1.0, 20),
    (WALL, 1.0, 20),
    (OPEN, 0.5, 600),
    (WALL, 0.3, 800),
    (EXPECTED, 0.1, 1500),
)
# Of the clearance, on Newton's last correction of a displacement. The forces take part in it, so
# what they lack of the contact law is of second order in it.
TOLERANCE = 1e-8


class ContactProblem(NamedTuple):
    """Arrays of the problem for m bearings: d0 [m], d0_dot [m/s], w_free, w [m/s2], force [N], and
    its tangent dF = p dw + q conj(dw) [kg], each complex of shape (m,); flexibility W [1/kg], shape
    (2 m, 2 m), of (x, y) pairs; scratch."""

    d0: np.ndarray
    d0_dot: np.ndarray
    w_free: np.ndarray
    w: np.ndarray
    force: np.ndarray
    expected: np.ndarray
    p: np.ndarray
    q: np.ndarray
    flexibility: np.ndarray
    jacobian: np.ndarray
    correction: np.ndarray


def new_contact_problem(m: int) -> ContactProblem:
    """A problem of m bearings, filled with zeros."""
    vectors = [np.zeros(m, dtype=complex) for _ in range(8)]
    matrices = [np.zeros((2 * m, 2 * m)) for _ in range(2)]
    return ContactProblem(*vectors, *matrices, np.zeros(2 * m))


@compiled
def solve_dense(a, x):
    """Overwrite x by a^-1 x, a of shape (m, m), by elimination with partial pivoting; False if
    a is singular."""
    m = len(x)
    for k in range(m):
        pivot = k
        for i in range(k + 1, m):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        if not abs(a[pivot, k]) > 0.0:
            return False
        if pivot != k:
            for j in range(k, m):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
            x[k], x[pivot] = x[pivot], x[k]
        inverse = 1.0 / a[k, k]
        for i in range(k + 1, m):
            ratio = a[i, k] * inverse
            for j in range(k + 1, m):
                a[i, j] -= ratio * a[k, j]
            x[i] -= ratio * x[k]
        x[k] *= inverse
        for j in range(k + 1, m):
            a[k, j] *= inverse
    for i in range(m - 1, -1, -1):
        for j in range(i + 1, m):
            x[i] -= a[i, j] * x[j]
    return True


@compiled
def _linearize(problem, bearings, omega, b_d, b_v):
    """Forces and tangents at problem.w, Newton's correction of w; False if its matrix is
    singular."""
    m = len(bearings)
    flexibility, jacobian, correction = problem.flexibility, problem.jacobian, problem.correction
    is_open = True
    for j in range(m):
        change = problem.w_free[j] - problem.w[j]
        correction[2 * j] = change.real
        correction[2 * j + 1] = change.imag
        d = problem.d0[j] + b_d * problem.w[j]
        problem.force[j] = 0.0
        problem.p[j] = 0.0
        problem.q[j] = 0.0
        if d.real * d.real + d.imag * d.imag > bearings[j].clearance ** 2:
            is_open = False
    if is_open:
        return True
    jacobian[:, :] = 0.0
    for i in range(2 * m):
        jacobian[i, i] = 1.0
    for j in range(m):
        bearing = bearings[j]
        d = problem.d0[j] + b_d * problem.w[j]
        d_dot = problem.d0_dot[j] + b_v * problem.w[j]
        force, p, q = contact_tangent(bearing, d, d_dot, omega, b_d, b_v)
        if force == 0.0:
            continue
        problem.force[j] = force
        problem.p[j] = p
        problem.q[j] = q
        t_xx, t_yx = (p + q).real, (p + q).imag
        t_xy, t_yy = (q - p).imag, (p - q).real
        for i in range(2 * m):
            w_x = flexibility[i, 2 * j]
            w_y = flexibility[i, 2 * j + 1]
            correction[i] += w_x * force.real + w_y * force.imag
            jacobian[i, 2 * j] -= w_x * t_xx + w_y * t_yx
            jacobian[i, 2 * j + 1] -= w_x * t_xy + w_y * t_yy
    return solve_dense(jacobian, correction)


@compiled
def _start(problem, bearings, place, b_d):
    """Where Newton starts: from the expected displacements, from open contacts, from the wall."""
    for j in range(len(bearings)):
        w = problem.w_free[j]
        if place == EXPECTED:
            if problem.expected[j] != 0.0:
                w = (problem.expected[j] - problem.d0[j]) / b_d
        elif place == WALL:
            free = problem.d0[j] + b_d * w
            if abs(free) > bearings[j].clearance:
                w = (free * (bearings[j].clearance / abs(free)) - problem.d0[j]) / b_d
        problem.w[j] = w


@compiled
def solve_contacts(problem, bearings, omega, b_d, b_v):
    """Solve for problem.w and problem.force; returns (converged, iterations).

    bearings: records, shape (m,); omega [rad/s]; last_force: of the last step, shape (m,) [N].
    Plain Newton from the last forces cycles between open and closed in some coarse steps;
    `ATTEMPTS` lists what is then done. `iterations` counts those of all attempts.
    """
    iterations = 0
    for place, relax, limit in ATTEMPTS:
        _start(problem, bearings, place, b_d)
        for _ in range(limit):
            iterations += 1
            if not _linearize(problem, bearings, omega, b_d, b_v):
                break
            is_converged = True
            for j in range(len(bearings)):
                change = complex(problem.correction[2 * j], problem.correction[2 * j + 1])
                problem.w[j] += relax * change
                problem.force[j] += relax * (
                    problem.p[j] * change + problem.q[j] * change.conjugate()
                )
                if not b_d * abs(change) <= TOLERANCE * bearings[j].clearance:
                    is_converged = False
            if is_converged:
                return True, iterations
    return False, iterations
