"""What a variable of the FMU is, and the units that it may have."""

from __future__ import annotations

import math
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Unit:
    """A unit: exponents of the SI base units, and how people want to see it (name, factor)."""

    name: str
    base: dict[str, int]
    display: tuple[str, float] | None = None


UNITS = {
    unit.name: unit
    for unit in (
        Unit("m", {"m": 1}, ("um", 1e6)),
        Unit("rad", {"rad": 1}, ("deg", 180 / math.pi)),
        Unit("rad/s", {"rad": 1, "s": -1}, ("rpm", 30 / math.pi)),
        Unit("rad/s2", {"rad": 1, "s": -2}),
        Unit("s", {"s": 1}),
        Unit("kg", {"kg": 1}),
        Unit("N", {"kg": 1, "m": 1, "s": -2}),
        Unit("N.m", {"kg": 1, "m": 2, "s": -2}),
        Unit("N.m/rad", {"kg": 1, "m": 2, "s": -2, "rad": -1}),
        Unit("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        Unit("kg.m2", {"kg": 1, "m": 2}),
        Unit("N/m", {"kg": 1, "s": -2}),
        Unit("N.s/m", {"kg": 1, "s": -1}),
        Unit("J", {"kg": 1, "m": 2, "s": -2}),
        Unit("m/s2", {"m": 1, "s": -2}),
        Unit("1", {}),
    )
}


@dataclass(frozen=True)
class Variable:
    """One variable of the FMU.

    kind: Real, Integer or Boolean; causality: input, output, local or parameter; unit: a key of
    `UNITS` (Reals); choices: the names of an Integer's values, from 0; is_unset_at_start: whether
    the start value stands for none, so that to set it changes nothing.
    """

    name: str
    kind: str
    causality: str
    text: str
    unit: str = "1"
    start: float | int | bool | None = None
    low: float | None = None
    high: float | None = None
    nominal: float | None = None
    choices: tuple[str, ...] = field(default=())
    is_unset_at_start: bool = False

    @property
    def is_observed(self) -> bool:
        """Whether the model computes it."""
        return self.causality in ("output", "local")
