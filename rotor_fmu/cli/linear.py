"""`rotor-fmu modes`, `campbell`, `unbalance`, `static`, `show`: each with a table and a picture."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from ..display import choose
from ..errors import InputError, writable_folder
from ..files import unfinished, write_text
from ..output_options import with_output_options
from ..runs.job import load_rotor, write_json
from ..units import in_si, split, units_for
from .shared import Units

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
OperatingRange = Annotated[
    str | None,
    typer.Option(
        "--range",
        help="Minimum and maximum continuous speed FROM:TO, in rad/s, or with rpm or Hz added; "
        "default: those of the machine's table operation.",
    ),
]
Rated = Annotated[
    str | None,
    typer.Option(
        help="Rated speed, such as 11000rpm: the range where --range is not given; default: the "
        "machine's own."
    ),
]
Clearances = Annotated[
    list[str] | None,
    typer.Option(help="NODE:RADIUS, radial clearance of a seal at a node, in m; repeatable."),
]


@with_output_options
def modes(
    rotor: RotorFile = None,
    speed: One = "0",
    count: Count = 8,
    contacts: Contacts = None,
    units: Units = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/modes"),
) -> dict[str, Any]:
    """Compute natural frequencies, damping, logarithmic decrements, whirl and mode shapes at a
    speed."""
    at, machine = one_speed(speed), _machine(rotor, units)
    from ..linear import answers

    _check_count(count)
    from ..figure_style import save
    from ..linear.mode_shapes import mode_shapes_figure

    result = answers.modes(machine, at, count=count, contacts=contacts)
    _name_films(machine)
    data = print_answer(result, result.table(), result.figure(), out, "modes")
    save(mode_shapes_figure(result), out / "modes_3d.png")
    return data


@with_output_options
def campbell(
    rotor: RotorFile = None,
    speed: Range = None,
    count: Count = 8,
    contacts: Contacts = None,
    harmonic: Annotated[
        list[float] | None,
        typer.Option(
            help="Multiple of the speed of rotation that excites, its order; repeatable; default 1."
        ),
    ] = None,
    operating: OperatingRange = None,
    rated: Rated = None,
    units: Units = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/campbell"),
) -> dict[str, Any]:
    """Compute the Campbell diagram, critical speeds, and the threshold speed of stability."""
    speeds, machine = speed_range(speed, 41), _machine(rotor, units)
    ends = operating_range(operating, rated, machine)
    from ..linear import answers

    _check_count(count)
    if len(speeds) == 1:
        raise InputError(f"--speed {speed}: must be FROM:TO, more than one speed")
    if len(speeds) == 0:
        top = _highest(machine, contacts) if ends is None else 1.25 * ends[1]
        speeds = np.linspace(0.0, top, 41)
    result = answers.campbell(
        machine, speeds, count=count, contacts=contacts, harmonic=harmonic or 1.0
    )
    _name_films(machine)
    return print_answer(result, result.table(), result.figure(ends), out, "campbell")


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
            help="NODE:AMOUNT:DEGREES, such as 4:50g.mm:90, or in kg.m; replaces the machine's "
            "unbalances; repeatable.",
        ),
    ] = None,
    mode: Annotated[
        int | None,
        typer.Option(
            help="Place the unbalances that API 617 prescribes (4W/N) for this mode, from 1."
        ),
    ] = None,
    factor: Annotated[
        float, typer.Option(help="With --mode: multiple of the residual unbalance 4W/N.")
    ] = 2.0,
    operating: OperatingRange = None,
    rated: Rated = None,
    clearance: Clearances = None,
    contacts: Contacts = None,
    units: Units = None,
    out: Annotated[Path, typer.Option(help="Folder for picture and CSV.")] = Path("out/unbalance"),
) -> dict[str, Any]:
    """Compute the steady response to unbalance, its critical speeds with amplification factors,
    and, with --range, separation margins, probe limits and clearances by API 617.

    x, y, major semi-axis and phase at any node. The probes are the nodes shown.
    """
    speeds, machine = speed_range(speed, 401), _machine(rotor, units)
    given = [_unbalance(text) for text in at] if at else None
    ends = operating_range(operating, rated, machine)
    gaps = dict(clearance_of(text) for text in clearance or [])
    if mode is not None and given:
        raise InputError("--mode and --unbalance: only one of both may place unbalances")
    if (mode is not None or gaps) and ends is None:
        raise InputError("--mode and --clearance: need the operating range, --range FROM:TO")
    for number in (*(node or []), *gaps):
        if not 1 <= number <= len(machine.nodes):
            raise InputError(f"--node {number}: must be from 1 to {len(machine.nodes)}")
    from ..linear import acceptance, answers
    from ..model.linear import placed_unbalances

    if mode is not None and ends is not None:
        placed = placed_unbalances(machine, mode, ends[1], factor=factor, contacts=contacts)
        given = [(p.node, p.amount, p.phase) for p in placed]
    if len(speeds) == 0:
        highest = _highest(machine, contacts) if ends is None else 1.25 * ends[1]
        speeds = np.linspace(0.0, highest, 401)
    result = answers.unbalance_response(machine, speeds, contacts=contacts, unbalances=given)
    nodes = node or result.nodes()
    _name_films(machine)
    writable_folder(out)
    _write_response(result, nodes, out / "unbalance.csv")
    if ends is None:
        top = float(np.abs(speeds).max())
        checked: Any = acceptance.critical_peaks(
            machine, top, nodes, unbalances=given, contacts=contacts
        )
    else:
        checked = acceptance.unbalance_check(
            machine, *ends, nodes, unbalances=given, clearances=gaps, contacts=contacts
        )
    more = {"criticals" if ends is None else "check": checked}
    figure = result.figure(nodes, ends)
    return print_answer(result, result.table(nodes), figure, out, "unbalance", more)


@with_output_options
def static(
    rotor: RotorFile = None,
    speed: One = "0",
    contacts: Contacts = None,
    units: Units = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/static"),
) -> dict[str, Any]:
    """Compute the deflection under gravity and the load on each bearing."""
    at, machine = one_speed(speed), _machine(rotor, units)
    from ..linear import answers

    result = answers.static(machine, at, contacts=contacts)
    return print_answer(result, result.table(), result.figure(), out, "static")


@with_output_options
def show(
    rotor: RotorFile = None,
    units: Units = None,
    out: Annotated[Path, typer.Option(help="Folder for the picture.")] = Path("out/show"),
) -> dict[str, Any]:
    """Draw the machine to scale and list its parts."""
    machine = _machine(rotor, units)
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


def _machine(file: Path | None, units: str | None) -> Rotor:
    """Return the machine; from here on what is shown is in the units asked for, or its own."""
    machine = load_rotor(file)[1]
    choose(units, machine.units)
    return machine


def _name_films(machine: Rotor) -> None:
    """Say of oil films where they are linearized."""
    from ..model.linear.bearing import journal_bearings

    if names := ", ".join(journal_bearings(machine)):
        typer.echo(f"oil films, each linearized where its journal rests at that speed: {names}")


def print_answer(
    result: Any,
    table: Table,
    figure: Figure,
    out: Path,
    name: str,
    more: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Print the table, write numbers and picture, and return the numbers.

    more: further answers by name, whose tables follow, whose numbers stand under the name, and
    whose pictures have the name behind that of the first.
    """
    from ..figure_style import save
    from ..linear.linear_tables import numbers

    further = more or {}
    data = numbers(result) | {key: numbers(answer) for key, answer in further.items()}
    writable_folder(out)
    save(figure, out / f"{name}.png")
    for key, answer in further.items():
        save(answer.figure(), out / f"{name}_{key}.png")
    write_json(data, out / f"{name}.json")
    typer.echo(table.text())
    for answer in further.values():
        typer.echo(f"\n{answer.table().text()}")
    typer.echo(f"written to {out}")
    return data


