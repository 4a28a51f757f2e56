"""Sensitivities over a communication step: the derivative of the motion at its end with respect to
the inputs during it, by tangents that pass through the solver's own steps (`step.tangent`).

An input is the value that a host sets at the beginning of the communication step, with all its
consequences: a speed that continues linearly also changes its rate.
"""

import numpy as np

from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..parts.base import PORT_OUTPUTS
from ..quantities import places
from ..step.excitation import at_load, spin_of
from ..step.step import rescale_carried
from ..step.tangent import instant_row, linearize_step, load_of, row_of, step_row
from .energy import powers
from .memory import spin_now
from .observe import PARTS_AT, SHAFT

_SHAFT, _PORT = places(SHAFT), places(PORT_OUTPUTS)
# Displacement along a derivative, as a share of the motion's size: a smaller one suffers from
# rounding of powers that cancel, a larger one from the curvature of films and contacts.
_SHARE = 1e-5


@jit
def moved_spin(spin, d_spin, step):
    """Return the rotation displaced by a step along a derivative."""
    return spin_of(
        spin.omega + step * d_spin[0], spin.alpha + step * d_spin[1], spin.theta + step * d_spin[2]
    )


@jit
def move(motion, row, step, out):
    """Fill `out` with a motion displaced by a step along a row of a tangent."""
    for i in range(len(motion.q)):
        out.q[i] = motion.q[i] + step * row.q[i]
        out.v[i] = motion.v[i] + step * row.v[i]
        out.v_dot[i] = motion.v_dot[i] + step * row.v_dot[i]
    for i in range(len(motion.internal_state)):
        out.internal_state[i] = motion.internal_state[i] + step * row.internal_state[i]


@jit
def difference_step(structure, spin, row, d_spin):
    """Return the step of a central difference along a row of a tangent; 0 if the row is 0."""
    length = structure.numbers[0].clearance
    frequency = max(abs(spin.omega), structure.numbers[0].slowest)
    size = max(abs(d_spin[0]) / frequency, abs(d_spin[2]))
    for i in range(len(structure.deflections)):
        dof = structure.deflections[i, 0]
        size = max(size, modulus(row.q[dof]) / length)
        size = max(size, modulus(row.v[dof]) / (length * frequency))
        size = max(size, modulus(row.v_dot[dof]) / (length * frequency * frequency))
    return _SHARE / size if size > 0.0 else 0.0


@jit
def torque_at(structure, spin, i, row, d_spin, step, motion, memory, work, tangents):
    """Displace the motion along row i into tangents.moved; return the torque for it [N.m]."""
    for k in range(len(memory.loads)):
        tangents.work.loads[k] = memory.loads[k] + step * load_of(i, k)
    move(motion, row, step, tangents.moved)
    return powers(
        structure,
        moved_spin(spin, d_spin, step),
        tangents.work.loads,
        tangents.moved,
        work.losses,
        tangents.work.flows,
    )


@jit_not_inlined
def torque_along(structure, spin, i, row, d_spin, motion, memory, work, tangents):
    """Return the derivative of the torque that the motion needs [N.m] along row i."""
    step = difference_step(structure, spin, row, d_spin)
    if step == 0.0:
        return 0.0
    # linear in the rate, whose share of the torque is the largest: the others are lost in it
    at_constant_speed = spin_of(spin.omega, 0.0, spin.theta)
    ahead = torque_at(
        structure, at_constant_speed, i, row, d_spin, step, motion, memory, work, tangents
    )
    behind = torque_at(
        structure, at_constant_speed, i, row, d_spin, -step, motion, memory, work, tangents
    )
    return (ahead - behind) * (0.5 / step)


@jit
def drive_along(record, d_drive, d_spin):
    """Return the derivative of the drive's torque on a free rotor [N.m]."""
    return d_drive - record[0].drive_impedance * d_spin[0]


