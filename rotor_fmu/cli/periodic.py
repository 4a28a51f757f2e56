"""`rotor-fmu response`: periodic motions over the speed or another parameter."""

import math
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..display import Shown, choose, current
from ..errors import InputError, writable_folder
from ..machine_file.loading import load_rotor, warn_of_changes
from ..model.machine.rotor import Rotor
from ..output_options import with_output_options, write_json
from ..screen import progress_of
from ..units import in_si
from .shared import RotorFile, Units
from .speeds import number_range, one_speed, speed_range

if TYPE_CHECKING:
    from ..periodic.request import ReportPoint
    from ..periodic.result import ResponseResult

# Of a curve, a value on it, and what is said behind these.
_AddPoint = Callable[[str, float, str], None]
_CHECKED = 8  # points that are taken into time
_HAS_LEFT = 1e6  # growth of a deviation by which the error of a run has left a motion


@with_output_options
def response(
    rotor: RotorFile = None,
    speed: str | None = None,
    over: str | None = None,
    values: Annotated[list[str] | None, typer.Option("--set")] = None,
    load: list[str] | None = None,
    period: int = 1,
    harmonics: int = 60,
    share: float = 1e-4,
    step: float = 0.1,
    seed: list[str] | None = None,
    whirl: bool = False,
    branches: bool = False,
    check: bool = False,
    fold_over: str | None = None,
    units: Units = None,
    out: Path = Path("out/response"),
) -> dict[str, Any]:
    """Compute periodic motions with contacts: the whole response curve, with its jumps and its
    unstable parts.

    A call that was stopped keeps its points in the folder, and the same call continues from there.

    speed: Speeds FROM:TO, or, with --over, one speed, in rad/s, or with rpm or Hz added; default:
        from an eighth of the machine's highest speed to that, or its rated speed.
    over: NAME=FROM:TO, a quantity of the machine that is varied instead of the speed, with or
        without unit.
    values: NAME=VALUE of the machine, with or without unit; repeatable.
    load: NAME=VALUE of a constant force, such as disc[2].fy=-20N; repeatable.
    period: Revolutions in a period of the motion.
    harmonics: Largest number of harmonics of the speed.
    share: Largest share of the motion that the highest harmonics may have.
    step: Longest step along the curve, by shooting as by harmonics: how far the contacts' Fourier
        series moves, in clearances (of motions past ten, in tenths of their size), with the share
        of the range.
    seed: Value of what is varied, with or without unit, at which a run in time looks for a further
        branch; repeatable.
    whirl: Follow the whirl that needs no unbalance: dry whip, oil whirl.
    branches: Follow also the branches that begin at period doublings and branch points.
    check: Run some points in time and say whether they persist.
    fold_over: NAME=FROM:TO, a second quantity over which the first fold is followed, with or
        without unit.
    out: Folder for picture and numbers.
    """
    from ..runs.settings_text import as_set, machine_values, named_texts

    if whirl and check:
        raise InputError("--check: not with --whirl, which is computed without unbalance")
    toml, machine = load_rotor(rotor)
    choose(units, machine.units, rotor or "")
    loads = named_texts("--load", load or [])
    parameters = machine_values("--set", machine, named_texts("--set", values or []))
    set_so = as_set(machine, parameters)
    of = {name: known.quantity.unit for name, known in set_so.numbers().items()}
    at, varied = _varied(speed or _usual(machine, over), over, set_so)
    unit = "rad/s" if varied is None else of.get(varied[0], "1")
    options: dict[str, Any] = {
        "speed": at,
        "over": varied,
        "parameters": parameters,
        "loads": {n: in_si(f"--load {n} =", v, "N") for n, v in loads.items()},
        "period": period,
        "harmonics": harmonics,
        "share": share,
        "step": step,
        "seeds": tuple(in_si("--seed", text, unit) for text in seed or ()),
        "whirl": whirl,
        "branches": branches,
    }
    second = None if fold_over is None else _second(fold_over, set_so, options)
    result = _computed(machine, toml, options, out, current().of_si(unit))
    summary = dict(result.summary)
    write_response(result, machine.name, summary, out)  # kept where what follows is stopped
    if not result.is_stopped and (second is not None or check):
        if second is not None:
            summary["folds"] = _folds(result, *second, current().of_si(of[second[0]]), out)
        if check:
            summary["check"] = _checked(result)
        write_json(summary, out / "response.json")
    _show(result, out)
    return summary


def _computed(
    machine: Rotor, toml: str, options: dict[str, Any], out: Path, axis: Shown
) -> "ResponseResult":
    """Compute a response, continuing from the points that are saved in the folder."""
    from ..model.periodic.laws import waits_for_compiler
    from ..periodic.request import compute_response, response_request

    request = response_request(machine, **options)
    warn_of_changes("--set", machine, request.rotor)
    warn_of_changes("--over", request.rotor, *request.ends())
    writable_folder(out)
    from ..periodic.saved_events import saved_log

    length = request.task.high - request.task.low
    with (
        saved_log(out, toml, options) as saved,
        response_progress(length, axis, saved.before) as report_point,
    ):
        if waits_for_compiler():
            print(
                "response: compiling the laws of all parts, once on this machine", file=sys.stderr
            )
        return compute_response(request, report_point, saved.log)


def _show(result: "ResponseResult", out: Path) -> None:
    """Print a response; raises `KeyboardInterrupt` for one that was stopped."""
    typer.echo(result.table().text())
    for note in result.notes:
        typer.echo(note)
    typer.echo(f"written to {out}")
    if result.is_stopped:
        print("response: its points are saved; the same call continues from there", file=sys.stderr)
        raise KeyboardInterrupt


