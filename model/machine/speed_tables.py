"""What is said where the speed leaves a range: of the tables over the speed that parts have."""

from __future__ import annotations

from typing import NamedTuple

from .rotor import Rotor


class SpeedRange(NamedTuple):
    """Speeds [rad/s], what is said of one outside, {speed:.4g} in it to be filled in, and the code
    of that message."""

    low: float
    high: float
    beyond: str
    code: str


def tables_of(rotor: Rotor) -> list[SpeedRange]:
    """Those that the tables of a machine's parts cover."""
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