def one_speed(text: str, option: str = "--speed") -> float:
    """A speed [rad/s] of `300`, `3000rpm`, `50Hz`; `InputError` for anything else."""
    return in_si(option, text, "rad/s")


def _without_unit(text: str, option: str) -> tuple[str, float]:
    """The text without the unit that stands in it, and what that is in rad/s."""
    result = {unit.lower() for unit in re.findall(_UNIT, text, re.I)}
    if len(result) > 1:
        raise InputError(f"{option} {text}: must have one unit, not {' and '.join(sorted(result))}")
    return re.sub(_UNIT, "", text, flags=re.I), _UNITS[result.pop() if result else "rad/s"]


def speed_range(text: str | None, points: int, option: str = "--speed") -> np.ndarray:
    """Speeds [rad/s] of `FROM:TO[:POINTS]`, or of a single one; none of None."""
    if text is None:
        return np.array([])
    plain, factor = _without_unit(text, option)
    ends = plain.split(":")
    if len(ends) == 1:
        return np.array([one_speed(text, option)])
    try:
        low, high = (float(end) * factor for end in ends[:2])
        count = int(ends[2]) if len(ends) > 2 else points
        is_range = len(ends) <= 3 and math.isfinite(low) and math.isfinite(high)
    except ValueError:
        is_range = False
    if not is_range:
        raise InputError(f"{option} {text}: must be FROM:TO or FROM:TO:POINTS")
    if not low < high:
        raise InputError(f"{option} {text}: FROM must be below TO")
    if not 2 <= count <= _MOST_POINTS:
        raise InputError(f"{option} {text}: POINTS must be an integer from 2 to {_MOST_POINTS}")
    return np.linspace(low, high, count)


