"""The loop over steps from one communication point to the next, compiled.

Chooses each step's length, repeats rejected steps, and updates after every step the energy
ledger, the amplitudes, and the monitors for the false wall-to-wall state and for damping by the
integrator.
"""

import math
from typing import NamedTuple

from ..kernels.functions import copy, direction
from ..kernels.jit import jit, jit_inlined
from ..step.excitation import Spin
from ..step.fitting import Fit, characteristic_frequency_after, unfitted
from ..step.step import rescale_carried
from ..step.step_status import DONE, ENDED_EARLY, UNFINISHED
from .communication_interval import begin_interval
from .control import keeps_tolerance, propose_step, retry_step, step_error, varies
from .early_return import CLOSED, GOES_ON, early_return_cause, is_watched
from .energy import has_power, port_power
from .error_control import NOTHING, Measures, local_error, measure, steady_length, update_size
from .memory import PEAK, move_loads, spin_now
from .monitors import monitor_errors, monitor_step, monitor_work
from .recorder import is_due, write
from .sensitivities import begin_tangents, propagate
from .stage_loop import (
    HARD,
    add_stage_work,
    record_stages,
    stage_error,
    step_in_stages_with_rotation,
    update_monitors_within_step,
)
from .step_with_rotation import step_with_rotation

_ROUNDING = 4.0 * 2.0**-52  # share of the host's time
_MOST = 1e15  # steps of an interval: a larger number would not be exact
# Share of the proposed length: steps that communication points cut shorter change accelerations by
# no more than their rounding, which longer steps after them would magnify.
_SLIVER = 1e-2


@jit
def _keep_carried(motion, trial):
    """Carry accelerations that differ from those at a step's end as much as at its beginning."""
    for i in range(len(motion.a)):
        trial.a[i] = trial.v_dot[i] + (motion.a[i] - motion.v_dot[i])
    for i in range(len(motion.internal_state)):
        change = motion.internal_rate_carried[i] - motion.internal_rate[i]
        trial.internal_rate_carried[i] = trial.internal_rate[i] + change


@jit_inlined
def _commit(run, control, h, spin, torque):
    """Make the trial state the present one and do the bookkeeping of an accepted step."""
    structure, motion, trial, memory = run.structure, run.motion, run.trial, run.memory
    work, r = run.work, memory.record[0]
    copy(trial.q, motion.q)
    copy(trial.v, motion.v)
    copy(trial.a, motion.a)
    copy(trial.v_dot, motion.v_dot)
    copy(trial.jerk, motion.jerk)
    copy(trial.force, motion.force)
    copy(trial.internal_state, motion.internal_state)
    copy(trial.internal_rate_carried, motion.internal_rate_carried)
    copy(trial.internal_rate, motion.internal_rate)
    r.steps += 1
    r.h_last = h
    if control.stages > 0:
        update_monitors_within_step(structure, h, motion, trial, memory, run.stages)
    r.omega = spin.omega
    r.theta = spin.theta
    r.alpha = spin.alpha
    r.torque = torque
    if control.stages > 0:
        add_stage_work(h, memory, run.stages)
    else:
        for i in range(len(memory.power)):
            memory.work[i] += 0.5 * h * (memory.power[i] + work.powers[i])
            memory.power[i] = work.powers[i]
    for i in range(len(memory.loads)):
        if has_power(structure, i, memory.loads[i]) or memory.load_power[i] != 0.0:
            power = port_power(structure, spin, i, memory.loads[i], motion.v)
            memory.load_work[i] += 0.5 * h * (memory.load_power[i] + power)
            memory.load_power[i] = power
    monitor_step(structure, control, spin, motion, memory, work)


@jit
def _rescale(record, h, motion):
    """Rescale the accelerations carried by generalized-alpha to steps of length h [s].

    They belong to an instant (alpha_m - alpha_f) h away: unchanged, a step would be of first order
    in the change of h.
    """
    r = record[0]
    if r.h_carried > 0.0 and h != r.h_carried:
        rescale_carried(motion, h / r.h_carried)
    r.h_carried = h


