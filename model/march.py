"""The loop over steps from one communication point to the next, compiled.

Chooses each step's length, repeats what is rejected, and keeps what has to be kept at every step:
the energy ledger, the amplitudes, and the watch for the false wall-to-wall state.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .assembly import Structure
from .compiled import compiled
from .control import ADAPTIVE, CONTROLLED, FIXED, error_indicator, next_step, shorter_step
from .energy import FLOWS, powers, total_energy
from .error_control import local_error, next_length, repeated_length
from .excitation import spin_of
from .step import accelerate, try_step

DONE, NOT_CONVERGED, NOT_FINITE = 0, 1, 2
# A journal that crosses its whole clearance in at most CROSSING_STEPS steps again and again is in
# the integrator's limit cycle, not in the machine's motion: a crossing scores CROSSING_SCORE, any
# step takes one away, and at TRAPPED_SCORE (some twenty crossings) the state is called false.
CROSSING_STEPS = 2
CROSSING_SCORE = 3.0
TRAPPED_SCORE = 60.0
CUT = 0.9  # of the wished length: a step below it was cut short and says little about the next one

RECORD = np.dtype(
    [
        (name, "f8")
        for name in (
            "t",  # time [s]
            "t_ref",  # since then the speed has been linear in time: [s], [rad/s], [rad/s2], [rad]
            "omega_ref",
            "alpha",
            "theta_ref",
            "omega",  # at t [rad/s]
            "theta",  # at t [rad]
            "h",  # wished step length [s]
            "h_last",
            "h_smallest",
            "h_largest",
            "error",  # of the last step, relative [1]
            "energy_at_start",  # of the machine [J]
            "torque",  # of the drive, at t [N.m]
            "turn",  # angle at which the present revolution began [rad]
            "trapped_at",  # time at which the false state was first seen [s], or NaN
            "failed_at",  # time of the step that failed [s], and its length [s]
            "failed_h",
        )
    ]
    + [(name, "i8") for name in ("steps", "rejected", "newton", "trapped", "continues")]
)


class Memory(NamedTuple):
    """What a run remembers besides the motion; every array changes in place.

    record: shape (1,) of dtype `RECORD`; work, power: of `FLOWS`, shape (6,) [J], [W]; peaks: shape
    (3, 2, discs): largest |x| and |y - y_static| [m] of the present revolution, of the one before,
    and since the last communication point; bounce: shape (bearings, 4): direction of the last
    contact (cos, sin), steps since then, score of crossings; rest: heights of
    the discs at rest, shape (discs,) [m].
    """

    record: np.ndarray
    work: np.ndarray
    power: np.ndarray
    peaks: np.ndarray
    bounce: np.ndarray
    rest: np.ndarray


def new_memory(structure: Structure) -> Memory:
    """Memory of a run that has not begun."""
    memory = Memory(
        record=np.zeros(1, dtype=RECORD).view(np.recarray),
        work=np.zeros(len(FLOWS)),
        power=np.zeros(len(FLOWS)),
        peaks=np.zeros((3, 2, len(structure.disc_dof))),
        bounce=np.zeros((len(structure.contacts), 4)),
        rest=np.zeros(len(structure.disc_dof)),
    )
    memory.record[0].trapped_at = np.nan
    return memory


@compiled
def spin_at(record, t):
    """Rotation at time t [s]: the speed is linear in time, the angle its integral."""
    r = record[0]
    since = t - r.t_ref
    return spin_of(
        r.omega_ref + r.alpha * since,
        r.alpha,
        r.theta_ref + since * (r.omega_ref + 0.5 * r.alpha * since),
    )


@compiled
def spin_now(record):
    """Rotation at the time reached."""
    r = record[0]
    return spin_of(r.omega, r.alpha, r.theta)


@compiled
def _watch_amplitudes(structure, motion, memory):
    """Largest displacements of the discs, over the last whole revolution and what has passed of
    the present one."""
    r = memory.record[0]
    peaks = memory.peaks
    if abs(r.theta - r.turn) >= 2.0 * math.pi:
        r.turn = r.theta
        for axis in range(2):
            for i in range(len(structure.disc_dof)):
                peaks[1, axis, i] = peaks[0, axis, i]
                peaks[0, axis, i] = 0.0
    for i in range(len(structure.disc_dof)):
        q = motion.q[structure.disc_dof[i]]
        x = abs(q.real)
        y = abs(q.imag - memory.rest[i])
        for window in (0, 2):
            peaks[window, 0, i] = max(peaks[window, 0, i], x)
            peaks[window, 1, i] = max(peaks[window, 1, i], y)


@compiled
def _watch_bounces(structure, motion, memory):
    """Count the steps in which a journal keeps hitting opposite walls within a step or two."""
    r = memory.record[0]
    contacts = structure.contacts
    n = structure.M.shape[0]
    bounce = memory.bounce
    for j in range(len(contacts)):
        bounce[j, 2] += 1.0
        bounce[j, 3] = max(0.0, bounce[j, 3] - 1.0)
        if motion.force[j] != 0.0:
            d = motion.q[contacts[j].dof] - motion.q[n + j]
            e = d / abs(d)
            is_opposite = e.real * bounce[j, 0] + e.imag * bounce[j, 1] < -0.5
            if is_opposite and bounce[j, 2] <= CROSSING_STEPS:
                bounce[j, 3] = min(2.0 * TRAPPED_SCORE, bounce[j, 3] + CROSSING_SCORE)
            bounce[j, 0] = e.real
            bounce[j, 1] = e.imag
            bounce[j, 2] = 0.0
        if bounce[j, 3] >= TRAPPED_SCORE:
            r.trapped += 1
            if math.isnan(r.trapped_at):
                r.trapped_at = r.t


@compiled
def _commit(h, loads, structure, motion, trial, memory, work, spin):
    """Make the trial state the present one and do the bookkeeping of an accepted step."""
    r = memory.record[0]
    for i in range(len(motion.q)):
        motion.q[i] = trial.q[i]
        motion.v[i] = trial.v[i]
        motion.a[i] = trial.a[i]
        motion.v_dot[i] = trial.v_dot[i]
        motion.jerk[i] = trial.jerk[i]
    for j in range(len(motion.force)):
        motion.force[j] = trial.force[j]
    r.steps += 1
    r.h_last = h
    r.omega = spin.omega
    r.theta = spin.theta
    for i in range(len(memory.power)):
        memory.work[i] += 0.5 * h * memory.power[i]
    r.torque = powers(structure, spin, loads, motion, memory.power)
    for i in range(len(memory.power)):
        memory.work[i] += 0.5 * h * memory.power[i]
    _watch_amplitudes(structure, motion, memory)
    _watch_bounces(structure, motion, memory)


@compiled
def begin_interval(structure, speed, rate, loads, is_start, motion, memory, work):
    """Take up the speed [rad/s], its rate [rad/s2] and the loads [N] of a new interval.

    Carries accelerations and powers over the jump; at the start the accelerations are
    those of the equation of motion. A jump of the speed is work that the drive does in no time.
    """
    r = memory.record[0]
    before = total_energy(structure, spin_now(memory.record), motion, work.stores)
    r.t_ref = r.t
    r.theta_ref = r.theta
    r.omega = speed
    r.omega_ref = speed
    r.alpha = rate
    spin = spin_now(memory.record)
    after = total_energy(structure, spin, motion, work.stores)
    if is_start:
        r.energy_at_start = after
    else:
        memory.work[0] += after - before
    for i in range(len(motion.a)):
        motion.a[i] -= motion.v_dot[i]
    accelerate(structure, spin, loads, motion, work)
    for i in range(len(motion.a)):
        motion.a[i] = motion.v_dot[i] + (0.0 if is_start else motion.a[i])
    r.torque = powers(structure, spin, loads, motion, memory.power)


@compiled
def _error(structure, control, spin, h, is_first, motion, trial):
    """Error of a trial step in the terms of the mode; above control.eps_max it is repeated."""
    if control.mode == ADAPTIVE:
        return error_indicator(control, h, is_first, motion, trial)
    if control.mode == CONTROLLED:
        return local_error(structure, control, spin.omega, h, motion, trial)
    return 0.0


@compiled
def _shorter(structure, control, h, error, status, motion, trial):
    """Length to repeat a step with [s]."""
    if status != DONE:
        shorter = 0.5 * h
    elif control.mode == CONTROLLED:
        shorter = repeated_length(structure, h, error, motion, trial)
    else:
        shorter = shorter_step(control, h, error)
    return max(control.h_min, shorter)


@compiled
def _next(control, wished, h, error, error_before, was_rejected):
    """Wished length of the next step [s], after one of length h that a communication point may have
    cut shorter than was wished."""
    if control.mode == ADAPTIVE:
        return next_step(control, wished, h, error)
    if control.mode == CONTROLLED:
        longest = h if was_rejected else control.h_max
        proposed = max(control.h_min, min(longest, next_length(h, error, error_before)))
        return proposed if h > CUT * wished else max(wished, proposed)
    return wished


@compiled
def _march(structure, scheme, control, t_end, loads, motion, trial, memory, work):
    """The loop over steps, cut to equal parts of what remains so that none is a sliver."""
    r = memory.record[0]
    memory.peaks[2, :, :] = 0.0
    varies = control.mode != FIXED
    shortest = control.h_min * (1.0 + 1e-5)
    parts = max(1.0, math.ceil((t_end - r.t) / r.h - 1e-6)) if t_end > r.t else 0.0
    while parts >= 1.0:
        h = (t_end - r.t) / parts
        wished = r.h
        was_rejected = False
        while True:
            t = t_end if parts == 1.0 else r.t + h
            spin = spin_at(memory.record, t)
            status, iterations = try_step(structure, scheme, spin, h, loads, motion, trial, work)
            r.newton += iterations
            error = 0.0
            if status == DONE:
                error = _error(structure, control, spin, h, r.steps == 0, motion, trial)
                if not varies or error <= control.eps_max or h <= shortest:
                    break
            elif not varies or h <= shortest:
                r.failed_at = r.t
                r.failed_h = h
                return status
            r.rejected += 1
            was_rejected = True
            wished = _shorter(structure, control, h, error, status, motion, trial)
            parts = max(1.0, math.ceil((t_end - r.t) / wished - 1e-6))
            h = (t_end - r.t) / parts
        r.t = t
        r.h = _next(control, wished, h, error, r.error, was_rejected)
        r.error = error
        r.h_smallest = wished if r.h_smallest == 0.0 else min(r.h_smallest, wished)
        r.h_largest = max(r.h_largest, wished)
        _commit(h, loads, structure, motion, trial, memory, work, spin)
        parts = parts - 1.0
        if varies and parts >= 1.0:
            parts = max(1.0, math.ceil((t_end - r.t) / r.h - 1e-6))
    return DONE


@compiled
def advance(structure, scheme, control, t_end, speed, loads, motion, trial, memory, work):
    """March to t_end [s]; returns DONE or why not.

    speed: now [rad/s], continued linearly from the last two given, or held; loads: constant until
    t_end, shape (bodies,) [N]. On failure the state is that after the last accepted step.
    """
    r = memory.record[0]
    since = r.t - r.t_ref
    if r.continues == 0:
        rate = 0.0
    elif since > 0.0:
        rate = (speed - r.omega_ref) / since
    else:
        rate = r.alpha
    begin_interval(structure, speed, rate, loads, False, motion, memory, work)
    return _march(structure, scheme, control, t_end, loads, motion, trial, memory, work)
