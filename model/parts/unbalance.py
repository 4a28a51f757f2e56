"""An unbalance at a node (ISO 21940-2: U = m e, here with its angle)."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import ANGLE, ANY, NOT_NEGATIVE, quantity
from . import base as of


@dataclass(frozen=True)
class Unbalance(of.Part):
    """An unbalance `amount` [kg.m] at the angle `phase` [rad] from the shaft's mark; its small mass
    adds to no inertia. It stands `offset` [m] beyond the node (from 1) along z."""

    KIND: ClassVar[str] = "unbalance"
    TEXT: ClassVar[str] = "an unbalance at a node"

    node: int
    amount: float = quantity("kg.m", "unbalance", NOT_NEGATIVE, is_tunable=True)
    phase: float = quantity("rad", "angle of the unbalance", ANGLE, 0.0, is_tunable=True)
    offset: float = quantity("m", "axial distance of the unbalance from the node", ANY, 0.0)

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield one unbalance."""
        yield of.UnbalanceElement(self.node, 1.0, 0.0, self.amount, self.phase, self.offset)
