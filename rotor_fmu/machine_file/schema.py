"""A JSON schema of machine files, for editors."""

from __future__ import annotations

from typing import Any

from ..model.quantities import NOT_NEGATIVE, POSITIVE
from .tables import Key, Table, own_tables, part_tables

_DRAFT = "https://json-schema.org/draft/2020-12/schema"

_WORDS: dict[str, dict[str, Any]] = {
    "number": {"type": "number"},
    "integer": {"type": "integer", "minimum": 1},
    "string": {"type": "string"},
    "numbers": {"type": "array", "items": {"type": "number"}},
    "tables": {"type": "array", "items": {"type": "object"}},
}


def schema() -> dict[str, Any]:
    """The schema (JSON Schema 2020-12): which tables and keys there are, of which types, within
    which limits. What one number says of another is left to the reader."""
    (whole, *named) = own_tables()
    properties = _properties(whole)
    for table in (*named, *part_tables()):
        one = _object(table)
        if table.name == "material":
            one = {**one, "additionalProperties": one, "required": []}
        properties[table.name] = {"type": "array", "items": one} if table.is_list else one
    return {
        "$schema": _DRAFT,
        "title": "A machine of rotor-fmu",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
    }


def _object(table: Table) -> dict[str, Any]:
    needed = [key.name for key in table.keys if key.is_needed and key.name != "node"]
    found: dict[str, Any] = {
        "type": "object",
        "description": table.text,
        "properties": _properties(table),
        "required": needed,
        "additionalProperties": False,
    }
    if any(key.name == "node" for key in table.keys):
        found["oneOf"] = [{"required": ["node"]}, {"required": ["z"]}]
    return found


def _properties(table: Table) -> dict[str, Any]:
    return {key.name: _property(key) for key in table.keys}


def _property(key: Key) -> dict[str, Any]:
    told = key.told
    if told is None:
        found = dict(_WORDS["string" if key.choices else key.kind])
        if key.choices:
            found["enum"] = list(key.choices)
        return {**found, "description": key.text}
    if told.is_switch:
        return {"type": "boolean", "description": key.text}
    number: dict[str, Any] = {"type": "number"}
    if told.rule is POSITIVE:
        number["exclusiveMinimum"] = 0
    elif told.rule is NOT_NEGATIVE:
        number["minimum"] = 0
    found = {**number, "description": f"{key.text} [{told.unit}]"}
    if told.may_be_list:
        column = {"type": "array", "items": number}
        found = {"description": found["description"], "oneOf": [number, column]}
    return found
