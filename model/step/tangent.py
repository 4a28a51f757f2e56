"""The tangent of a step: the derivative of the motion at its end with respect to the inputs.

A row of a `Tangent` is the derivative of a motion with respect to one input, complex as the motion
is and linear in it over the reals. A row passes through the same operations of the step as a
motion, prediction, factorized matrix, interfaces, correction, with the interfaces' problem replaced
by its derivative

    dw = dw_free + W dF,    dF = dF/dd dd + dF/dd' dd' + dF/dOmega dOmega + dF/ds ds

with the internal states s of the laws (`law_tangents`). Step lengths and fitting count as constant.
"""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import add_product, solve
from ..kernels.functions import copy
from ..kernels.jit import jit, jit_not_inlined
from ..parts.housing import masses
from .bows import add_bows_along
from .excitation import add_load
from .interface_problem import solve_columns
from .law_tangents import change_of, force_by_rest, linearize_laws, states_along
from .laws import kinematics, relative
from .linear_step import balance, balance_back, correct, predict
from .step import (
    Motion,
    add_interface_force,
    add_internal,
    by_axis,
    housing_forces,
    predict_internal_state,
)


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
    """Work arrays of tangents. by_law: the pairs of dF/dd and of dF/dd'; d_free: derivatives of the
    predicted internal states; flows, ledger: of `ledger.FLOWS`; load_work: of each load [J]."""

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
    load_work: Annotated[np.ndarray, float, "loads"]
    loads: Annotated[np.ndarray, complex, "loads"]


class RunTangents(NamedTuple):
    """The tangents of a run: at the present time, at the end of a step, work arrays, and a motion
    displaced along one of them."""

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
    """Return the derivative of load i with respect to the input of a row [1]: row 0 is the drive,
    then come the loads, each along x and along y."""
    if row == 1 + 2 * i:
        return 1.0 + 0.0j
    return 1.0j if row == 2 + 2 * i else 0.0j


@jit
def _add_by_spin(structure, spin, d_spin, share, damping, q, v, scratch, out):
    """Add to out `share` times the change of unbalance and internal forces with the rotation
    alone."""
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
def _loads_on_base(structure, row):
    """Return the derivative of the base's acceleration with respect to the input of a row [1]."""
    base = structure.numbers[0].base_load
    return load_of(row, base) if base >= 0 else 0.0j


@jit
def linearize_step(structure, scheme, spin, h, new, problem, work):
    """Fill in what all rows of a step have in common, at its end `new`."""
    share = h * scheme.gamma / (1.0 - scheme.alpha_m) * (1.0 - scheme.alpha_f)
    linearize_laws(structure, spin, share, new, problem.free, work)


@jit_not_inlined
def step_row(structure, scheme, fit, spin, h, row, old, out, d_spin, new, step, problem, work):
    """Fill `out`, a row at the end of a step, from `old`, the same row at its beginning; new: the
    motion at the end; step: its `Workspace`; d_spin: of the rotation there."""
    n = structure.M.shape[0]
    af = scheme.alpha_f
    am, share = fit.mass * scheme.alpha_m, 1.0 - af
    predict(scheme, h, old.q, old.v, old.a, out.q, out.v)
    free, scratch = out.a[:n], step.scratch
    free[:] = 0.0
    for i in range(len(structure.load_dof)):
        load = load_of(row, i)
        if load != 0.0:
            add_load(structure, i, share * load, free)
    for i in range(n):
        scratch[i] = af * old.v_dot[i] - am * old.a[i]
    add_product(structure.M, scratch, free)
    add_internal(structure, spin, -share, fit.damping, out.q, out.v, scratch, free)
    _add_by_spin(structure, spin, d_spin, share, fit.damping, new.q, new.v, scratch, free)
    add_bows_along(structure, spin, d_spin[2], share, h, old, new, free)
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
    _solve_row(structure, scheme, spin, h, rate, out, d_spin, new, problem, work)
    for j in range(len(structure.interfaces)):
        if out.force[j] != 0.0:
            add_interface_force(structure, step, j, out.force[j], out.a)
    correct(scheme, h, out.a, out.q, out.v)
    balance(scheme, fit.mass, old.a, old.v_dot, out.a, out.v_dot)
    if len(out.internal_state) == 0:
        return
    _fill_states_along(
        *(structure, spin, d_spin, rate, new, problem.free, out, work.d_free, False, work)
    )
    _fill_states_along(
        *(structure, spin, d_spin, 0.0, new, new.internal_state, out, out.internal_state),
        *(True, work),
    )
    balance_back(
        scheme,
        old.internal_rate_carried,
        old.internal_rate,
        out.internal_rate,
        out.internal_rate_carried,
    )


@jit
def _fill_states_along(structure, spin, d_spin, rate, motion, state, out, d_state, are_rates, work):
    """Fill out.internal_state, or if are_rates out.internal_rate, from the laws at a motion; state,
    d_state: as in `states_along`."""
    omega = max(abs(spin.omega), structure.numbers[0].slowest)
    into = out.internal_rate if are_rates else out.internal_state
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.states > 0:
            first = interface.internal_state
            states_along(
                *(structure.laws, interface, kinematics(interface, spin, motion.q, motion.v)),
                *(change_of(interface, out, d_spin, omega), rate),
                *(state[first:], d_state[first:], are_rates, work, into),
            )


@jit
def _solve_row(structure, scheme, spin, h, rate, out, d_spin, new, problem, work):
    """Fill out.force from the derivative of the interfaces' problem."""
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
        work.known[j] = known + force_by_rest(
            structure.laws,
            interface,
            kinematics(interface, spin, new.q, new.v),
            d_spin,
            rate,
            problem.free[first:],
            work.d_free[first:],
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
    """Fill the accelerations and rates of a row from the equation of motion at an instant at which
    displacements, velocities and internal states do not depend on the input."""
    n = structure.M.shape[0]
    f = out.v_dot[:n]
    f[:] = 0.0
    for i in range(len(structure.load_dof)):
        load = load_of(row, i)
        if load != 0.0:
            add_load(structure, i, load, f)
    _add_by_spin(structure, spin, d_spin, 1.0, 1.0, motion.q, motion.v, step.scratch, f)
    add_bows_along(structure, spin, d_spin[2], 1.0, 0.0, out, motion, f)
    d_base = _loads_on_base(structure, row)
    for j in range(len(structure.housings)):
        out.v_dot[n + j] = -housing_forces(structure.housings[j], -d_base, 0j, 0j)
    work.d_free[:] = 0.0
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        first = interface.internal_state
        force = force_by_rest(
            structure.laws,
            interface,
            kinematics(interface, spin, motion.q, motion.v),
            d_spin,
            0.0,
            motion.internal_state[first:],
            work.d_free[first:],
            work,
        )
        out.force[j] = force
        out.v_dot[interface.dof] += force
        out.v_dot[interface.end] -= force
    for j in range(len(structure.housings)):
        m_x, m_y = masses(structure.housings[j])
        out.v_dot[n + j] = by_axis(1.0 / m_x, 1.0 / m_y, out.v_dot[n + j])
    out.v_dot[n + len(structure.housings)] = 0.0
    solve(structure.M_factors, f)
    _fill_states_along(
        *(structure, spin, d_spin, 0.0, motion, motion.internal_state, out, out.internal_state),
        *(True, work),
    )
    copy(out.v_dot, out.a)
    copy(out.internal_rate, out.internal_rate_carried)
