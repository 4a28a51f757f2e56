"""Units that users write and see besides SI units; inside, everything is in SI units.

The usual ones of speeds and inputs stand here; all others are read by pint, which is imported where
one is written.
"""

import math
import re
import sys
from functools import cache
from typing import Any

from .errors import InputError, optional

# what one of it is in the SI unit above it
_OTHERS = {
    "rad": {"deg": math.pi / 180.0},
    "rad/s": {"rpm": math.pi / 30.0, "Hz": 2.0 * math.pi},
    "rad/s2": {"rpm/s": math.pi / 30.0, "Hz/s": 2.0 * math.pi},
    "s": {"ms": 1e-3, "min": 60.0},
    "N": {"mN": 1e-3, "kN": 1e3},
    "N.m": {"mN.m": 1e-3, "kN.m": 1e3},
    "m/s2": {"g": 9.80665},
}
# What a unit measures, and others in which it is given.
_MEASURED = {
    "m": ("a length", "mm, um, inch, mil"),
    "s": ("a time", "ms, min"),
    "kg": ("a mass", "g, t, lb"),
    "rad": ("an angle", "deg"),
    "rad/s": ("a speed of rotation", "rpm, Hz"),
    "rad/s2": ("a rate of the speed", "rpm/s, Hz/s"),
    "1/s": ("a rate without turns", "1/min"),
    "m/s": ("a velocity", "mm/s, in/s"),
    "m/s2": ("an acceleration", "mm/s2, g"),
    "N": ("a force", "kN, lbf"),
    "N.m": ("a torque", "N.mm, lbf.in"),
    "N/m": ("a stiffness", "N/mm, MN/m, lbf/in"),
    "N.s/m": ("a damping", "N.s/mm, kN.s/m, lbf.s/in"),
    "W": ("a power", "kW, hp"),
    "Pa": ("a stress or a pressure", "GPa, MPa, bar, psi"),
    "kg/m3": ("a density", "g/cm3, lb/in3"),
    "kg.m": ("an unbalance", "g.mm, oz.in"),
    "kg.m2": ("a moment of inertia", "kg.mm2, lb.in2"),
    "Pa.s": ("a viscosity", "mPa.s, cP"),
    "J/(kg.K)": ("a specific heat", "kJ/(kg.K), BTU/(lb.degF)"),
    "degC": ("a temperature", ""),
    "1": ("a number", "percent"),
}
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^:]*?)\s*")
# What no unit contains: characters but letters, digits and signs of powers, products and quotients,
# differences, and numbers that are no exponents nor the 1 of 1/min. Pint would leave them out or
# calculate with them: 2 mm# 3, 0,01 mm, 1 000 rpm and 1+1 mm would be 2 mm, 0, 0 and 1.
_NO_UNIT = re.compile(r"^\.|[^\w\s*^/().\-·⋅%°]|\s-|-\s|(?<![\w.^)])(?<!\*\*)(?<!\^-)(?<!\*\*-)\d")
# What has the same name in two systems of units: what pint would take it for is not what most mean.
_AMBIGUOUS = {
    "gr": "grams or grains? write g or grain",
    "ton": "metric, short or long tons? write t, short_ton or long_ton",
}
# A cycle is a turn here, and what has no angle in it is no speed of rotation.
_OURS = (
    "hertz = 2 * pi * radian / second = Hz",
    "cpm = revolution / minute",
    "inch_mil = 0.001 * inch = mil = mils",
    "lbm = pound",
    "@alias gram = gm",
    "@alias revolution = rev",
)
_ANGLES = ("radian", "degree", "revolution", "turn", "cycle", "hertz", "per_minute", "cpm", "rpm")


def split(text: str) -> tuple[float, str] | None:
    """Return a number and the unit behind it, empty where there is none; None if the text does not
    begin with a number."""
    match = _NUMBER.fullmatch(text)
    return (float(match[1]), match[2]) if match and math.isfinite(float(match[1])) else None


