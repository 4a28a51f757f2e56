"""Derivatives of all that can be read: by time, at the time reached, and by an input, over the last
communication step (`sensitivities`).

Everything read is a function of the motion. The motion is moved along its derivative, to both sides
and by a share of its own period or size, and read there; by time the accelerations on both sides
are those of the equation of motion.
"""

from __future__ import annotations

import math

from ..kernels.jit import jit, jit_inlined, jit_not_inlined
from ..quantities import places
from ..step.excitation import spin_of
from ..step.step import accelerate
from ..step.tangent import row_of
from .energy import powers
from .memory import spin_now
from .observe import SHAFT, observe
from .sensitivities import moved_spin, rotation_along, step_along, torque_at

_SHAFT = places(SHAFT)
_SHARE = 1e-4  # of a radian of the fastest motion: how far to look to both sides
# In these shares: to both sides for the first derivative, and further for the second one, of which
# rounding takes more the nearer the points are; its weights are those of fourth order.
_PLACES = (-1.0, 1.0, -20.0, 20.0, -40.0, 40.0, 0.0)
_WEIGHTS = (0.0, 0.0, 16.0, 16.0, -1.0, -1.0, -30.0)
_NORM = 12.0 * 20.0**2
# Of a free rotor: until its rate agrees to this share.
_ITERATIONS, _BALANCED = 20, 1e-13


@jit_not_inlined
def _read(structure, memory, work, tangents, spin, torque, out):
    """`observe` the moved motion under the moved loads, at another rotation and torque [N.m]; the
    run stays as it is."""
    r = memory.record[0]
    omega, alpha, theta, held = r.omega, r.alpha, r.theta, r.torque
    r.omega, r.alpha, r.theta, r.torque = spin.omega, spin.alpha, spin.theta, torque
    _swap(memory.loads, tangents.work.loads)
    observe(structure, tangents.moved, memory, work, out, True)
    _swap(memory.loads, tangents.work.loads)
    r.omega, r.alpha, r.theta, r.torque = omega, alpha, theta, held


@jit
def _swap(one, other):
    for i in range(len(one)):
        one[i], other[i] = other[i], one[i]


@jit_inlined  # as arguments a whole run is more than a WebAssembly function may have
def by_input(run, tangents, row):
    """Fill reading.derivatives[0] with the sensitivities to the input of a row of the tangents."""
    structure, memory = run.structure, run.memory
    first, second = run.reading.derivatives[0], run.reading.derivatives[1]
    along, d_spin = row_of(tangents.now, row), tangents.now.spin[row]
    spin = spin_now(memory.record)
    by = step_along(structure, spin, along, d_spin)
    for side in range(2):
        signed = by if side == 0 else -by
        torque = torque_at(
            structure, spin, row, along, d_spin, signed, run.motion, memory, run.work, tangents
        )
        there = moved_spin(spin, d_spin, signed)
        out = first if side == 0 else second
        _read(structure, memory, run.work, tangents, there, torque, out)
    for i in range(len(first)):
        first[i] = (first[i] - second[i]) * (0.5 / by) if by > 0.0 else 0.0
    rotation_along(structure, memory.record, 1.0 if row == 0 else 0.0, d_spin, first)


@jit_inlined
def by_time(run, tangents):
    """Fill reading.derivatives with the first and the second derivatives by time."""
    structure, motion, memory, work = run.structure, run.motion, run.memory, run.work
    moved = tangents.moved
    r = memory.record[0]
    first, second, now = run.reading.derivatives[0], run.reading.derivatives[1], run.reading.at
    spin = spin_now(memory.record)
    fastest = max(abs(r.omega), structure.numbers[0].slowest)
    by = _SHARE / max(fastest, math.sqrt(r.characteristic_frequency_squared))
    for i in range(len(memory.work)):
        tangents.work.ledger[i] = memory.work[i]
    for i in range(len(second)):
        second[i] = 0.0
    alpha_rate = _jerk(structure, motion, memory, work, tangents, spin, by)
    for place in range(len(_PLACES)):
        signed = by * _PLACES[place]
        _along_time(motion, signed, moved)
        torque, there = _balanced(structure, memory, work, tangents, spin, alpha_rate, signed)
        for i in range(len(memory.work)):
            change = 0.5 * signed * (memory.power[i] + tangents.work.flows[i])
            memory.work[i] = tangents.work.ledger[i] + change
        _read(structure, memory, work, tangents, there, torque, first if place == 0 else now)
        if place == 1:
            for i in range(len(first)):
                first[i] = (now[i] - first[i]) * (0.5 / by)
        elif place > 1:
            for i in range(len(second)):
                second[i] += _WEIGHTS[place] * now[i]
    for i in range(len(memory.work)):
        memory.work[i] = tangents.work.ledger[i]
    for i in range(len(second)):
        second[i] /= _NORM * by * by
    rates = tangents.after.spin[0]
    rates[0], rates[1], rates[2] = r.alpha, alpha_rate, r.omega
    drive_rate = r.drive_rate if r.varies == 1 else 0.0
    rotation_along(structure, memory.record, drive_rate, rates, first)
    rates[0], rates[1], rates[2] = alpha_rate, second[_SHAFT.a], r.alpha
    rotation_along(structure, memory.record, 0.0, rates, second)


