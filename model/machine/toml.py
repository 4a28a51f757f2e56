"""TOML text -> `Rotor`, with one plain line for whatever is missing, misspelt or impossible."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import MISSING, Field, fields
from difflib import get_close_matches
from importlib.resources import files
from itertools import pairwise
from typing import Any

from ..parts import PARTS
from ..parts.shaft import Material, Section
from ..protocol.part import Part
from ..quantities import QuantityError, check, quantities
from .rotor import Rotor

_SHAFT_KEYS = ("nodes", "diameters", "eta_v", "eta_h", "rotating_damping")
_OWN_KEYS = ("name", "gravity", "material", "shaft")


def rig_toml(name: str = "zigulic2003") -> str:
    """TOML text of a rig that comes with the package."""
    return files(__package__).joinpath("rigs", f"{name}.toml").read_text(encoding="utf-8")


def rig(name: str = "zigulic2003") -> Rotor:
    """A rig that comes with the package."""
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
    _refuse_unknown("", data, (*_OWN_KEYS, *(part.KIND for part in PARTS)))
    for key in ("material", "shaft"):
        if key not in data:
            raise QuantityError(f"[{key}] is missing")
    material = _make(Material, "material", data["material"])
    shaft = _table("shaft", data["shaft"])
    _refuse_unknown("shaft", shaft, _SHAFT_KEYS)
    name = data.get("name", "rotor")
    if not isinstance(name, str):
        raise QuantityError(f"name = {name!r}: must be a string")
    start, sections = _sections(shaft, material)
    return Rotor(
        material=material,
        sections=sections,
        parts=tuple(part for kind in PARTS for part in _parts(kind, data)),
        eta_v=_number(shaft.get("eta_v", 0.0)),
        eta_h=_number(shaft.get("eta_h", 0.0)),
        rotating_damping=shaft.get("rotating_damping", False),
        gravity=_number(data.get("gravity", 9.81)),
        name=name,
        start=start,
    )


def _sections(shaft: dict[str, Any], material: Material) -> tuple[float, tuple[Section, ...]]:
    """Position of the first node [m] and the sections between nodes."""
    for key in ("nodes", "diameters"):
        if not isinstance(shaft.get(key), list):
            raise QuantityError(f"shaft.{key} = {shaft.get(key)!r}: must be a list of numbers [m]")
    nodes, diameters = shaft["nodes"], shaft["diameters"]
    if len(nodes) < 2:
        raise QuantityError(f"shaft.nodes: {len(nodes)} given, at least 2 are needed")
    if len(diameters) != len(nodes) - 1:
        raise QuantityError(
            f"shaft.diameters: {len(diameters)} given, {len(nodes) - 1} needed "
            "(one for each element between two nodes)"
        )
    for i, z in enumerate(nodes, 1):
        check(f"shaft.nodes[{i}]", quantities(Rotor)["start"], z)
    for i, diameter in enumerate(diameters, 1):
        check(f"shaft.element[{i}].diameter", quantities(Section)["outer_left"], diameter)
    ends = pairwise(nodes)
    sections = tuple(
        Section.cylinder(float(right - left), float(diameter), material)
        for (left, right), diameter in zip(ends, diameters, strict=True)
    )
    return float(nodes[0]), sections


def _parts(kind: type[Part], data: dict[str, Any]) -> list[Part]:
    """All parts of a kind."""
    if kind.KIND not in data:
        return []
    given = data[kind.KIND]
    if kind.IS_SINGLE:
        return [_make(kind, kind.KIND, given)]
    if not isinstance(given, list):
        raise QuantityError(f"{kind.KIND} = {given!r}: must be a list of tables, [[{kind.KIND}]]")
    return [_make(kind, f"{kind.KIND}[{i}]", item) for i, item in enumerate(given, 1)]


def _table(where: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise QuantityError(f"{where} = {value!r}: must be a table, [{where}]")
    return value


def _number(value: Any) -> Any:
    """A number as a float; what is none is left to the check of its quantity."""
    is_number = isinstance(value, int) and not isinstance(value, bool)
    return float(value) if is_number and abs(value) < 2**1023 else value


def _refuse_unknown(where: str, table: dict[str, Any], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            name = key if key.isprintable() else repr(key)
            shown = f"{where}.{name}" if where else name
            near = get_close_matches(key, known, 1)
            hint = f"did you mean {near[0]}? " if near else ""
            raise QuantityError(f"{shown}: unknown key; {hint}known are {', '.join(known)}")


def _is_optional(field: Field) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def _make(kind: type, where: str, value: Any) -> Any:
    table = _table(where, value)
    _refuse_unknown(where, table, tuple(f.name for f in fields(kind)))
    for field in fields(kind):
        if not _is_optional(field) and field.name not in table:
            raise QuantityError(f"{where}.{field.name} is missing")
    numbers = quantities(kind)
    return kind(**{k: _number(v) if k in numbers else v for k, v in table.items()})
