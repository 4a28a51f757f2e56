"""The machine of a linear analysis, and the answer: printed, and written as numbers and picture."""

from collections.abc import Iterable, Mapping
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..display import choose
from ..errors import writable_folder
from ..linear.linear_tables import numbers
from ..machine_file.loading import load_rotor
from ..model.machine.rotor import Rotor
from ..output_options import write_json
from ..tables import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def machine_in_units(file: Path | None, units: str | None) -> Rotor:
    """Return the machine; from here on what is shown is in the units asked for, or its own."""
    machine = load_rotor(file)[1]
    choose(units, machine.units, file or "")
    return machine


def say(*groups: Iterable[str]) -> None:
    """Print sentences, each in a line."""
    for sentence in chain.from_iterable(groups):
        typer.echo(sentence)


def print_answer(
    result: Any,
    out: Path,
    name: str,
    table: Table | None = None,
    figure: "Figure | None" = None,
    more: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Print the table of an answer, write its numbers and its picture, and return the numbers.

    table, figure: by default the answer's own; more: further answers by name, whose tables follow,
    whose numbers stand under the name, and whose pictures have the name behind that of the first.
    """
    from ..plotting.figure_style import save

    further = more or {}
    data = numbers(result) | {key: numbers(answer) for key, answer in further.items()}
    writable_folder(out)
    save(figure or result.figure(), out / f"{name}.png")
    for key, answer in further.items():
        save(answer.figure(), out / f"{name}_{key}.png")
    write_json(data, out / f"{name}.json")
    typer.echo((table or result.table()).text())
    for answer in further.values():
        typer.echo(f"\n{answer.table().text()}")
    typer.echo(f"written to {out}")
    return data
