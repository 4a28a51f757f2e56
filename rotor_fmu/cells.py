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
    if isinstance(value, float) and not spec:
        return five_digits(value)
    return format(value, spec)


def five_digits(value: float) -> str:
    """Return a number to five digits, of one up to ten million all that are before the point."""
    return f"{value:.0f}" if 99999.5 <= abs(value) < 1e7 else f"{value:.5g}"


def column_head(name: str, unit: str) -> str:
    """Return the head of a column: its name, and its unit if it has one."""
    return name if unit in ("", "1") else f"{name} [{unit}]"


def html_table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table in HTML, words flush left; empty heads, and those of no row, are left out."""
    lines = [[cell(value) for value in row] for row in rows]
    columns = zip(*lines, strict=True) if lines else [()] * len(heads)
    styles = [' style="text-align: left"' if _are_words(column) else "" for column in columns]
    top = f"<thead>{_line(heads, styles, 'th')}</thead>" if lines and any(heads) else ""
    body = "".join(_line(line, styles, "td") for line in lines)
    return f"<table><caption>{html.escape(caption)}</caption>{top}<tbody>{body}</tbody></table>"


def _line(texts: Sequence[str], styles: Sequence[str], tag: str) -> str:
    scope = ' scope="col"' if tag == "th" else ""
    cells = (
        f"<{tag}{scope}{style}>{html.escape(text)}</{tag}>"
        for text, style in zip(texts, styles, strict=True)
    )
    return f"<tr>{''.join(cells)}</tr>"


def _are_words(column: Iterable[str]) -> bool:
    """Whether no cell of a column begins with a number, and one is a word."""
    texts = [text for text in column if text not in ("", "-", "none")]
    return bool(texts) and not any(text.lstrip("+-")[:1].isdigit() for text in texts)


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown, without an end of line behind the last row."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