class Attempt(NamedTuple):
    """A step that was tried: its status, its Newton iterations, the most of them for one rotation,
    the fit of the scheme, the rotation, the drive's torque [N.m], and, if it is done, the measures
    of its local error, that error, and the error in the measure of the mode."""

    status: int
    iterations: int
    hardest: int
    fit: Fit
    spin: Spin
    torque: float
    measures: Measures
    local: float
    error: float


@jit_inlined
def _attempt(run, scheme, control, t, h):
    """Take a step to time t [s], and judge it."""
    structure, motion, trial, memory = run.structure, run.motion, run.trial, run.memory
    r = memory.record[0]
    fit = unfitted()
    if control.stages > 0:
        status, iterations, hardest, spin, torque = step_in_stages_with_rotation(
            structure, control, t, h, motion, trial, memory, run.work, run.stages
        )
    else:
        status, iterations, fit, spin, torque = step_with_rotation(
            structure, scheme, control, t, h, motion, trial, memory, run.work, run.problem
        )
        hardest = iterations
    measures, local, error = NOTHING, 0.0, 0.0
    if status == DONE:
        frequency = math.copysign(math.sqrt(r.characteristic_frequency_squared), spin.omega)
        measures = measure(structure.weights, direction(frequency * h), motion, trial)
        size = r.motion_size
        if control.stages > 0:
            local = stage_error(structure, control, size, frequency, h, motion, run.stages)
        else:
            local = local_error(structure, control, size, frequency, h, measures)
        error = step_error(structure, control, local, h, r.steps == 0, motion, trial)
    return Attempt(status, iterations, hardest, fit, spin, torque, measures, local, error)


@jit
def _parts(r, t_end, h):
    """Return the number of equal steps, of about h [s], into which the time until t_end [s] is
    divided, so that the last one is not tiny, also where the host's time is so late that its
    rounding is a part of h."""
    rounding = _ROUNDING * (abs(r.t_of_host) + abs(t_end)) / h
    return max(1.0, math.ceil(min(_MOST, (t_end - r.t) / h - min(0.1, max(1e-6, rounding)))))


@jit_inlined
def _record(run, control, h):
    """Let the recorder write a row if one is due."""
    structure, motion, memory = run.structure, run.motion, run.memory
    recorder, observed = run.recorder, run.outputs.observed
    if len(recorder.rows) == 0:
        return
    if control.stages > 0:
        record_stages(
            structure, h, motion, run.trial, memory, run.work, run.stages, recorder, observed
        )
    elif is_due(structure, memory.record, recorder.head):
        write(structure, motion, memory, run.work, recorder, observed)


@jit_inlined
def _accepted_step(run, scheme, control, t_end, parts, taken):
    """Take one of `parts` steps until t_end [s], repeated until accepted, after `taken` iterations.

    Return both numbers now, end [s], length [s] and proposed length [s] of the step, whether it was
    repeated, and the last `Attempt`; a status other than DONE is that of a failure.
    """
    structure, motion, memory = run.structure, run.motion, run.memory
    r = memory.record[0]
    is_varied = varies(control.mode)
    shortest = control.h_min * (1.0 + 1e-5)
    h, t, proposed, was_rejected = (t_end - r.t) / parts, r.t, r.h, False
    spin = spin_now(memory.record)
    none = Attempt(UNFINISHED, 0, 0, unfitted(), spin, 0.0, NOTHING, 0.0, 0.0)
    while True:
        if is_varied:
            monitor_work(structure, memory)
        if taken >= r.max_iterations:
            step = none
            break
        t = t_end if parts == 1.0 else r.t + h
        if keeps_tolerance(control.mode):
            _rescale(memory.record, h, motion)
        step = _attempt(run, scheme, control, t, h)
        r.newton += step.iterations
        taken += max(1, step.iterations)
        is_done = step.status == DONE
        if is_done:
            if not is_varied or step.error <= control.eps_max:
                break
            if h <= shortest:
                if keeps_tolerance(control.mode) and math.isnan(r.coarse_at):
                    r.coarse_at = r.t
                break
        elif not is_varied or h <= shortest:
            break
        r.rejected += 1
        was_rejected = True
        proposed = retry_step(structure, control, h, step.error, is_done, motion, run.trial)
        parts = _parts(r, t_end, proposed)
        h = (t_end - r.t) / parts
    return parts, taken, t, h, proposed, was_rejected, step


