"""The tangent of a step: how the motion at its end changes with what is given at its beginning.

A row of a `Tangent` is the derivative of a motion by one input, complex as the motion is and linear
in it over the reals. What the step does to a motion, prediction, factorized matrix, interfaces,
correction, it does to a row as well, with the interfaces' problem replaced by its derivative

    dw = dw_free + W dF,    dF = dF/dd dd + dF/dd' dd' + dF/dOmega dOmega + dF/down down

The laws give dF/dd and dF/dd' in closed form (`parts.law`); by speed and internal states a law, a
function of a few numbers, is differenced. Step lengths and fitting count as given.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import add_product, solve
from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..parts.housing import masses
from ..parts.law import Kinematics, Weights
from .excitation import add_load
from .interface_problem import solve_columns
from .laws import kinematics, law_rates, law_tangent, relative
from .linear_step import balance, balance_back, correct, predict
from .step import (
    Motion,
    add_interface_force,
    add_internal,
    by_axis,
    housing_forces,
    predict_internal_state,
)

# Of the size of what a law depends on: by how much it is differenced.
_SHARE = 1e-6


class Tangent(NamedTuple):
    """Derivatives of a motion, as in `Motion`, one row an input; the last row is scratch. spin: of
    the speed [rad/s], its rate [rad/s2] and the angle [rad]."""

    q: Annotated[np.ndarray, complex, "2 * loads + 2", "size"]
    v: Annotated[np.ndarray, complex, "2 * loads + 2", "size"]
    a: Annotated[np.ndarray, complex, "2 * loads + 2", "size"]
    v_dot: Annotated[np.ndarray, complex, "2 * loads + 2", "size"]
    jerk: Annotated[np.ndarray, complex, "2 * loads + 2", "size"]
    force: Annotated[np.ndarray, complex, "2 * loads + 2", "interfaces"]
    internal_state: Annotated[np.ndarray, float, "2 * loads + 2", "internal_states"]
    internal_rate_carried: Annotated[np.ndarray, float, "2 * loads + 2", "internal_states"]
    internal_rate: Annotated[np.ndarray, float, "2 * loads + 2", "internal_states"]
    spin: Annotated[np.ndarray, float, "2 * loads + 2", "3"]


class TangentWork(NamedTuple):
    """Scratch of tangents. by_law: the pairs of dF/dd and of dF/dd'; free, rate: of the laws'
    states; flows, ledger: of `ledger.FLOWS`."""

    by_law: Annotated[np.ndarray, complex, "interfaces", "4"]
    known: Annotated[np.ndarray, complex, "interfaces"]
    d_free: Annotated[np.ndarray, float, "internal_states"]
    shifted: Annotated[np.ndarray, float, "internal_states"]
    above: Annotated[np.ndarray, float, "internal_states"]
    below: Annotated[np.ndarray, float, "internal_states"]
    matrix: Annotated[np.ndarray, float, "2 * interfaces", "2 * interfaces"]
    right: Annotated[np.ndarray, float, "2 * interfaces"]
    places: Annotated[np.ndarray, np.int64, "2 * interfaces"]
    flows: Annotated[np.ndarray, float, "flows"]
    ledger: Annotated[np.ndarray, float, "flows"]
    loads: Annotated[np.ndarray, complex, "loads"]


class Tangents(NamedTuple):
    """The tangents of a run: at the time reached, at the end of a step, scratch, and a motion that
    is moved along one of them."""

    now: Tangent
    after: Tangent
    work: TangentWork
    moved: Motion


@jit
def row_of(tangent, row):
    """Return one row of a tangent as a `Motion`."""
    return Motion(
        tangent.q[row],
        tangent.v[row],
        tangent.a[row],
        tangent.v_dot[row],
        tangent.jerk[row],
        tangent.force[row],
        tangent.internal_state[row],
        tangent.internal_rate_carried[row],
        tangent.internal_rate[row],
    )


@jit
def load_of(row, i):
    """Return the derivative of load i by the input of a row [1]: the drive is row 0, then come the
    loads, each along x and along y."""
    if row == 1 + 2 * i:
        return 1.0 + 0.0j
    return 1.0j if row == 2 + 2 * i else 0.0j


@jit
def _add_by_spin(structure, spin, d_spin, share, damping, q, v, scratch, out):
    """out += share times the change of unbalance and internal forces with the rotation alone."""
    d_omega, d_alpha, d_theta = d_spin[0], d_spin[1], d_spin[2]
    if d_omega == 0.0 and d_alpha == 0.0 and d_theta == 0.0:
        return
    turning = 1j * d_theta * complex(spin.omega * spin.omega, -spin.alpha)
    turning = share * spin.direction * (turning + complex(2.0 * spin.omega * d_omega, -d_alpha))
    for i in range(len(structure.unbalance)):
        unbalance = structure.unbalances[i]
        force = structure.unbalance[i] * turning
        out[unbalance.dof] += force
        if unbalance.offset != 0.0:
            out[unbalance.slope] += unbalance.offset * force
    n = len(out)
    for i in range(n):
        turned = -share * (damping * d_omega * v[i] + 0.5 * d_alpha * q[i])
        scratch[i] = complex(turned.imag, -turned.real)
    add_product(structure.G, scratch, out)
    kappa = -share * structure.numbers[0].kappa_v * d_omega
    if kappa != 0.0:
        for i in range(n):
            scratch[i] = complex(kappa * q[i].imag, -kappa * q[i].real)
        add_product(structure.K_shaft, scratch, out)


@jit
def _shift(moving, d, d_dot, d_omega, by):
    """Return `Kinematics` moved along a derivative; speed and sliding speed change together."""
    turned = by * d_omega
    return Kinematics(
        moving.displacement + by * d,
        moving.velocity + by * d_dot,
        moving.speed + turned,
        moving.sliding_speed + turned,
    )


@jit
def _step_along(interface, moving, d, d_dot, d_omega, free, d_free, omega_scale):
    """Return by how much to move along a derivative; 0 where there is nothing to move."""
    size = modulus(d) / interface.length
    size = max(size, modulus(d_dot) / (interface.length * omega_scale))
    size = max(size, abs(d_omega) / max(abs(moving.speed), 1.0))
    for k in range(interface.states):
        scale = abs(free[k]) if free[k] != 0.0 else interface.length
        size = max(size, abs(d_free[k]) / scale)
    return _SHARE / size if size > 0.0 else 0.0


@jit_not_inlined
def _force_by_rest(laws, interface, moving, d_omega, rate, free, d_free, omega_scale, work):
    """Return dF by the speed and by what is known of the internal states."""
    by = _step_along(interface, moving, 0j, 0j, d_omega, free, d_free, omega_scale)
    if by == 0.0:
        return 0.0j
    weights = Weights(1.0, 0.0, rate)
    first = interface.internal_state
    shifted = work.shifted[first:]
    for k in range(interface.states):
        shifted[k] = free[k] + by * d_free[k]
    above, _, _ = law_tangent(
        laws, interface, _shift(moving, 0j, 0j, d_omega, by), weights, shifted, work.above[first:]
    )
    for k in range(interface.states):
        shifted[k] = free[k] - by * d_free[k]
    below, _, _ = law_tangent(
        laws, interface, _shift(moving, 0j, 0j, d_omega, -by), weights, shifted, work.below[first:]
    )
    return (above - below) * (0.5 / by)


@jit_not_inlined
def _states_along(
    laws, interface, moving, d, d_dot, d_omega, rate, free, d_free, omega_scale, work, out
):
    """Fill out with the change of the internal states at the end of a step."""
    by = _step_along(interface, moving, d, d_dot, d_omega, free, d_free, omega_scale)
    first = interface.internal_state
    weights = Weights(1.0, 0.0, rate)
    shifted = work.shifted[first:]
    for side in range(2):
        signed = by if side == 0 else -by
        for k in range(interface.states):
            shifted[k] = free[k] + signed * d_free[k]
        law_tangent(
            laws,
            interface,
            _shift(moving, d, d_dot, d_omega, signed),
            weights,
            shifted,
            work.above[first:] if side == 0 else work.below[first:],
        )
    for k in range(interface.states):
        change = work.above[first + k] - work.below[first + k]
        out[first + k] = change * (0.5 / by) if by > 0.0 else 0.0


@jit_not_inlined
def _rates_along(
    laws, interface, moving, d, d_dot, d_omega, state, d_state, omega_scale, work, out
):
    """Fill out with the change of the rates of the internal states."""
    by = _step_along(interface, moving, d, d_dot, d_omega, state, d_state, omega_scale)
    first = interface.internal_state
    shifted = work.shifted[first:]
    for side in range(2):
        signed = by if side == 0 else -by
        for k in range(interface.states):
            shifted[k] = state[k] + signed * d_state[k]
        law_rates(
            laws,
            interface,
            _shift(moving, d, d_dot, d_omega, signed),
            shifted,
            work.above[first:] if side == 0 else work.below[first:],
        )
    for k in range(interface.states):
        change = work.above[first + k] - work.below[first + k]
        out[first + k] = change * (0.5 / by) if by > 0.0 else 0.0


@jit
def _linearize_laws(structure, spin, rate, motion, free, work):
    """Fill work.by_law at a motion; free: of its internal states."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        moving = kinematics(interface, spin, motion.q, motion.v)
        first = interface.internal_state
        out = work.above[first:]
        _, p, q = law_tangent(
            structure.laws, interface, moving, Weights(1.0, 0.0, rate), free[first:], out
        )
        work.by_law[j, 0], work.by_law[j, 1] = p, q
        _, p, q = law_tangent(
            structure.laws, interface, moving, Weights(0.0, 1.0, rate), free[first:], out
        )
        work.by_law[j, 2], work.by_law[j, 3] = p, q


