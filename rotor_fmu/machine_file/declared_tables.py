"""The tables of a machine file with their keys, as the data classes declare them."""

from collections.abc import Iterator
from dataclasses import MISSING, dataclass, fields
from typing import Any

from ..model.machine.operating_speeds import Operation
from ..model.machine.rotor import OF_SHAFT, Rotor
from ..model.parts import PARTS
from ..model.parts.base import Part
from ..model.parts.housing import Housing
from ..model.parts.journal_bearing import RUPTURES
from ..model.parts.shaft import SHEARS, TAPERS, Material, Section
from ..model.quantities import Quantity, quantities


@dataclass(frozen=True)
class Key:
    """A key of a table: its quantity, or `text`, `choices` and `unit`, empty of what is no number;
    default: None where it must be given."""

    name: str
    quantity: Quantity | None
    text: str
    default: Any = None
    is_needed: bool = False
    choices: tuple[str, ...] = ()
    kind: str = "number"
    unit: str = ""

    @property
    def measured_in(self) -> str:
        """The SI unit of its numbers, empty where it has none."""
        if self.quantity is None:
            return self.unit
        return "" if self.quantity.is_switch else self.quantity.unit


@dataclass(frozen=True)
class Table:
    """A table: how it is headed, its description, whether there may be several, its keys."""

    heading: str
    name: str
    text: str
    is_list: bool
    keys: tuple[Key, ...]


# Keys that are no quantities, by their names.
_WORDS = {
    "node": ("integer", "number of the node of the shaft, from 1; or `z`, a position [m]"),
    "housing": ("string", "name of the `[[housing]]` that it sits on; ground without"),
    "ring": ("string", "name of the `[[housing]]` that is its ring; the node itself without"),
    "name": ("word", "name, by which the FMU, pictures and other parts call it"),
    "material": ("string", "name of a `[material.NAME]`; the machine's own without"),
    "rupture": ("string", "where the film ruptures: as Reynolds says, or Guembel"),
}
_CHOICES = {"rupture": RUPTURES}


def part_tables() -> Iterator[Table]:
    """The table of every kind of part."""
    for kind in PARTS:
        heading = f"[{kind.KIND}]" if kind.IS_SINGLE else f"[[{kind.KIND}]]"
        yield Table(heading, kind.KIND, kind.TEXT, not kind.IS_SINGLE, tuple(_keys_of(kind)))


def _keys_of(kind: type[Part] | type[Operation] | type[Material]) -> Iterator[Key]:
    numbers = quantities(kind)
    ordered = sorted(fields(kind), key=lambda field: field.name in numbers)
    for field in ordered:
        default = None if field.default is MISSING else field.default
        is_needed = field.default is MISSING
        if field.name in numbers:
            quantity = numbers[field.name]
            yield Key(field.name, quantity, quantity.text, default, is_needed)
        else:
            word, text = _WORDS[field.name]
            if kind is Housing:  # whose name other parts say, and no variable
                word = "string"
            choices = _CHOICES.get(field.name, ())
            yield Key(field.name, None, text, default or None, is_needed, choices, word)
            if field.name == "node":
                yield Key("z", None, "position along the shaft; a node is put there [m]", unit="m")


def own_tables() -> Iterator[Table]:
    """What stands beside the parts: the machine's own keys, material, shaft and sections."""
    own = quantities(Rotor)
    top = [Key("name", None, "name of the machine", "rotor", kind="string")]
    top.append(Key("identifier", None, "name of its FMU, made from `name`", kind="string"))
    text = "units that tables and pictures show: `us`, or words such as `rpm, mil, pp`"
    top.append(Key("units", None, text, kind="string"))
    text = (
        "machine file that this one adds to: keys replace its own, parts follow its own; an empty "
        "list, such as `seal = []`, removes its parts of that kind, which a file that extends this "
        "one may replace"
    )
    top.append(Key("extends", None, text, kind="string"))
    defaults = {field.name: field.default for field in fields(Rotor)}
    for name in ("gravity", "gravity_angle", "inclination"):
        top.append(Key(name, own[name], own[name].text, defaults[name]))
    yield Table("", "", "The machine as a whole.", False, tuple(top))
    text = "how the machine is run; what is left out follows from its lowest natural frequency"
    yield Table("[operation]", "operation", text, False, tuple(_keys_of(Operation)))
    text = "of discs and of the shaft; `[material.NAME]` for others"
    yield Table("[material]", "material", text, False, tuple(_keys_of(Material)))
    shaft = [
        Key("nodes", None, "positions of the nodes [m], ascending", kind="numbers", unit="m"),
        Key("diameters", None, "of the cylinders between them [m]", kind="numbers", unit="m"),
        Key("start", own["start"], "position of the first node, with `[[section]]`", 0.0),
    ]
    for name in OF_SHAFT:
        shaft.append(Key(name, own[name], own[name].text, defaults[name]))
    yield Table("[shaft]", "shaft", "nodes and what lies between them", False, tuple(shaft))
    text = "one stretch of the shaft after another, in the place of `nodes` and `diameters`"
    yield Table("[[section]]", "section", text, True, tuple(_section_keys()))


def _section_keys() -> Iterator[Key]:
    quantity = quantities(Section)
    yield Key("length", quantity["length"], "length", is_needed=True)
    yield Key("elements", None, "elements that it is divided into", 1, kind="integer")
    for name, end in (("outer", "outer diameter"), ("bore", "diameter of the bore")):
        default = 0.0 if name == "bore" else None
        yield Key(name, quantity[f"{name}_left"], end, default)
        for side in ("left", "right"):
            yield Key(f"{name}_{side}", quantity[f"{name}_{side}"], f"{end} at its {side} end")
    yield Key("material", None, _WORDS["material"][1], kind="string")
    yield Key("axial_force", quantity["axial_force"], quantity["axial_force"].text, 0.0)
    yield Key("shear", None, "shear coefficient", SHEARS[0], choices=SHEARS, kind="string")
    text = (
        "shape if it tapers or has layers: its own, or a cylinder's of mean or (ROSS) middle shear"
    )
    yield Key("taper", None, text, TAPERS[0], choices=TAPERS, kind="string")
    yield Key("layer", None, "`[[section.layer]]`: what else lies there", kind="tables")