@jit
def rotation_along(structure, record, d_drive, d_spin, out):
    """Fill in the derivatives of angle, speed and rate and, for a free rotor, of its torques: in a
    difference of two speeds the effect of a force is lost in rounding."""
    out[_SHAFT.phi], out[_SHAFT.w], out[_SHAFT.a] = d_spin[2], d_spin[0], d_spin[1]
    if record[0].is_free == 1:
        torque = drive_along(record, d_drive, d_spin)
        out[_SHAFT.tau] = torque
        out[_SHAFT.tau_load] = torque - structure.numbers[0].inertia * d_spin[1]
        out[_SHAFT.tau_wave] = torque - record[0].drive_impedance * d_spin[0]


@jit
def _add_scaled(out, base, unit, d_spin, unit_spin, d_alpha):
    """Set a row to `base` plus d_alpha times the row of a unit rate."""
    for i in range(len(out.q)):
        out.q[i] = base.q[i] + d_alpha * unit.q[i]
        out.v[i] = base.v[i] + d_alpha * unit.v[i]
        out.a[i] = base.a[i] + d_alpha * unit.a[i]
        out.v_dot[i] = base.v_dot[i] + d_alpha * unit.v_dot[i]
    for i in range(len(out.internal_state)):
        out.internal_state[i] = base.internal_state[i] + d_alpha * unit.internal_state[i]
        out.internal_rate[i] = base.internal_rate[i] + d_alpha * unit.internal_rate[i]
        carried = d_alpha * unit.internal_rate_carried[i]
        out.internal_rate_carried[i] = base.internal_rate_carried[i] + carried
    for i in range(3):
        d_spin[i] += d_alpha * unit_spin[i]


@jit
def _rate_along(record, i, d_torque, d_torque_by_rate, d_omega, d_omega_by_rate):
    """Return the derivative of a free rotor's rate [rad/s2] that keeps its torques in balance."""
    damping = record[0].drive_impedance
    d_drive = (1.0 if i == 0 else 0.0) - damping * d_omega
    return (d_drive - d_torque) / (d_torque_by_rate + damping * d_omega_by_rate)


@jit_not_inlined
def begin_tangents(structure, spin, rate_by_drive, motion, memory, work, tangents):
    """Fill in the tangents at the beginning of a communication step. rate_by_drive: derivative of
    the speed's rate with respect to the speed [1/s]."""
    now = tangents.now
    is_free = memory.record[0].is_free == 1
    inputs = len(now.q) - 1
    for i in range(inputs + 1):
        row, d_spin = row_of(now, i), now.spin[i]
        row.q[:] = 0.0
        row.v[:] = 0.0
        row.internal_state[:] = 0.0
        d_spin[:] = 0.0
        if is_free and i == inputs:
            d_spin[1] = 1.0
        elif not is_free and i == 0:
            d_spin[0], d_spin[1] = 1.0, rate_by_drive
        instant_row(structure, spin, i, row, d_spin, motion, work, tangents.work)
    if not is_free:
        return
    unit = row_of(now, inputs)
    along = torque_along(
        structure, spin, inputs, unit, now.spin[inputs], motion, memory, work, tangents
    )
    for i in range(inputs):
        row = row_of(now, i)
        torque = torque_along(structure, spin, i, row, now.spin[i], motion, memory, work, tangents)
        d_alpha = _rate_along(memory.record, i, torque, along, 0.0, 0.0)
        _add_scaled(row, row, unit, now.spin[i], now.spin[inputs], d_alpha)


