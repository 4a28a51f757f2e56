"""Subsynchronous whirls, slower than the rotation, of a machine on tilting pads that follow each.

`modes` has pads follow at the frequency of rotation, as API 617 has those of its analyses. A slower
whirl moves in a film that is mostly stiffer then, and has less damping.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from .amplification import CRITICALLY_DAMPED
from .linear_machine import shared_machine
from .modes import LEAST_GROWTH, modes_up_to


class SubsynchronousWhirl(NamedTuple):
    """The least logarithmic decrement of subsynchronous whirls [1], and the frequency of its whirl
    [rad/s]; the least one where pads follow at the frequency of rotation, infinite where there is
    none [1]."""

    log_dec: float
    frequency: float
    synchronous: float

    @property
    def is_critically_damped(self) -> bool:
        """Whether its amplification factor is below 2.5."""
        return self.log_dec >= CRITICALLY_DAMPED

    @property
    def growth(self) -> float:
        """Rate at which it grows, negative where it decays [1/s]."""
        return -self.log_dec * self.frequency / (2 * math.pi)

    @property
    def is_growing(self) -> bool:
        """Whether it grows by more than rounding."""
        return self.log_dec < -LEAST_GROWTH


@lru_cache(maxsize=4)  # several sentences about an answer ask for it
def subsynchronous_whirl(
    rotor: Rotor,
    speed: float,
    contacts: str | None = None,
    coupling: tuple[tuple[int, float], ...] = (),
) -> SubsynchronousWhirl | None:
    """Return the least damped whirl slower than a speed [rad/s], which pads follow; None at
    standstill, where no pads tilt, or where there is no such whirl.

    contacts: `open` or `pinned`; None: open where the machine is held without them; coupling: nodes
    (from 1), each with a cross-coupled stiffness [N/m], about the equilibrium without it. Raises
    `LinearError` where the machine does not rest at that speed.
    """
    if speed == 0.0:
        return None
    machine = shared_machine(rotor, contacts)
    linear, added = machine.at(speed), machine.cross_coupling(dict(coupling))
    if not machine.laws.follows.any():
        return None
    linear = linear._replace(own_K=linear.own_K + added)
    own = modes_up_to(machine, linear, abs(speed), pads_whirl=True)
    synchronous = modes_up_to(machine, linear, abs(speed))
    of_own, of_synchronous = (found.damped < abs(speed) for found in (own, synchronous))
    if not of_own.any():
        return None
    least = np.flatnonzero(of_own)[own.log_dec[of_own].argmin()]
    return SubsynchronousWhirl(
        float(own.log_dec[least]),
        float(own.damped[least]),
        float(synchronous.log_dec[of_synchronous].min(initial=math.inf)),
    )
