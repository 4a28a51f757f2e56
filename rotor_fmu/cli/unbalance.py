"""`rotor-fmu unbalance`: the steady response to unbalance, and its check by API 617."""

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ..errors import InputError, writable_folder
from ..files import unfinished
from ..output_options import with_output_options
from ..units import in_si, split
from .nodes import Clearances, check_nodes, clearances_of
from .shared import Contacts, RotorFile, Units
from .show_result import machine_in_units, name_films, print_answer
from .speeds import OperatingRange, Range, Rated, operating_range, speed_range, usual_speeds

_POINTS = 401


@with_output_options
def unbalance(
    rotor: RotorFile = None,
    speed: Range = None,
    node: Annotated[
        list[int] | None,
        typer.Option(
            help="Node to show, counted from 1; repeatable; default: the nodes with the largest "
            "orbits."
        ),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--unbalance",
            help="NODE:AMOUNT:DEGREES, such as 4:50g.mm:90, or in kg.m; replaces the machine's "
            "own unbalances; repeatable.",
        ),
    ] = None,
    mode: Annotated[
        int | None,
        typer.Option(
            help="Place the unbalances that API 617 prescribes (4W/N) for this mode, from 1."
        ),
    ] = None,
    factor: Annotated[
        float | None,
        typer.Option(help="With --mode: multiple of the residual unbalance 4W/N; default: 2."),
    ] = None,
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
    speeds, machine = speed_range(speed, _POINTS), machine_in_units(rotor, units)
    given = [_unbalance(text) for text in at] if at else None
    ends = operating_range(operating, rated, machine)
    gaps = clearances_of(clearance)
    if mode is not None and given:
        raise InputError("--mode and --unbalance: only one of both may place unbalances")
    if mode is None and factor is not None:
        raise InputError(f"--factor {factor:g}: needs --mode, whose unbalances it multiplies")
    if (mode is not None or gaps) and ends is None:
        raise InputError("--mode and --clearance: need the operating range, --range FROM:TO")
    check_nodes(machine, "--node", (*(node or []), *gaps))
    from ..linear import acceptance, answers
    from ..model.linear.unbalance_placement import FACTOR, placed_unbalances

    if mode is not None and ends is not None:
        times = FACTOR if factor is None else factor
        placed = placed_unbalances(machine, mode, ends[1], factor=times, contacts=contacts)
        given = [(p.node, p.amount, p.phase) for p in placed]
    if len(speeds) == 0:
        speeds = usual_speeds(machine, contacts, ends, _POINTS)
    result = answers.unbalance_response(machine, speeds, contacts=contacts, unbalances=given)
    nodes = node or result.nodes()
    name_films(machine)
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
    shown = result.table(nodes), result.figure(nodes, ends)
    return print_answer(result, out, "unbalance", *shown, more)


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
