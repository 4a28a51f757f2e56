"""A port: a node where an external force acts and whose displacement is observed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..protocol import part as of


@dataclass(frozen=True)
class Port(of.Part):
    """An external force on a node, and the node's displacement."""

    KIND: ClassVar[str] = "port"
    TEXT: ClassVar[str] = "an external force on a node, and the node's displacement"

    node: int

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """A port and a probe."""
        yield of.Port(self.node, f"node {self.node}")
        yield of.Probe(self.node)
