"""The small nonlinear problem that remains of a step: the forces of all interfaces at once.

    w = w_free + W F(d, d'),   d = d0 + b_d w,   d' = d0' + b_v w

w: relative accelerations of node and housing [m/s2], one complex number an interface; W:
flexibility of the step [1/kg]; d0, d0': predicted displacement and velocity; b_d = beta h^2, b_v =
gamma h; internal states of the laws: internal_state = free + b_rate * rate. The unknowns are
accelerations, because displacements lose digits in very short steps.
"""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.functions import modulus, scaled
from ..kernels.jit import jit, jit_inlined, jit_not_inlined
from ..parts.law import Kinematics
from .laws import law_gap, law_tangent

EXPECTED, OPEN, WALL = 0, 1, 2
# Where Newton starts, one attempt after another; the iterations of each, and how many of them apply
# the whole correction. The later ones apply less of it where it turns, so that they do not cycle
# between open and closed, or between sliding forward and backward.
STARTS = (EXPECTED, OPEN, WALL)
ITERATIONS, UNDAMPED = 600, 20
# Factors of the share that is applied where a correction points against the last one, and where it
# does not; factor of the largest share at each such turn, which ends cycles of a regained share.
DAMPING, RECOVERY, FALL = 0.5, 1.5, 0.9
# Share of an interface's length that bounds Newton's last correction of a displacement. The forces
# are corrected with it, so their error is of second order in it.
TOLERANCE = 1e-8
# Instead of a limit of the iterations, for a step towards rest, which a shorter one may replace:
# only iterations without damping, and no correction moves a film or a rolling bearing by more than
# its length.
TOWARDS_REST = -1


class InterfaceProblem(NamedTuple):
    """Arrays of the problem for m interfaces: d0 [m], d0_dot [m/s], w_free, w [m/s2], force [N],
    its tangent dF = p dw + q conj(dw) [kg], each complex of shape (m,); free, internal_state:
    states of the laws, predicted and solved; residual: largest difference between a force and its
    law where the iterations are limited [N], shape (1,); flexibility W [1/kg], shape (2 m, 2 m), of
    (x, y) pairs; jacobian, closed: the columns of Newton's matrix that differ from the identity,
    and their indices; correction, last_correction: scratch."""

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
    residual: Annotated[np.ndarray, float, "1"]
    flexibility: Annotated[np.ndarray, float, "2 * interfaces", "2 * interfaces"]
    jacobian: Annotated[np.ndarray, float, "2 * interfaces", "2 * interfaces"]
    correction: Annotated[np.ndarray, float, "2 * interfaces"]
    last_correction: Annotated[np.ndarray, float, "2 * interfaces"]
    closed: Annotated[np.ndarray, np.int64, "2 * interfaces"]


@jit
def solve_columns(a, places, x):
    """Overwrite x by A^-1 x, by elimination with partial pivoting; return False if A is singular.

    A, shape (m, m), is the identity but for its columns `places`, ascending, shape (c,), which are
    those of a, shape (m, c), overwritten. Pivots are chosen from the rows `places`.
    """
    m, columns = len(x), len(places)
    for k in range(columns):
        row = places[k]
        pivot = row
        for later in range(k + 1, columns):
            if abs(a[places[later], k]) > abs(a[pivot, k]):
                pivot = places[later]
        if not abs(a[pivot, k]) > 0.0:
            return False
        if pivot != row:
            for j in range(k, columns):
                a[row, j], a[pivot, j] = a[pivot, j], a[row, j]
            x[row], x[pivot] = x[pivot], x[row]
        inverse = 1.0 / a[row, k]
        for i in range(row + 1, m):
            ratio = a[i, k] * inverse
            for j in range(k + 1, columns):
                a[i, j] -= ratio * a[row, j]
            x[i] -= ratio * x[row]
        x[row] *= inverse
        for j in range(k + 1, columns):
            a[row, j] *= inverse
    right = columns  # the first of the columns to the right of the diagonal
    for i in range(m - 1, -1, -1):
        for j in range(right, columns):
            x[i] -= a[i, j] * x[places[j]]
        if right > 0 and places[right - 1] == i:
            right -= 1
    return True


@jit
def _linearize(problem, laws, interfaces, spin, weights):
    """Fill in the forces and tangents at problem.w and Newton's correction of w; return False if
    the matrix is singular. Only closed contacts, and laws with states, have columns of their
    own."""
    m, b_d, b_v = len(interfaces), weights.displacement, weights.velocity
    flexibility, jacobian, correction = problem.flexibility, problem.jacobian, problem.correction
    columns = 0
    for j in range(m):
        change = problem.w_free[j] - problem.w[j]
        correction[2 * j] = change.real
        correction[2 * j + 1] = change.imag
    for j in range(m):
        interface = interfaces[j]
        problem.force[j] = 0.0
        problem.p[j] = 0.0
        problem.q[j] = 0.0
        d = problem.d0[j] + scaled(b_d, problem.w[j])
        if interface.states == 0 and not law_gap(laws, interface, d) < 0.0:
            continue
        d_dot = problem.d0_dot[j] + scaled(b_v, problem.w[j])
        kinematics = Kinematics(d, d_dot, spin.omega, spin.sliding, spin.theta)
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
            jacobian[i, columns] = -(w_x * t_xx + w_y * t_yx)
            jacobian[i, columns + 1] = -(w_x * t_xy + w_y * t_yy)
        for axis in range(2):
            problem.closed[columns + axis] = 2 * j + axis
            jacobian[2 * j + axis, columns + axis] += 1.0
        columns += 2
    return solve_columns(jacobian, problem.closed[:columns], correction)


