"""Values as cells of tables, on the screen, in Markdown and in HTML."""

import html
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


def html_table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table in HTML; heads that are all empty are left out."""
    head = "".join(f'<th scope="col">{html.escape(text)}</th>' for text in heads)
    top = f"<thead><tr>{head}</tr></thead>" if any(heads) else ""
    lines = ("".join(f"<td>{html.escape(cell(value))}</td>" for value in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"<table><caption>{html.escape(caption)}</caption>{top}<tbody>{body}</tbody></table>"


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown, without an end of line behind the last row."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
