"""A table that goes to the screen, to a CSV file and to a Markdown page."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from rotor_fmu.cells import cell, markdown_table
from rotor_fmu.files import unfinished, write_text
from rotor_fmu.screen import text_table


@dataclass(frozen=True)
class Column:
    """Name in files, head on paper (with its unit), format of the numbers; whether the screen,
    which is narrower, shows it too."""

    name: str
    head: str
    spec: str = ""
    on_screen: bool = True


class ResultTable:
    """Rows of values by column name; a missing value is shown as a dash."""

    def __init__(
        self, columns: Sequence[Column], rows: Sequence[Mapping[str, object]], title: str = ""
    ) -> None:
        self._columns, self.rows, self._title = columns, rows, title

    def print(self, console: Console) -> None:
        """Print the table to the screen."""
        shown = [column for column in self._columns if column.on_screen]
        cells = [self._cells(row, shown) for row in self.rows]
        table = text_table(self._title, [column.head for column in shown], cells)
        console.print(table, soft_wrap=False)

    def write(self, csv_path: Path, markdown_path: Path) -> None:
        """All digits as CSV, the table as Markdown."""
        with unfinished(csv_path) as part, part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, [column.name for column in self._columns])
            writer.writeheader()
            names = set(writer.fieldnames)
            writer.writerows({k: v for k, v in row.items() if k in names} for row in self.rows)
        heads = [column.head.replace("\n", " ") for column in self._columns]
        rows = (self._cells(row, self._columns) for row in self.rows)
        write_text(markdown_table(heads, rows) + "\n", markdown_path)

    @staticmethod
    def _cells(row: Mapping[str, object], columns: Sequence[Column]) -> list[str]:
        return [cell(row.get(column.name), column.spec) for column in columns]
