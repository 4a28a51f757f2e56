"""A residual bow of the shaft (API 684: a shaft that is not straight when nothing loads it)."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import ANGLE, NOT_NEGATIVE, quantity
from . import base as of


@dataclass(frozen=True)
class Bow(of.Part):
    """A residual bow: free of load, the node (from 1, between the ends) lies `amplitude` [m] off
    the straight line through the ends of the shaft, at the angle `phase` [rad] from its mark; the
    two elements beside the node are bent, the rest is straight. Several add up to a bow of any
    shape."""

    KIND: ClassVar[str] = "bow"
    TEXT: ClassVar[str] = "a residual bow of the shaft, which turns with it"

    node: int
    amplitude: float = quantity(
        "m",
        "bow of the shaft at the node, from the line through its ends",
        NOT_NEGATIVE,
        is_parameter=True,
    )
    phase: float = quantity("rad", "angle of the bow", ANGLE, 0.0, is_parameter=True)

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield one bow."""
        yield of.BowElement(self.node, self.amplitude, self.phase)
