"""The loop over steps from one communication point to the next, compiled.

Chooses each step's length, repeats rejected steps, and updates after every step the energy
ledger, the amplitudes, and the monitors for the false wall-to-wall state and for damping by the
integrator.
"""

from __future__ import annotations

import math

from ..kernels.functions import direction
from ..kernels.jit import jit, jit_inlined
from ..step.fitting import characteristic_frequency_after, fitted, unfitted
from ..step.step import DONE, NOT_CONVERGED, accelerate, try_step
from .control import CONTROLLED, FIXED, propose_step, retry_step, step_error
from .energy import FLOW, powers, total_energy
from .error_control import NOTHING, local_error, measure, steady_length, update_size
from .memory import PEAK, move_loads, spin_at, spin_now, take_loads
from .monitors import (
    monitor_errors,
    monitor_step,
    monitor_work,
    open_window,
)
from .recorder import is_due, write
from .stage_loop import add_stage_work, pass_stages, record_stages, stage_error, turn_in_stages

# What becomes of an advance: as of a step, or UNFINISHED, after `max_iterations` of the interfaces'
# problem, a step counting for one at least.
UNFINISHED = 3
# A free rotor's rate is found by repeating the step, once at least, until the speed agrees to
# SPIN_TOLERANCE, above the noise that the contact problem's own tolerance leaves.
SPIN_ITERATIONS, SPIN_TOLERANCE = 12, 1e-9


@jit_inlined
def _commit(h, structure, control, motion, trial, memory, work, stages, spin, torque):
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
    for i in range(len(motion.internal_state)):
        motion.internal_state[i] = trial.internal_state[i]
        motion.internal_rate_carried[i] = trial.internal_rate_carried[i]
        motion.internal_rate[i] = trial.internal_rate[i]
    r.steps += 1
    r.h_last = h
    if control.stages > 0:
        pass_stages(structure, h, motion, trial, memory, stages)
    r.omega = spin.omega
    r.theta = spin.theta
    r.alpha = spin.alpha
    r.torque = torque
    if control.stages > 0:
        add_stage_work(h, memory, stages)
    else:
        for i in range(len(memory.power)):
            memory.work[i] += 0.5 * h * (memory.power[i] + work.powers[i])
            memory.power[i] = work.powers[i]
    monitor_step(structure, control, spin, motion, memory, work)


@jit
def begin_interval(structure, drive, rate, is_start, motion, memory, work):
    """Take up what drives the rotor and the loads [N] of a new interval: the speed [rad/s] and its
    rate [rad/s2], or the torque on a free rotor [N.m] and its rate [N.m/s]; those of the loads are
    memory.load_rates.

    Carries accelerations and powers over the jump; at the start the accelerations are
    those of the equation of motion. A jump of the speed is work that the drive does in no time.
    """
    r = memory.record[0]
    loads = memory.loads
    before = total_energy(structure, spin_now(memory.record), motion, work.stores)
    r.t_ref = r.t
    r.theta_ref = r.theta
    take_loads(memory, drive, rate)
    if r.is_free == 0:
        r.omega = drive
        r.omega_ref = drive
        r.alpha = rate
    after = total_energy(structure, spin_now(memory.record), motion, work.stores)
    if is_start:
        r.energy_at_start = after
        open_window(structure, memory)
    else:
        memory.work[FLOW.drive] += after - before
    for i in range(len(motion.a)):
        motion.a[i] -= motion.v_dot[i]
    for i in range(len(motion.internal_state)):
        motion.internal_rate_carried[i] -= motion.internal_rate[i]
    for _ in range(SPIN_ITERATIONS):
        spin = spin_now(memory.record)
        accelerate(structure, spin, r.damping, loads, motion, work)
        r.torque = powers(structure, spin, loads, motion, work.losses, memory.power)
        change = _imbalance(structure, memory.record, r.torque)
        if abs(change) <= SPIN_TOLERANCE * (1.0 + abs(r.alpha)):
            break
        r.alpha += change
    for i in range(len(motion.a)):
        motion.a[i] = motion.v_dot[i] + (0.0 if is_start else motion.a[i])
    for i in range(len(motion.internal_state)):
        motion.internal_rate_carried[i] = motion.internal_rate[i] + (
            0.0 if is_start else motion.internal_rate_carried[i]
        )


