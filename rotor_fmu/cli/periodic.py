"""`rotor-fmu response`: periodic answers over the speed or another parameter."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from ..errors import InputError, writable_folder
from ..output_options import with_output_options
from ..runs.job import load_rotor, write_json
from ..screen import progress_of
from .shared import RotorFile
from .speeds import one_speed, speed_range

if TYPE_CHECKING:
    from ..model.machine.rotor import Rotor
    from ..model.periodic.branch import Solution
    from ..periodic.result import ResponseResult

_errors = Console(stderr=True)
_CHECKED = 8  # points that are taken into time


@with_output_options
def response(
    rotor: RotorFile = None,
    speed: Annotated[
        str | None,
        typer.Option(
            "--speed",
            help="FROM:TO in rad/s, or with rpm or Hz behind; with --over one. Default: from an "
            "eighth of the machine's highest speed to that, or its rated speed.",
        ),
    ] = None,
    over: Annotated[
        str | None,
        typer.Option(
            help="NAME=FROM:TO: a quantity of the machine to vary in the place of the speed."
        ),
    ] = None,
    values: Annotated[
        list[str] | None, typer.Option("--set", help="NAME=VALUE of the machine; repeatable.")
    ] = None,
    load: Annotated[
        list[str] | None,
        typer.Option(help="NAME=VALUE of a constant force, disc[2].fy=-20 [N]; repeatable."),
    ] = None,
    period: Annotated[int, typer.Option(help="Revolutions in a period.")] = 1,
    harmonics: Annotated[int, typer.Option(help="Harmonics of the speed, at most.")] = 60,
    share: Annotated[
        float, typer.Option(help="What the highest harmonics may be of the motion.")
    ] = 1e-4,
    step: Annotated[
        float, typer.Option(help="Longest step, in clearances and shares of the range.")
    ] = 0.1,
    seed: Annotated[
        list[float] | None,
        typer.Option(help="Value where a run in time looks for a further branch; repeatable."),
    ] = None,
    whirl: Annotated[
        bool, typer.Option("--whirl", help="Backward whirl by itself, without unbalance.")
    ] = False,
    branches: Annotated[
        bool,
        typer.Option(
            "--branches", help="Follow what begins at period doublings and branch points too."
        ),
    ] = False,
    check: Annotated[
        bool, typer.Option("--check", help="Take points into time and say whether they stay.")
    ] = False,
    fold_over: Annotated[
        str | None,
        typer.Option(help="NAME=FROM:TO: where the first fold lies over another quantity."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for picture and numbers.")] = Path(
        "out/response"
    ),
) -> dict[str, Any]:
    """Periodic motions with contacts: the whole curve with its jumps and unstable parts.

    A call that was stopped keeps its points in the folder, and the same call continues from there.
    """
    toml, machine = load_rotor(rotor)
    at, varied = _varied(speed or _usual(machine, over), over)
    asked: dict[str, Any] = {
        "speed": at,
        "over": varied,
        "parameters": _pairs("--set", values),
        "loads": _pairs("--load", load),
        "period": period,
        "harmonics": harmonics,
        "share": share,
        "step": step,
        "seeds": tuple(seed or ()),
        "whirl": whirl,
        "branches": branches,
    }
    from ..periodic.answers import found, question

    task = question(machine, **asked)
    writable_folder(out)
    from ..periodic.saved_events import saved_journal

    length = task.task.high - task.task.low
    with saved_journal(out, toml, asked) as saved, _progress(length, saved.before) as tell:
        result = found(task, tell, saved.journal)
    summary = dict(result.summary)
    if not result.is_stopped:
        if fold_over is not None:
            summary["folds"] = _folds(result, fold_over)
        if check:
            summary["check"] = _checked(result)
    _show(result, machine.name, summary, out)
    return summary


def _show(result: ResponseResult, name: str, summary: dict[str, Any], out: Path) -> None:
    """Write and print a response; raises `KeyboardInterrupt` for one that was stopped."""
    write_response(result, name, summary, out)
    typer.echo(result.table().text())
    for note in result.notes:
        typer.echo(note)
    typer.echo(f"written to {out}")
    if result.is_stopped:
        print("response: its points are saved; the same call continues from there", file=sys.stderr)
        raise KeyboardInterrupt


def write_response(
    result: ResponseResult, name: str, summary: dict[str, Any], folder: Path
) -> None:
    """Write the picture, the page and the numbers of a response; name: of the machine."""
    from ..figure_style import save

    if result.points:
        save(result.figure(), folder / "response.png")
        _write_page(result, name, folder / "response.html")
    write_json(summary, folder / "response.json")


def _write_page(result: ResponseResult, name: str, path: Path) -> None:
    """Write the page; where what draws it is not installed a warning says so instead."""
    from ..files import write_text
    from ..periodic.response_page import response_page

    try:
        write_text(response_page(result, name), path)
    except InputError as error:
        print(f"warning: {path.name} is not written: {error}", file=sys.stderr)


@contextmanager
def _progress(length: float, before: int) -> Iterator[Callable[[str, Solution], None]]:
    """Show how much of the range, so long, is covered, and where the curve is; before: points of an
    earlier call."""
    count, low, high = 0, math.inf, -math.inf
    with progress_of("response", length, _errors, first=2.0) as update:

        def tell(label: str, point: Solution) -> None:
            """Take one more point."""
            nonlocal count, low, high
            count, low, high = count + 1, min(low, point.value), max(high, point.value)
            if count > before:
                text = f"{label}: {count} points, at {point.value:.5g}, {point.orbit.H} harmonics"
                update(high - low, lambda: text, False)

        yield tell


def _usual(machine: Rotor, over: str | None) -> str:
    """Return the speeds of a machine's response as an option gives them."""
    from ..operation import operating_speeds

    speeds = operating_speeds(machine)
    return f"{speeds.rated!r}" if over else f"{speeds.highest / 8.0!r}:{speeds.highest!r}"


