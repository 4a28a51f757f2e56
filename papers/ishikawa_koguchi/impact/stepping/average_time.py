"""IMPACT=AVERAGE TIME: cut the increment back to the mean time at which contacts open or close.

1. Solve the increment with the contacts frozen; find those that should have changed.
2. Their crossing times, linear in openings and forces; solve again up to the mean of them.
3. Change them all at once; a contact closes at the opening that it has.
4. If one closed, an impulse; then compatible accelerations (`impulse`).
5. An increment of 1e-6 dt; what is left of the increment follows as one of its own.

(Abaqus Theory 2.4.2; paper B, section 3.1.5 and Figure 8.)
"""

import numpy as np

from .hard_stop import held
from .impulse import TENSION, change_contacts
from .state import AT_ONCE, Line, accept, length_to, openings_of
from .stepper import Instant

RESTART = 1e-6  # increment after an impact, of the time increment
PENETRATION = 1e-10  # of an open contact, from which it counts as closing [m]
SHORT = 1e-3  # steps shorter than this share of the increment hold accelerations


def average_time(stepper, state, dt, target, number, cap):
    """The increment to the target, or the two or three that an event makes of its beginning."""
    h = length_to(state, dt, target)
    old, attempt = state.motion, 1
    motion, changing = _frozen(stepper, state, h, dt)
    if not changing.any():
        motion = motion._replace(t=target)
        yield accept(state, motion, Line(number, 1, 1, target, h, False))
        return
    state.cutbacks += 1
    state.log.append(Line(number, attempt, 1, old.t, h, True))
    share = _mean_event(stepper, state, motion, changing)
    if share > AT_ONCE:
        attempt += 1
        motion, _ = _frozen(stepper, state, share * h, dt)
        yield accept(state, motion, Line(number, attempt, 1, motion.t, share * h, False))
        number += 1
        attempt = 0
    state.motion = change_contacts(stepper, state, changing, dt)
    if number > cap:
        return
    motion, _ = _frozen(stepper, state, RESTART * dt, dt)
    yield accept(state, motion, Line(number, attempt + 1, 0, motion.t, RESTART * dt, False))


def _frozen(stepper, state, h, dt) -> tuple[Instant, np.ndarray]:
    """The motion after h with the contacts as they are, and which of them should have changed."""
    contacts = stepper.structure.contacts
    free = stepper.free(state.motion, h)
    N, force = held(free, contacts, state.closed, state.rest, by_acceleration=h < SHORT * dt)
    state.solves += 1
    motion = stepper.finish(free, N, force)
    opens = state.closed & (force < -TENSION * state.largest_force)
    closes = ~state.closed & (openings_of(stepper, motion) - state.rest < -PENETRATION)
    return motion, opens | closes


def _mean_event(stepper, state, motion, changing) -> float:
    """Mean of the times at which contacts change, linear in openings and forces, over h."""
    before, after = (
        np.where(state.closed, at.force, openings_of(stepper, at) - state.rest)[changing]
        for at in (state.motion, motion)
    )
    before = np.maximum(before, 0.0)
    return float(np.mean(before / (before - after)))
