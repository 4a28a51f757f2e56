"""Tables of a study's file: known names, and suggestions for misspelt ones."""

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

from ..errors import InputError

Tables = Mapping[str, Any]


def nearest(name: str, known: Iterable[str]) -> str:
    """Return a suggestion for a misspelt name."""
    listed = sorted(set(known))
    near = difflib.get_close_matches(name, listed, 3, 0.5) or listed[:3]
    return f"did you mean {', '.join(near)}?" if near else "there is none"


def known_name(where: str, name: str, known: Iterable[str]) -> str:
    """Return the name itself if it is known, else `InputError` with the nearest; where: what it is
    of."""
    known = tuple(known)
    if name not in known:
        raise InputError(f"{where} {name}: unknown name; {nearest(name, known)}".strip())
    return name


def table_of(tables: Tables, key: str) -> dict[str, Any]:
    """Return a table by its key, empty where it is left out; `InputError` for anything else."""
    table = tables.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{key} = {table!r}: must be a table")
    return table
