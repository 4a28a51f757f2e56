"""What one increment of an experiment hands to the next, and the status log that it writes."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from .stepper import Instant, Stepper

AT_ONCE = 1e-9  # what is shorter than this share of an increment takes no time


class Line(NamedTuple):
    """A line of the status log: increment, attempt, iterations, time reached [s], increment of
    time tried [s]; an attempt that is cut back does not advance the time."""

    increment: int
    attempt: int
    iterations: int
    t: float
    h: float
    is_cut_back: bool

    def __str__(self) -> str:
        """As in Figure 8: step, increment, attempt, three counts of iterations, total time, time in
        the step, increment of time."""
        t = f"{float(f'{self.t:.8g}'):#.3g}"
        mantissa, exponent = f"{self.h:.3e}".split("e")
        h = f"{mantissa}e{exponent[0]}{exponent[1:]:0>3}"
        counts = f"0\t{self.iterations}\t{self.iterations}"
        return f"1\t{self.increment}\t{self.attempt}\t{counts}\t{t}\t{t}\t{h}"


@dataclass
class State:
    """Motion; which contacts are closed, and at which openings they rest [m], each of shape (m,);
    the largest contact force so far [N]; what was counted and logged."""

    motion: Instant
    closed: np.ndarray
    rest: np.ndarray
    largest_force: float = 0.0
    cutbacks: int = 0
    solves: int = 0
    log: list[Line] = field(default_factory=list)


def accept(state: State, motion: Instant, line: Line) -> Instant:
    """Take a motion, with its line of the log, as the one to go on from; returns it."""
    state.motion = motion
    state.log.append(line)
    state.largest_force = max(state.largest_force, float(np.abs(motion.force).max(initial=0.0)))
    return motion


def length_to(state: State, dt: float, target: float) -> float:
    """To the target [s]; exactly dt for a whole increment, so that its factors are found again."""
    h = target - state.motion.t
    return dt if abs(h - dt) < AT_ONCE * dt else h


def openings_of(stepper: Stepper, motion: Instant) -> np.ndarray:
    """Openings of the contacts in a motion [m], shape (m,)."""
    contacts = stepper.structure.contacts
    return contacts.openings(contacts.B.T @ motion.q)
