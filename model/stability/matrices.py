"""The machine as x' = A x, its contacts open, as they carry it at rest, or closed and slipping."""

import math

from ..kernels.band import add_product, solve
from ..kernels.functions import direction, scaled
from ..kernels.jit import jit, jit_not_inlined
from ..parts.housing import masses
from ..parts.law import Kinematics, StateSlopes
from ..step.laws import law_gap, law_linearize, law_vibrate, relative, side_of

# Which interfaces with a wall are closed: none, all, those that carry the machine at rest, or the
# one of this number.
OPEN, ALL, REST = -1, -2, -3
# Where one is called closed and slipping: penetration over the radius of its wall, and a spin
# [rad/s] that leaves nothing of the smoothing of friction.
_DEPTH, _SLIPPING = 0.1, 1e9
_DIRECTIONS = 64  # in which a wall is looked at


@jit
def is_wall(interface):
    """Return whether the interface is a wall that may slip; a race that turns is carried along
    instead."""
    return interface.slips == 1


@jit
def is_closed(interfaces, j, case):
    """Return whether interface j is closed in this case."""
    return is_wall(interfaces[j]) and case in (ALL, j)


@jit_not_inlined
def fill_tangents(structure, survey, motion, trial, omega):
    """Fill in the laws' tangents at this speed of rotation [rad/s]: in equilibrium, but for walls
    at a small penetration, their surfaces slipping in the sense of the rotation.

    A journal that whirls along a wall does not move against the wall's damping. trial: the laws'
    internal states, overwritten by those in equilibrium.
    """
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.has_wall == 0:
            d = relative(interface, motion.q)
            _fill_tangent(structure, survey, motion, trial, j, d, omega, omega)
        else:
            _fill_wall_tangent(structure, survey, motion, trial, j, omega)


@jit_not_inlined
def _fill_wall_tangent(structure, survey, motion, trial, j, omega):
    """Fill in the tangent of wall j at a small penetration: how far a journal is pushed along its
    displacement, the mean of all directions, which differ where the wall is worn."""
    interface = structure.interfaces[j]
    sliding = -_SLIPPING if omega < 0.0 else _SLIPPING
    pushed = 0.0j
    for k in range(_DIRECTIONS):
        e = direction(2.0 * math.pi * k / _DIRECTIONS)
        d = scaled(interface.length, e)
        gap = law_gap(structure.laws, interface, d)
        d += scaled(gap + _DEPTH * interface.length, e)
        _fill_tangent(structure, survey, motion, trial, j, d, omega, sliding)
        pushed += survey.p_d[j] + survey.q_d[j] * (e * e).conjugate()
    survey.p_d[j] = scaled(1.0 / _DIRECTIONS, pushed)
    survey.q_d[j] = survey.p_v[j] = survey.q_v[j] = 0.0


@jit_not_inlined
def _fill_tangent(structure, survey, motion, trial, j, d, omega, sliding):
    """Fill in the tangent of interface j at a displacement [m] and a spin past it [rad/s], where
    its law's states are in equilibrium."""
    interface = structure.interfaces[j]
    kinematics = Kinematics(d, 0.0j, omega, sliding, 0.0)
    states = trial[interface.internal_state :]
    _force, p_d, q_d, p_v, q_v = law_vibrate(
        structure.laws,
        interface,
        kinematics,
        abs(omega),
        motion.internal_state[interface.internal_state :],
        states,
    )
    if interface.vibrating > 0:
        at = interface.first_vibrating
        slopes = StateSlopes(
            *(survey.rates[at:], survey.force_by_states[at:]),
            *(survey.rates_by_d[at:], survey.rates_by_v[at:], survey.rates_by_states[at:, at:]),
        )
        solved = survey.solved[interface.internal_state :]
        _force, p_d, q_d, p_v, q_v = law_linearize(
            structure.laws, interface, kinematics, states, solved, slopes
        )
    survey.p_d[j], survey.q_d[j] = p_d, q_d
    survey.p_v[j], survey.q_v[j] = p_v, q_v


