"""`rotor-fmu bearing`: a film, a floating ring, a damper or a rolling bearing by itself."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from ..errors import InputError, check_one_of, writable_file
from ..files import write_text
from ..model.machine.rotor import Rotor
from ..output_options import with_output_options
from .shared import PictureFolder, RotorFile, Units
from .show_result import machine_in_units, print_answer, say
from .speeds import number_range, speed_range, where_carried

if TYPE_CHECKING:
    from ..linear.bearing_answers import BearingCurves, DamperCurves, RingCurves, RollingCurves


@with_output_options
def bearing(
    rotor: RotorFile = None,
    speed: str | None = None,
    name: Annotated[str | None, typer.Option("--bearing")] = None,
    load: str | None = None,
    table: Path | None = None,
    units: Units = None,
    out: PictureFolder = Path("out/bearing"),
) -> dict[str, Any]:
    """Compute where a bearing's journal, ring or shaft rests, and its coefficients there.

    Of an oil film also the threshold of whirl; the last column compares the film's load with a
    solution of Reynolds' equation in two dimensions. Of a floating ring also how fast it turns, and
    the coefficients of both films in series. Of a squeeze film damper the film's stiffness
    and damping on centred circular orbits; of a rolling bearing what its elements carry, and how
    its stiffness changes as they pass.

    speed: Speeds FROM:TO or FROM:TO:POINTS, or one, in rad/s, or with rpm or Hz added; of a damper
        one, the frequency of its orbits; a rolling bearing needs none.
    name: Its name, such as journal_bearing[2]; default: the first.
    load: Load along gravity, FROM:TO or FROM:TO:POINTS, or one, in N or with kN added; default:
        what weight and loads put on it.
    table: File for a linear_bearing with these coefficients over the speed.
    """
    speeds, machine = speed_range(speed, 21), machine_in_units(rotor, units)
    if load is None:
        speeds = where_carried(speeds, machine, None)
    loads = None if load is None else number_range(load, 21, "--load", "N")
    if loads is not None and len(loads) > 1:
        if len(speeds) > 1:
            raise InputError(f"--load {load}: must be one where --speed {speed} is a range")
        if table is not None:
            raise InputError(f"--load {load}: must be one, for the speeds of --table")
    from ..linear.where_linearized import where_beyond_ranges

    result = _result(machine, name, speeds, loads)
    beyond = where_beyond_ranges(machine, speeds if len(speeds) else [0.0])
    # a load that is given asks nothing of the machine's other parts
    say(s for s in beyond if loads is None or s.startswith(f"{result.bearing}: "))
    if table is None:
        return print_answer(result, out, "bearing")
    text = _linear_bearing(result, machine)
    writable_file(table, "the table's", "--table")
    if rotor and table.exists() and table.samefile(rotor):
        raise InputError(f"--table {table}: is the machine's own file; give another")
    data = print_answer(result, out, "bearing")
    write_text(text, table)
    typer.echo(f"written to {table}")
    return data


def _result(
    machine: Rotor, name: str | None, speeds: np.ndarray, loads: np.ndarray | None
) -> "BearingCurves | DamperCurves | RingCurves | RollingCurves":
    """Return the curves of the bearing of that name, by default the first."""
    from ..linear import bearing_answers as answers
    from ..model.bearing_curves import bearings
    from ..model.parts.floating_ring_bearing import FloatingRingBearing
    from ..model.parts.rolling_bearing import RollingBearing
    from ..model.parts.squeeze_film_damper import SqueezeFilmDamper

    known = bearings(machine)
    if not known:
        raise InputError(
            "the machine has no [[journal_bearing]], [[squeeze_film_damper]], [[rolling_bearing]] "
            "or [[floating_ring_bearing]]"
        )
    chosen = name or next(iter(known))
    check_one_of(f"--bearing {chosen}", chosen, known)
    kind = type(known[chosen])
    is_damper = kind is SqueezeFilmDamper
    if loads is not None and not (loads >= 0.0 if is_damper else loads > 0.0).all():
        least = "must be >= 0" if is_damper else "must be > 0"
        raise InputError(f"--load {loads.min():g}: {least}")
    if kind is RollingBearing:
        given = speeds if len(speeds) else np.zeros(1)
        return answers.rolling(machine, given, bearing=chosen, load=loads)
    if not is_damper:
        if not len(speeds):
            raise InputError(f"--speed: must be given, on which the film of {chosen} depends")
        answer = answers.floating_ring if kind is FloatingRingBearing else answers.bearing
        return answer(machine, speeds, bearing=chosen, load=loads)
    if len(speeds) != 1 or speeds[0] <= 0.0:
        raise InputError(f"--speed: must be one above 0, of the orbits of {chosen}")
    if loads is not None and len(loads) != 1:
        raise InputError(f"--load: must be one, under which {chosen} rests")
    load = None if loads is None else float(loads[0])
    return answers.damper(machine, float(speeds[0]), bearing=chosen, load=load)


def _linear_bearing(
    result: "BearingCurves | DamperCurves | RingCurves | RollingCurves", machine: Rotor
) -> str:
    """Return a `[[linear_bearing]]` with the coefficients over the speed as TOML."""
    from ..linear.bearing_answers import BearingCurves, RingCurves
    from ..model.bearing_curves import bearings
    from ..model.machine.toml_text import toml_text
    from ..model.parts.squeeze_film_damper import SqueezeFilmDamper

    part = bearings(machine)[result.bearing]
    if isinstance(part, SqueezeFilmDamper) and part.ring:
        raise InputError(
            f"--table: {result.bearing} stands between two housings, {part.ring!r} and "
            f"{part.housing or 'ground'!r}; a linear_bearing is between a node and one of them"
        )
    # a node that a part was placed on has no number in the file
    values: dict[str, Any] = {"z": float(f"{machine.nodes[part.node - 1]:.12g}")}
    if housing := getattr(part, "housing", ""):
        values["housing"] = housing
    what, rests = "", "it rests"
    K, C = (np.reshape(of, (-1, 2, 2)) for of in (result.K, result.C))
    if isinstance(result, BearingCurves | RingCurves):
        both = isinstance(result, RingCurves)
        what = "The films of " if both else "The film of "
        rests = "journal and ring rest" if both else "its journal rests"
        if len(K) > 1:
            values["speed"] = result.speeds.tolist()
    for letter, of in (("k", K), ("c", C)):
        for i, row in enumerate("xy"):
            for j, column in enumerate("xy"):
                all_of = of[:, i, j].tolist()
                values[f"{letter}{row}{column}"] = all_of if "speed" in values else all_of[0]
    head = f"# {what}{result.bearing} of {machine.name}, linearized where {rests}.\n"
    is_ring = isinstance(result, RingCurves)
    if is_ring or (isinstance(result, BearingCurves) and result.tilts.shape[1]):
        follows = "The ring follows" if is_ring else "Pads follow"
        when = "at the frequency of rotation: right for unbalance, not for slower whirls"
        head += f"# {follows} {when}.\n"
    return f"{head}\n{toml_text({'linear_bearing': [values]})}"
