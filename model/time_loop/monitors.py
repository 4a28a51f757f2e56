"""The monitors, which run after every step: the probes' amplitudes and 1x components, the false
wall-to-wall state, damping by the integrator that exceeds the machine's own, and the iterations of
a cycle."""

import math

from ..kernels.functions import scaled
from ..kernels.jit import jit
from ..step.excitation import at_place
from ..step.laws import relative, squared_normal_force
from ..structure.ledger import FLOWS, INFLOWS
from ..warnings import COARSEST_IN_CONTACT, SLOW
from .control import REALTIME, keeps_tolerance
from .energy import total_energy
from .memory import AXIS, BOUNCE, ONCE, PEAK, SENSE, spin_now

# A journal that crosses its whole clearance in at most CROSSING_STEPS steps again and again is in
# the integrator's limit cycle, not in the machine's motion: a crossing scores CROSSING_SCORE, any
# step takes one away, and at TRAPPED_SCORE (some twenty crossings) the state is called false.
CROSSING_STEPS = 2
CROSSING_SCORE = 3.0
TRAPPED_SCORE = 60.0
# The energy ledger is evaluated after this number of cycles of the rotation or of the lowest mode,
# whichever is faster. Sliding friction of the rotor takes its energy from the drive, not from the
# whirl: the integrator's loss is compared with all others, if it exceeds the ledger's rounding. In
# steps longer than COARSE [rad] of the rotation the quadrature of the ledger has errors as large.
WINDOW_CYCLES = 10.0
LEAST_LOSS = 3e-4
MEMORY = 0.8  # share of a window's sums that the next one keeps
COARSE = 0.5
# About the root mean square of the errors that error control with COARSEST_IN_CONTACT keeps to. A
# coarser revolution with a touch means as much as a coarser step in which a contact closes.
COARSEST_RMS = 0.02
TURN = 2.0 * math.pi
# Speed below which a shaft stands [rad/s]: a revolution takes a thousand seconds.
STANDSTILL = TURN / 1000.0
_FRICTION = FLOWS.index("friction")
_LOSSES = len(INFLOWS)


@jit
def monitor_step(structure, control, spin, motion, memory, work):
    """Run the monitors that look at one accepted step."""
    monitor_revolution(structure, spin, motion, memory)
    monitor_walls(structure, motion, memory)
    monitor_losses(structure, control, motion, memory, work)


@jit
def monitor_revolution(structure, spin, motion, memory):
    """Update, for each probe, the largest displacements over the last whole revolution and the
    present one, and the forward and backward 1x components over the last whole revolution. If the
    shaft stands still or turns back, both revolutions begin anew, for `monitor_walls` too."""
    r = memory.record[0]
    peaks, walls, once = memory.peaks, memory.wall_peaks, memory.once
    past = spin.theta - r.turn
    if abs(spin.omega) < STANDSTILL or (past - r.swept) * r.swept < 0.0:
        r.turn = spin.theta
        r.swept = 0.0
        past = 0.0
        peaks[: PEAK.since_communication, :, :] = 0.0
        walls[: PEAK.since_communication, :] = 0.0
        once[ONCE.integral :, :, :] = 0.0
    by_step = abs(past - r.swept)
    is_whole = abs(past) >= TURN
    until_end = (TURN - abs(r.swept)) / by_step if is_whole else 1.0
    r.swept = past
    if is_whole:
        r.turn += math.copysign(TURN, past)
        r.swept = past - math.copysign(TURN, past)
        if abs(r.swept) >= TURN:  # steps longer than a revolution cannot be judged
            r.turn = spin.theta
            r.swept = 0.0
            until_end = 0.0
    for i in range(len(structure.probes)):
        displacement = at_place(structure.probes[i], motion.q) - memory.rest[i]
        turned = (displacement * spin.direction.conjugate(), displacement * spin.direction)
        for sense in range(len(SENSE)):
            last, now = once[ONCE.now, sense, i], turned[sense]
            # at the end of the revolution, as if it were linear over the step
            end = last + scaled(until_end, now - last)
            once[ONCE.integral, sense, i] += scaled(0.5 * until_end * by_step, last + end)
            if is_whole:
                # by the angle turned, so that a lag is negative whichever way the shaft turns
                ahead = sense if past > 0.0 else 1 - sense
                once[ONCE.mean, ahead, i] = once[ONCE.integral, sense, i] * (1.0 / TURN)
                once[ONCE.integral, sense, i] = 0.5 * abs(r.swept) * (end + now)
            once[ONCE.now, sense, i] = now
        x, y = abs(displacement.real), abs(displacement.imag)
        size = (x, y, x * x + y * y)
        for axis in range(len(AXIS)):
            if is_whole:
                peaks[PEAK.last_revolution, axis, i] = peaks[PEAK.this_revolution, axis, i]
                peaks[PEAK.this_revolution, axis, i] = 0.0
            for span in (PEAK.this_revolution, PEAK.since_communication):
                peaks[span, axis, i] = max(peaks[span, axis, i], size[axis])
    for j in range(walls.shape[1] if is_whole else 0):
        walls[PEAK.last_revolution, j] = walls[PEAK.this_revolution, j]
        walls[PEAK.this_revolution, j] = 0.0


