"""`rotor-fmu balance`: correction unbalances from runs with trial unbalances."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError
from ..output_options import with_output_options
from ..units import in_si
from .shared import PictureFolder, RotorFile, Units
from .show_result import machine_in_units, print_answer
from .speeds import one_speed


@with_output_options
def balance(
    rotor: RotorFile = None,
    speed: Annotated[
        list[str] | None,
        typer.Option(
            "--speed",
            help="Balancing speed, in rad/s or with rpm or Hz added; at least one; repeatable.",
        ),
    ] = None,
    plane: Annotated[
        list[int] | None,
        typer.Option(help="Node of a correction plane, counted from 1; at least one; repeatable."),
    ] = None,
    node: Annotated[
        list[int] | None,
        typer.Option(help="Node where vibration is measured; repeatable; default: the planes."),
    ] = None,
    trial: Annotated[
        str | None,
        typer.Option(
            metavar="UNBALANCE",
            help="Trial unbalance of each plane, such as 50g.mm, or in kg.m; default: all together "
            "pull with a tenth of the rotor's weight.",
        ),
    ] = None,
    units: Units = None,
    out: PictureFolder = Path("out/balance"),
) -> dict[str, Any]:
    """Balance a machine by influence coefficients (ISO 21940-12), from runs in time: as it is, with
    a trial unbalance in each correction plane, and with the correction unbalances."""
    if not speed or not plane:
        raise InputError("--speed and --plane: must be given, such as --speed 1500rpm --plane 4")
    speeds, machine = [one_speed(text) for text in speed], machine_in_units(rotor, units)
    amount = None if trial is None else in_si("--trial", trial, "kg.m")
    from ..trial_balancing import balance as balanced

    result = balanced(machine, speeds, plane, measured=node, trial=amount)
    return print_answer(result, out, "balance")
