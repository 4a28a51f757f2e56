"""`rotor-fmu frequency-response`: displacements by a force, and control loops' sensitivity."""

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ..errors import InputError
from ..output_options import with_output_options
from .shared import Contacts, PictureFolder, RotorFile, Units
from .show_result import machine_in_units, print_answer
from .speeds import One, one_speed, speed_range, usual_frequencies

_POINTS = 801


@with_output_options
def frequency_response(
    rotor: RotorFile = None,
    force: Annotated[
        str | None,
        typer.Option(help="Where the force acts: a node from 1, or a part, such as a port."),
    ] = None,
    node: Annotated[
        list[str] | None,
        typer.Option(help="Node or part whose motion is shown; repeatable; default: the force's."),
    ] = None,
    frequency: Annotated[
        str | None,
        typer.Option(
            help="FROM:TO or FROM:TO:POINTS in rad/s, or with Hz or rpm added, peaks between the "
            "points included; default: from 1 Hz, or half the lowest natural frequency, to 500 Hz, "
            "or beyond the lowest natural frequencies and three times the machine's speeds."
        ),
    ] = None,
    speed: One = "0",
    loop: Annotated[
        Path | None,
        typer.Option(help="File with control loops of magnetic bearings, for their sensitivity."),
    ] = None,
    zones: Annotated[
        str | None,
        typer.Option(
            help="With --loop: largest sensitivities of zones A, B and C, such as 3:4:5, from the "
            "edition of ISO 14839-3 that applies."
        ),
    ] = None,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/frequency_response"),
) -> dict[str, Any]:
    """Compute the frequency response of displacements to a force at a speed, or, with --loop, the
    sensitivity of the control loops of magnetic bearings (ISO 14839-3)."""
    ends, at = speed_range(frequency, _POINTS, "--frequency"), one_speed(speed)
    machine = machine_in_units(rotor, units)
    if frequency is not None and (len(ends) < 2 or ends[0] <= 0):
        raise InputError(f"--frequency {frequency}: must be FROM:TO, both above 0")
    if (force is None) == (loop is None):
        raise InputError("--force and --loop: one of both must be given")
    if zones is not None and loop is None:
        raise InputError(f"--zones {zones}: are of --loop, which is not given")
    bounds = () if zones is None else _zones(zones)
    from ..linear import frequency_answers as answers

    if frequency is None:
        state = contacts or (None if loop is None else "open")
        ends = usual_frequencies(machine, at, state, _POINTS)
    points = np.geomspace(ends[0], ends[-1], len(ends))
    result: answers.FrequencyResponse | answers.Sensitivity
    if loop is not None:
        loops = answers.read_loops("--loop", loop, machine)
        result = answers.sensitivity(
            machine, points, loops, speed=at, contacts=contacts or "open", zones=bounds
        )
    else:
        start = answers.place_of(machine, str(force), "--force")
        nodes = [answers.place_of(machine, text, "--node") for text in node or [str(force)]]
        result = answers.frequency_response(
            machine, points, start, nodes, speed=at, contacts=contacts, peaks=True
        )
    return print_answer(result, out, "frequency_response")


def _zones(text: str) -> tuple[float, ...]:
    try:
        bounds = tuple(float(bound) for bound in text.split(":"))
        is_known = len(bounds) == 3 and 0 < bounds[0] < bounds[1] < bounds[2] < math.inf
    except ValueError:
        is_known = False
    if not is_known:
        raise InputError(f"--zones {text}: must be A:B:C, three ascending numbers above 0")
    return bounds
