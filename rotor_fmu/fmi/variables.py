"""The variables of the FMU, and their units."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache

from ..model.quantities import NOTHING, SMALLEST


@dataclass(frozen=True)
class Unit:
    """A unit: exponents of the SI base units, None where they are no integers, as FMI has them, and
    how people want to see it (name, factor)."""

    name: str
    base: dict[str, int] | None
    display: tuple[str, float] | None = None


_BASE = {of: {of: 1} for of in ("kg", "m", "s", "rad", "A", "K", "mol", "cd")} | {"1": {}}
_DERIVED = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Hz": {"s": -1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
}
_SMALLEST = float(f"{SMALLEST:g}")  # without the last digits of its rounding
_SHOWN = {"m": ("um", 1e6), "rad": ("deg", 180 / math.pi), "rad/s": ("rpm", 30 / math.pi)}


@cache
def unit(name: str) -> Unit:
    """Return the unit that is spelled so: SI units with exponents, `.` between factors, one `/`
    before those that divide, in brackets where they are several: `kg/m3`, `m/(N.s)`; or with a
    power, `N/m^1.5`. Raises `KeyError` or `ValueError` for another name."""
    known = _BASE | _DERIVED
    root, hat, last = name.partition("^")
    if hat and unit(root) and float(last):
        return Unit(name, None)
    base: dict[str, int] = {}
    above, _, below = name.partition("/")
    for side, factors in ((1, above), (-1, below or "1")):
        for factor in factors.strip("()").split("."):
            word = factor if factor == "1" else factor.rstrip("0123456789")
            power = side * int(factor[len(word) :] or 1)
            for of, exponent in known[word].items():
                base[of] = base.get(of, 0) + power * exponent
    ordered = {of: base[of] for of in _BASE if base.get(of)}
    return Unit(name, ordered, _SHOWN.get(name))


def are_alike(one: str, other: str) -> bool:
    """Return whether two names are of the same unit, as N.m and J are; of others than SI units
    whether they are spelled alike."""
    try:
        bases = unit(one).base, unit(other).base
    except (KeyError, ValueError):
        return one == other
    return one == other if None in bases else bases[0] == bases[1]


@dataclass(frozen=True)
class Variable:
    """One variable of the FMU.

    kind: Real, Integer, Boolean or Enumeration; causality: input, output, local or parameter; unit:
    a name that `unit` reads (Reals); low, high: its limits; is_low_excluded: whether it must be
    above `low`; choices: the names of an Enumeration's values, from 0; is_unset_at_start: whether
    the start value of a solver parameter leaves it to the preset;
    is_tunable: whether a parameter may change between two steps; reached_by: see
    `quantities.Output`.
    """

    name: str
    kind: str
    causality: str
    text: str
    unit: str = "1"
    start: float | int | bool | None = None
    low: float | None = None
    high: float | None = None
    is_low_excluded: bool = False
    nominal: float | None = None
    choices: tuple[str, ...] = field(default=())
    is_unset_at_start: bool = False
    is_tunable: bool = False
    reached_by: str = NOTHING

    @property
    def least(self) -> float | None:
        """The least value that is allowed, if there is one."""
        if self.low is None or not self.is_low_excluded:
            return self.low
        return max(math.nextafter(self.low, math.inf), _SMALLEST)

    @property
    def type_name(self) -> str:
        """Name of an Enumeration's type, which may be that of no variable: `SolverPreset`."""
        words = self.name.replace(".", "_").split("_")
        return "".join(word.capitalize() for word in words)

    @property
    def is_observed(self) -> bool:
        """Whether the model computes it."""
        return self.causality in ("output", "local")


def start_values(table: Iterable[Variable]) -> dict[str, float]:
    """Return the start values of the variables that have one, by name."""
    return {v.name: v.start for v in table if v.start is not None}
