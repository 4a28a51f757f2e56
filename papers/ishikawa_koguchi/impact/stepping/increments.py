"""Increments whose contacts are solved at their end: IMPACT=NO and IMPACT=CURRENT TIME."""

import numpy as np

from .hard_stop import unilateral
from .impulse import Here, compatible_accelerations
from .state import Line, accept, length_to


def solved(stepper, state, dt, target, number, cap):
    """IMPACT=NO: the contacts are solved at the end of the increment."""
    h = length_to(state, dt, target)
    free = stepper.free(state.motion, h)
    N, force = unilateral(free, stepper.structure.contacts, state.closed)
    state.solves += 1
    state.closed = force > 0
    motion = stepper.finish(free, N, force)._replace(t=target)
    yield accept(state, motion, Line(number, 1, 1, target, h, False))


def current_time(stepper, state, dt, target, number, cap):
    """IMPACT=CURRENT TIME: as IMPACT=NO, then compatible velocities and accelerations."""
    before = state.closed
    (motion,) = solved(stepper, state, dt, target, number, cap)
    if (state.closed & ~before).any():
        here = Here(stepper, motion)
        impulse = np.zeros(len(before))
        part = here.flexibility[np.ix_(state.closed, state.closed)]
        impulse[state.closed] = np.linalg.solve(part, -here.rates(motion.v)[state.closed])
        motion = motion._replace(v=motion.v + here.columns @ impulse)
    if (state.closed != before).any():
        motion = compatible_accelerations(stepper, state, motion)
    state.motion = motion
    yield motion
