"""A linear isotropic support to ground."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import NOT_NEGATIVE, quantity
from .base import Element, Part, Shape, SpringElement


@dataclass(frozen=True)
class Support(Part):
    """A linear isotropic spring [N/m] and damper [N.s/m] from a node to ground."""

    KIND: ClassVar[str] = "support"
    TEXT: ClassVar[str] = "an isotropic spring and damper from a node to ground"

    node: int
    stiffness: float = quantity("N/m", "stiffness", NOT_NEGATIVE)
    damping: float = quantity("N.s/m", "damping", NOT_NEGATIVE, 0.0)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one spring."""
        yield SpringElement(self.node, self.stiffness, self.damping)

    def outline(self) -> Iterator[Shape]:
        """Yield a spring from the shaft to ground."""
        yield Shape(0.0, 0.0, 0.0, 0.0, "spring")