def write_response(
    result: "ResponseResult", name: str, summary: dict[str, Any], folder: Path
) -> None:
    """Write the numbers, the picture and the page of a response; name: of the machine."""
    from ..periodic.response_page import response_page
    from ..plotting.figure_style import save
    from ..report.run_page import write_page

    write_json(summary, folder / "response.json")  # first, at once: the pictures take seconds
    if result.points:
        save(result.figure(), folder / "response.png")
        write_page(lambda: response_page(result, name), folder / "response.html")


@contextmanager
def response_progress(length: float, axis: Shown, before: int = 0) -> Iterator["ReportPoint"]:
    """Show how far a response is, with the number of harmonics; see `_progress`."""
    with _progress(length, before, axis) as add:
        yield lambda label, point: add(label, point.value, f", {point.orbit.H} harmonics")


@contextmanager
def _progress(length: float, before: int, axis: Shown) -> Iterator[_AddPoint]:
    """Show how much of the range, so long, is covered, and where the curve is; before: points of an
    earlier call; axis: how its values are shown."""
    count, low, high = 0, math.inf, -math.inf
    with progress_of("response", length, first=2.0) as update:

        def add(label: str, value: float, more: str) -> None:
            nonlocal count, low, high
            count, low, high = count + 1, min(low, value), max(high, value)
            if count > before:
                text = f"{label}: {count} points, at {axis.text(value)}{more}"
                update(high - low, lambda: text, False)

        yield add


def _usual(machine: Rotor, over: str | None) -> str:
    """Return the speeds of a machine's response as an option gives them."""
    from ..operating_speeds import operating_speeds

    speeds = operating_speeds(machine)
    return f"{speeds.rated!r}" if over else f"{speeds.highest / 8.0!r}:{speeds.highest!r}"


def _varied(
    speed: str, over: str | None, machine: Rotor
) -> tuple[float | tuple[float, float], tuple[str, float, float] | None]:
    """Return the range of speeds, or the one speed, and the quantity that is varied instead."""
    if over is not None:
        return one_speed(speed), _range(over, "--over", machine)
    ends = speed_range(speed, None)
    if len(ends) != 2:
        raise InputError(f"--speed {speed}: must be FROM:TO")
    return (float(ends[0]), float(ends[1])), None


def _second(text: str, machine: Rotor, options: Mapping[str, Any]) -> tuple[str, float, float]:
    """Return the quantity of `--fold-over` and its range, checked before anything is computed."""
    from ..model.periodic.queries import check_second
    from ..periodic.request import response_request

    name, low, high = _range(text, "--fold-over", machine)
    check_second(*response_request(machine, **options), name, low, high)
    return name, low, high


def _folds(
    result: "ResponseResult", name: str, low: float, high: float, axis: Shown, out: Path
) -> dict[str, Any]:
    """Return where the first fold lies over the quantity of `--fold-over`, and draw it; where there
    is none, say so: the curve itself is a result. axis: how the quantity is shown."""
    from ..plotting.figure_style import save

    found: dict[str, Any] = {"second": [], "first": [], "name": name, "ends": []}
    try:
        with _progress(high - low, 0, axis) as add:
            folds = result.fold_curve(
                name, low, high, report_value=lambda value: add("folds", value, "")
            )
    except InputError as error:
        typer.echo(f"--fold-over {name}: {error}")
        return found
    first, last = (axis.text(end) for end in (folds.second[0], folds.second[-1]))
    ends = " to ".join(folds.ends)
    typer.echo(f"Folds over {name}: {len(folds.second)} points from {first} to {last}, {ends}")
    save(result.fold_figure(name, folds), out / "response_folds.png")
    lists = {"second": folds.second.tolist(), "first": folds.first.tolist()}
    return found | lists | {"ends": folds.ends}


def _checked(result: "ResponseResult") -> list[dict[str, Any]]:
    """Points of the branches, evenly chosen, in time; said one a line."""
    from ..model.simulation import StepFailure

    points = result.points[:: max(1, len(result.points) // _CHECKED)]
    rows, axis = [], result.axis
    for point in points:
        value = axis.text(point.value)
        try:
            seen = result.check(point)
        except (InputError, StepFailure) as error:  # the curve itself is a result
            typer.echo(f"{value}: {error}")
            continue
        row = {"value": point.value, "stable": point.is_stable}
        rows.append(row | {"stays": seen.stays, "distance": seen.distance})
        what, more = "stable" if point.is_stable else "unstable", ""
        if seen.stays and not point.is_stable:
            each = abs(point.multipliers[0]) ** (1 / point.orbit.turns)
            growth = each**seen.turns
            more = f", in which a deviation grows {growth:.3g} times"
            if growth > _HAS_LEFT:  # as beside a grazing, where a stable motion begins
                more = (
                    f": gone to a motion that near, since a deviation grows {each:.3g} times a turn"
                )
        typer.echo(
            f"{value}, {what}: {'stays' if seen.stays else 'leaves'}, "
            f"{seen.distance:.2g} of the orbit away after {seen.turns} turns{more}"
        )
    return rows


def _range(text: str, option: str, machine: Rotor) -> tuple[str, float, float]:
    """Return a parameter's name and both ends, in SI units, of `NAME=FROM:TO`."""
    from ..runs.settings_text import known_parameter

    name, equals, ends = (part.strip() for part in text.partition("="))
    if not equals or ends.count(":") != 1:
        raise InputError(f"{option} {text}: must be NAME=FROM:TO")
    unit = machine.numbers()[known_parameter(option, name, machine)].quantity.unit
    low, high = number_range(ends, None, f"{option} {name} =", unit)
    return name, float(low), float(high)
