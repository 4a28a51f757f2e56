"""Messages for speeds outside a range, such as that of a part's table over the speed."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ..message_templates import Message
from ..parts.bearing_with_oil import BearingWithOil
from ..parts.journal_bearing import JournalBearing
from ..parts.speed_table import interpolant
from .rotor import Rotor

BEYOND_TABLE = "beyond-table"
RIM = 1500.0  # speed of a disc's rim above which steel bursts [m/s]
# Re sqrt(c / R), Re = density w R c / viscosity, above which vortices may form between concentric
# cylinders, the inner of which turns (ISO 7902-1; Taylor 1923: its square is 1708)
_VORTICES = 41.3
_SAMPLES = 1001  # of a list of viscosities


class SpeedRange(NamedTuple):
    """A range of speeds [rad/s], the message for a speed outside it, in which {speed:.4g},
    {high:.4g} and {reynolds:.4g} are filled in, the code of that message, and whether the range
    holds whichever way the shaft turns; of a film that is laminar in it the name and the critical
    Reynolds number [1]."""

    low: float
    high: float
    beyond: str
    code: str
    is_of_size: bool
    film: str = ""
    reynolds: float = math.nan

    def holds(self, speed: float) -> bool:
        """Return whether a speed [rad/s] lies in the range."""
        return self.low <= (abs(speed) if self.is_of_size else speed) <= self.high

    def message(self, speed: float) -> Message:
        """Return the message for a speed [rad/s] outside the range."""
        text = self.beyond.format(speed=speed, high=self.high, reynolds=self.reynolds)
        return Message(text, self.code)


def speed_ranges(rotor: Rotor) -> list[SpeedRange]:
    """Return the ranges that the tables of a machine's parts cover, whose heat balances are made,
    in which its films are laminar, and in which its discs hold."""
    named = list(rotor.named_parts())
    tables = [_range_of(where, part) for where, part in named if getattr(part, "speed", ())]
    oils = [(where, part) for where, part in named if isinstance(part, BearingWithOil)]
    films = [_laminar(where, part) for where, part in named if isinstance(part, JournalBearing)]
    positive = [_positive(where, part) for where, part in oils if part.why_positive]
    return [*tables, *positive, *films, *_whole(rotor)]


def _whole(rotor: Rotor) -> Iterator[SpeedRange]:
    """Yield the range in which the largest disc does not burst, if there is a disc."""
    if rotor.discs:
        yield SpeedRange(
            0.0,
            2.0 * RIM / max(disc.diameter for disc in rotor.discs),
            "speed {speed:.4g} rad/s is above {high:.4g} rad/s, where the rim of the largest disc "
            f"moves at {RIM:g} m/s and steel bursts: is it meant in rpm, or does a coupling "
            "diverge?",
            "burst-speed",
            is_of_size=True,
        )


def _range_of(where: str, part: Any) -> SpeedRange:
    low, high = part.speed[0], part.speed[-1]
    is_film = isinstance(part, JournalBearing)
    values = "viscosity is that" if is_film else "coefficients are those"
    return SpeedRange(
        low,
        high,
        f"{where}: speed {{speed:.4g}} rad/s lies outside its table, {low:g} to {high:g} rad/s; "
        f"from there on its {values} of the end",
        BEYOND_TABLE,
        is_of_size=is_film,
    )


def _positive(where: str, part: BearingWithOil) -> SpeedRange:
    """Return the range of a film that has no heat balance turned the other way."""
    return SpeedRange(
        0.0,
        math.inf,
        f"{where}: speed {{speed:.4g}} rad/s is negative, where it has no heat balance, but the "
        f"viscosity of positive speeds: {part.why_positive}",
        BEYOND_TABLE,
        is_of_size=False,
    )


def _laminar(where: str, part: JournalBearing) -> SpeedRange:
    """Return the range in which the film of a journal bearing is laminar."""
    reynolds = _VORTICES * math.sqrt(part.journal_radius / part.clearance)
    per_viscosity = reynolds / (part.density * part.journal_radius * part.clearance)
    if isinstance(part.viscosity, tuple):
        speeds = np.linspace(part.speed[0], part.speed[-1], _SAMPLES)
        over = speeds / interpolant(part.speed, part.viscosity)(speeds)
        ends = per_viscosity * part.viscosity[0], per_viscosity * part.viscosity[-1]
        ascending = np.maximum.accumulate(over)  # also where the lubricant becomes thicker again
        most = float(np.interp(per_viscosity, ascending, speeds, left=ends[0], right=ends[1]))
    else:
        most = per_viscosity * part.viscosity
    return SpeedRange(
        0.0,
        most,
        f"{where}: speed {{speed:.4g}} rad/s is above {{high:.4g}} rad/s, where the Reynolds "
        "number of its film exceeds {reynolds:.4g} (ISO 7902-1): the film is not laminar, and "
        "bears and brakes more than is computed",
        "not-laminar",
        is_of_size=True,
        film=where,
        reynolds=reynolds,
    )
