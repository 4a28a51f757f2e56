"""Whirls slower than the rotation of a machine on tilting pads, which follow each at its own
frequency.

`modes` has pads follow at the frequency of rotation, as API 617 has those of its analyses. A slower
whirl moves in a film that is mostly stiffer then, and has less damping. What follows is so fast
that each mode has one frequency at which all follows it: not so of floating rings, whose own whirls
are slow.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from .linear_machine import LinearMachine
from .modes import DEFAULT_COUNT, Modes, modes_of

_ITERATIONS = 20  # of a frequency, each a tenth or less as far from it as the one before
_CLOSE = 1e-9  # of a frequency


class OwnWhirl(NamedTuple):
    """The slower whirl with the least logarithmic decrement [1], and its frequency [rad/s]; the
    least one of slower whirls where pads follow at the frequency of rotation [1]."""

    log_dec: float
    frequency: float
    synchronous: float


@lru_cache(maxsize=4)  # several sentences about an answer ask for it
def own_whirl(
    rotor: Rotor,
    speed: float,
    contacts: str | None = None,
    coupling: tuple[tuple[int, float], ...] = (),
) -> OwnWhirl | None:
    """Return the least damped whirl slower than a speed [rad/s], of the lowest modes, where pads
    follow it at its own frequency; None where no pads tilt, or there is no such whirl.

    contacts: `open` or `pinned`; None: open where the machine is held without them; coupling: nodes
    (from 1), each with a cross-coupled stiffness [N/m], about the equilibrium without it. Raises
    `LinearError` where the machine does not rest at that speed.
    """
    machine = LinearMachine(rotor, contacts)
    linear, added = machine.at(speed), machine.cross_coupling(dict(coupling))
    if machine.vibrating(linear, 0.0) is linear:
        return None

    def modes_at(frequency: float, count: int) -> Modes:
        there = machine.vibrating(linear, frequency)
        return modes_of(machine, there._replace(own_K=there.own_K + added), count)

    found = modes_at(abs(speed), DEFAULT_COUNT)
    slower = found.is_held & (found.damped < abs(speed))
    # each by its place among the others: one that is followed from the rotation's frequency to its
    # own may pass another
    all_own = [_own(modes_at, abs(speed), int(place)) for place in np.flatnonzero(slower)]
    own = [root for root in all_own if root is not None]
    if not own:
        return None
    least = min(own, key=_log_dec)
    return OwnWhirl(_log_dec(least), least.imag, float(found.log_dec[slower].min()))


def _own(modes_at: Callable[[float, int], Modes], start: float, place: int) -> complex | None:
    """Return the eigenvalue at a place, by natural frequency, with pads that follow at its
    frequency, looked for from `start` on [rad/s]; None where there is none."""
    frequency = start
    for _ in range(_ITERATIONS):
        roots = modes_at(frequency, place + 1).eigenvalues
        if place >= len(roots):
            return None
        root = complex(roots[place])
        if abs(root.imag - frequency) <= _CLOSE * root.imag:
            return root
        frequency = root.imag
    return None


def _log_dec(root: complex) -> float:
    return -2 * math.pi * root.real / root.imag
