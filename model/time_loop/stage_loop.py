"""A step of Radau IIA in the time loop: rotation and loads at its stages, its local error, ledger,
monitors and recorder."""

import math

from ..kernels.functions import copy, scaled
from ..kernels.jit import jit, jit_not_inlined
from ..schemes.radau import EXPECTED, STAGES, A, C, weight_at, weight_until
from ..step.excitation import spin_of
from ..step.laws import relative
from ..step.stages import spin_of_stage, try_stages
from ..step.step import Motion
from ..step.step_status import DONE, NOT_CONVERGED
from .energy import powers
from .error_control import radians_of, tolerated_error
from .memory import move_loads, spin_at
from .monitors import monitor_revolution
from .recorder import is_due, rows_within, write
from .step_with_rotation import SPIN_ITERATIONS, SPIN_TOLERANCE

# Accuracy of the interfaces' displacements in a step of one radian, as a share of the tolerance,
# and its bounds.
OF_TOLERANCE, FINEST, COARSEST = 2e-2, 1e-10, 1e-5
# A step with more of Newton's iterations for one rotation is not followed by a longer one.
HARD = 3
# Factor on the estimated error of a step in which two smooth motions meet.
AT_JOINT = 60.0
# Largest angle of the rotation or of the lowest mode between two checks of an amplitude [rad].
MONITOR_ANGLE = 0.1


@jit
def _motion_at(motion, stages, i):
    """Return the `Motion` of stage i, as far as energies and powers need it."""
    return Motion(
        stages.q[i],
        stages.v[i],
        stages.v_dot[i],
        stages.v_dot[i],
        motion.jerk,
        stages.force[i],
        stages.internal_state[i],
        stages.internal_rate[i],
        stages.internal_rate[i],
    )


@jit
def step_in_stages_with_rotation(structure, control, t, h, motion, trial, memory, work, stages):
    """Take a step in stages to time t [s] with the rotation that belongs to it; the results are
    those of `step_with_rotation`, without the fit, and with the most iterations for one rotation
    after their sum."""
    r = memory.record[0]
    last = STAGES - 1
    for i in range(STAGES):
        at = t if i == last else r.t + C[i] * h
        move_loads(memory, at)
        for k in range(len(memory.loads)):
            stages.loads[i, k] = memory.loads[k]
        stages.drive[i] = r.drive
        spin = spin_at(memory.record, at, r.alpha)
        stages.omega[i], stages.alpha[i], stages.theta[i] = spin.omega, spin.alpha, spin.theta
    middle = spin_at(memory.record, r.t + 0.5 * h, r.alpha)
    radians = radians_of(structure, math.sqrt(r.characteristic_frequency_squared), h)
    accuracy = min(COARSEST, max(FINEST, OF_TOLERANCE * radians * control.tolerance))
    status, total, hardest, torque = NOT_CONVERGED, 0, 0, 0.0
    for correction in range(SPIN_ITERATIONS):
        status, iterations = try_stages(structure, middle, h, accuracy, motion, trial, stages)
        total += iterations
        hardest = max(hardest, iterations)
        if status != DONE:
            break
        largest = 0.0
        for i in range(STAGES):
            torque = powers(
                structure,
                spin_of_stage(stages, i),
                stages.loads[i],
                _motion_at(motion, stages, i),
                work.losses,
                stages.powers[i],
            )
            drive = stages.drive[i]
            stages.torque[i] = torque
            if r.is_free == 1:
                change = (drive - torque) / structure.numbers[0].inertia
                stages.alpha[i] += change
                largest = max(largest, h * abs(change))
        is_small = largest <= SPIN_TOLERANCE * (1.0 + abs(stages.omega[last]))
        if r.is_free == 0 or (is_small and correction > 0):
            break
        _integrate_rotation(r, h, stages)
        status = NOT_CONVERGED
    return status, total, hardest, spin_of_stage(stages, last), torque


@jit
def _integrate_rotation(r, h, stages):
    """Set speeds and angles of a free rotor from its rates at the stages."""
    for i in range(STAGES):
        omega = r.omega
        for k in range(STAGES):
            omega += h * A[i, k] * stages.alpha[k]
        stages.omega[i] = omega
    for i in range(STAGES):
        theta = r.theta
        for k in range(STAGES):
            theta += h * A[i, k] * stages.omega[k]
        stages.theta[i] = theta


@jit
def stage_error(structure, control, size, frequency, h, motion, stages):
    """Return the local error of a step in stages, as `error_control.local_error`: the mass-weighted
    root mean square of its last acceleration less that extrapolated from its start and its first
    two stages."""
    weights, difference = structure.weights, stages.scratch[0]
    for i in range(len(difference)):
        difference[i] = (
            scaled(EXPECTED[0], motion.v_dot[i])
            + scaled(EXPECTED[1], stages.v_dot[0, i])
            + scaled(EXPECTED[2], stages.v_dot[1, i])
            - stages.v_dot[2, i]
        )
    total = 0.0
    for j in range(len(weights)):
        x, y = difference[weights[j].i], difference[weights[j].k]
        total += weights[j].weight * (x.real * y.real + x.imag * y.imag)
    tolerated = tolerated_error(structure, control, size, frequency, h)
    error = control.error_constant * h * h * math.sqrt(max(0.0, total)) / tolerated
    return AT_JOINT * error if has_joint(structure, motion, stages) else error


