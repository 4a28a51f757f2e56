"""The linear answers of a machine that the metrics of a study ask for."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from ..model.linear.amplification import largest
from ..model.linear.campbell import Campbell, CriticalSpeed, campbell
from ..model.linear.linear_machine import shared_machine
from ..model.linear.modes import DEFAULT_COUNT, Modes, count_up_to, modes, modes_up_to
from ..model.linear.static import lowest_speed, static
from ..model.linear.subsynchronous import subsynchronous_whirl
from ..model.linear.unbalance import steady_whirl
from ..model.linear.unbalance_peaks import criticals_about, major_axis, with_criticals
from ..model.machine.rotor import Rotor

_SPEEDS = 31  # between which critical speeds, thresholds and peaks are looked for


class Whirl(NamedTuple):
    """Logarithmic decrement [1] and frequency [rad/s] of a whirl."""

    log_dec: float
    frequency: float


@dataclass(frozen=True)
class LinearAnswers:
    """The linear answers of a machine that metrics ask for, each computed once: at a speed, and
    from `low` to `high` [rad/s]; places: see `linear_runs.places_of`; count: of the lowest modes at
    the speed that are asked for."""

    rotor: Rotor
    places: Mapping[str, tuple[int, float]]
    speed: float
    low: float
    high: float
    count: int

    @cached_property
    def modes(self) -> Modes:
        """The lowest modes at the speed."""
        return modes(self.rotor, self.speed, count=max(self.count, DEFAULT_COUNT))

    @cached_property
    def slower(self) -> Whirl:
        """The least damped whirl slower than the rotation, of NaN where there is none; -inf of a
        machine that leaves its rest without oscillation."""
        machine = shared_machine(self.rotor)
        found = modes_up_to(machine, machine.at(self.speed), abs(self.speed))
        if len(found.growing):
            return Whirl(-math.inf, 0.0)
        if whirl := subsynchronous_whirl(self.rotor, self.speed):
            return Whirl(whirl.log_dec, whirl.frequency)
        whirls = map(Whirl, found.log_dec[found.is_sound], found.damped[found.is_sound])
        slower = (whirl for whirl in whirls if whirl.frequency < abs(self.speed))
        return min(slower, default=Whirl(math.nan, math.nan))

    @cached_property
    def range(self) -> np.ndarray:
        """The speeds of the range, from where oil films carry the machine on."""
        low = max(self.low, lowest_speed(self.rotor, self.high))
        return np.linspace(low, self.high, _SPEEDS)

    @cached_property
    def campbell(self) -> Campbell:
        """The Campbell diagram over the range."""
        return campbell(
            self.rotor, self.range, count=count_up_to(self.rotor, self.high, DEFAULT_COUNT)
        )

    @property
    def critical(self) -> list[CriticalSpeed]:
        """The critical speeds in the range, critically damped ones left out."""
        low, high = self.range[[0, -1]].tolist()
        about = criticals_about(self.rotor, low, high, None)  # as the response asks too
        inside = (c for c in about if low <= c.speed <= high)
        return [c for c in inside if not c.is_critically_damped]

    def orbit(self, part: str) -> Callable[[float], float]:
        """Return the major semi-axis of the orbit of a part's place [m] as a function of the
        speed."""
        node, offset = self.places[part]
        whirl = steady_whirl(self.rotor)
        return partial(major_axis, whirl, 2 * (node - 1), 2 * (node - 1) + 1, offset)

    def peak(self, part: str) -> float:
        """Return the largest major semi-axis of a part's orbits in the range [m]."""
        return largest(self.orbit(part), with_criticals(self.rotor, self.range))[1]

    @cached_property
    def loads(self) -> dict[str, float]:
        """The size of the load on each support at rest while the machine turns at the speed [N]."""
        rest = static(self.rotor, self.speed)
        sizes = np.hypot(rest.load_x, rest.load_y).tolist()
        return dict(zip(rest.supports, sizes, strict=True))