@jit
def _start(problem, laws, interfaces, place, b_d):
    """Set Newton's starting point: the expected displacements, no forces, or the walls."""
    for j in range(len(interfaces)):
        w = problem.w_free[j]
        if place == EXPECTED:
            if problem.expected[j] != 0.0:
                w = scaled(1.0 / b_d, problem.expected[j] - problem.d0[j])
        elif place == WALL and interfaces[j].has_wall == 1:
            free = problem.d0[j] + b_d * w
            gap = law_gap(laws, interfaces[j], free)
            if gap < 0.0:
                wall = free * (1.0 + gap / modulus(free))
                w = (wall - problem.d0[j]) * (1.0 / b_d)
        problem.w[j] = w
        problem.last_correction[2 * j] = 0.0
        problem.last_correction[2 * j + 1] = 0.0


@jit
def _relaxation(problem, share, largest):
    """Return the share of Newton's correction to apply, and the largest one, given the last two."""
    along = 0.0
    for i in range(len(problem.correction)):
        along += problem.correction[i] * problem.last_correction[i]
        problem.last_correction[i] = problem.correction[i]
    if along < 0.0:
        return DAMPING * share, FALL * largest
    return min(largest, RECOVERY * share), largest


@jit_inlined
def _correct(problem, interfaces, share, b_d, is_bounded):
    """Apply a share of Newton's correction, all of the last one, so that motion and forces are
    consistent; is_bounded: see `TOWARDS_REST`. Return whether it was the last."""
    is_converged = True
    longest = 1.0
    for j in range(len(interfaces)):
        change = complex(problem.correction[2 * j], problem.correction[2 * j + 1])
        moved = b_d * modulus(change)
        if not moved <= TOLERANCE * interfaces[j].length:
            is_converged = False
        if is_bounded and interfaces[j].has_wall == 0:
            longest = max(longest, moved / interfaces[j].length)
    share = 1.0 if is_converged else share / longest
    for j in range(len(interfaces)):
        change = complex(problem.correction[2 * j], problem.correction[2 * j + 1])
        problem.w[j] += scaled(share, change)
        by_motion = problem.p[j] * change + problem.q[j] * change.conjugate()
        problem.force[j] += scaled(share, by_motion)
    return is_converged


@jit
def _residual(problem, laws, interfaces, spin, weights):
    """Return the largest difference between an interface's force and its law [N]."""
    largest = 0.0
    for j in range(len(interfaces)):
        interface, at = interfaces[j], interfaces[j].internal_state
        d = problem.d0[j] + weights.displacement * problem.w[j]
        d_dot = problem.d0_dot[j] + weights.velocity * problem.w[j]
        force = problem.force[j]
        if interface.states > 0 or law_gap(laws, interface, d) < 0.0:
            moving = Kinematics(d, d_dot, spin.omega, spin.sliding, spin.theta)
            free, internal_state = problem.free[at:], problem.internal_state[at:]
            force -= law_tangent(laws, interface, moving, weights, free, internal_state)[0]
        largest = max(largest, modulus(force))
    return largest


@jit_not_inlined
def _solve_within(problem, laws, interfaces, spin, weights, limit):
    """Do at most `limit` Newton iterations from the expected displacements, and continue with the
    forces reached; fill problem.residual and return the number of iterations."""
    b_d = weights.displacement
    _start(problem, laws, interfaces, EXPECTED, b_d)
    iterations = 0
    is_converged = False
    while iterations < limit and not is_converged:
        iterations += 1
        if not _linearize(problem, laws, interfaces, spin, weights):
            _follow_forces(problem)
            break
        is_converged = _correct(problem, interfaces, 1.0, b_d, False)
    problem.residual[0] = _residual(problem, laws, interfaces, spin, weights)
    return iterations


@jit
def _follow_forces(problem):
    """Set problem.w to the accelerations that the forces cause."""
    for i in range(len(problem.w)):
        w = problem.w_free[i]
        for j in range(len(problem.w)):
            force = problem.force[j]
            x = problem.flexibility[2 * i, 2 * j : 2 * j + 2]
            y = problem.flexibility[2 * i + 1, 2 * j : 2 * j + 2]
            w += complex(
                x[0] * force.real + x[1] * force.imag, y[0] * force.real + y[1] * force.imag
            )
        problem.w[i] = w


@jit
def solve_interfaces(problem, laws, interfaces, spin, weights, limit=0):
    """Solve for problem.w, problem.force and problem.internal_state; return (converged,
    iterations).

    interfaces: records, shape (m,); weights: b_d, b_v and b_rate; limit: of the iterations, whose
    result is then accepted; 0 for none, or `TOWARDS_REST`. `iterations` counts those of all
    attempts.
    """
    if limit > 0:
        return True, _solve_within(problem, laws, interfaces, spin, weights, limit)
    iterations, b_d, is_bounded = 0, weights.displacement, limit == TOWARDS_REST
    for place in STARTS:
        _start(problem, laws, interfaces, place, b_d)
        share, largest = 1.0, 1.0
        for iteration in range(UNDAMPED if is_bounded else ITERATIONS):
            iterations += 1
            if not _linearize(problem, laws, interfaces, spin, weights):
                break
            if iteration >= UNDAMPED - 1:
                share, largest = _relaxation(problem, share, largest)
            if _correct(problem, interfaces, share, b_d, is_bounded):
                return True, iterations
    return False, iterations