@jit
def has_joint(structure, old, stages):
    """Return whether two smooth motions meet within the step: where a wall's force begins, ceases,
    or reverses its friction."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.has_wall == 0:
            continue
        force = old.force[j]
        before = _torque_about_centre(force, relative(interface, old.q))
        for i in range(STAGES):
            if (stages.force[i, j] != 0.0) != (force != 0.0):
                return True
            after = _torque_about_centre(stages.force[i, j], stages.d[i, j])
            if before * after < 0.0:
                return True
    return False


@jit
def _torque_about_centre(force, displacement):
    """Return the torque of a wall's force about its centre [N.m]."""
    return displacement.real * force.imag - displacement.imag * force.real


@jit
def add_stage_work(h, memory, stages):
    """Add the flows of the step to the ledger."""
    for i in range(len(memory.power)):
        flow = 0.0
        for k in range(STAGES):
            flow += A[STAGES - 1, k] * stages.powers[k, i]
        memory.work[i] += h * flow
        memory.power[i] = stages.powers[STAGES - 1, i]


@jit
def update_monitors_within_step(structure, h, motion, trial, memory, stages):
    """Update the amplitude monitors at intermediate points of an accepted step, at even distances
    of at most `MONITOR_ANGLE`; trial is overwritten."""
    last = STAGES - 1
    fastest = max(abs(stages.omega[last]), structure.numbers[0].lowest_omega)
    parts = max(1, math.ceil(h * fastest / MONITOR_ANGLE))
    for k in range(1, parts):
        x = k / parts
        omega, theta = _turned_within(h, x, stages)
        for probe in structure.probes:
            _displace(h, x, probe.dof, motion, trial, stages)
            _displace(h, x, probe.slope, motion, trial, stages)
        spin = spin_of(omega, stages.alpha[last], theta)
        monitor_revolution(structure, spin, trial, memory)


@jit
def _back(h, x, k):
    """Return the weight of stage k in an integral from a step's end back to its fraction x [s]."""
    return h * (weight_until(k, x) - A[STAGES - 1, k])


@jit
def _turned_within(h, x, stages):
    """Return speed and angle at a fraction x of the step."""
    omega, theta = stages.omega[STAGES - 1], stages.theta[STAGES - 1]
    for k in range(STAGES):
        omega += _back(h, x, k) * stages.alpha[k]
        theta += _back(h, x, k) * stages.omega[k]
    return omega, theta


@jit
def _displace(h, x, i, motion, trial, stages):
    """Do `_displace_within` for one dof."""
    trial.q[i] = motion.q[i]
    for k in range(STAGES):
        trial.q[i] += scaled(_back(h, x, k), stages.v[k, i])


@jit
def _displace_within(h, x, motion, trial, stages):
    """Set the displacements of `trial` to those at a fraction x of the step that led to `motion`:
    the polynomials through the velocities at the stages."""
    for i in range(len(motion.q)):
        _displace(h, x, i, motion, trial, stages)


@jit_not_inlined
def record_stages(structure, h, motion, trial, memory, work, stages, recorder, out):
    """Record an accepted step, whose end is the present state, and rows within it that are due;
    trial is overwritten, the state is not changed."""
    r = memory.record[0]
    parts = rows_within(structure, memory.record, recorder.head)
    r.h_last = h / parts
    if parts > 1:
        t, omega, theta, alpha, torque = r.t, r.omega, r.theta, r.alpha, r.torque
        copy(memory.work, stages.ledger)
        for k in range(1, parts):
            x = k / parts
            _move_within(h, x, motion, trial, memory, stages)
            r.t = t - (1.0 - x) * h
            if is_due(structure, memory.record, recorder.head):
                write(structure, trial, memory, work, recorder, out)
        r.t, r.omega, r.theta, r.alpha, r.torque = t, omega, theta, alpha, torque
        copy(stages.ledger, memory.work)
    if is_due(structure, memory.record, recorder.head):
        write(structure, motion, memory, work, recorder, out)
    r.h_last = h


@jit
def _move_within(h, x, motion, trial, memory, stages):
    """Set `trial`, the rotation and the ledger to those at a fraction x of the step: the
    polynomials through the rates at the stages."""
    r = memory.record[0]
    _displace_within(h, x, motion, trial, stages)
    for i in range(len(motion.q)):
        trial.v[i], trial.v_dot[i] = motion.v[i], 0.0
    copy(motion.internal_state, trial.internal_state)
    copy(stages.ledger, memory.work)
    r.omega, r.theta = _turned_within(h, x, stages)
    r.alpha = r.torque = 0.0
    for k in range(STAGES):
        at, back = weight_at(k, x), _back(h, x, k)
        r.alpha += at * stages.alpha[k]
        r.torque += at * stages.torque[k]
        for i in range(len(motion.q)):
            trial.v[i] += scaled(back, stages.v_dot[k, i])
            trial.v_dot[i] += scaled(at, stages.v_dot[k, i])
        for i in range(len(motion.internal_state)):
            trial.internal_state[i] += back * stages.internal_rate[k, i]
        for i in range(len(memory.work)):
            memory.work[i] += back * stages.powers[k, i]
