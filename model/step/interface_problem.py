"""The small nonlinear problem that remains of a step: the forces of all interfaces at once.

    w = w_free + W F(d, d'),   d = d0 + b_d w,   d' = d0' + b_v w

w: relative accelerations of node and housing [m/s2], one complex number an interface; W:
flexibility of the step [1/kg]; d0, d0': predicted displacement and velocity; b_d = beta h^2,
b_v = gamma h; internal states of the laws: internal_state = free + b_own * rate.
Accelerations, not displacements, are the unknowns: with displacements very short steps lose digits.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.functions import modulus
from ..kernels.jit import jit
from ..parts.law import Kinematics
from .laws import law_gap, law_tangent

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
# Of an interface's length, on Newton's last correction of a displacement. The forces take part in
# it, so what they lack of their law is of second order in it.
TOLERANCE = 1e-8


class InterfaceProblem(NamedTuple):
    """Arrays of the problem for m interfaces: d0 [m], d0_dot [m/s], w_free, w [m/s2], force [N],
    its tangent dF = p dw + q conj(dw) [kg], each complex of shape (m,); free, internal_state:
    states of the laws, predicted and solved; flexibility W [1/kg], shape (2 m, 2 m), of (x, y)
    pairs; scratch."""

    d0: Annotated[np.ndarray, complex, "interfaces"]
    d0_dot: Annotated[np.ndarray, complex, "interfaces"]
    w_free: Annotated[np.ndarray, complex, "interfaces"]
    w: Annotated[np.ndarray, complex, "interfaces"]
    force: Annotated[np.ndarray, complex, "interfaces"]
    expected: Annotated[np.ndarray, complex, "interfaces"]
    p: Annotated[np.ndarray, complex, "interfaces"]
    q: Annotated[np.ndarray, complex, "interfaces"]
    free: Annotated[np.ndarray, float, "internal_states"]
    internal_state: Annotated[np.ndarray, float, "internal_states"]
    flexibility: Annotated[np.ndarray, float, "2 * interfaces", "2 * interfaces"]
    jacobian: Annotated[np.ndarray, float, "2 * interfaces", "2 * interfaces"]
    correction: Annotated[np.ndarray, float, "2 * interfaces"]


@jit
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


@jit
def _linearize(problem, laws, interfaces, spin, weights):
    """Return the forces and tangents at problem.w, Newton's correction of w; False if its matrix is
    singular."""
    m, b_d, b_v = len(interfaces), weights.displacement, weights.velocity
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
        if law_gap(laws, interfaces[j], d) < 0.0:
            is_open = False
    if is_open and len(problem.internal_state) == 0:
        return True
    jacobian[:, :] = 0.0
    for i in range(2 * m):
        jacobian[i, i] = 1.0
    for j in range(m):
        interface = interfaces[j]
        d = problem.d0[j] + b_d * problem.w[j]
        d_dot = problem.d0_dot[j] + b_v * problem.w[j]
        kinematics = Kinematics(d, d_dot, spin.omega, spin.sliding)
        free, internal_state = (
            problem.free[interface.internal_state :],
            problem.internal_state[interface.internal_state :],
        )
        force, p, q = law_tangent(laws, interface, kinematics, weights, free, internal_state)
        if force == 0.0 and p == 0.0 and q == 0.0:
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


@jit
def _start(problem, laws, interfaces, place, b_d):
    """Set Newton's starting point: the expected displacements, no forces, or the walls."""
    for j in range(len(interfaces)):
        w = problem.w_free[j]
        if place == EXPECTED:
            if problem.expected[j] != 0.0:
                w = (problem.expected[j] - problem.d0[j]) * (1.0 / b_d)
        elif place == WALL and interfaces[j].has_wall == 1:
            free = problem.d0[j] + b_d * w
            gap = law_gap(laws, interfaces[j], free)
            if gap < 0.0:
                wall = free * (1.0 + gap / modulus(free))
                w = (wall - problem.d0[j]) * (1.0 / b_d)
        problem.w[j] = w


@jit
def solve_interfaces(problem, laws, interfaces, spin, weights):
    """Solve for problem.w, problem.force and problem.own; returns (converged, iterations).

    interfaces: records, shape (m,); weights: b_d, b_v and b_own.
    Plain Newton from where it slid before cycles between open and closed in some coarse steps;
    `ATTEMPTS` lists what is then done. `iterations` counts those of all attempts.
    """
    iterations, b_d = 0, weights.displacement
    for place, relax, limit in ATTEMPTS:
        _start(problem, laws, interfaces, place, b_d)
        for _ in range(limit):
            iterations += 1
            if not _linearize(problem, laws, interfaces, spin, weights):
                break
            is_converged = True
            for j in range(len(interfaces)):
                change = complex(problem.correction[2 * j], problem.correction[2 * j + 1])
                problem.w[j] += relax * change
                problem.force[j] += relax * (
                    problem.p[j] * change + problem.q[j] * change.conjugate()
                )
                if not b_d * modulus(change) <= TOLERANCE * interfaces[j].length:
                    is_converged = False
            if is_converged:
                return True, iterations
    return False, iterations
