"""A JSON schema of machine files, for editors."""

from typing import Any

from ..model.machine.names import IDENTIFIER
from ..model.quantities import NOT_NEGATIVE, POSITIVE
from .declared_tables import Key, Table, own_tables, part_tables

_DRAFT = "https://json-schema.org/draft/2020-12/schema"

# A number with a unit behind it, `0.1 mm`.
_WITH_UNIT = {"type": "string", "pattern": r"^\s*[-+]?[0-9]*\.?[0-9]+([eE][-+]?[0-9]+)?\s*\S"}
_LENGTHS = {"anyOf": [{"type": "number"}, _WITH_UNIT]}
_WORDS: dict[str, dict[str, Any]] = {
    "number": {"type": "number"},
    "integer": {"type": "integer", "minimum": 1},
    "string": {"type": "string"},
    "word": {"type": "string", "pattern": f"^{IDENTIFIER.pattern}$"},
    "numbers": {"type": "array", "items": _LENGTHS},
    "tables": {"type": "array", "items": {"type": "object"}},
}


def schema() -> dict[str, Any]:
    """Return the schema (JSON Schema 2020-12): which tables and keys there are, of which types,
    within which limits. Rules that relate one number to another are left to the reader."""
    (whole, *named) = own_tables()
    properties = _properties(whole)
    for table in (*named, *part_tables()):
        one = _object(table)
        if table.name == "material":
            one = {**one, "additionalProperties": one, "required": []}
        properties[table.name] = {"type": "array", "items": one} if table.is_list else one
    head = {"$schema": _DRAFT, "title": "A machine of rotor-fmu", "type": "object"}
    return head | {"properties": properties, "additionalProperties": False}


def _object(table: Table) -> dict[str, Any]:
    needed = [key.name for key in table.keys if key.is_needed and key.name != "node"]
    properties = _properties(table) | _units_of(table)
    result: dict[str, Any] = {"type": "object", "description": table.text, "properties": properties}
    result |= {"required": needed, "additionalProperties": False}
    if any(key.name == "node" for key in table.keys):
        result["oneOf"] = [{"required": ["node"]}, {"required": ["z"]}]
    return result


def _units_of(table: Table) -> dict[str, Any]:
    """The table of the units of its plain numbers."""
    names = {key.name: {"type": "string"} for key in table.keys if key.measured_in}
    text = "units of this table's plain numbers"
    units = {"type": "object", "description": text, "properties": names}
    return {"units": units | {"additionalProperties": False}} if names else {}


def _properties(table: Table) -> dict[str, Any]:
    return {key.name: _property(key) for key in table.keys}


def _property(key: Key) -> dict[str, Any]:
    quantity = key.quantity
    if quantity is None:
        result = dict(_WORDS["string" if key.choices else key.kind])
        if key.unit and key.kind == "number":
            result = dict(_LENGTHS)
        if key.choices:
            result["enum"] = list(key.choices)
        return {**result, "description": key.text}
    if quantity.is_switch:
        return {"type": "boolean", "description": key.text}
    number: dict[str, Any] = {"type": "number"}
    with_unit = [_WITH_UNIT] if key.measured_in else []
    if quantity.rule is POSITIVE:
        number["exclusiveMinimum"] = 0
    elif quantity.rule is NOT_NEGATIVE:
        number["minimum"] = 0
    result = {"description": f"{key.text} [{quantity.unit}]"}
    allowed = [number, *with_unit]
    if quantity.may_be_list:
        allowed.append({"type": "array", "items": {"anyOf": [number, *with_unit]}})
    return result | (number if len(allowed) == 1 else {"anyOf": allowed})
