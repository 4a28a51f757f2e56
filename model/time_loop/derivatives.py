"""Derivatives of all outputs: with respect to time, at the present time, and with respect to an
input, over the last communication step (`sensitivities`).

Every output is a function of the motion. The motion is displaced along its derivative to both
sides, by a share of its period or size, and observed there; for the time derivative the
accelerations on both sides are those of the equation of motion.
"""

import math

from ..kernels.functions import copy
from ..kernels.jit import jit, jit_inlined, jit_not_inlined
from ..quantities import places
from ..step.excitation import spin_of
from ..step.step import accelerate
from ..step.tangent import row_of
from .energy import port_power, powers
from .memory import spin_now
from .observe import SHAFT, observe
from .sensitivities import difference_step, moved_spin, rotation_along, torque_at

_SHAFT = places(SHAFT)
_SHARE = 1e-4  # step of the finite differences, in radians of the fastest motion
# Points in multiples of that step: on both sides for the first derivative, and farther away for the
# second one, which suffers more from rounding; its weights are of fourth order.
_PLACES = (-1.0, 1.0, -20.0, 20.0, -40.0, 40.0, 0.0)
_WEIGHTS = (0.0, 0.0, 16.0, 16.0, -1.0, -1.0, -30.0)
_NORM = 12.0 * 20.0**2
# Iterations for the rate of a free rotor, and its relative accuracy.
_ITERATIONS, _BALANCED = 20, 1e-13


@jit_not_inlined
def _read(structure, memory, work, tangents, spin, torque, out):
    """Do `observe` for the displaced motion under the displaced loads, at another rotation and
    torque [N.m]; the run itself is left unchanged."""
    r = memory.record[0]
    omega, alpha, theta, torque_now = r.omega, r.alpha, r.theta, r.torque
    r.omega, r.alpha, r.theta, r.torque = spin.omega, spin.alpha, spin.theta, torque
    _swap(memory.loads, tangents.work.loads)
    observe(structure, tangents.moved, memory, work, out, True)
    _swap(memory.loads, tangents.work.loads)
    r.omega, r.alpha, r.theta, r.torque = omega, alpha, theta, torque_now


@jit
def _swap(one, other):
    for i in range(len(one)):
        one[i], other[i] = other[i], one[i]


@jit_inlined  # as arguments a whole run is more than a WebAssembly function may have
def by_input(run, tangents, row):
    """Fill outputs.derivatives[0] with the sensitivities to the input of a row of the tangents."""
    structure, memory = run.structure, run.memory
    first, second = run.outputs.derivatives[0], run.outputs.derivatives[1]
    along, d_spin = row_of(tangents.now, row), tangents.now.spin[row]
    spin = spin_now(memory.record)
    step = difference_step(structure, spin, along, d_spin)
    for side in range(2):
        signed = step if side == 0 else -step
        torque = torque_at(
            structure, spin, row, along, d_spin, signed, run.motion, memory, run.work, tangents
        )
        spin_there = moved_spin(spin, d_spin, signed)
        out = first if side == 0 else second
        _read(structure, memory, run.work, tangents, spin_there, torque, out)
    for i in range(len(first)):
        first[i] = (first[i] - second[i]) * (0.5 / step) if step > 0.0 else 0.0
    rotation_along(structure, memory.record, 1.0 if row == 0 else 0.0, d_spin, first)


@jit_inlined
def by_time(run, tangents):
    """Fill outputs.derivatives with the first and the second derivatives with respect to time."""
    structure, motion, memory, work = run.structure, run.motion, run.memory, run.work
    moved = tangents.moved
    r = memory.record[0]
    first, second, now = run.outputs.derivatives[0], run.outputs.derivatives[1], run.outputs.at
    spin = spin_now(memory.record)
    fastest = max(abs(r.omega), structure.numbers[0].slowest)
    step = _SHARE / max(fastest, math.sqrt(r.characteristic_frequency_squared))
    copy(memory.work, tangents.work.ledger)
    copy(memory.load_work, tangents.work.load_work)
    second[:] = 0.0
    alpha_rate = _jerk(structure, motion, memory, work, tangents, spin, step)
    for place in range(len(_PLACES)):
        signed = step * _PLACES[place]
        _along_time(motion, signed, moved)
        torque, spin_there = _balanced(structure, memory, work, tangents, spin, alpha_rate, signed)
        _move_work(structure, memory, tangents, spin_there, signed)
        _read(structure, memory, work, tangents, spin_there, torque, first if place == 0 else now)
        if place == 1:
            for i in range(len(first)):
                first[i] = (now[i] - first[i]) * (0.5 / step)
        elif place > 1:
            for i in range(len(second)):
                second[i] += _WEIGHTS[place] * now[i]
    copy(tangents.work.ledger, memory.work)
    copy(tangents.work.load_work, memory.load_work)
    for i in range(len(second)):
        second[i] /= _NORM * step * step
    rates = tangents.after.spin[0]
    rates[0], rates[1], rates[2] = r.alpha, alpha_rate, r.omega
    drive_rate = r.drive_rate if r.varies == 1 else 0.0
    rotation_along(structure, memory.record, drive_rate, rates, first)
    rates[0], rates[1], rates[2] = alpha_rate, second[_SHAFT.a], r.alpha
    rotation_along(structure, memory.record, 0.0, rates, second)


