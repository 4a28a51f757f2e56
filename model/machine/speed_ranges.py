"""Messages for speeds outside a range, such as that of a part's table over the speed."""

import math
from typing import Any, NamedTuple

from ..parts.bearing_with_oil import BearingWithOil
from ..parts.journal_bearing import JournalBearing
from .rotor import Rotor


class SpeedRange(NamedTuple):
    """A range of speeds [rad/s], the message for a speed outside it, in which {speed:.4g} is filled
    in, the code of that message, and whether the range holds whichever way the shaft turns."""

    low: float
    high: float
    beyond: str
    code: str
    is_of_size: bool

    def holds(self, speed: float) -> bool:
        """Return whether a speed [rad/s] lies in the range."""
        return self.low <= (abs(speed) if self.is_of_size else speed) <= self.high


def speed_ranges(rotor: Rotor) -> list[SpeedRange]:
    """Return the ranges that the tables of a machine's parts cover, whose heat balances are
    made."""
    named = list(rotor.named_parts())
    tables = [_range_of(where, part) for where, part in named if getattr(part, "speed", ())]
    oils = [(where, part) for where, part in named if isinstance(part, BearingWithOil)]
    return [*tables, *(_positive(where, part) for where, part in oils if part.why_positive)]


def _range_of(where: str, part: Any) -> SpeedRange:
    low, high = part.speed[0], part.speed[-1]
    is_film = isinstance(part, JournalBearing)
    values = "viscosity is that" if is_film else "coefficients are those"
    return SpeedRange(
        low,
        high,
        f"{where}: speed {{speed:.4g}} rad/s lies outside its table, {low:g} to {high:g} rad/s; "
        f"from there on its {values} of the end",
        "beyond-table",
        is_of_size=is_film,
    )


def _positive(where: str, part: BearingWithOil) -> SpeedRange:
    """Return the range of a film that has no heat balance turned the other way."""
    return SpeedRange(
        0.0,
        math.inf,
        f"{where}: speed {{speed:.4g}} rad/s is negative, where it has no heat balance, but the "
        f"viscosity of positive speeds: {part.why_positive}",
        "beyond-table",
        is_of_size=False,
    )
