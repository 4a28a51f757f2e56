"""TOML text -> `Rotor`, with a one-line error for a key that is missing, misspelt or impossible."""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import fields
from importlib.resources import files
from typing import Any

from ..parts import PARTS
from ..parts.base import Part
from ..parts.base_and_start import Start
from ..parts.bow import Bow
from ..quantities import GRAVITY, QuantityError, check
from .mesh import Mesh
from .operating_speeds import Operation
from .rotor import OF_SHAFT, Rotor
from .shaft_tables import POSITION, Materials, sections_between, sections_in_turn
from .table_reader import UnfitKeys, a_table, fits, make, number, refuse_unknown, tables_of

_SHAFT_KEYS = ("nodes", "diameters", "start", *OF_SHAFT)
_OWN_KEYS = (
    "name", "identifier", "units", "gravity", "gravity_angle", "inclination", "operation",
    "material", "shaft", "section",
)  # fmt: skip


def rig_toml() -> str:
    """Return the TOML text of the rig that comes with the package."""
    return files(__package__).joinpath("rigs", "zigulic2003.toml").read_text(encoding="utf-8")


def rig() -> Rotor:
    """Return the rig that comes with the package."""
    return parse_rotor(rig_toml())


def parse_rotor(text: str) -> Rotor:
    """Read a machine from TOML text (SI units; `machine/rigs/zigulic2003.toml` is the example).

    Raises `QuantityError` naming the key, its value and what is allowed.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise QuantityError(_closed_list(text) or f"not valid TOML: {error}") from error
    refuse_unknown("", data, (*_OWN_KEYS, *(part.KIND for part in PARTS)))
    for key in ("material",) if "section" in data else ("material", "shaft"):
        if key not in data:
            raise QuantityError(f"[{key}] is missing")
    materials = Materials(data["material"])
    shaft = a_table("shaft", data.get("shaft", {}))
    refuse_unknown("shaft", shaft, _SHAFT_KEYS)
    if "section" in data:
        for key in ("nodes", "diameters"):
            if key in shaft:
                raise QuantityError(f"shaft.{key}: cannot be combined with [[section]]")
        sections = sections_in_turn(data["section"], materials)
        start = number(shaft.get("start", 0.0))
    else:
        if "start" in shaft:
            raise QuantityError("shaft.start: cannot be combined with shaft.nodes")
        start, sections = sections_between(
            shaft.get("nodes"), shaft.get("diameters"), materials.own
        )
    Rotor(material=materials.own, sections=sections, parts=(), start=start)  # checked
    mesh = Mesh(sections, start, list(_places(data)))
    rotor = Rotor(
        material=materials.own,
        sections=mesh.sections,
        parts=tuple(p for kind in PARTS for p in _parts(kind, data, mesh, materials)),
        **{name: number(shaft[name]) for name in OF_SHAFT if name in shaft},
        gravity=number(data.get("gravity", GRAVITY)),
        gravity_angle=number(data.get("gravity_angle", 0.0)),
        inclination=number(data.get("inclination", 0.0)),
        name=data.get("name", "rotor"),
        start=start,
        operation=make(Operation, "operation", data.get("operation", {})),
        identifier=data.get("identifier", ""),
        units=data.get("units", ""),
    )
    if {Start, Bow} <= set(map(type, rotor.parts)):
        raise QuantityError("start: cannot be given with a bow, whose shaft is not straight")
    return rotor


def _closed_list(text: str) -> str:
    """Return one line about a list in one piece, as `disc = []` is, and tables that would add to
    it, which TOML does not allow; nothing where there is none."""
    for kind in (part.KIND for part in PARTS):
        forms = (rf"^{kind}[ \t]*=[ \t]*\[", rf"^[ \t]*\[\[[ \t]*{kind}[ \t]*\]\]")
        if all(re.search(form, text, re.MULTILINE) for form in forms):
            return (
                f"{kind} = [...]: is a whole list, to which [[{kind}]] cannot add; to replace the "
                f"parts of another file, extend one that extends it and has `{kind} = []`"
            )
    return ""


def _tables(kind: type[Part], data: dict[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    """Return the tables of a kind of part, each with its name."""
    if kind.KIND not in data:
        return []
    if kind.IS_SINGLE:
        return [(kind.KIND, a_table(kind.KIND, data[kind.KIND]))]
    return tables_of(kind.KIND, data[kind.KIND])


def _has_place(kind: type[Part]) -> bool:
    """Return whether a kind of part sits on a node, which z may give."""
    names = {field.name for field in fields(kind)}
    return "node" in names and "z" not in names


def _places(data: dict[str, Any]) -> Iterator[tuple[str, float]]:
    """Yield every part that is placed by z, and its z [m]."""
    for kind in filter(_has_place, PARTS):
        for where, table in _tables(kind, data):
            if "z" not in table:
                continue
            if "node" in table:
                raise QuantityError(f"{where}.z: cannot be combined with {where}.node")
            check(f"{where}.z", POSITION, table["z"])
            yield where, float(table["z"])


def _parts(
    kind: type[Part], data: dict[str, Any], mesh: Mesh, materials: Materials
) -> Iterator[Part]:
    names = {field.name for field in fields(kind)}
    for where, table in _tables(kind, data):
        values = dict(table)
        if _has_place(kind):
            if "z" in values:
                values["node"] = mesh.node_at(float(values.pop("z")))
            elif "node" in values:
                values["node"] = mesh.node(where, values["node"])
        if "material" in values and "material" in names:
            values["material"] = materials.take(f"{where}.material", values["material"])
        try:
            yield make(kind, where, values)
        except UnfitKeys as error:
            is_misspelt = fits(kind, values)
            others = [] if is_misspelt else [f"[[{of.KIND}]]" for of in PARTS if fits(of, values)]
            hint = f"; the keys given are those of {' or '.join(others)}" if others else ""
            raise QuantityError(f"{error}{hint}") from error
