"""The shaft elements of a rotor that ROSS saved -> sections, layers and materials."""

from typing import Any

from ..parts.shaft import POISSON
from ..quantities import QuantityError
from .ross_element import Element

_SHEARS = {"cowper": "cowper", "hutchinson": "ross-hutchinson"}
_FLAGS = ("shear_effects", "rotary_inertia", "gyroscopic")
_SIDES = ("idl", "odl", "idr", "odr")
_LOADS = ("axial_force", "torque", "alpha", "beta")


def sections_of(
    shaft: list[Element], origins: dict[str, str]
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Return the sections from left to right, the inmost layer first, and their materials; origins:
    takes the element that each of them was."""
    if not shaft:
        raise QuantityError("ShaftElement_... is missing")
    materials: dict[str, Any] = {}
    at: dict[int, list[tuple[dict[str, Any], str]]] = {}
    for element in shaft:
        section = _section(element, materials, origins)
        at.setdefault(element.node(), []).append((section, element.where))
    for n in range(max(at) + 1):
        if n not in at:
            raise QuantityError(
                f"ShaftElement with n = {n} is missing; the elements must be those of one shaft"
            )
    sections = []
    for i, n in enumerate(sorted(at), 1):
        each = sorted(at[n], key=lambda item: item[0]["bore_left"])
        (core, _), *layers = each
        for j, (layer, where) in enumerate(each):
            inner = f".layer[{j}]" if j else ""
            # as the file's reader and as the check of the whole shaft call it
            origins |= {f"{name}[{i}]{inner}": where for name in ("section", "shaft.element")}
            if j and layer.pop("length") != core["length"]:
                raise QuantityError(f"ShaftElement with n = {n}: layers of different L")
        sections.append(core | ({"layer": [layer for layer, _ in layers]} if layers else {}))
    return sections, materials


def _section(
    element: Element, materials: dict[str, Any], origins: dict[str, str]
) -> dict[str, Any]:
    element.refuse_others("L", "n", "material", "shear_method_calc", *_SIDES, *_FLAGS, *_LOADS)
    for flag in _FLAGS:
        value = element.values.get(flag, True)
        if not isinstance(value, bool):
            raise QuantityError(f"{element.where}.{flag} = {value!r}: must be true or false")
        if not value and flag != "shear_effects":
            raise QuantityError(
                f"{element.where}.{flag} = false: not supported, a shaft here always has it"
            )
    element.refuse_nonzero("torque")
    method = element.values.get("shear_method_calc", "cowper")
    if method not in tuple(_SHEARS):
        raise QuantityError(
            f"{element.where}.shear_method_calc = {method!r}: must be cowper or hutchinson"
        )
    bore, outer = element.number("idl"), element.number("odl")
    return {
        "length": element.number("L"),
        "material": _material(element, materials, origins),
        "outer_left": outer,
        "outer_right": element.number("odr", outer),
        "bore_left": bore,
        "bore_right": element.number("idr", bore),
        "axial_force": element.number("axial_force", 0.0),
        "shear": _SHEARS[method] if element.values.get("shear_effects", True) else "rigid",
        "taper": "middle",
    }


def _material(element: Element, materials: dict[str, Any], origins: dict[str, str]) -> str:
    """Return the name of the element's material, which is added to the others."""
    values = element.given("material")
    where = f"{element.where}.material"
    if not isinstance(values, dict):
        raise QuantityError(f"{where} = {values!r}: must be a table")
    inner = Element(where, "Material", values)
    young, shear = inner.number("E"), inner.number("G_s")
    if not shear > 0:
        raise QuantityError(f"{where}.G_s = {shear:g} Pa: must be > 0")
    poisson = young / (2 * shear) - 1
    if not POISSON.allows(poisson):
        raise QuantityError(
            f"{where}: E / (2 G_s) - 1 = {poisson:g}, Poisson's ratio: {POISSON.words}"
        )
    table = {"young": young, "density": inner.number("rho"), "poisson": poisson}
    name = base = str(values.get("name", "material"))
    count = 1
    while materials.setdefault(name, table) != table:
        count += 1
        name = f"{base} {count}"
    origins.setdefault(f"material.{name}", where)
    return name
