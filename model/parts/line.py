"""The end of a transmission line at a node: a coupling stable for any communication step."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import quantity
from . import base as of
from .port import Port


@dataclass(frozen=True, kw_only=True)
class Line(Port):
    """The end of a line of characteristic impedance Z [N.s/m] at a node (from 1). The input is the
    incoming wave a: the force on the node is a - Z v, solved within the steps, and the reflected
    wave is a - 2 Z v."""

    KIND: ClassVar[str] = "line"
    TEXT: ClassVar[str] = "the end of a transmission line, which couples a node with another model"

    impedance: float = quantity("N.s/m", "characteristic impedance of the line")

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield a damper to ground, a port for the wave, and two probes."""
        yield of.SpringElement(self.node, 0.0, self.impedance)
        for element in super().elements(where, density):
            if isinstance(element, of.PortElement):
                element = element._replace(impedance=self.impedance)
            yield element
