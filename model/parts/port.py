"""Ports and sensors: nodes where an external force acts, and whose motion is observed."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from . import base as of


@dataclass(frozen=True)
class Sensor(of.Part):
    """The displacement and the velocity of a node (from 1)."""

    KIND: ClassVar[str] = "sensor"
    TEXT: ClassVar[str] = "the displacement and the velocity of a node"

    node: int

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield two probes."""
        yield of.ProbeElement(self.node)
        yield of.VelocityElement(self.node)

    def outline(self) -> Iterator[of.Shape]:
        """Yield a gauge beside the shaft."""
        yield of.Shape(0.0, 0.0, 0.0, 0.0, "gauge")


@dataclass(frozen=True)
class Port(Sensor):
    """An external force on a node (from 1), and the node's displacement and velocity."""

    KIND: ClassVar[str] = "port"
    TEXT: ClassVar[str] = "an external force on a node, and the node's displacement and velocity"

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield a port and two probes."""
        yield of.PortElement(self.node, f"node {self.node}")
        yield from super().elements(where, density)

    def outline(self) -> Iterator[of.Shape]:
        """Yield an arrow to the shaft."""
        yield of.Shape(0.0, 0.0, 0.0, 0.0, "force")