def operating_range(
    text: str | None, rated: str | None, machine: Rotor
) -> tuple[float, float] | None:
    """The minimum and maximum continuous speed [rad/s] of `--range` and `--rated`, the range alone
    where both are given; without either those of the machine's own `[operation]`, None if it has
    none."""
    if text is None:
        if rated is None:
            own = [speed for speed in machine.operation.continuous_speeds if speed > 0]
            return (own[0], own[-1]) if own else None
        speed = rated_speed(rated, machine)
        return speed, speed
    ends = speed_range(text, 2, "--range")
    if len(ends) != 2 or ends[0] <= 0:
        raise InputError(f"--range {text}: must be FROM:TO, both above 0")
    return float(ends[0]), float(ends[1])


def rated_speed(text: str | None, machine: Rotor) -> float:
    """The speed [rad/s] of `--rated`, or the machine's own."""
    if text is None:
        own = machine.operation.rated_speed
        if own is None:
            raise InputError(
                "--rated: must be given, such as --rated 11000rpm, or operation.rated_speed"
            )
        return own
    speed = one_speed(text, "--rated")
    if speed <= 0:
        raise InputError(f"--rated {text}: must be above 0")
    return speed


def clearance_of(text: str) -> tuple[int, float]:
    """The node and the radial clearance [m] of `NODE:RADIUS`."""
    try:
        node, _, radius = text.partition(":")
        result = int(node), float(radius)
    except ValueError:
        result = 0, math.nan
    if not (math.isfinite(result[1]) and result[1] > 0):
        raise InputError(f"--clearance {text}: must be NODE:RADIUS, the radial clearance in m")
    return result


def _unbalance(text: str) -> tuple[int, float, float]:
    try:
        node, amount, *phase = text.split(":")
        number = int(node)
        degrees = float(phase[0]) if phase else 0.0
        is_known = len(phase) < 2 and math.isfinite(degrees)
    except ValueError:
        is_known = False
    if not is_known or split(amount) is None:
        raise InputError(f"--unbalance {text}: must be NODE:AMOUNT or NODE:AMOUNT:DEGREES")
    return number, in_si(f"--unbalance {number}:", amount, "kg.m"), math.radians(degrees)


def _write_response(result: Any, nodes: list[int], path: Path) -> None:
    """A row a speed: of each node the amplitudes 0-p, the phases and the semi-axes."""
    import csv

    columns = {"speed [rad/s]": result.speeds}
    for node in nodes:
        at = node - 1
        columns |= {
            f"node[{node}].x [m]": np.abs(result.x[:, at]),
            f"node[{node}].y [m]": np.abs(result.y[:, at]),
            f"node[{node}].x_phase [rad]": result.phase_x[:, at],
            f"node[{node}].y_phase [rad]": result.phase_y[:, at],
            f"node[{node}].major [m]": result.major[:, at],
            f"node[{node}].minor [m]": result.minor[:, at],
        }
    with unfinished(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow([f"{value:.9g}" for value in row])


def _check_count(count: int) -> None:
    if not 1 <= count <= 1000:
        raise InputError(f"--count {count}: must be from 1 to 1000")


def _highest(machine: Rotor, contacts: str | None) -> float:
    """A speed [rad/s] above the lowest critical ones, for who names none."""
    from ..model import linear

    damped = linear.modes(machine, count=4, contacts=contacts).damped
    return 1.25 * float(damped[-1]) if len(damped) else 1000.0