@jit_not_inlined
def _move_work(structure, memory, tangents, spin, step):
    """Set the work of all flows and loads to that of the displaced motion, `step` [s] from now."""
    for i in range(len(memory.work)):
        change = 0.5 * step * (memory.power[i] + tangents.work.flows[i])
        memory.work[i] = tangents.work.ledger[i] + change
    for i in range(len(memory.load_work)):
        power = port_power(structure, spin, i, tangents.work.loads[i], tangents.moved.v)
        change = 0.5 * step * (memory.load_power[i] + power)
        memory.load_work[i] = tangents.work.load_work[i] + change


@jit_not_inlined
def _jerk(structure, motion, memory, work, tangents, spin, step):
    """Fill in the rates of change of the accelerations and of the laws' rates; return that of the
    rotation's rate [rad/s3]."""
    moved = tangents.moved
    moved.jerk[:] = 0.0
    moved.internal_rate_carried[:] = 0.0
    _along_time(motion, -step, moved)
    _, behind = _balanced(structure, memory, work, tangents, spin, 0.0, -step)
    copy(moved.v_dot, moved.a)
    copy(moved.internal_rate, tangents.work.shifted)
    _along_time(motion, step, moved)
    _, ahead = _balanced(structure, memory, work, tangents, spin, 0.0, step)
    for i in range(len(motion.q)):
        moved.jerk[i] = (moved.v_dot[i] - moved.a[i]) * (0.5 / step)
    for i in range(len(motion.internal_state)):
        change = moved.internal_rate[i] - tangents.work.shifted[i]
        moved.internal_rate_carried[i] = change * (0.5 / step)
    return (ahead.alpha - behind.alpha) * (0.5 / step)


@jit_not_inlined
def _along_time(motion, step, out):
    """Fill `out` with the motion `step` [s] later, using its out.jerk."""
    third = step / 3.0
    for i in range(len(motion.q)):
        jerk = out.jerk[i]
        out.q[i] = motion.q[i] + step * (
            motion.v[i] + 0.5 * step * (motion.v_dot[i] + third * jerk)
        )
        out.v[i] = motion.v[i] + step * (motion.v_dot[i] + 0.5 * step * jerk)
    for i in range(len(motion.internal_state)):
        rate = motion.internal_rate[i] + 0.5 * step * out.internal_rate_carried[i]
        out.internal_state[i] = motion.internal_state[i] + step * rate


@jit_not_inlined
def _balanced(structure, memory, work, tangents, spin, alpha_rate, step):
    """Fill in the accelerations of the displaced motion, `step` [s] from now; return its torque
    [N.m] and its rotation, for a free rotor with the rate that balances its torques."""
    moved = tangents.moved
    r = memory.record[0]
    for i in range(len(memory.loads)):
        rate = memory.load_rates[i] if r.varies == 1 else 0j
        tangents.work.loads[i] = memory.loads[i] + step * rate
    omega = spin.omega + step * (spin.alpha + 0.5 * step * alpha_rate)
    theta = spin.theta + step * (spin.omega + 0.5 * step * (spin.alpha + step / 3.0 * alpha_rate))
    spin_there = spin_of(omega, spin.alpha + step * alpha_rate, theta)
    torque = 0.0
    for _ in range(_ITERATIONS):
        accelerate(structure, spin_there, r.damping, tangents.work.loads, moved, work)
        torque = powers(
            structure, spin_there, tangents.work.loads, moved, work.losses, tangents.work.flows
        )
        if r.is_free == 0:
            break
        drive = r.drive + (step * r.drive_rate if r.varies == 1 else 0.0)
        change = (drive - r.drive_impedance * omega - torque) / structure.numbers[0].inertia
        if abs(change) <= _BALANCED * (1.0 + abs(spin_there.alpha)):
            break
        spin_there = spin_of(omega, spin_there.alpha + change, theta)
    return torque, spin_there
