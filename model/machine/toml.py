"""TOML text -> `Rotor`, with one plain line for whatever is missing, misspelt or impossible."""

from __future__ import annotations

import tomllib
from dataclasses import MISSING, fields
from importlib.resources import files
from typing import Any

from .rotor import Bearing, Disc, Material, Rotor, RotorError, Support

_SHAFT_KEYS = ("nodes", "diameters", "eta_v", "eta_h", "rotating_damping")


def rig_toml(name: str = "zigulic2003") -> str:
    """TOML text of a rig that comes with the package."""
    return files(__package__).joinpath("rigs", f"{name}.toml").read_text(encoding="utf-8")


def rig(name: str = "zigulic2003") -> Rotor:
    """A rig that comes with the package."""
    return parse_rotor(rig_toml(name))


def parse_rotor(text: str) -> Rotor:
    """Read a rotor from TOML text (SI units; `model/rigs/zigulic2003.toml` is the example).

    Raises `RotorError` naming the key, its value and what is allowed.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise RotorError(f"not valid TOML: {reason}") from error
    _refuse_unknown(
        "",
        data,
        ("name", "gravity", "material", "shaft", "coupling", "disc", "bearing", "support"),
    )
    for key in ("material", "shaft"):
        if key not in data:
            raise RotorError(f"[{key}] is missing")
    shaft = _table("shaft", data["shaft"])
    _refuse_unknown("shaft", shaft, _SHAFT_KEYS)
    for key in ("nodes", "diameters"):
        if not isinstance(shaft.get(key), list):
            raise RotorError(f"shaft.{key} = {shaft.get(key)!r}: must be a list of numbers [m]")
    rotating = shaft.get("rotating_damping", False)
    if not isinstance(rotating, bool):
        raise RotorError(f"shaft.rotating_damping = {rotating!r}: must be true or false")
    name = data.get("name", "rotor")
    if not isinstance(name, str):
        raise RotorError(f"name = {name!r}: must be a string")
    return Rotor(
        material=_make(Material, "material", data["material"]),
        nodes=tuple(shaft["nodes"]),
        diameters=tuple(shaft["diameters"]),
        discs=_make_all(Disc, "disc", data.get("disc", [])),
        bearings=_make_all(Bearing, "bearing", data.get("bearing", [])),
        supports=_make_all(Support, "support", data.get("support", [])),
        coupling=_make(Disc, "coupling", data["coupling"]) if "coupling" in data else None,
        eta_v=shaft.get("eta_v", 0.0),
        eta_h=shaft.get("eta_h", 0.0),
        rotating_damping=rotating,
        gravity=data.get("gravity", 9.81),
        name=name,
    )


def _table(where: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise RotorError(f"{where} = {value!r}: must be a table, [{where}]")
    return value


def _refuse_unknown(where: str, table: dict[str, Any], known: tuple[str, ...]) -> None:
    for key in table:
        if key not in known:
            name = key if key.isprintable() else repr(key)
            shown = f"{where}.{name}" if where else name
            raise RotorError(f"{shown}: unknown key; known are {', '.join(known)}")


def _make(kind: type, where: str, value: Any) -> Any:
    table = _table(where, value)
    _refuse_unknown(where, table, tuple(f.name for f in fields(kind)))
    for field in fields(kind):
        if field.default is MISSING and field.name not in table:
            raise RotorError(f"{where}.{field.name} is missing")
    return kind(**table)


def _make_all(kind: type, where: str, value: Any) -> tuple:
    if not isinstance(value, list):
        raise RotorError(f"{where} = {value!r}: must be a list of tables, [[{where}]]")
    return tuple(_make(kind, f"{where}[{i}]", item) for i, item in enumerate(value, 1))