@jit_not_inlined
def propagate(structure, scheme, fit, spin, h, ratio, t, new, memory, work, problem, tangents):
    """Propagate the tangents over a step of length h [s] that ends at `new`, at time t [s]; ratio:
    factor with which the carried accelerations were rescaled."""
    now, after, tangent_work = tangents.now, tangents.after, tangents.work
    is_free = memory.record[0].is_free == 1
    elapsed = t - memory.record[0].t_ref
    inputs = len(now.q) - 1
    linearize_step(structure, scheme, spin, h, new, problem, tangent_work)
    for i in range(inputs + (1 if is_free else 0)):
        old, out, d_spin = row_of(now, i), row_of(after, i), after.spin[i]
        if i == inputs:
            _clear(old)
            d_spin[0], d_spin[1], d_spin[2] = 0.5 * h, 1.0, 0.25 * h * h
        elif is_free:
            d_spin[0] = now.spin[i, 0] + 0.5 * h * now.spin[i, 1]
            d_spin[1] = 0.0
            d_spin[2] = now.spin[i, 2] + 0.5 * h * (now.spin[i, 0] + d_spin[0])
        else:
            d_spin[1] = now.spin[i, 1]
            first = 1.0 if i == 0 else 0.0
            d_spin[0] = first + d_spin[1] * elapsed
            d_spin[2] = elapsed * (first + 0.5 * d_spin[1] * elapsed)
        if ratio != 1.0:
            rescale_carried(old, ratio)
        step_row(
            structure, scheme, fit, spin, h, i, old, out, d_spin, new, work, problem, tangent_work
        )
    if is_free:
        unit, unit_spin = row_of(after, inputs), after.spin[inputs]
        along = torque_along(structure, spin, inputs, unit, unit_spin, new, memory, work, tangents)
        for i in range(inputs):
            row, d_spin = row_of(after, i), after.spin[i]
            torque = torque_along(structure, spin, i, row, d_spin, new, memory, work, tangents)
            d_alpha = _rate_along(memory.record, i, torque, along, d_spin[0], unit_spin[0])
            _add_scaled(row, row, unit, d_spin, unit_spin, d_alpha)
    for i in range(inputs):
        _add_scaled(
            row_of(now, i), row_of(after, i), row_of(after, i), now.spin[i], after.spin[i], 0.0
        )
        for k in range(3):
            now.spin[i, k] = after.spin[i, k]


@jit
def _clear(row):
    row.q[:] = 0.0
    row.v[:] = 0.0
    row.a[:] = 0.0
    row.v_dot[:] = 0.0
    row.internal_state[:] = 0.0
    row.internal_rate[:] = 0.0
    row.internal_rate_carried[:] = 0.0


@jit_not_inlined
def observe_sensitivities(structure, motion, memory, work, tangents, out):
    """Fill in the outputs that are sensitivities."""
    now, spin = tangents.now, spin_now(memory.record)
    drive = np.int64(0)  # a literal would be compiled separately
    row, d_spin = row_of(now, drive), now.spin[drive]
    if memory.record[0].is_free == 1:
        torque = drive_along(memory.record, 1.0, d_spin)
    else:
        torque = torque_along(structure, spin, drive, row, d_spin, motion, memory, work, tangents)
    out[_SHAFT.dphi_ddrive] = d_spin[2]
    out[_SHAFT.dw_ddrive] = d_spin[0]
    out[_SHAFT.dtau_ddrive] = torque
    out[_SHAFT.dtau_load_ddrive] = torque - structure.numbers[0].inertia * d_spin[1]
    for i in range(len(structure.load_dof)):
        if structure.load_dof[i] >= 0:
            _observe_port(structure, i, now, out[PARTS_AT + structure.load_arms[i].out :])


@jit
def _observe_port(structure, i, now, out):
    """Fill in the derivatives of displacement and velocity at a load with respect to this load."""
    by_x, by_y = 1 + 2 * i, 2 + 2 * i
    x, y = at_load(structure, i, now.q[by_x]), at_load(structure, i, now.q[by_y])
    out[_PORT.dx_dfx], out[_PORT.dx_dfy] = x.real, y.real
    out[_PORT.dy_dfx], out[_PORT.dy_dfy] = x.imag, y.imag
    x, y = at_load(structure, i, now.v[by_x]), at_load(structure, i, now.v[by_y])
    out[_PORT.dvx_dfx], out[_PORT.dvx_dfy] = x.real, y.real
    out[_PORT.dvy_dfx], out[_PORT.dvy_dfy] = x.imag, y.imag
