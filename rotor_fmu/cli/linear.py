"""`rotor-fmu modes`, `campbell`, `unbalance`, `static`, `show`: each with a table and a picture."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from ..errors import InputError, writable_folder
from ..files import write_text
from ..output_options import with_output_options
from ..runs.job import load_rotor, write_json
from ..units import units_for

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..linear.linear_tables import Table
    from ..model.machine.rotor import Rotor

# The answers themselves are imported where they are asked for: a user with bad input, or of another
# command, should not wait for them.

_UNITS = {unit.lower(): factor for unit, factor in units_for("rad/s").items()}
_UNIT = "|".join(_UNITS)
_POINTS, _MOST_POINTS = 101, 100_000

RotorFile = Annotated[
    Path | None, typer.Option("--rotor", help="Machine file; default: the rig of paper A.")
]
Contacts = Annotated[
    str | None,
    typer.Option(
        help="State of clearance contacts: open or pinned; default: open if other supports hold it."
    ),
]
One = Annotated[
    str,
    typer.Option(
        "--speed", help="Speed, such as 3000rpm or 50Hz; a number without unit is in rad/s."
    ),
]
Range = Annotated[
    str | None,
    typer.Option(
        "--speed", help="Speeds FROM:TO or FROM:TO:POINTS, in rad/s, or with rpm or Hz added."
    ),
]
Count = Annotated[int, typer.Option(help="Number of modes.")]


@with_output_options
def modes(
    rotor: RotorFile = None,
    speed: One = "0",
    count: Count = 8,
    contacts: Contacts = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/modes"),
) -> dict[str, Any]:
    """Compute natural frequencies, damping, logarithmic decrements, whirl and mode shapes at a
    speed."""
    at, (_, machine) = one_speed(speed), load_rotor(rotor)
    from ..linear import answers

    _check_count(count)
    result = answers.modes(machine, at, count=count, contacts=contacts)
    _name_films(machine)
    return print_answer(result, result.table(), result.figure(), out, "modes")


@with_output_options
def campbell(
    rotor: RotorFile = None,
    speed: Range = None,
    count: Count = 8,
    contacts: Contacts = None,
    harmonic: Annotated[
        float, typer.Option(help="Multiple of the speed of rotation that excites.")
    ] = 1.0,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/campbell"),
) -> dict[str, Any]:
    """Compute the Campbell diagram, critical speeds, and the threshold speed of stability."""
    speeds, (_, machine) = speed_range(speed, 41), load_rotor(rotor)
    from ..linear import answers

    _check_count(count)
    if len(speeds) == 1:
        raise InputError(f"--speed {speed}: must be FROM:TO, more than one speed")
    if len(speeds) == 0:
        speeds = np.linspace(0.0, _highest(machine, contacts), 41)
    result = answers.campbell(machine, speeds, count=count, contacts=contacts, harmonic=harmonic)
    _name_films(machine)
    return print_answer(result, result.table(), result.figure(), out, "campbell")


@with_output_options
def unbalance(
    rotor: RotorFile = None,
    speed: Range = None,
    node: Annotated[
        list[int] | None, typer.Option(help="Node to show, counted from 1; repeatable.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--unbalance",
            help="NODE:AMOUNT[:DEGREES] in kg m, replaces the machine's unbalances; repeatable.",
        ),
    ] = None,
    contacts: Contacts = None,
    out: Annotated[Path, typer.Option(help="Folder for picture and CSV.")] = Path("out/unbalance"),
) -> dict[str, Any]:
    """Compute the steady response to unbalance: x, y, major semi-axis and phase at any node."""
    speeds, (_, machine) = speed_range(speed, 401), load_rotor(rotor)
    given = [_unbalance(text) for text in at] if at else None
    from ..linear import answers

    for number in node or []:
        if not 1 <= number <= len(machine.nodes):
            raise InputError(f"--node {number}: must be from 1 to {len(machine.nodes)}")
    if len(speeds) == 0:
        speeds = np.linspace(0.0, _highest(machine, contacts), 401)
    result = answers.unbalance_response(machine, speeds, contacts=contacts, unbalances=given)
    nodes = node or result.nodes()
    _name_films(machine)
    return print_answer(result, result.table(nodes), result.figure(nodes), out, "unbalance")


@with_output_options
def static(
    rotor: RotorFile = None,
    speed: One = "0",
    contacts: Contacts = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/static"),
) -> dict[str, Any]:
    """Compute the deflection under gravity and the load on each bearing."""
    at, (_, machine) = one_speed(speed), load_rotor(rotor)
    from ..linear import answers

    result = answers.static(machine, at, contacts=contacts)
    return print_answer(result, result.table(), result.figure(), out, "static")


@with_output_options
def show(
    rotor: RotorFile = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/show"),
) -> dict[str, Any]:
    """Draw the machine to scale and list its parts."""
    _, machine = load_rotor(rotor)
    from ..linear import answers
    from ..linear.inventory import inventory

    listed = inventory(machine)
    return print_answer(listed, listed.table(), answers.show(machine), out, "show")


@with_output_options
def import_ross(
    file: Annotated[Path, typer.Argument(help="Rotor saved by ROSS, as TOML or JSON.")],
    out: Annotated[Path, typer.Option(help="The machine file to write.")] = Path("machine.toml"),
) -> dict[str, Any]:
    """Convert a rotor that ROSS saved into a machine file."""
    from ..machine_file.reading import import_ross as read
    from ..model.machine.writing import toml_text

    result = read("FILE", file)
    writable_folder(out.parent)
    head = f"# From {file.name}, a rotor that ROSS saved.\n"
    head += "".join(f"# {note}\n" for note in result.notes)
    write_text(f"{head}\n{toml_text(result.tables)}", out)
    for note in result.notes:
        typer.echo(note)
    typer.echo(f"written to {out}")
    return {"notes": result.notes, "out": str(out)}


def _name_films(machine: Rotor) -> None:
    """Say of oil films where they are linearized."""
    from ..model.linear.journal import journal_bearings

    if names := ", ".join(journal_bearings(machine)):
        typer.echo(f"oil films, each linearized where its journal rests at that speed: {names}")


def print_answer(result: Any, table: Table, figure: Figure, out: Path, name: str) -> dict[str, Any]:
    """Print the table, write numbers and picture, and return the numbers."""
    from ..figure_style import save
    from ..linear.linear_tables import numbers

    data = numbers(result)
    writable_folder(out)
    save(figure, out / f"{name}.png")
    write_json(data, out / f"{name}.json")
    typer.echo(table.text())
    typer.echo(f"written to {out}")
    return data


def one_speed(text: str) -> float:
    """A speed [rad/s] of `300`, `3000rpm`, `50Hz`; `InputError` for anything else."""
    plain, factor = _without_unit(text)
    try:
        value = float(plain) * factor
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"--speed {text}: must be a number, in rad/s or with rpm or Hz behind it")
    return value


def _without_unit(text: str) -> tuple[str, float]:
    """The text without the unit that stands in it, and what that is in rad/s."""
    result = {unit.lower() for unit in re.findall(_UNIT, text, re.I)}
    if len(result) > 1:
        raise InputError(f"--speed {text}: must have one unit, not {' and '.join(sorted(result))}")
    return re.sub(_UNIT, "", text, flags=re.I), _UNITS[result.pop() if result else "rad/s"]


def speed_range(text: str | None, points: int) -> np.ndarray:
    """Speeds [rad/s] of `FROM:TO[:POINTS]`, or of a single one; none of None."""
    if text is None:
        return np.array([])
    plain, factor = _without_unit(text)
    ends = plain.split(":")
    if len(ends) == 1:
        return np.array([one_speed(text)])
    try:
        low, high = (float(end) * factor for end in ends[:2])
        count = int(ends[2]) if len(ends) > 2 else points
        is_range = len(ends) <= 3 and math.isfinite(low) and math.isfinite(high)
    except ValueError:
        is_range = False
    if not is_range:
        raise InputError(f"--speed {text}: must be FROM:TO or FROM:TO:POINTS")
    if not low < high:
        raise InputError(f"--speed {text}: FROM must be below TO")
    if not 2 <= count <= _MOST_POINTS:
        raise InputError(f"--speed {text}: POINTS must be an integer from 2 to {_MOST_POINTS}")
    return np.linspace(low, high, count)


def _unbalance(text: str) -> tuple[int, float, float]:
    try:
        node, amount, *phase = text.split(":")
        result = int(node), float(amount), math.radians(float(phase[0])) if phase else 0.0
        is_known = len(phase) < 2 and all(map(math.isfinite, result))
    except ValueError:
        is_known = False
    if not is_known:
        raise InputError(f"--unbalance {text}: must be NODE:AMOUNT or NODE:AMOUNT:DEGREES")
    return result


def _check_count(count: int) -> None:
    if not 1 <= count <= 1000:
        raise InputError(f"--count {count}: must be from 1 to 1000")


def _highest(machine: Rotor, contacts: str | None) -> float:
    """A speed [rad/s] above the lowest critical ones, for who names none."""
    from ..model import linear

    damped = linear.modes(machine, count=4, contacts=contacts).damped
    return 1.25 * float(damped[-1]) if len(damped) else 1000.0