@jit
def _loads_on_base(structure, row):
    """Return the derivative of the base's acceleration by the input of a row [1]."""
    base = structure.numbers[0].base_load
    return load_of(row, base) if base >= 0 else 0.0j


@jit
def linearize_step(structure, scheme, spin, h, new, problem, work):
    """Fill in what all rows of a step have in common, at its end `new`."""
    share = h * scheme.gamma / (1.0 - scheme.alpha_m) * (1.0 - scheme.alpha_f)
    _linearize_laws(structure, spin, share, new, problem.free, work)


@jit_not_inlined
def step_row(structure, scheme, fit, spin, h, row, old, out, d_spin, new, step, problem, work):
    """Fill `out`, a row at the end of a step, from `old`, the same at its beginning; new: the
    motion at the end, step: its `Workspace`; d_spin: of the rotation there."""
    n = structure.M.shape[0]
    af = scheme.alpha_f
    am, share = fit.mass * scheme.alpha_m, 1.0 - af
    omega_scale = max(abs(spin.omega), structure.numbers[0].slowest)
    predict(scheme, h, old.q, old.v, old.a, out.q, out.v)
    free, scratch = out.a[:n], step.scratch
    for i in range(n):
        free[i] = 0.0
    for i in range(len(structure.load_dof)):
        load = load_of(row, i)
        if load != 0.0:
            add_load(structure, i, share * load, free)
    for i in range(n):
        scratch[i] = af * old.v_dot[i] - am * old.a[i]
    add_product(structure.M, scratch, free)
    add_internal(structure, spin, -share, fit.damping, out.q, out.v, scratch, free)
    _add_by_spin(structure, spin, d_spin, share, fit.damping, new.q, new.v, scratch, free)
    solve(step.factors, free)
    d_base = _loads_on_base(structure, row)
    for j in range(len(structure.housings)):
        at = n + j
        force = housing_forces(structure.housings[j], -d_base, out.q[at], fit.damping * out.v[at])
        m_x, m_y = masses(structure.housings[j])
        force += by_axis(m_x / share, m_y / share, am * old.a[at] - af * old.v_dot[at])
        out.a[at] = -by_axis(step.housing[j, 0], step.housing[j, 1], force)
    out.a[n + len(structure.housings)] = 0.0
    rate = predict_internal_state(scheme, h, old, work.d_free)
    _solve_row(structure, scheme, spin, h, rate, out, d_spin, new, problem, work, omega_scale)
    for j in range(len(structure.interfaces)):
        if out.force[j] != 0.0:
            add_interface_force(structure, step, j, out.force[j], out.a)
    correct(scheme, h, out.a, out.q, out.v)
    balance(scheme, fit.mass, old.a, old.v_dot, out.a, out.v_dot)
    if len(out.internal_state) == 0:
        return
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.states > 0:
            first = interface.internal_state
            moving = kinematics(interface, spin, new.q, new.v)
            d, d_dot = relative(interface, out.q), relative(interface, out.v)
            _states_along(
                structure.laws,
                interface,
                moving,
                d,
                d_dot,
                d_spin[0],
                rate,
                problem.free[first:],
                work.d_free[first:],
                omega_scale,
                work,
                out.internal_state,
            )
    _fill_rates_along(structure, spin, d_spin, new, out, omega_scale, work)
    balance_back(
        scheme,
        old.internal_rate_carried,
        old.internal_rate,
        out.internal_rate,
        out.internal_rate_carried,
    )


