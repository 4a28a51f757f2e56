"""Causes that end an advance early: a limit is passed, or a contact closes or opens."""

from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..step.excitation import at_place
from .equilibrium import MOVED

# Status of a start: the equilibrium lies beyond a limit; the method with stages has neither
# tangents nor the impedance of a line; too little inertia for a torque to drive.
LIMITED, IN_STAGES, NO_INERTIA = 1 + MOVED, 2 + MOVED, 3 + MOVED
# Outcome of a step: it goes on; beyond the limit of displacement or force; a contact closed or
# opened.
GOES_ON, PAST_DISPLACEMENT, PAST_FORCE, CLOSED, OPENED = 0, 1, 2, 3, 4


@jit
def is_watched(r):
    """Return whether anything may end an advance early."""
    return r.limit_displacement > 0.0 or r.limit_force > 0.0 or r.stops_at_contact == 1


@jit
def largest_displacement(structure, motion):
    """Return the largest distance of a probe from the axis [m]."""
    largest = 0.0
    for i in range(len(structure.probes)):
        largest = max(largest, modulus(at_place(structure.probes[i], motion.q)))
    return largest


@jit
def largest_force(motion):
    """Return the largest force of an interface [N]."""
    largest = 0.0
    for j in range(len(motion.force)):
        largest = max(largest, modulus(motion.force[j]))
    return largest


@jit_not_inlined
def rests_past_limit(structure, motion, r):
    """Return whether the equilibrium lies past a limit; `failed_value` is then the value."""
    if r.limit_displacement > 0.0:
        r.failed_value = largest_displacement(structure, motion)
        if r.failed_value >= r.limit_displacement:
            r.failed_at = PAST_DISPLACEMENT
            return True
    if r.limit_force > 0.0:
        r.failed_value = largest_force(motion)
        if r.failed_value >= r.limit_force:
            r.failed_at = PAST_FORCE
            return True
    return False


@jit_not_inlined
def early_return_cause(structure, motion, trial, r):
    """Return the cause for which the step to `trial` ends the advance early, or GOES_ON. A limit
    that is passed does so once, until the motion has been within all limits again."""
    displacement = r.limit_displacement > 0.0
    if displacement:
        r.failed_value = largest_displacement(structure, trial)
        displacement = r.failed_value > r.limit_displacement
    force = r.limit_force > 0.0 and largest_force(trial) > r.limit_force
    if force and not displacement:
        r.failed_value = largest_force(trial)
    was_past = r.is_past_limit == 1
    r.is_past_limit = 1 if displacement or force else 0
    if not was_past and r.is_past_limit == 1:
        return PAST_DISPLACEMENT if displacement else PAST_FORCE
    if r.stops_at_contact == 1:
        for j in range(len(structure.interfaces)):
            if structure.interfaces[j].has_wall == 1:
                is_closed, was_closed = trial.force[j] != 0.0, motion.force[j] != 0.0
                if is_closed != was_closed:
                    r.failed_value = j
                    return CLOSED if is_closed else OPENED
    return GOES_ON
