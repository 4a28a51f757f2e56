"""Tables -> TOML text: the contents of a machine file."""

import json
import re
from collections.abc import Mapping
from typing import Any


def toml_text(tables: Mapping[str, Any]) -> str:
    """Return TOML of numbers, strings, lists of numbers, tables, and lists of tables."""
    return "\n".join(_lines("", tables)).strip() + "\n"


def _lines(where: str, table: Mapping[str, Any]) -> list[str]:
    lines = [f"{_key(k)} = {_value(v)}" for k, v in table.items() if not _is_table(v)]
    for key, value in table.items():
        if not _is_table(value):
            continue
        name = f"{where}.{_key(key)}" if where else _key(key)
        for item in [value] if isinstance(value, Mapping) else value:
            brackets = f"[{name}]" if isinstance(value, Mapping) else f"[[{name}]]"
            lines += ["", brackets, *_lines(name, item)]
    return lines


def _is_table(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return bool(value) and isinstance(value[0], Mapping)
    return isinstance(value, Mapping)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # a basic string of TOML is one of JSON, but for the character DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_value(item) for item in value)}]"
    return repr(value)