@jit
def _fill_rates_along(structure, spin, d_spin, motion, out, omega_scale, work):
    """Fill out.internal_rate from the laws."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.states > 0:
            first = interface.internal_state
            _rates_along(
                structure.laws,
                interface,
                kinematics(interface, spin, motion.q, motion.v),
                relative(interface, out.q),
                relative(interface, out.v),
                d_spin[0],
                motion.internal_state[first:],
                out.internal_state[first:],
                omega_scale,
                work,
                out.internal_rate,
            )


@jit
def _solve_row(structure, scheme, spin, h, rate, out, d_spin, new, problem, work, omega_scale):
    """Fill out.force by the derivative of the interfaces' problem."""
    interfaces = structure.interfaces
    m = len(interfaces)
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    flexibility, matrix, right = problem.flexibility, work.matrix, work.right
    for j in range(m):
        interface = interfaces[j]
        first = interface.internal_state
        d, d_dot = relative(interface, out.q), relative(interface, out.v)
        w = relative(interface, out.a)
        right[2 * j], right[2 * j + 1] = w.real, w.imag
        by = work.by_law[j]
        known = by[0] * d + by[1] * d.conjugate() + by[2] * d_dot + by[3] * d_dot.conjugate()
        work.known[j] = known + _force_by_rest(
            structure.laws,
            interface,
            kinematics(interface, spin, new.q, new.v),
            d_spin[0],
            rate,
            problem.free[first:],
            work.d_free[first:],
            omega_scale,
            work,
        )
    matrix[:, :] = 0.0
    for i in range(2 * m):
        matrix[i, i] = 1.0
    for j in range(m):
        by, known = work.by_law[j], work.known[j]
        p, q = b_d * by[0] + b_v * by[2], b_d * by[1] + b_v * by[3]
        t_xx, t_yx = (p + q).real, (p + q).imag
        t_xy, t_yy = (q - p).imag, (p - q).real
        for i in range(2 * m):
            w_x, w_y = flexibility[i, 2 * j], flexibility[i, 2 * j + 1]
            right[i] += w_x * known.real + w_y * known.imag
            matrix[i, 2 * j] -= w_x * t_xx + w_y * t_yx
            matrix[i, 2 * j + 1] -= w_x * t_xy + w_y * t_yy
    for i in range(2 * m):
        work.places[i] = i
    solve_columns(matrix, work.places, right)
    for j in range(m):
        by = work.by_law[j]
        w = complex(right[2 * j], right[2 * j + 1])
        p, q = b_d * by[0] + b_v * by[2], b_d * by[1] + b_v * by[3]
        out.force[j] = work.known[j] + p * w + q * w.conjugate()


