"""The list of a machine's parts, shown with its picture."""

from __future__ import annotations

from dataclasses import dataclass

from ..model.machine.rotor import Rotor
from ..model.structure.assembly import assemble
from .linear_tables import Table


@dataclass(frozen=True)
class Inventory:
    """name: of the machine; mass [kg]; length [m]; inertia: about the axis [kg.m2]; nodes:
    positions [m]; parts: name, kind in words, node (0 of what has none), position [m]."""

    name: str
    mass: float
    length: float
    inertia: float
    nodes: tuple[float, ...]
    parts: tuple[tuple[str, str, int, float], ...]

    def table(self) -> Table:
        """Return a table with one row for each part."""
        title = (
            f"{self.name}: {len(self.nodes)} nodes, {self.length * 1e3:.5g} mm, "
            f"{self.mass:.5g} kg, {self.inertia:.4g} kg m2 about its axis"
        )
        rows = [
            (name, node or "", z * 1e3 if node else "", text) for name, text, node, z in self.parts
        ]
        return Table(title, ("part", "node", "z [mm]", "what it is"), rows)


def inventory(rotor: Rotor) -> Inventory:
    """Return the list of a machine."""
    structure = assemble(rotor)
    parts = []
    for where, part in rotor.named_parts():
        node = getattr(part, "node", 0)
        parts.append((where, part.TEXT, node, rotor.nodes[node - 1] if node > 0 else 0.0))
    return Inventory(
        name=rotor.name,
        mass=float(structure.mass_sum[::2].sum()),
        length=rotor.length,
        inertia=float(structure.numbers[0].inertia),
        nodes=rotor.nodes,
        parts=tuple(parts),
    )