@jit_inlined
def _propose_next(run, control, is_steady, is_sliver, step, proposed, h, was_rejected):
    """Choose the length of the next step, and update the records of lengths and errors."""
    memory = run.memory
    r = memory.record[0]
    error = step.error
    if is_steady and r.error_touched == 0 and not was_rejected:
        r.h = steady_length(run.structure, control, step.spin.omega, proposed, h, error, memory)
    else:
        is_hard = control.stages > 0 and step.hardest > HARD
        r.h = propose_step(control, proposed, h, error, r.error, was_rejected or is_hard)
    if not is_sliver:
        r.error = error
        r.carried_since = r.t
    r.residual = max(r.residual, run.problem.residual[0])
    r.h_smallest = proposed if r.h_smallest == 0.0 else min(r.h_smallest, proposed)
    r.h_largest = max(r.h_largest, proposed)


@jit_inlined
def _time_loop(run, scheme, control, tangents, t_end):
    """Take steps until t_end [s]; return DONE or why not."""
    structure, motion, trial, memory = run.structure, run.motion, run.trial, run.memory
    r = memory.record[0]
    memory.peaks[PEAK.since_communication, :, :] = 0.0
    memory.wall_peaks[PEAK.since_communication, :] = 0.0
    # of a machine that is unstable with its contacts open
    is_steady = keeps_tolerance(control.mode) and control.h_in_the_open < math.inf
    if is_steady:
        r.h = min(r.h, max(control.h_min, control.h_in_the_open))
    taken = 0
    parts = _parts(r, t_end, r.h) if t_end > r.t else 0.0
    while parts >= 1.0:
        h_before = r.h_carried
        parts, taken, t, h, proposed, was_rejected, step = _accepted_step(
            run, scheme, control, t_end, parts, taken
        )
        if step.status != DONE:
            r.failed_at = r.t
            r.failed_h = h
            return step.status
        fit, spin = step.fit, step.spin
        ends = early_return_cause(structure, motion, trial, r) if is_watched(r) else GOES_ON
        if GOES_ON < ends < CLOSED:
            r.failed_at = r.t
            return ENDED_EARLY + ends
        if r.has_sensitivities == 1:
            ratio = h / h_before if keeps_tolerance(control.mode) and h_before > 0.0 else 1.0
            propagate(
                *(structure, scheme, fit, spin, h, ratio, t),
                *(trial, memory, run.work, run.problem, tangents),
            )
        r.characteristic_frequency_squared = characteristic_frequency_after(
            structure, spin.omega, h, step.measures, r.characteristic_frequency_squared
        )
        monitor_errors(structure, control, step.local, spin, motion, trial, memory)
        update_size(structure, spin.omega, h, trial, memory)
        r.t = t
        r.h_carried = h
        r.damping = fit.damping
        is_sliver = keeps_tolerance(control.mode) and t - r.carried_since < _SLIVER * proposed
        _propose_next(run, control, is_steady, is_sliver, step, proposed, h, was_rejected)
        if is_sliver:
            _keep_carried(motion, trial)
        _commit(run, control, h, spin, step.torque)
        _record(run, control, h)
        parts = parts - 1.0
        if ends >= CLOSED and parts >= 1.0:
            r.failed_at = r.t
            return ENDED_EARLY + ends
        if varies(control.mode) and parts >= 1.0:
            parts = _parts(r, t_end, r.h)
    return DONE


@jit_inlined
def advance(run, scheme, control, tangents, t_end, drive, rate, d_rate):
    """Advance to t_end [s]; return DONE or why not.

    drive: the speed now [rad/s], of a free rotor the torque [N.m]; rate: of either [rad/s2, N.m/s];
    d_rate: its derivative with respect to the speed [1/s]; memory.loads: now [N], with
    memory.load_rates [N/s]. All are linear in time until t_end. On failure the state is that after
    the last accepted step.
    """
    structure, motion, memory, work = run.structure, run.motion, run.memory, run.work
    begin_interval(structure, drive, rate, False, motion, memory, work)
    if memory.record[0].has_sensitivities == 1:
        begin_tangents(structure, spin_now(memory.record), d_rate, motion, memory, work, tangents)
    status = _time_loop(run, scheme, control, tangents, t_end)
    if status != DONE:
        move_loads(memory, memory.record[0].t)
    return status
