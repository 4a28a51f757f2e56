"""The list of a machine's parts, shown with its picture."""

from dataclasses import dataclass

from ..cells import five_digits
from ..display import current
from ..model.machine.rotor import Rotor
from ..model.structure.assembly import assemble
from ..tables import Table


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
        d = current()
        inertia = self.inertia * d.mass * (1.0 if d.length_unit == "mm" else d.length**2)
        unit = f"{d.mass_unit} {'m2' if d.length_unit == 'mm' else f'{d.length_unit}2'}"
        title = (
            f"{self.name}: {len(self.nodes)} nodes, "
            f"{five_digits(self.length * d.length)} {d.length_unit}, "
            f"{five_digits(self.mass * d.mass)} {d.mass_unit}, {inertia:.4g} {unit} about its axis"
        )
        rows = [
            (name, node or "", z * d.length if node else "", text)
            for name, text, node, z in self.parts
        ]
        return Table(title, ("part", "node", f"z [{d.length_unit}]", "what it is"), rows)


def inventory(rotor: Rotor) -> Inventory:
    """Return the list of a machine."""
    structure = assemble(rotor)
    parts = []
    for where, part in rotor.named_parts():
        node = getattr(part, "node", 0)
        name = getattr(part, "name", None) or where  # of a housing, to which bearings refer
        text = part.TEXT if name == where else f"{name}, {part.TEXT}"
        parts.append((where, text, node, rotor.nodes[node - 1] if node > 0 else 0.0))
    return Inventory(
        name=rotor.name,
        mass=float(structure.mass_sum[::2].sum()),
        length=rotor.length,
        inertia=float(structure.numbers[0].inertia),
        nodes=rotor.nodes,
        parts=tuple(parts),
    )
