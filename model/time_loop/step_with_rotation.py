"""The rotation in a step: prescribed, or such that a free rotor's torques balance."""

import math

from ..kernels.jit import jit, jit_inlined
from ..step.fitting import fitted, unfitted
from ..step.step import try_step
from ..step.step_status import DONE, NOT_CONVERGED
from .energy import powers
from .memory import move_loads, spin_at

# The rate of a free rotor is found by repeating the step, at least once, until the speed agrees to
# SPIN_TOLERANCE, above the noise that the contact problem's own tolerance leaves.
SPIN_ITERATIONS, SPIN_TOLERANCE = 12, 1e-9


@jit
def imbalance(structure, record, omega, torque, h):
    """Return the change of a free rotor's rate [rad/s2], at the end of a step of length h [s], with
    which its drive less the torque of its line's impedance equals `torque`; 0 for another rotor."""
    r = record[0]
    if r.is_free == 0:
        return 0.0
    drive = r.drive - r.drive_impedance * omega
    return (drive - torque) / (structure.numbers[0].inertia + 0.5 * h * r.drive_impedance)


@jit_inlined
def step_with_rotation(structure, scheme, control, t, h, motion, trial, memory, work, problem):
    """Take a step to time t [s] with the rotation that belongs to it: prescribed, or such that a
    free rotor's torques balance at its end. Fill work.powers.

    Return the status, the Newton iterations, the fit of the scheme, the rotation, and the drive's
    torque [N.m].
    """
    r, loads = memory.record[0], memory.loads
    move_loads(memory, t)
    spin = spin_at(memory.record, t, r.alpha)
    status, total, torque = NOT_CONVERGED, 0, 0.0
    fit = unfitted()
    for correction in range(SPIN_ITERATIONS):
        if control.is_fitted and control.h_in_the_open == math.inf:
            fit = fitted(scheme, math.sqrt(r.characteristic_frequency_squared) * h)
        status, iterations = try_step(
            *(structure, scheme, fit, spin, h, loads),
            *(motion, trial, work, problem, control.newton_limit),
        )
        total += iterations
        if status != DONE:
            break
        torque = powers(structure, spin, loads, trial, work.losses, work.powers)
        change = imbalance(structure, memory.record, spin.omega, torque, h)
        is_small = 0.5 * h * abs(change) <= SPIN_TOLERANCE * (1.0 + abs(spin.omega))
        if r.is_free == 0:
            break
        # the last change, too, of which the motion takes next to nothing
        spin = spin_at(memory.record, t, spin.alpha + change)
        if is_small and correction > 0:
            break
        status = NOT_CONVERGED
    return status, total, fit, spin, torque
