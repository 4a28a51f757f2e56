"""Values as cells of tables, on the screen, in Markdown and in HTML."""

from __future__ import annotations


def cell(value: object, spec: str = "") -> str:
    """Return a value as text, a dash if it is missing or NaN.

    spec: format of a number; by default five digits of a float and all of an integer.
    """
    if value is None or value != value:
        return "-"
    if isinstance(value, str):
        return value
    return format(value, spec or (".5g" if isinstance(value, float) else ""))