@jit
def instant_row(structure, spin, row, out, d_spin, motion, step, work):
    """Fill the accelerations and rates of a row by the equation of motion at an instant, at which
    displacements, velocities and internal states are given."""
    n = structure.M.shape[0]
    omega_scale = max(abs(spin.omega), structure.numbers[0].slowest)
    f = out.v_dot[:n]
    for i in range(n):
        f[i] = 0.0
    for i in range(len(structure.load_dof)):
        load = load_of(row, i)
        if load != 0.0:
            add_load(structure, i, load, f)
    _add_by_spin(structure, spin, d_spin, 1.0, 1.0, motion.q, motion.v, step.scratch, f)
    d_base = _loads_on_base(structure, row)
    for j in range(len(structure.housings)):
        out.v_dot[n + j] = -housing_forces(structure.housings[j], -d_base, 0j, 0j)
    for i in range(len(work.d_free)):
        work.d_free[i] = 0.0
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        first = interface.internal_state
        force = _force_by_rest(
            structure.laws,
            interface,
            kinematics(interface, spin, motion.q, motion.v),
            d_spin[0],
            0.0,
            motion.internal_state[first:],
            work.d_free[first:],
            omega_scale,
            work,
        )
        out.force[j] = force
        f[interface.dof] += force
        out.v_dot[interface.end] -= force
    for j in range(len(structure.housings)):
        m_x, m_y = masses(structure.housings[j])
        out.v_dot[n + j] = by_axis(1.0 / m_x, 1.0 / m_y, out.v_dot[n + j])
    out.v_dot[n + len(structure.housings)] = 0.0
    solve(structure.M_factors, f)
    _fill_rates_along(structure, spin, d_spin, motion, out, omega_scale, work)
    for i in range(len(out.a)):
        out.a[i] = out.v_dot[i]
    for i in range(len(out.internal_rate)):
        out.internal_rate_carried[i] = out.internal_rate[i]