@jit
def _imbalance(structure, record, torque):
    """Return the change of a free rotor's rate [rad/s2] that makes its drive `torque`; of another
    rotor not at all."""
    r = record[0]
    return (r.drive - torque) / structure.numbers[0].inertia if r.is_free == 1 else 0.0


@jit_inlined
def _turn(structure, scheme, control, t, h, loads, motion, trial, memory, work, problem):
    """Take a step to time t [s] with the rotation that goes with it: prescribed, or such that a
    free rotor's torques balance at its end. Fills work.powers.

    Returns the status, the Newton iterations, what the scheme was fitted with, the rotation, and
    the drive's torque [N.m].
    """
    r = memory.record[0]
    move_loads(memory, t)
    spin = spin_at(memory.record, t, r.alpha)
    status, total, torque = NOT_CONVERGED, 0, 0.0
    fit = unfitted()
    for correction in range(SPIN_ITERATIONS):
        if control.is_fitted and control.h_in_the_open == math.inf:
            fit = fitted(scheme, math.sqrt(r.characteristic_frequency_squared) * h)
        status, iterations = try_step(
            structure, scheme, fit, spin, h, loads, motion, trial, work, problem
        )
        total += iterations
        if status != DONE:
            break
        torque = powers(structure, spin, loads, trial, work.losses, work.powers)
        change = _imbalance(structure, memory.record, torque)
        is_small = 0.5 * h * abs(change) <= SPIN_TOLERANCE * (1.0 + abs(spin.omega))
        if r.is_free == 0 or (is_small and correction > 0):
            break
        spin = spin_at(memory.record, t, spin.alpha + change)
        status = NOT_CONVERGED
    return status, total, fit, spin, torque


@jit
def _rescale(record, h, motion):
    """Make the accelerations that generalized-alpha carries along those of steps of length h [s].

    They belong to an instant (alpha_m - alpha_f) h away: left as they were, a step would be of
    first order in the change of h.
    """
    r = record[0]
    if r.h_carried > 0.0 and h != r.h_carried:
        ratio = h / r.h_carried
        for i in range(len(motion.a)):
            motion.a[i] = motion.v_dot[i] + ratio * (motion.a[i] - motion.v_dot[i])
        for i in range(len(motion.internal_state)):
            change = motion.internal_rate_carried[i] - motion.internal_rate[i]
            motion.internal_rate_carried[i] = motion.internal_rate[i] + ratio * change
    r.h_carried = h


