"""Numbers with units in a machine file, `"0.1 mm"`, turned into SI units.

A table may also name the unit of a whole column or key: `units = { speed = "rpm", kxx = "MN/m" }`
holds for all plain numbers of that name in its table.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

from ..errors import InputError
from ..model.machine.table_reader import nearest
from ..model.quantities import EXPONENT, unit_of
from ..units import factor, in_si, split
from .declared_tables import Key, own_tables, part_tables

_UNITS = "units"
_NESTED = "layer"  # tables in a section, with a section's keys


@cache
def _keys() -> dict[str, dict[str, Key]]:
    """The keys that are numbers with a unit, by the name of their table and their own."""
    return {
        table.name: {key.name: key for key in table.keys if key.measured_in}
        for table in (*own_tables(), *part_tables())
    }


def in_si_units(data: Mapping[str, Any], where: str = "") -> dict[str, Any]:
    """Return the tables of a machine file with every number in SI units; where: what messages begin
    with. Raises `InputError` for a unit that is unknown or does not fit."""
    known = _keys()
    # `units` of the machine as a whole are those of its pictures
    plain = {key: value for key, value in data.items() if key not in known and key != _UNITS}
    result = _converted(where, plain, known[""])
    if _UNITS in data:
        result[_UNITS] = data[_UNITS]
    for name in (key for key in data if key in known):
        result[name] = _tables(f"{where}{name}", data[name], known[name])
    return {key: result[key] for key in data}


def _tables(where: str, given: Any, keys: Mapping[str, Key]) -> Any:
    """Return a table, a list of tables, or a table of named ones."""
    if isinstance(given, list):
        return [_tables(f"{where}[{i}]", item, keys) for i, item in enumerate(given, 1)]
    if not isinstance(given, dict):
        return given
    inner = {
        name: _tables(f"{where}.{name}", item, keys)
        for name, item in given.items()
        if name == _NESTED or (name not in keys and name != _UNITS and isinstance(item, dict))
    }
    return _converted(f"{where}.", given, keys) | inner


def _converted(where: str, table: Mapping[str, Any], keys: Mapping[str, Key]) -> dict[str, Any]:
    """Return a table with the values of these keys in SI units."""
    units = table.get(_UNITS, {}) if keys else {}
    if not isinstance(units, dict):
        raise InputError(f"{where}{_UNITS} = {units!r}: must be a table, {{ key = 'unit' }}")
    for name in units:
        if name not in keys or name not in table:
            given = [key for key in keys if key in table]
            hint = f"{nearest(name, given)}of this table are {', '.join(given) or 'none'}"
            raise InputError(f"{where}{_UNITS}.{name}: no number of that name is here; {hint}")
    values = {name: value for name, value in table.items() if name != _UNITS}
    usual = keys[EXPONENT].default if EXPONENT in keys else None
    for name in values.keys() & keys.keys():
        unit = unit_of(keys[name].measured_in, values.get(EXPONENT, usual))
        factor_of_plain = 1.0
        if name in units:
            shown = f"{where}{_UNITS}.{name} = {units[name]!r}"
            factor_of_plain = factor(shown, str(units[name]), unit)
        values[name] = _value(f"{where}{name} =", values[name], unit, factor_of_plain)
    return values


def _value(shown: str, value: Any, unit: str, factor_of_plain: float) -> Any:
    if isinstance(value, list):
        return [_value(shown, item, unit, factor_of_plain) for item in value]
    if isinstance(value, str):  # a plain number too, where no unit stands behind it
        is_plain = (split(value) or (0.0, value))[1] == ""
        return in_si(shown, value, unit) * (factor_of_plain if is_plain else 1.0)
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return value * factor_of_plain if is_number and factor_of_plain != 1.0 else value
