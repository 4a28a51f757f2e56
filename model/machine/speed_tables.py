"""Messages for speeds outside a range, such as that of a part's table over the speed."""

from __future__ import annotations

from typing import NamedTuple

from .rotor import Rotor


class SpeedRange(NamedTuple):
    """A range of speeds [rad/s], the message for a speed outside it, in which {speed:.4g} is filled
    in, and the code of that message."""

    low: float
    high: float
    beyond: str
    code: str


def tables_of(rotor: Rotor) -> list[SpeedRange]:
    """Return the ranges that the tables of a machine's parts cover."""
    named = ((where, getattr(part, "speed", ())) for where, part in rotor.named_parts())
    return [
        SpeedRange(
            speeds[0],
            speeds[-1],
            f"{where}: speed {{speed:.4g}} rad/s lies outside its table, {speeds[0]:g} to "
            f"{speeds[-1]:g} rad/s; from there on its coefficients are those of the end",
            "beyond-table",
        )
        for where, speeds in named
        if speeds
    ]
