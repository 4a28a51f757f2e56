"""What can go wrong with an impact: input that cannot be, a run that diverges."""

from __future__ import annotations


class ImpactError(ValueError):
    """An experiment that cannot be; names the thing, its value and what is allowed."""


class Diverged(RuntimeError):
    """A run whose energy left all bounds; t [s], increment [1], energy [J] when it was caught."""

    def __init__(self, t: float, increment: int, energy: float, scale: float) -> None:
        super().__init__(
            f"diverged at t = {t:.6g} s, increment {increment}: energy {energy:.4g} J, "
            f"{abs(energy) / scale:.2g} times that of the system"
        )
        self.t, self.increment, self.energy = t, increment, energy