@jit
def find_seats(structure, motion, seats):
    """Fill `seats` with where the walls that carry the machine hold it, in equilibrium."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        carries = interface.has_wall == 1 and motion.force[j] != 0.0
        seats[j] = relative(interface, motion.q) if carries else 0.0j


@jit
def is_seat(seats, j):
    """Return whether interface j is a wall that carries the machine at rest."""
    return seats[j] != 0.0


@jit_not_inlined
def fill_rest_tangents(structure, survey, motion, trial, seats, omega):
    """Fill in the tangents of the walls that carry the machine, where they do at rest, the shaft
    turning at this speed [rad/s]."""
    for j in range(len(structure.interfaces)):
        if is_seat(seats, j):
            _fill_tangent(structure, survey, motion, trial, j, seats[j], omega, omega)


@jit_not_inlined
def _fill_matrix(band, survey, basis, mass, out):
    """Fill out with M^-1 times a band matrix, in the coarse dofs."""
    coarse = len(mass)
    is_whole = basis.shape[1] == 0
    out[:, :] = 0.0
    for k in range(coarse):
        for i in range(len(survey.along)):
            survey.product[i] = 0.0
            if is_whole:
                survey.along[i] = 1.0 if i == k else 0.0
            else:
                survey.along[i] = basis[i, k]
        add_product(band, survey.along, survey.product)
        _to_coarse(survey, basis, mass)
        for i in range(coarse):
            out[i, k] = survey.column[i]


@jit
def _to_coarse(survey, basis, mass):
    """Set column to M^-1 basis^T product."""
    for i in range(len(mass)):
        if basis.shape[1] == 0:
            survey.column[i] = survey.product[i].real
        else:
            survey.column[i] = 0.0
            for k in range(len(survey.product)):
                survey.column[i] += basis[k, i] * survey.product[k].real
    solve(mass, survey.column[: len(mass)])


@jit
def fill_basis_matrices(structure, survey, case):
    """Fill in the matrices that do not depend on the speed, in the basis of this case, unless it is
    the same as in the last one."""
    place = -1
    if case >= OPEN and len(survey.single_contact_basis) > 0:
        place = survey.first_wall[0] if case == OPEN else case
    if place == survey.in_use[1]:
        return
    survey.in_use[1] = place
    if place == -1:
        _fill_matrices(structure, survey, survey.basis, survey.mass)
    else:
        _fill_matrices(
            structure, survey, survey.single_contact_basis[place], survey.single_contact_mass[place]
        )


@jit_not_inlined
def _fill_matrices(structure, survey, basis, mass):
    """Fill in the matrices that do not depend on the speed."""
    _fill_matrix(structure.K, survey, basis, mass, survey.K)
    _fill_matrix(structure.C, survey, basis, mass, survey.C)
    _fill_matrix(structure.G, survey, basis, mass, survey.G)
    _fill_matrix(structure.K_shaft, survey, basis, mass, survey.K_shaft)
    n, coarse = len(structure.static_load), len(mass)
    survey.in_use[0] = coarse
    for j in range(len(structure.interfaces)):
        dof = structure.interfaces[j].dof
        for i in range(n):
            survey.product[i] = 1.0 if i == dof else 0.0
        _to_coarse(survey, basis, mass)
        for i in range(coarse):
            whole = 1.0 if i == dof else 0.0
            if basis.shape[1] > 0:
                whole = basis[dof, i] if dof < n else 0.0
            survey.pick[j, i] = whole
            survey.push[j, i] = survey.column[i]
        for h in range(len(structure.housings)):
            survey.pick[j, coarse + h] = side_of(structure.interfaces[j], n + h)
            survey.push[j, coarse + h] = side_of(structure.interfaces[j], n + h)


@jit
def fill_system_matrix(structure, survey, seats, speed, case):
    """Fill in A at one speed [rad/s] in one case, for x = (q, v / scale, s), q the x of all dofs
    and housings, then their y, s the states of laws that follow a vibration; scale: the machine's
    lowest frequency [rad/s]."""
    numbers = structure.numbers[0]
    scale = numbers.lowest_omega
    sign = 1.0 if speed > 0.0 else -1.0 if speed < 0.0 else 0.0
    kappa = numbers.kappa_v * speed + numbers.kappa_h * sign
    coarse = survey.in_use[0]
    half = coarse + len(structure.housings)
    size = 2 * half
    states = 2 * size + len(survey.rates)
    A = survey.A
    A[:states, :states] = 0.0
    for i in range(size):
        A[i, size + i] = 1.0
    for i in range(half):
        for k in range(half):
            for plane in (0, half):
                A[size + plane + i, plane + k] = -survey.K[i, k]
                A[size + plane + i, size + plane + k] = -survey.C[i, k]
            # -i z is (y, -x)
            A[size + i, half + k] = -kappa * survey.K_shaft[i, k]
            A[size + half + i, k] = kappa * survey.K_shaft[i, k]
            A[size + i, size + half + k] = -speed * survey.G[i, k]
            A[size + half + i, size + k] = speed * survey.G[i, k]
    for h in range(len(structure.housings)):
        housing, x, y = structure.housings[h], coarse + h, half + coarse + h
        A[size + x, x] -= housing.kx
        A[size + y, y] -= housing.ky
        A[size + x, size + x] -= housing.cx
        A[size + y, size + y] -= housing.cy
    for j in range(len(structure.interfaces)):
        acts = structure.interfaces[j].has_wall == 0 or (case == REST and is_seat(seats, j))
        if acts or is_closed(structure.interfaces, j, case):
            _add_force(survey, half, j, 0, survey.p_d[j], survey.q_d[j])
            _add_force(survey, half, j, size, survey.p_v[j], survey.q_v[j])
        _add_states(survey, half, j, structure.interfaces[j], scale)
    for h in range(len(structure.housings)):
        m_x, m_y = masses(structure.housings[h])
        for k in range(states):
            A[size + coarse + h, k] /= m_x
            A[size + half + coarse + h, k] /= m_y
    for i in range(size, 2 * size):
        for k in range(size):
            A[i, k] /= scale * scale
            A[i, size + k] /= scale
        for k in range(2 * size, states):
            A[i, k] /= scale * scale
    for i in range(2 * size, states):
        for k in range(size):
            A[i, k] /= scale
        for k in range(2 * size, states):
            A[i, k] /= scale


@jit
def _add_force(survey, half, j, first, p, q):
    """Add the tangent p z + q conj(z) of interface j as a matrix of (x, y), from column `first`
    on."""
    size = 2 * half
    xx, xy = (p + q).real, (q - p).imag
    yx, yy = (p + q).imag, (p - q).real
    for i in range(half):
        push = survey.push[j, i]
        for k in range(half):
            at = push * survey.pick[j, k]
            survey.A[size + i, first + k] += xx * at
            survey.A[size + i, first + half + k] += xy * at
            survey.A[size + half + i, first + k] += yx * at
            survey.A[size + half + i, first + half + k] += yy * at


@jit
def _add_states(survey, half, j, interface, scale):
    """Add the force of interface j by its states that follow a vibration, and their rates; one
    that stays where it is, which is no free motion, gets the rate -scale."""
    size = 2 * half
    for own in range(interface.first_vibrating, interface.first_vibrating + interface.vibrating):
        row = 2 * size + own
        stays = True
        for plane in range(2):
            e = 1j if plane else 1.0 + 0.0j
            force = (e.conjugate() * survey.force_by_states[own]).real
            by_d = (e.conjugate() * survey.rates_by_d[own]).real
            by_v = (e.conjugate() * survey.rates_by_v[own]).real
            stays = stays and by_d == 0.0 and by_v == 0.0
            for i in range(half):
                at = plane * half + i
                survey.A[size + at, row] = force * survey.push[j, i]
                survey.A[row, at] = by_d * survey.pick[j, i]
                survey.A[row, size + at] = by_v * survey.pick[j, i]
        for k in range(interface.vibrating):
            by_state = survey.rates_by_states[own, interface.first_vibrating + k]
            stays = stays and by_state == 0.0
            survey.A[row, 2 * size + interface.first_vibrating + k] = by_state
        if stays:
            survey.A[row, row] = -scale