@jit_not_inlined
def _jerk(structure, motion, memory, work, tangents, spin, by):
    """Fill in the change of the accelerations and of the laws' rates per second; returns that of
    the rotation's rate [rad/s3]."""
    moved = tangents.moved
    for i in range(len(motion.q)):
        moved.jerk[i] = 0.0
    for i in range(len(motion.internal_state)):
        moved.internal_rate_carried[i] = 0.0
    _along_time(motion, -by, moved)
    _, behind = _balanced(structure, memory, work, tangents, spin, 0.0, -by)
    for i in range(len(motion.q)):
        moved.a[i] = moved.v_dot[i]
    for i in range(len(motion.internal_state)):
        tangents.work.shifted[i] = moved.internal_rate[i]
    _along_time(motion, by, moved)
    _, ahead = _balanced(structure, memory, work, tangents, spin, 0.0, by)
    for i in range(len(motion.q)):
        moved.jerk[i] = (moved.v_dot[i] - moved.a[i]) * (0.5 / by)
    for i in range(len(motion.internal_state)):
        change = moved.internal_rate[i] - tangents.work.shifted[i]
        moved.internal_rate_carried[i] = change * (0.5 / by)
    return (ahead.alpha - behind.alpha) * (0.5 / by)


@jit_not_inlined
def _along_time(motion, by, out):
    """Fill `out` with the motion a little later, with its out.jerk."""
    third = by / 3.0
    for i in range(len(motion.q)):
        jerk = out.jerk[i]
        out.q[i] = motion.q[i] + by * (motion.v[i] + 0.5 * by * (motion.v_dot[i] + third * jerk))
        out.v[i] = motion.v[i] + by * (motion.v_dot[i] + 0.5 * by * jerk)
    for i in range(len(motion.internal_state)):
        rate = motion.internal_rate[i] + 0.5 * by * out.internal_rate_carried[i]
        out.internal_state[i] = motion.internal_state[i] + by * rate


@jit_not_inlined
def _balanced(structure, memory, work, tangents, spin, alpha_rate, by):
    """Fill in the accelerations of the moved motion, `by` [s] from now; returns its torque [N.m]
    and its rotation, of a free rotor with the rate that balances its torques."""
    moved = tangents.moved
    r = memory.record[0]
    for i in range(len(memory.loads)):
        rate = memory.load_rates[i] if r.varies == 1 else 0j
        tangents.work.loads[i] = memory.loads[i] + by * rate
    omega = spin.omega + by * (spin.alpha + 0.5 * by * alpha_rate)
    theta = spin.theta + by * (spin.omega + 0.5 * by * (spin.alpha + by / 3.0 * alpha_rate))
    there = spin_of(omega, spin.alpha + by * alpha_rate, theta)
    torque = 0.0
    for _ in range(_ITERATIONS):
        accelerate(structure, there, r.damping, tangents.work.loads, moved, work)
        torque = powers(
            structure, there, tangents.work.loads, moved, work.losses, tangents.work.flows
        )
        if r.is_free == 0:
            break
        drive = r.drive + (by * r.drive_rate if r.varies == 1 else 0.0)
        change = (drive - r.drive_impedance * omega - torque) / structure.numbers[0].inertia
        if abs(change) <= _BALANCED * (1.0 + abs(there.alpha)):
            break
        there = spin_of(omega, there.alpha + change, theta)
    return torque, there
