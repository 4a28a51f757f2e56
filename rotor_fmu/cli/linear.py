"""`rotor-fmu modes`, `campbell`, `static`, `show`, `frequency-response`: table and picture."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ..errors import InputError
from ..output_options import with_output_options
from .shared import Contacts, PictureFolder, RotorFile, Units, check_count
from .show_result import machine_in_units, print_answer, say
from .speeds import (
    One,
    OperatingRange,
    Range,
    Rated,
    one_speed,
    operating_range,
    speed_range,
    usual_frequencies,
    usual_speeds,
    where_carried,
)

# The answers themselves are imported where they are asked for: a user with bad input, or of another
# command, should not wait for them.

_SPEEDS, _FREQUENCIES, _MOST_MODES = 41, 801, 1000

Count = Annotated[int, typer.Option(help="Number of modes.")]


@with_output_options
def modes(
    rotor: RotorFile = None,
    speed: One = None,
    count: Count = 8,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/modes"),
) -> dict[str, Any]:
    """Compute natural frequencies, damping, logarithmic decrements, whirl and mode shapes at a
    speed."""
    at, machine = None if speed is None else one_speed(speed), machine_in_units(rotor, units)
    check_count(count, _MOST_MODES)
    from ..linear import answers
    from ..linear.mode_answers import mode_shapes_figure
    from ..linear.where_linearized import where_linearized
    from ..plotting.figure_style import save

    result = answers.modes(machine, at, count=count, contacts=contacts)
    say(where_linearized(machine, [result.speed], contacts))
    data = print_answer(result, out, "modes")
    save(mode_shapes_figure(result), out / "modes_3d.png")
    return data


@with_output_options
def campbell(
    rotor: RotorFile = None,
    speed: Range = None,
    count: Count = 8,
    contacts: Contacts = None,
    harmonic: list[float] | None = None,
    operating: OperatingRange = None,
    rated: Rated = None,
    units: Units = None,
    out: PictureFolder = Path("out/campbell"),
) -> dict[str, Any]:
    """Compute the Campbell diagram, critical speeds, and the threshold speed of stability.

    harmonic: Multiple of the speed of rotation that excites, its order; repeatable; default 1.
    """
    speeds, machine = speed_range(speed, _SPEEDS), machine_in_units(rotor, units)
    ends = operating_range(operating, rated, machine)
    check_count(count, _MOST_MODES)
    if len(speeds) == 1:
        raise InputError(f"--speed {speed}: must be FROM:TO, more than one speed")
    from ..linear import answers
    from ..linear.where_linearized import where_linearized

    if len(speeds) == 0:
        speeds = usual_speeds(machine, contacts, ends, _SPEEDS)
    speeds = where_carried(speeds, machine, contacts)
    result = answers.campbell(
        machine, speeds, count=count, contacts=contacts, harmonic=harmonic or 1.0
    )
    say(where_linearized(machine, speeds, contacts))
    return print_answer(result, out, "campbell", figure=result.figure(ends))


@with_output_options
def static(
    rotor: RotorFile = None,
    speed: One = None,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/static"),
) -> dict[str, Any]:
    """Compute the deflection under gravity and constant loads, and what each bearing bears."""
    at, machine = None if speed is None else one_speed(speed), machine_in_units(rotor, units)
    from ..linear import answers
    from ..linear.where_linearized import (
        where_beyond_ranges,
        where_it_lies_in_contacts,
        where_not_at_rest,
        where_straight,
    )

    result = answers.static(machine, at, contacts=contacts)
    beyond = where_beyond_ranges(machine, [result.speed])
    lies = where_it_lies_in_contacts(machine, result.speed, contacts)
    leaves = where_not_at_rest(machine, result.speed, contacts)
    say(where_straight(machine), beyond, lies, leaves)
    return print_answer(result, out, "static")


@with_output_options
def show(
    rotor: RotorFile = None, units: Units = None, out: PictureFolder = Path("out/show")
) -> dict[str, Any]:
    """Draw the machine to scale and list its parts."""
    machine = machine_in_units(rotor, units)
    from ..linear.inventory import inventory
    from ..plotting.machine_drawing import machine_figure

    return print_answer(inventory(machine), out, "show", figure=machine_figure(machine))


@with_output_options
def frequency_response(
    rotor: RotorFile = None,
    force: str | None = None,
    node: list[str] | None = None,
    frequency: str | None = None,
    speed: One = None,
    loop: Path | None = None,
    zones: str | None = None,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/frequency_response"),
) -> dict[str, Any]:
    """Compute the frequency response of displacements to a force, or to an acceleration of the
    base, at a speed, or, with --loop, the sensitivity of the control loops of magnetic bearings
    (ISO 14839-3).

    force: Where the force acts: a node from 1, or a part, such as a port; base: the base is
        accelerated instead, and displacements are relative to it.
    node: Node or part whose motion is shown; repeatable; default: the force's, with the base those
        of the sensors, or of discs, bodies and bearings given by coefficients.
    frequency: FROM:TO or FROM:TO:POINTS in rad/s, or with Hz or rpm added, peaks between the points
        included; default: from 1 Hz, or half the lowest natural frequency, to 500 Hz, or beyond the
        lowest natural frequencies and three times the machine's speeds.
    loop: File with control loops of magnetic bearings, for their sensitivity.
    zones: With --loop: largest sensitivities of zones A, B and C, such as 3:4:5, from the edition
        of ISO 14839-3 that applies.
    """
    ends = speed_range(frequency, _FREQUENCIES, "--frequency")
    given, machine = None if speed is None else one_speed(speed), machine_in_units(rotor, units)
    if frequency is not None and (len(ends) < 2 or ends[0] <= 0):
        raise InputError(f"--frequency {frequency}: must be FROM:TO, both above 0")
    if (force is None) == (loop is None):
        raise InputError("--force, --loop: one of them must be given, and only one")
    if zones is not None and loop is None:
        raise InputError(f"--zones {zones}: are of --loop, which is not given")
    bounds = () if zones is None else _zones(zones)
    from ..linear import frequency_answers as answers
    from ..linear.answers import usual_speed
    from ..linear.where_linearized import where_beyond_ranges, where_linearized, where_not_reached

    compute: Callable[..., answers.FrequencyResponse | answers.Sensitivity]
    if loop is not None:
        contacts = contacts or "open"
        loops = answers.read_loops("--loop", loop, machine)
        compute = partial(answers.sensitivity, loops=loops, zones=bounds)
    else:
        start = answers.excitation_of(machine, str(force), "--force")
        usual = answers.observed_places(machine) if isinstance(start, str) else [start]
        nodes = [answers.place_of(machine, text, "--node") for text in node or ()] or usual
        if not nodes:
            raise InputError(
                "--node: must be given; of no part is the motion observed, as it is of a sensor"
            )
        compute = partial(answers.frequency_response, force=start, nodes=nodes, peaks=True)
    at = usual_speed(machine, contacts) if given is None else given
    if frequency is None:
        ends = usual_frequencies(machine, at, contacts, _FREQUENCIES)
    points = np.geomspace(ends[0], ends[-1], len(ends))
    result = compute(machine, points, speed=at, contacts=contacts)
    if loop is None:
        say(
            where_linearized(machine, [at], contacts, follows_force=True),
            where_not_reached(machine, [at], contacts),
        )
    else:  # loops hold a machine, and their answer says whether they do
        say(where_beyond_ranges(machine, [at]))
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
