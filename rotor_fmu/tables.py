"""A table of results, as text and as HTML."""

from collections.abc import Sequence
from typing import Any, NamedTuple, Self

import numpy as np

from .cells import cell, html_table
from .display import in_letters


class Table(NamedTuple):
    """A heading, columns with units, rows of numbers and words."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[object]]

    @classmethod
    def of(cls, title: str, columns: Sequence[tuple[str, Any]]) -> Self:
        """Return the table of columns, each a head and its numbers or words."""
        heads, values = zip(*columns, strict=True)
        rows = zip(*(v.tolist() if isinstance(v, np.ndarray) else v for v in values), strict=True)
        return cls(title, heads, list(rows))

    def text(self) -> str:
        """Return the table as text in columns, for a terminal; without rows its title says it."""
        if not self.rows:
            return self.title
        shown = [[*map(in_letters, self.heads)], *([*map(cell, row)] for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
        lines = [
            "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True))
            for row in shown
        ]
        return "\n".join([self.title, *lines])

    def html(self) -> str:
        """Return the table as HTML, for a notebook."""
        return html_table(self.title, self.heads, self.rows)