@jit_inlined
def _time_loop(
    structure,
    scheme,
    control,
    t_end,
    motion,
    trial,
    memory,
    work,
    problem,
    stages,
    reading,
    recorder,
):
    """Return the loop over steps, cut to equal parts of what remains so that none is a sliver."""
    r = memory.record[0]
    loads = memory.loads
    memory.peaks[PEAK.since_communication, :, :] = 0.0
    varies = control.mode != FIXED
    shortest = control.h_min * (1.0 + 1e-5)
    # of a machine that is unstable with its contacts open
    is_steady = control.mode == CONTROLLED and control.h_in_the_open < math.inf
    if is_steady:
        r.h = min(r.h, max(control.h_min, control.h_in_the_open))
    taken = 0
    parts = max(1.0, math.ceil((t_end - r.t) / r.h - 1e-6)) if t_end > r.t else 0.0
    while parts >= 1.0:
        h = (t_end - r.t) / parts
        proposed = r.h
        was_rejected = False
        measures, local = NOTHING, 0.0
        while True:
            if varies:
                monitor_work(structure, memory)
            if taken >= r.max_iterations:
                r.failed_at = r.t
                r.failed_h = h
                return UNFINISHED
            t = t_end if parts == 1.0 else r.t + h
            if control.mode == CONTROLLED:
                _rescale(memory.record, h, motion)
            fit = unfitted()
            if control.stages > 0:
                status, iterations, spin, torque = turn_in_stages(
                    structure,
                    control,
                    t,
                    h,
                    motion,
                    trial,
                    memory,
                    work,
                    stages,
                    SPIN_ITERATIONS,
                    SPIN_TOLERANCE,
                )
            else:
                status, iterations, fit, spin, torque = _turn(
                    structure, scheme, control, t, h, loads, motion, trial, memory, work, problem
                )
            r.newton += iterations
            taken += max(1, iterations)
            error = 0.0
            if status == DONE:
                frequency = math.copysign(math.sqrt(r.characteristic_frequency_squared), spin.omega)
                measures = measure(structure.weights, direction(frequency * h), motion, trial)
                size = r.motion_size
                if control.stages > 0:
                    local = stage_error(structure, control, size, frequency, h, motion, stages)
                else:
                    local = local_error(structure, control, size, frequency, h, measures)
                error = step_error(structure, control, local, h, r.steps == 0, motion, trial)
                if not varies or error <= control.eps_max:
                    break
                if h <= shortest:
                    if control.mode == CONTROLLED and math.isnan(r.coarse_at):
                        r.coarse_at = r.t
                    break
            elif not varies or h <= shortest:
                r.failed_at = r.t
                r.failed_h = h
                return status
            r.rejected += 1
            was_rejected = True
            proposed = retry_step(structure, control, h, error, status == DONE, motion, trial)
            parts = max(1.0, math.ceil((t_end - r.t) / proposed - 1e-6))
            h = (t_end - r.t) / parts
        r.characteristic_frequency_squared = characteristic_frequency_after(
            structure, spin.omega, h, measures, r.characteristic_frequency_squared
        )
        monitor_errors(structure, control, local, spin, motion, trial, memory)
        update_size(structure, spin.omega, h, trial, memory)
        r.t = t
        r.h_carried = h
        r.damping = fit.damping
        if is_steady and r.error_touched == 0 and not was_rejected:
            r.h = steady_length(structure, control, spin.omega, proposed, h, error, memory)
        else:
            r.h = propose_step(control, proposed, h, error, r.error, was_rejected)
        r.error = error
        r.h_smallest = proposed if r.h_smallest == 0.0 else min(r.h_smallest, proposed)
        r.h_largest = max(r.h_largest, proposed)
        _commit(h, structure, control, motion, trial, memory, work, stages, spin, torque)
        if len(recorder.rows) > 0:
            if control.stages > 0:
                record_stages(
                    structure,
                    h,
                    motion,
                    trial,
                    memory,
                    work,
                    stages,
                    recorder,
                    reading.observed,
                )
            elif is_due(structure, memory.record, recorder.head):
                write(structure, motion, memory, work, recorder, reading.observed)
        parts = parts - 1.0
        if varies and parts >= 1.0:
            parts = max(1.0, math.ceil((t_end - r.t) / r.h - 1e-6))
    return DONE


@jit
def continued_rate(record, drive):
    """Return the rate [rad/s2] at which a speed goes on that is `drive` [rad/s] now: that between
    the last two given, or 0 where it is held; 0 of a torque too."""
    r = record[0]
    since = r.t - r.t_ref
    if r.is_free == 1 or r.continues == 0:
        return 0.0
    return (drive - r.omega_ref) / since if since > 0.0 else r.alpha


@jit_inlined
def advance(
    structure,
    scheme,
    control,
    t_end,
    drive,
    rate,
    motion,
    trial,
    memory,
    work,
    problem,
    stages,
    reading,
    recorder,
):
    """Advance to t_end [s]; returns DONE or why not.

    drive: the speed now [rad/s], of a free rotor the torque [N.m]; rate: of either [rad/s2, N.m/s];
    memory.loads: now [N], with memory.load_rates [N/s]. All are linear in time until t_end.
    On failure the state is that after the last accepted step.
    """
    begin_interval(structure, drive, rate, False, motion, memory, work)
    status = _time_loop(
        structure,
        scheme,
        control,
        t_end,
        motion,
        trial,
        memory,
        work,
        problem,
        stages,
        reading,
        recorder,
    )
    if status != DONE:
        move_loads(memory, memory.record[0].t)
    return status
