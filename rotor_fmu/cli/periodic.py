"""`rotor-fmu response`: periodic answers over the speed or another parameter."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from ..errors import InputError, writable_folder
from ..output_options import with_output_options
from ..runs.job import load_rotor, write_json
from .shared import RotorFile
from .speeds import one_speed, speed_range

if TYPE_CHECKING:
    from ..model.periodic.branch import Solution
    from ..periodic.result import ResponseResult

_EVERY = 2.0  # seconds between two lines of progress
_CHECKED = 8  # points that are taken into time


@with_output_options
def response(
    rotor: RotorFile = None,
    speed: Annotated[
        str,
        typer.Option(
            "--speed", help="FROM:TO in rad/s, or with rpm or Hz behind; with --over one."
        ),
    ] = "50:400",
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
    """Periodic motions with contacts: the whole curve with its jumps and unstable parts."""
    at, varied = _varied(speed, over)
    machine = load_rotor(rotor)[1]
    writable_folder(out)
    from ..figure_style import save
    from ..periodic.answers import answer

    result = answer(
        machine,
        speed=at,
        over=varied,
        parameters=_pairs("--set", values),
        loads=_pairs("--load", load),
        period=period,
        harmonics=harmonics,
        share=share,
        step=step,
        seeds=seed or (),
        whirl=whirl,
        tell=_Progress(),
    )
    summary = dict(result.summary)
    if fold_over is not None:
        summary["folds"] = _folds(result, fold_over)
    if check:
        summary["check"] = _checked(result)
    save(result.figure(), out / "response.png")
    write_json(summary, out / "response.json")
    typer.echo(result.table().text())
    for note in result.notes:
        typer.echo(note)
    typer.echo(f"written to {out}")
    return summary


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


class _Progress:
    """A line on standard error every now and then."""

    def __init__(self) -> None:
        self._said = time.monotonic()
        self._count = 0
        self._console = Console(stderr=True)

    def __call__(self, label: str, point: Solution) -> None:
        self._count += 1
        if time.monotonic() - self._said > _EVERY:
            self._said = time.monotonic()
            self._console.print(
                f"{label}: {self._count} points, at {point.value:.5g}, {point.orbit.H} harmonics"
            )


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
