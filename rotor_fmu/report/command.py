"""`rotor-fmu plot` and `rotor-fmu report`."""

from __future__ import annotations

import difflib
import math
from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError, writable_folder

# What draws is imported where it is asked for: bad input should not wait for it.

_KINDS = (
    "bode", "polar", "orbit", "cascade", "poincare", "contact-angle", "contact-force", "energy",
    "spectrum", "whirl",
)  # fmt: skip


def plot(
    kind: Annotated[str, typer.Argument(help=f"One of {', '.join(_KINDS)}.")],
    run: Annotated[Path, typer.Argument(help="Folder of a run, with its recording.npz.")],
    place: Annotated[
        str | None,
        typer.Option(help="As disc[2] or bearing[1]; default: what moves, or is pressed, most."),
    ] = None,
    speed: Annotated[
        float | None, typer.Option(help="For orbit and spectrum, in Hz; default: the 1x peak.")
    ] = None,
    pp: Annotated[bool, typer.Option("--pp", help="Peak-to-peak, instead of 0-p.")] = False,
    out: Annotated[Path | None, typer.Option(help="Folder; default: the run's.")] = None,
) -> None:
    """Draw a recorded run as vibration engineers do."""
    if kind not in _KINDS:
        near = difflib.get_close_matches(kind, _KINDS, 1, 0.0)[0]
        raise InputError(f"KIND {kind}: did you mean {near}? It must be one of {', '.join(_KINDS)}")
    if speed is not None and not 0 < speed < math.inf:
        raise InputError(f"--speed {speed:g} Hz: must be > 0 and finite")
    from ..figures import save
    from ..vibration import TooFewTurns
    from .figures import KINDS, View
    from .places import read_run

    recorded = read_run(run)
    folder = writable_folder(out or (run if run.is_dir() else run.parent))
    view = View(recorded, place, None if speed is None else speed * 2 * math.pi, pp)
    try:
        figure = KINDS[kind](view)
    except TooFewTurns as error:
        raise InputError(f"{run}: {error}") from error
    typer.echo(save(figure, folder / f"{kind}.png"))
