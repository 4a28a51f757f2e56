"""The tables of a TOML file that describe the shaft: materials, and sections between nodes.

Either `[shaft]` gives the nodes' positions and a diameter between any two, or `[[section]]` tables
describe one stretch after another, each of one or more elements:

    length, elements (1), material, axial_force (0), shear ("cowper"), taper ("exact")
    outer, or outer_left and outer_right; bore (0), or bore_left and bore_right
    [[section.layer]]: another layer there, such as a sleeve, given in the same way
"""

from itertools import pairwise
from typing import Any

from ..arguments import check_integer
from ..parts.shaft import Material, Section
from ..quantities import ANY, Quantity, QuantityError, check, quantities
from .table_reader import a_table, make, nearest, number, refuse_unknown, tables_of

_PROFILE_KEYS = (
    "outer", "outer_left", "outer_right", "bore", "bore_left", "bore_right", "material",
    "axial_force", "shear", "taper",
)  # fmt: skip
_SECTION_KEYS = ("length", "elements", *_PROFILE_KEYS, "layer")
POSITION = Quantity("m", "position along the shaft", ANY)
# More do not improve a beam: the rounding error of its stiffness grows with the fourth power.
MOST_ELEMENTS = 1000


class Materials:
    """The materials of a file: the machine's own, and others by their names.

    `[material]` is the machine's own; `[material.brass]` has a name. Where all have names, the
    first is the machine's own.
    """

    def __init__(self, given: Any) -> None:
        table = a_table("material", given)
        named = {name: item for name, item in table.items() if isinstance(item, dict)}
        own = {name: item for name, item in table.items() if name not in named}
        self.named: dict[str, Material] = {
            name: _material(f"material.{name}", t) for name, t in named.items()
        }
        if own or not named:
            self.own = make(Material, "material", own)
        else:
            self.own = next(iter(self.named.values()))

    def take(self, where: str, name: Any) -> Material:
        """Return the material of this name, as `where` gives it."""
        if not isinstance(name, str) or name not in self.named:
            known = ", ".join(self.named) or "none"
            raise QuantityError(
                f"{where} = {name!r}: no material of that name; {nearest(name, self.named)}"
                f"there is {known}"
            )
        return self.named[name]


def _material(where: str, table: dict[str, Any]) -> Material:
    """Return a named material, whose values are refused by its name."""
    for name, rule in quantities(Material).items():
        if name in table:
            check(f"{where}.{name}", rule, table[name])
    material: Material = make(Material, where, table)
    return material


def sections_between(
    nodes: Any, diameters: Any, material: Material
) -> tuple[float, tuple[Section, ...]]:
    """Return the position of the first node [m] and solid cylinders between nodes."""
    for key, given in (("nodes", nodes), ("diameters", diameters)):
        if not isinstance(given, list):
            raise QuantityError(f"shaft.{key} = {given!r}: must be a list of numbers [m]")
    if len(nodes) > MOST_ELEMENTS + 1:
        raise QuantityError(f"shaft.nodes: {len(nodes)} given, at most {MOST_ELEMENTS + 1}")
    if len(nodes) < 2:
        raise QuantityError(f"shaft.nodes: {len(nodes)} given, at least 2 are needed")
    if len(diameters) != len(nodes) - 1:
        raise QuantityError(
            f"shaft.diameters: {len(diameters)} given, {len(nodes) - 1} needed "
            "(one for each element between two nodes)"
        )
    for i, z in enumerate(nodes, 1):
        check(f"shaft.nodes[{i}]", POSITION, z)
    for i, diameter in enumerate(diameters, 1):
        check(f"shaft.diameters[{i}]", quantities(Section)["outer_left"], diameter)
    ends = pairwise(nodes)
    sections = tuple(
        Section.cylinder(float(right - left), float(diameter), material)
        for (left, right), diameter in zip(ends, diameters, strict=True)
    )
    return float(nodes[0]), sections


def sections_in_turn(given: Any, materials: Materials) -> tuple[Section, ...]:
    """Return the shaft from `[[section]]` tables, left to right, each cut into its elements."""
    sections: list[Section] = []
    for where, table in tables_of("section", given):
        refuse_unknown(where, table, _SECTION_KEYS)
        if "length" not in table:
            raise QuantityError(f"{where}.length is missing")
        check(f"{where}.length", quantities(Section)["length"], table["length"])
        count = table.get("elements", 1)
        check_integer(f"{where}.elements", count, 1, MOST_ELEMENTS, QuantityError)
        if len(sections) + count > MOST_ELEMENTS:
            raise QuantityError(
                f"{where}.elements = {count}: a shaft has at most {MOST_ELEMENTS} elements, and "
                f"{len(sections)} lie before"
            )
        length = float(table["length"])
        profiles = [_profile(where, table, length, materials)]
        for inner, layer in tables_of(f"{where}.layer", table.get("layer", [])):
            refuse_unknown(inner, layer, _PROFILE_KEYS)
            profiles.append(_profile(inner, layer, length, materials))
        for i in range(count):
            core, *layers = (profile.part(i / count, (i + 1) / count) for profile in profiles)
            sections.append(core.with_layers(*layers))
    return tuple(sections)


def _profile(where: str, table: dict[str, Any], length: float, materials: Materials) -> Section:
    """Return the diameters and the material that a table gives."""
    values: dict[str, Any] = {"axial_force": table.get("axial_force", 0.0)}
    for name, default in (("outer", None), ("bore", 0.0)):
        sides = [f"{name}_left", f"{name}_right"]
        if name in table and any(side in table for side in sides):
            raise QuantityError(
                f"{where}.{name}: cannot be combined with {name}_left or {name}_right"
            )
        for side in sides:
            values[side] = table.get(side, table.get(name, default))
            if values[side] is None:
                raise QuantityError(f"{where}.{name} is missing, or {side}")
    for name, value in values.items():
        check(f"{where}.{name}", quantities(Section)[name], value)
    material = materials.own
    if "material" in table:
        material = materials.take(f"{where}.material", table["material"])
    choices = {name: table[name] for name in ("shear", "taper") if name in table}
    sizes = {name: number(value) for name, value in values.items()}
    section = Section(length=length, material=material, **choices, **sizes)
    section.check(where)
    return section