def _varied(
    speed: str, over: str | None
) -> tuple[float | tuple[float, float], tuple[str, float, float] | None]:
    """Return the range of speeds, or the one speed, and the quantity that is varied instead."""
    if over is not None:
        return one_speed(speed), _range(over, "--over")
    ends = speed_range(speed, 2)
    if len(ends) != 2:
        raise InputError(f"--speed {speed}: must be FROM:TO")
    return (float(ends[0]), float(ends[1])), None


def _folds(result: ResponseResult, text: str) -> dict[str, Any]:
    """Return where the first fold lies over the quantity of `--fold-over`."""
    name, low, high = _range(text, "--fold-over")
    folds = result.fold_curve(name, low, high)
    return {
        "second": folds.second.tolist(),
        "first": folds.first.tolist(),
        "name": name,
        "ends": folds.ends,
    }


def _checked(result: ResponseResult) -> list[dict[str, Any]]:
    """Points of the branches, evenly chosen, in time; said one a line."""
    points = result.points[:: max(1, len(result.points) // _CHECKED)]
    rows = []
    for point in points:
        seen = result.check(point)
        rows.append(
            {
                "value": point.value,
                "stable": point.is_stable,
                "stays": seen.stays,
                "distance": seen.distance,
            }
        )
        what = "stable" if point.is_stable else "unstable"
        typer.echo(
            f"{point.value:.5g} {result.unit}, {what}: {'stays' if seen.stays else 'leaves'}, "
            f"{seen.distance:.2g} of the orbit away after {seen.turns} turns"
        )
    return rows


def _range(text: str, option: str) -> tuple[str, float, float]:
    name, equals, ends = (part.strip() for part in text.partition("="))
    try:
        low, high = (float(end) for end in ends.split(":"))
    except ValueError:
        equals = ""
    if not equals:
        raise InputError(f"{option} {text}: must be NAME=FROM:TO")
    return name, low, high


def _pairs(option: str, texts: list[str] | None) -> dict[str, float]:
    result = {}
    for text in texts or []:
        name, equals, value = (part.strip() for part in text.partition("="))
        try:
            result[name] = float(value)
        except ValueError:
            equals = ""
        if not equals:
            raise InputError(f"{option} {text}: must be NAME=NUMBER")
    return result
