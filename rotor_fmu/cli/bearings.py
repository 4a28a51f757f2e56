"""`rotor-fmu bearing`: a journal bearing by itself."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from ..errors import InputError, writable_folder
from ..files import write_text
from ..output_options import with_output_options
from ..runs.job import load_rotor
from .answers import print_answer
from .shared import PictureFolder
from .speeds import speed_range

if TYPE_CHECKING:
    from ..model.linear.bearing import BearingCurves
    from ..model.parts.journal_bearing import JournalBearing


@with_output_options
def bearing(
    file: Annotated[Path, typer.Argument(help="Machine file with a journal_bearing.")],
    speed: Annotated[
        str,
        typer.Option(
            "--speed",
            help="Speeds FROM:TO or FROM:TO:POINTS, or one, in rad/s, or with rpm or Hz added.",
        ),
    ],
    name: Annotated[
        str | None,
        typer.Option("--bearing", help="Its name, such as journal_bearing[2]; default: the first."),
    ] = None,
    load: Annotated[
        float | None,
        typer.Option(help="Load downwards, in N; default: what the machine's weight puts on it."),
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option(help="File for a linear_bearing with these coefficients over the speed."),
    ] = None,
    out: PictureFolder = Path("out/bearing"),
) -> dict[str, Any]:
    """Compute where a journal rests in its oil film, the film's eight coefficients there, and the
    threshold of whirl.

    The last column compares the film's load with a solution of Reynolds' equation in two
    dimensions.
    """
    speeds, (_, machine) = speed_range(speed, 21), load_rotor(file)
    if load is not None and not (math.isfinite(load) and load > 0):
        raise InputError(f"--load {load:g}: must be > 0")
    from ..linear import answers
    from ..model.linear.bearing import journal_bearings

    if table is not None:
        writable_folder(table.parent)
    result = answers.bearing(machine, speeds, bearing=name, load=load)
    if table is not None:
        part = journal_bearings(machine)[result.bearing]
        write_text(_linear_bearing(result, part, file), table)
        typer.echo(f"written to {table}")
    return print_answer(result, result.table(), result.figure(), out, "bearing")


def _linear_bearing(result: BearingCurves, part: JournalBearing, file: Path) -> str:
    """Return a `[[linear_bearing]]` with the coefficients over the speed as TOML."""
    from ..model.machine.writing import toml_text

    values: dict[str, Any] = {"node": part.node}
    if part.housing:
        values["housing"] = part.housing
    is_table = len(result.speeds) > 1
    if is_table:
        values["speed"] = result.speeds.tolist()
    for letter, of in (("k", result.K), ("c", result.C)):
        for i, row in enumerate("xy"):
            for j, column in enumerate("xy"):
                column_values = np.asarray(of[:, i, j], dtype=float).tolist()
                values[f"{letter}{row}{column}"] = column_values if is_table else column_values[0]
    head = f"# The film of {result.bearing} of {file.name}, linearized where its journal rests.\n"
    return f"{head}\n{toml_text({'linear_bearing': [values]})}"
