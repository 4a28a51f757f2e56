"""What closed contacts do to a motion at one instant: impulses and compatible accelerations.

    velocities      M dv = B N H,          N^T B^T (v + dv) = 0
    accelerations   M a = f - K q - C v + B N lambda,   N^T B^T a + bend = 0

at the closed contacts (Abaqus Theory 2.4.2), solved as complementarity problems, so that neither H
nor lambda pulls.
"""

import numpy as np

from .hard_stop import complementarity
from .state import openings_of
from .stepper import Instant, Stepper

TENSION = 1e-6  # of a closed contact, of the largest force so far, from which it opens


class Here:
    """What the contacts do to the masses at one instant, when nothing has time to move."""

    def __init__(self, stepper: Stepper, motion: Instant) -> None:
        contacts = stepper.structure.contacts
        p, self._B = contacts.B.T @ motion.q, contacts.B
        self.N = contacts.gradient(p)
        self.bend = contacts.bend(p, contacts.B.T @ motion.v)
        self.columns = stepper.mass_columns @ self.N
        self.flexibility = self.N.T @ stepper.mass_flexibility @ self.N

    def rates(self, v: np.ndarray) -> np.ndarray:
        """Of the openings, for velocities or accelerations (these without `bend`)."""
        return self.N.T @ (self._B.T @ v)


def change_contacts(stepper, state, changing, dt) -> Instant:
    """Change the contacts; impulse and compatible accelerations, at no cost of time."""
    motion = state.motion
    closes = changing & ~state.closed
    state.closed = state.closed ^ changing
    state.rest = np.where(closes, openings_of(stepper, motion), state.rest)
    if closes.any():
        here = Here(stepper, motion)
        rates = here.rates(motion.v)
        impulse = pushing(here, state, rates, TENSION * float(np.abs(rates).max()))
        # what stops a contact point within an increment: the first measure of the forces to come
        state.largest_force = max(state.largest_force, float(impulse.max()) / dt)
        motion = motion._replace(v=motion.v + here.columns @ impulse)
    return compatible_accelerations(stepper, state, motion)


def compatible_accelerations(stepper, state, motion: Instant) -> Instant:
    """Accelerations of the equation of motion with which no closed contact penetrates."""
    here = Here(stepper, motion)
    r = stepper.residual(motion.t, motion.q, motion.v)
    a = stepper.free_acceleration(r)
    loose = TENSION * state.largest_force * float(here.flexibility.max())
    force = pushing(here, state, here.rates(a) + here.bend, loose)
    return motion._replace(a=a + here.columns @ force, r=r, force=force)


def pushing(here, state, rates: np.ndarray, loose: float) -> np.ndarray:
    """Impulses or forces on the closed contacts, none of them pulling, that leave no negative rate
    of theirs; contacts whose rate is above `loose` then open."""
    result = np.zeros(len(rates))
    closed = np.flatnonzero(state.closed)
    part = here.flexibility[np.ix_(closed, closed)]
    result[closed], _ = complementarity(part, rates[closed], np.ones(len(closed), dtype=bool))
    after = rates + here.flexibility @ result
    state.closed = state.closed & ((result > 0) | (after <= loose))
    return result
