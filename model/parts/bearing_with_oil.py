"""A journal bearing whose heat balance is made, for either sense of rotation."""

from dataclasses import dataclass, replace

import numpy as np

from .journal_bearing import JournalBearing


@dataclass(frozen=True, kw_only=True)
class BearingWithOil(JournalBearing):
    """What `laws_at_rest.oil` makes of a `JournalBearing` with a heat balance: one with viscosities
    over the speed, and others for negative speeds [Pa.s].

    why_positive: why there is no heat balance at negative speeds, in words, so that the viscosities
    there are those of positive speeds; empty if there is one.
    """

    negative_viscosity: tuple[float, ...]
    why_positive: str

    def viscosity_tables(self) -> list[np.ndarray]:
        """Return the `speed_table`s of the viscosity at positive and at negative speeds."""
        negative = JournalBearing.viscosity_tables(replace(self, viscosity=self.negative_viscosity))
        return [super().viscosity_tables()[0], negative[1]]
