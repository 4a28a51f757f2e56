"""`rotor-fmu modes`, `campbell`, `static`, `show`: each with a table and a picture."""

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError
from ..output_options import with_output_options
from .shared import Contacts, PictureFolder, RotorFile, Units, check_count
from .show_result import machine_in_units, name_films, print_answer
from .speeds import (
    One,
    OperatingRange,
    Range,
    Rated,
    one_speed,
    operating_range,
    speed_range,
    usual_speeds,
)

# The answers themselves are imported where they are asked for: a user with bad input, or of another
# command, should not wait for them.

_POINTS, _MOST_MODES = 41, 1000

Count = Annotated[int, typer.Option(help="Number of modes.")]


@with_output_options
def modes(
    rotor: RotorFile = None,
    speed: One = "0",
    count: Count = 8,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/modes"),
) -> dict[str, Any]:
    """Compute natural frequencies, damping, logarithmic decrements, whirl and mode shapes at a
    speed."""
    at, machine = one_speed(speed), machine_in_units(rotor, units)
    from ..linear import answers

    check_count(count, _MOST_MODES)
    from ..linear.mode_shapes import mode_shapes_figure
    from ..plotting.figure_style import save

    result = answers.modes(machine, at, count=count, contacts=contacts)
    name_films(machine)
    data = print_answer(result, out, "modes")
    save(mode_shapes_figure(result, result.machine_name, result.shear), out / "modes_3d.png")
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
    out: PictureFolder = Path("out/campbell"),
) -> dict[str, Any]:
    """Compute the Campbell diagram, critical speeds, and the threshold speed of stability."""
    speeds, machine = speed_range(speed, _POINTS), machine_in_units(rotor, units)
    ends = operating_range(operating, rated, machine)
    from ..linear import answers

    check_count(count, _MOST_MODES)
    if len(speeds) == 1:
        raise InputError(f"--speed {speed}: must be FROM:TO, more than one speed")
    if len(speeds) == 0:
        speeds = usual_speeds(machine, contacts, ends, _POINTS)
    result = answers.campbell(
        machine, speeds, count=count, contacts=contacts, harmonic=harmonic or 1.0
    )
    name_films(machine)
    return print_answer(result, out, "campbell", figure=result.figure(ends))


@with_output_options
def static(
    rotor: RotorFile = None,
    speed: Annotated[
        str | None,
        typer.Option(
            help="Speed, such as 3000rpm or 50Hz; a number without unit is in rad/s; default: 0, "
            "or the rated speed of a machine that oil films hold."
        ),
    ] = None,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/static"),
) -> dict[str, Any]:
    """Compute the deflection under gravity and the load on each bearing."""
    at, machine = None if speed is None else one_speed(speed), machine_in_units(rotor, units)
    from ..linear import answers

    result = answers.static(machine, at, contacts=contacts)
    return print_answer(result, out, "static")


@with_output_options
def show(
    rotor: RotorFile = None,
    units: Units = None,
    out: PictureFolder = Path("out/show"),
) -> dict[str, Any]:
    """Draw the machine to scale and list its parts."""
    machine = machine_in_units(rotor, units)
    from ..linear import answers
    from ..linear.inventory import inventory

    return print_answer(inventory(machine), out, "show", figure=answers.show(machine))
