"""TOML text -> `Rotor`, with a one-line error for a key that is missing, misspelt or impossible."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import fields
from importlib.resources import files
from typing import Any

from ..parts import PARTS
from ..parts.base import Part
from ..quantities import QuantityError
from .rotor import Rotor
from .shaft_tables import Materials, sections_between, sections_in_turn
from .table_reader import a_table, make, number, refuse_unknown, tables_of

_SHAFT_KEYS = ("nodes", "diameters", "start", "eta_v", "eta_h", "rotating_damping")
_OWN_KEYS = (
    "name", "gravity", "gravity_angle", "inclination", "material", "shaft", "section",
)  # fmt: skip
_SAME = 1e-9  # of the shaft's length: positions that are one


def rig_toml(name: str = "zigulic2003") -> str:
    """Return the TOML text of a rig that comes with the package."""
    return files(__package__).joinpath("rigs", f"{name}.toml").read_text(encoding="utf-8")


def rig(name: str = "zigulic2003") -> Rotor:
    """Return a rig that comes with the package."""
    return parse_rotor(rig_toml(name))


def parse_rotor(text: str) -> Rotor:
    """Read a machine from TOML text (SI units; `machine/rigs/zigulic2003.toml` is the example).

    Raises `QuantityError` naming the key, its value and what is allowed.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise QuantityError(f"not valid TOML: {reason}") from error
    refuse_unknown("", data, (*_OWN_KEYS, *(part.KIND for part in PARTS)))
    for key in ("material",) if "section" in data else ("material", "shaft"):
        if key not in data:
            raise QuantityError(f"[{key}] is missing")
    materials = Materials(data["material"])
    shaft = a_table("shaft", data.get("shaft", {}))
    refuse_unknown("shaft", shaft, _SHAFT_KEYS)
    name = data.get("name", "rotor")
    if not isinstance(name, str):
        raise QuantityError(f"name = {name!r}: must be a string")
    if "section" in data:
        for key in ("nodes", "diameters"):
            if key in shaft:
                raise QuantityError(f"shaft.{key}: is given beside [[section]]")
        sections = sections_in_turn(data["section"], materials)
        start = number(shaft.get("start", 0.0))
    else:
        if "start" in shaft:
            raise QuantityError("shaft.start: is given beside shaft.nodes")
        start, sections = sections_between(
            shaft.get("nodes"), shaft.get("diameters"), materials.own
        )
    bare = Rotor(material=materials.own, sections=sections, parts=(), start=start)
    return Rotor(
        material=materials.own,
        sections=sections,
        parts=tuple(p for kind in PARTS for p in _parts(kind, data, bare.nodes, materials)),
        eta_v=number(shaft.get("eta_v", 0.0)),
        eta_h=number(shaft.get("eta_h", 0.0)),
        rotating_damping=shaft.get("rotating_damping", False),
        gravity=number(data.get("gravity", 9.81)),
        gravity_angle=number(data.get("gravity_angle", 0.0)),
        inclination=number(data.get("inclination", 0.0)),
        name=name,
        start=start,
    )


def _parts(
    kind: type[Part], data: dict[str, Any], nodes: Sequence[float], materials: Materials
) -> list[Part]:
    """Return all parts of a kind."""
    if kind.KIND not in data:
        return []
    if kind.IS_SINGLE:
        given = [(kind.KIND, a_table(kind.KIND, data[kind.KIND]))]
    else:
        given = tables_of(kind.KIND, data[kind.KIND])
    names = {field.name for field in fields(kind)}
    parts = []
    for where, table in given:
        values = dict(table)
        if "z" in values and "node" in names and "z" not in names:
            values["node"] = _node_at(where, values, nodes)
        if "material" in values and "material" in names:
            values["material"] = materials.take(f"{where}.material", values["material"])
        parts.append(make(kind, where, values))
    return parts


def _node_at(where: str, values: dict[str, Any], nodes: Sequence[float]) -> int:
    """Return the node at the position z [m], which may be given in the place of its number."""
    z = number(values.pop("z"))
    if "node" in values:
        raise QuantityError(f"{where}.z: is given beside {where}.node")
    if isinstance(z, bool) or not isinstance(z, float):
        raise QuantityError(f"{where}.z = {z!r}: must be a number")
    node = min(range(len(nodes)), key=lambda i: abs(nodes[i] - z))
    if not abs(nodes[node] - z) <= _SAME * (nodes[-1] - nodes[0]):
        raise QuantityError(
            f"{where}.z = {z:g} m: no node is there; the nearest is node {node + 1} at "
            f"{nodes[node]:g} m"
        )
    return node + 1