def in_si(shown: str, text: str, si: str) -> float:
    """Return a number with or without unit, `0.1 mm`, in an SI unit; shown: what is given.

    Raises `InputError` where it is no number, or its unit is unknown or measures something else.
    """
    parts = split(text)
    if parts is None:
        examples = _MEASURED.get(si, ("", ""))[1].replace(", ", " or ")
        others = f", in {si}{f' or with {examples} behind it' if examples else ''}"
        raise InputError(f"{shown} {text}: must be a number{'' if si == '1' else others}")
    number, unit = parts
    return number * factor(f"{shown} {text}", unit, si) if unit else number


def number(where: str, value: object, unit: str = "") -> float:
    """Return the finite number of a file or a text; unit: the SI unit in which it is, if it may be
    given in another, such as `3000 rpm`. Raises `InputError`, which begins with `where`."""
    if unit and isinstance(value, str):
        return in_si(f"{where} =", value, unit)
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, float))
        or not abs(value) <= sys.float_info.max
    ):
        raise InputError(f"{where} = {value!r}: must be a finite number")
    return float(value)


def factor(shown: str, unit: str, si: str) -> float:
    """Return what one of a unit is in the SI unit; shown: what is given, for `InputError`."""
    known = {name.lower(): value for name, value in _OTHERS.get(si, {}).items()}
    if unit == si:
        return 1.0
    if si.startswith("rad/s") and unit.lower() in known:
        return known[unit.lower()]
    if unit in _OTHERS.get(si, {}):
        return _OTHERS[si][unit]
    if si == "degC":  # a scale with an offset has no factor
        raise InputError(f"{shown}: {_must_be(si)}")
    for name, question in _AMBIGUOUS.items():
        if re.search(rf"(?<![A-Za-z_]){name}s?(?![A-Za-z_])", unit):
            raise InputError(f"{shown}: {question}")
    unknown = InputError(f"{shown}: the unit {unit!r} is unknown; {_must_be(si)}")
    if _NO_UNIT.search(re.sub(r"^1\s*/|\s*(\^|\*\*)\s*", r"\1", unit)):
        raise unknown
    optional("pint", "units", shown)
    registry = _registry()
    try:
        asked = registry.parse_expression(_spelled(unit))
        asked = asked if hasattr(asked, "units") else registry.Quantity(asked)
    except Exception as error:  # its reader raises many kinds, of Python's tokenizer too
        raise unknown from error
    is_turning = any(name in str(asked.units) for name in _ANGLES)
    try:
        result = float(asked.to(_spelled(si)).magnitude)
    except Exception as error:
        raise InputError(f"{shown}: {_must_be(si)}") from error
    if si.startswith("rad/s") and not is_turning:
        raise InputError(f"{shown}: radians or turns a {unit!r}? {_must_be(si)}")
    if si == "1/s" and is_turning:  # Hz would be 2 pi of it
        raise InputError(f"{shown}: {_must_be(si)}")
    return result


def _must_be(si: str) -> str:
    measured, examples = _MEASURED.get(si, ("", ""))
    kind = f"{measured}, " if measured else ""
    return f"must be {kind}in {si}{f' or such as {examples}' if examples else ''}"


def _spelled(unit: str) -> str:
    """Return a unit as pint reads it: `kg.m2` and `oz-in` have `**` and `*`, and a degree of
    temperature within a unit is that of a difference."""
    text = re.sub(r"(?:deg|°)([CF])\b", r"delta_deg\1", unit)
    text = text.replace("µ", "u").replace("μ", "u").replace("·", "*").replace("⋅", "*")
    text = re.sub(r"(?<=[A-Za-z0-9)])[.\-](?=[A-Za-z(])", "*", text)
    return re.sub(r"(?<=[A-Za-z])(\d)", r"**\1", text)


@cache
def _registry() -> Any:
    import pint

    registry: Any = pint.UnitRegistry(on_redefinition="ignore")
    for definition in _OURS:
        registry.define(definition)
    return registry
