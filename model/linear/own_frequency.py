"""Whirls slower than the rotation of a machine on tilting pads, which follow each mode.

`modes` has pads follow at the frequency of rotation, as API 617 has those of its analyses. A slower
whirl moves in a film that is mostly stiffer then, and has less damping.
"""

import math
from functools import lru_cache
from typing import NamedTuple

from ..machine.rotor import Rotor
from .linear_machine import LinearMachine
from .modes import DEFAULT_COUNT, LEAST_GROWTH, modes_of


class OwnWhirl(NamedTuple):
    """The slower whirl with the least logarithmic decrement [1], and its frequency [rad/s]; the
    least one of slower whirls where pads follow at the frequency of rotation [1]."""

    log_dec: float
    frequency: float
    synchronous: float

    @property
    def growth(self) -> float:
        """Rate at which it grows, negative where it decays [1/s]."""
        return -self.log_dec * self.frequency / (2 * math.pi)

    @property
    def is_growing(self) -> bool:
        """Whether it grows by more than rounding."""
        return self.log_dec < -LEAST_GROWTH


@lru_cache(maxsize=4)  # several sentences about an answer ask for it
def own_whirl(
    rotor: Rotor,
    speed: float,
    contacts: str | None = None,
    coupling: tuple[tuple[int, float], ...] = (),
) -> OwnWhirl | None:
    """Return the least damped whirl slower than a speed [rad/s], of the lowest modes, which pads
    follow; None where no pads tilt, or there is no such whirl.

    contacts: `open` or `pinned`; None: open where the machine is held without them; coupling: nodes
    (from 1), each with a cross-coupled stiffness [N/m], about the equilibrium without it. Raises
    `LinearError` where the machine does not rest at that speed.
    """
    machine = LinearMachine(rotor, contacts)
    linear, added = machine.at(speed), machine.cross_coupling(dict(coupling))
    if not machine.laws.follows.any():
        return None
    linear = linear._replace(own_K=linear.own_K + added)
    seen = (modes_of(machine, linear, DEFAULT_COUNT, pads_whirl=own) for own in (True, False))
    slower = [(found, found.is_held & (found.damped < abs(speed))) for found in seen]
    if not all(places.any() for _, places in slower):
        return None
    (own, of_own), (synchronous, of_synchronous) = slower
    least = own.eigenvalues[of_own][own.log_dec[of_own].argmin()]
    return OwnWhirl(
        float(own.log_dec[of_own].min()),
        float(least.imag),
        float(synchronous.log_dec[of_synchronous].min()),
    )