@jit
def monitor_errors(structure, control, local, spin, old, new, memory):
    """Record the local errors of the last revolution, after a step from `old` to `new` with the
    error `local`, in tolerances; check whether a contact closed in a step too coarse to resolve
    what follows."""
    r = memory.record[0]
    by_step = abs(spin.theta - r.theta)
    r.error_largest = max(r.error_largest, local)
    r.error_swept += by_step
    r.error_square += by_step * local * local
    has_closed = False
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].has_wall == 1 and new.force[j] != 0.0:
            r.error_touched = 1
            has_closed = has_closed or old.force[j] == 0.0
    is_bound = keeps_tolerance(control.mode) and control.tolerance <= COARSEST_IN_CONTACT
    is_coarse = has_closed and local * control.tolerance > COARSEST_IN_CONTACT and not is_bound
    if r.error_swept >= TURN:
        r.error_rms = math.sqrt(r.error_square / r.error_swept)
        rms = r.error_rms * control.tolerance
        is_coarse |= r.error_touched == 1 and rms > COARSEST_RMS and not is_bound
        r.error_largest_before = r.error_largest
        r.error_largest, r.error_swept, r.error_square = 0.0, 0.0, 0.0
        r.error_touched = 0
    if is_coarse and math.isnan(r.blind_at):
        r.blind_at = r.t


@jit
def monitor_walls(structure, motion, memory):
    """Update the largest normal forces of the walls over the present revolution, and count the
    steps in which a journal keeps hitting opposite walls within a step or two."""
    r = memory.record[0]
    interfaces = structure.interfaces
    bounce, peaks = memory.bounce, memory.wall_peaks
    for j in range(len(interfaces)):
        if interfaces[j].has_wall == 0:
            continue
        bounce[j, BOUNCE.steps] += 1.0
        bounce[j, BOUNCE.score] = max(0.0, bounce[j, BOUNCE.score] - 1.0)
        if motion.force[j] != 0.0:
            d = relative(interfaces[j], motion.q)
            squared = squared_normal_force(d, motion.force[j])
            for span in (PEAK.this_revolution, PEAK.since_communication):
                peaks[span, j] = max(peaks[span, j], squared)
            x, y = bounce[j, BOUNCE.x], bounce[j, BOUNCE.y]
            along = d.real * x + d.imag * y
            size = (d.real * d.real + d.imag * d.imag) * (x * x + y * y)
            is_opposite = along < 0.0 and along * along > 0.25 * size  # by more than 120 degrees
            if is_opposite and bounce[j, BOUNCE.steps] <= CROSSING_STEPS:
                bounce[j, BOUNCE.score] = min(
                    2.0 * TRAPPED_SCORE, bounce[j, BOUNCE.score] + CROSSING_SCORE
                )
            bounce[j, BOUNCE.x] = d.real
            bounce[j, BOUNCE.y] = d.imag
            bounce[j, BOUNCE.steps] = 0.0
        if bounce[j, BOUNCE.score] >= TRAPPED_SCORE:
            r.trapped += 1
            if math.isnan(r.trapped_at):
                r.trapped_at = r.t


@jit
def monitor_work(structure, memory):
    """Count the iterations of the present cycle, and record when they became too many."""
    r = memory.record[0]
    if r.t >= r.cycle_end:
        fastest = max(abs(r.omega), structure.numbers[0].lowest_omega)
        r.cycle_end = r.t + 2.0 * math.pi / fastest
        r.cycle_newton = r.newton
    taken = r.newton - r.cycle_newton
    if taken > SLOW and math.isnan(r.slow_at):
        r.slow_at = r.t


@jit
def open_window(structure, memory):
    """Begin a window of `monitor_losses` at the present time."""
    r = memory.record[0]
    fastest = max(abs(r.omega), structure.numbers[0].lowest_omega)
    r.window_end = r.t + WINDOW_CYCLES * 2.0 * math.pi / fastest
    r.touched_at = math.nan


@jit
def monitor_losses(structure, control, motion, memory, work):
    """Compare, once in a window, the energy that the integrator dissipated in a machine that
    touched with that of the machine's dampers.

    Not under error control: its steps resolve every growth that the survey has found, and their
    other errors are within the tolerance. Nor in real time, where every step takes equally long.
    """
    if keeps_tolerance(control.mode) or control.mode == REALTIME:
        return
    r = memory.record[0]
    if math.isnan(r.touched_at):
        for j in range(len(structure.interfaces)):
            if structure.interfaces[j].has_wall == 1 and motion.force[j] != 0.0:
                r.touched_at = r.t
    if r.t < r.window_end:
        return
    flows = memory.work
    residual = total_energy(structure, spin_now(memory.record), motion, work.stores)
    residual -= r.energy_at_start
    for i in range(_LOSSES):
        residual -= flows[i]
    losses = 0.0
    for i in range(_LOSSES, len(flows)):
        losses += flows[i]
    residual += losses
    vibration = losses - flows[_FRICTION]
    r.leaky_taken = MEMORY * r.leaky_taken + r.window_residual - residual
    r.leaky_losses = MEMORY * r.leaky_losses + losses - r.window_losses
    r.leaky_vibration = MEMORY * r.leaky_vibration + vibration - r.window_vibration
    is_large = r.leaky_taken > control.overdamping * r.leaky_vibration
    is_seen = r.leaky_taken > LEAST_LOSS * r.leaky_losses
    # friction feeds a whirl where the rotor turns
    is_fine = 0.0 < abs(r.omega) * r.h_last < COARSE and losses > vibration
    has_touched = not math.isnan(r.touched_at)
    if has_touched and is_large and is_seen and is_fine and math.isnan(r.overdamped_at):
        r.overdamped_at = r.touched_at
    r.window_residual = residual
    r.window_losses = losses
    r.window_vibration = vibration
    open_window(structure, memory)
