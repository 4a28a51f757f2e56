"""`rotor-fmu plot` and `report`."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Annotated, Any

import typer

from ..display import choose
from ..errors import InputError, writable_folder
from ..files import write_text
from ..output_options import with_output_options
from ..runs import PLOTS
from ..units import in_si
from .completion import one_of, places
from .shared import Units

# What draws is imported where it is asked for: bad input should not wait for it.


@with_output_options
def plot(
    kind: Annotated[
        str,
        typer.Argument(
            help=f"Kind of plot, one of {', '.join(PLOTS)}.", autocompletion=one_of(PLOTS)
        ),
    ],
    run: Annotated[Path, typer.Argument(help="Folder of a run, which holds its recording.npz.")],
    place: Annotated[
        str | None,
        typer.Option(
            help="Part to plot, such as disc[2]; default: the largest motion or force.",
            autocompletion=places,
        ),
    ] = None,
    speed: Annotated[
        str | None,
        typer.Option(
            help="Speed of an orbit or a spectrum, such as 1800rpm or 30Hz, or in rad/s; default: "
            "the 1x peak."
        ),
    ] = None,
    pp: Annotated[
        bool, typer.Option("--pp", help="Show amplitudes peak-to-peak instead of 0-p.")
    ] = False,
    units: Units = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the picture; default: the run's.")
    ] = None,
) -> dict[str, Any]:
    """Draw a recorded run in one of the usual plots of vibration engineering."""
    if kind not in PLOTS:
        near = difflib.get_close_matches(kind, PLOTS, 1, 0.0)[0]
        raise InputError(f"KIND {kind}: did you mean {near}? It must be one of {', '.join(PLOTS)}")
    at = None if speed is None else in_si("--speed", speed, "rad/s")
    if at == 0:
        raise InputError(f"--speed {speed}: must not be 0")
    from ..figure_style import save
    from ..plotting.reading import read_run
    from ..report.signal_plots import KINDS
    from ..report.view import View
    from ..vibration import TooFewTurns

    recorded = read_run(run)
    choose(units, recorded.rotor.units if recorded.rotor else "")
    folder = writable_folder(out or (run if run.is_dir() else run.parent))
    view = View(recorded, place, at, pp)
    try:
        figure = KINDS[kind](view)
    except TooFewTurns as error:
        raise InputError(f"{run}: {error}") from error
    picture = save(figure, folder / f"{kind}.png")
    typer.echo(picture)
    return {"out": picture}


@with_output_options
def report(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN_OR_STUDY [RUN]",
            help="Folder of a run, or of two runs to compare, or of a study.",
        ),
    ],
    units: Units = None,
    out: Annotated[Path, typer.Option(help="The page to write.")] = Path("report.html"),
) -> dict[str, Any]:
    """Write the report page of a run, of two runs compared with each other, or of a study."""
    from ..plotting.reading import (
        is_study,
        read_run,
        read_study,
        read_summary,
        rows_of_quantiles,
        told_apart,
    )

    for path in paths:
        if not path.exists():
            raise InputError(f"{path}: is not there; give the folder of a run or of a study")
    studies = [path for path in paths if is_study(path)]
    if studies and len(paths) > 1:
        raise InputError(f"{studies[0]}: is a study, which has a page of its own; give it alone")
    if len(paths) > 2:
        raise InputError(f"{len(paths)} runs: a page shows one or two")
    writable_folder(out.parent)
    if out.is_dir():
        raise InputError(f"--out {out}: is a folder; give the page's name in it")
    if studies:
        from ..plotting.selected import pages_of_runs
        from ..report.study import study_page

        about, rows = read_study(paths[0])
        drawn = rows_of_quantiles(about, rows)
        page = study_page(about, rows, pages_of_runs(paths[0], out.parent), drawn)
    else:
        from ..report.page import runs_page

        runs = [read_run(path) for path in paths]
        told_apart(runs, paths)
        choose(units, runs[0].rotor.units if runs[0].rotor else "")
        page = runs_page(runs, [read_summary(path) for path in paths])
    write_text(page, out)
    typer.echo(out)
    return {"out": out}
