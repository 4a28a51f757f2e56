"""Constant forces on the shaft."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import ANY, quantity
from . import base as of


@dataclass(frozen=True)
class Load(of.Part):
    """A constant force (fx, fy) [N] on the shaft, such as that of a gear's mesh or of a volute,
    `offset` [m] beyond a node (from 1) along z. It acts in runs and in the equilibrium of every
    linear analysis, as gravity does."""

    KIND: ClassVar[str] = "load"
    TEXT: ClassVar[str] = "a constant force on the shaft, such as that of a gear's mesh"

    node: int
    fx: float = quantity("N", "force to the right", ANY, 0.0, is_parameter=True)
    fy: float = quantity("N", "force upwards", ANY, 0.0, is_parameter=True)
    offset: float = quantity("m", "axial distance of the force from the node", ANY, 0.0)

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield one force."""
        yield of.ForceElement(self.node, self.fx, self.fy, self.offset)

    def outline(self) -> Iterator[of.Shape]:
        """Yield an arrow to the shaft."""
        yield of.Shape(self.offset, 0.0, 0.0, 0.0, "lift" if self.fy > 0.0 else "force")
