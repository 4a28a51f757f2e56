"""Tables of a TOML file -> data classes, with a one-line error for a key that is missing, misspelt
or of the wrong type."""

from collections.abc import Collection
from dataclasses import MISSING, Field, fields
from typing import Any

from ..near_names import near_names
from ..quantities import QuantityError, quantities


class UnfitKeys(QuantityError):
    """A table with a key that it does not have, or without one that it needs."""


def a_table(where: str, value: Any) -> dict[str, Any]:
    """Return the value, which must be a table."""
    if not isinstance(value, dict):
        raise QuantityError(f"{where} = {value!r}: must be a table, [{where}]")
    return value


def tables_of(where: str, given: Any) -> list[tuple[str, dict[str, Any]]]:
    """Return a list of tables, each with its name, `disc[1]`."""
    if not isinstance(given, list):
        raise QuantityError(f"{where} = {given!r}: must be a list of tables, [[{where}]]")
    return [(f"{where}[{i}]", a_table(f"{where}[{i}]", item)) for i, item in enumerate(given, 1)]


def number(value: Any, may_be_list: bool = False) -> Any:
    """Return a number as a float, and a list as a tuple of floats if it may be one; anything else
    is left to the check of its quantity."""
    if may_be_list and isinstance(value, list):
        return tuple(number(item) for item in value)
    is_number = isinstance(value, int) and not isinstance(value, bool)
    return float(value) if is_number and abs(value) < 2**1023 else value


def nearest(given: object, known: Collection[str]) -> str:
    """Return `did you mean x? ` if a known name is near."""
    near = near_names(given, known)
    return f"did you mean {near[0]}? " if near else ""


def refuse_unknown(where: str, table: dict[str, Any], known: Collection[str]) -> None:
    """Raise `UnfitKeys` for the first key that is not known."""
    for key in table:
        if key not in known:
            shown = f"{where}.{key}" if where else key
            hint = nearest(key, known)
            raise UnfitKeys(f"{shown}: unknown key; {hint}known are {', '.join(known)}")


def _is_optional(field: Field[Any]) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def fits(kind: type, given: Collection[str]) -> bool:
    """Return whether these are keys of a data class, or nearly, with all that it needs; one key
    alone says nothing."""
    known = {field.name: _is_optional(field) for field in fields(kind)}
    meant = {(near_names(key, known) or [key])[0] for key in given}
    return (
        len(meant) > 1 and meant <= known.keys() and all(known[key] for key in known.keys() - meant)
    )


def make(kind: type, where: str, value: Any) -> Any:
    """Return an instance of a data class from a table with its fields as keys."""
    table = a_table(where, value)
    refuse_unknown(where, table, tuple(f.name for f in fields(kind)))
    for field in fields(kind):
        if not _is_optional(field) and field.name not in table:
            raise UnfitKeys(f"{where}.{field.name} is missing")
        given = table.get(field.name, "")
        if field.type in (str, "str") and not isinstance(given, str):
            raise QuantityError(f"{where}.{field.name} = {given!r}: must be a string")
    numbers = quantities(kind)
    values = {
        key: number(value, numbers[key].may_be_list) if key in numbers else value
        for key, value in table.items()
    }
    return kind(**values)
