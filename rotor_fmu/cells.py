"""Values as cells of tables, on the screen, in Markdown and in HTML."""

from collections.abc import Iterable, Sequence


def cell(value: object, spec: str = "") -> str:
    """Return a value as text, a dash if it is missing or NaN.

    spec: format of a number; by default five digits of a float and all of an integer.
    """
    if value is None or value != value:
        return "-"
    if isinstance(value, str):
        return value
    return format(value, spec or (".5g" if isinstance(value, float) else ""))


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown, without an end of line behind the last row."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
