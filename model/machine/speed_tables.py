"""Tables over the speed that parts have, and what is said where the speed leaves one."""

from __future__ import annotations

from typing import NamedTuple

from .rotor import Rotor


class SpeedTable(NamedTuple):
    """The speeds [rad/s] that the table of a part covers, and the part's name."""

    where: str
    low: float
    high: float

    @property
    def beyond(self) -> str:
        """The sentence for a speed outside, {speed:.4g} in it to be filled in."""
        return (
            f"{self.where}: speed {{speed:.4g}} rad/s lies outside its table, {self.low:g} to "
            f"{self.high:g} rad/s; from there on its coefficients are those of the end"
        )


def tables_of(rotor: Rotor) -> list[SpeedTable]:
    """Those of a machine."""
    named = ((where, getattr(part, "speed", ())) for where, part in rotor.named_parts())
    return [SpeedTable(where, speeds[0], speeds[-1]) for where, speeds in named if speeds]
