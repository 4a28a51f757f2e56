"""`rotor-fmu plot`, `report` and `page`."""

from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from ..display import choose
from ..errors import InputError, check_one_of, writable_folder
from ..files import write_text
from ..output_options import with_output_options, write_json
from ..runs import PLOTS, check_options
from ..units import in_si
from .nodes import Clearances, CrossCouplings, Stages, check_nodes, clearances_of, cross_couplings
from .shared import Page, RotorFile, Units, check_page, one_of, places, warned
from .show_result import machine_in_units
from .speeds import OperatingRange, Rated, operating_range

# What draws is imported where it is asked for: bad input should not wait for it.


@with_output_options
def plot(
    kind: Annotated[
        str,
        typer.Argument(
            help=f"Kind of plot, one of {', '.join(PLOTS)}.", autocompletion=one_of(PLOTS)
        ),
    ],
    run: Annotated[Path, typer.Argument()],
    place: Annotated[str | None, typer.Option(autocompletion=places)] = None,
    speed: str | None = None,
    is_pp: Annotated[bool, typer.Option("--pp")] = False,
    units: Units = None,
    out: Path | None = None,
) -> dict[str, Any]:
    """Draw a recorded run in one of the usual plots of vibration engineering.

    run: Folder of a run, which holds its recording.npz.
    place: Part to plot, such as disc[2]; default: the largest motion or force.
    speed: Speed of an orbit or a spectrum, such as 1800rpm or 30Hz, or in rad/s; default: the 1x
        peak after the start-up.
    is_pp: Show amplitudes peak-to-peak instead of 0-p.
    out: Folder for the picture; default: the run's.
    """
    check_one_of(f"KIND {kind}", kind, PLOTS)
    check_options(kind, place=place, speed=speed, is_pp=is_pp)
    at = None if speed is None else in_si("--speed", speed, "rad/s")
    if at == 0:
        raise InputError(f"--speed {speed}: must not be 0")
    from ..plotting.figure_style import save
    from ..run_pictures.signal_plots import KINDS
    from ..run_pictures.view import View
    from ..saved_results import read_run
    from ..vibration import TooFewTurns

    recorded = read_run(run)
    choose(units, recorded.shown_units)
    folder = writable_folder(out or (run if run.is_dir() else run.parent))
    view = View(recorded, place, at, is_pp)
    try:
        figure = KINDS[kind](view)
    except TooFewTurns as error:
        raise InputError(f"{run}: {error}") from error
    picture = save(figure, folder / f"{kind}.png")
    typer.echo(picture)
    return {"out": picture}


@with_output_options
def report(
    paths: Annotated[list[Path] | None, typer.Argument(metavar="[RUN_OR_STUDY [RUN]]")] = None,
    rotor: Path | None = None,
    operating: OperatingRange = None,
    rated: Rated = None,
    node: list[int] | None = None,
    mode: int | None = None,
    clearance: Clearances = None,
    stage: Stages = None,
    cross_coupling: CrossCouplings = None,
    is_live: Annotated[bool, typer.Option("--live")] = False,
    units: Units = None,
    out: Page = Path("report.html"),
) -> dict[str, Any]:
    """Write the report page of a run, of two runs compared with each other, of a study, or, with
    --rotor, of a machine: statics, critical speeds, modes, response, stability, contact.

    The report of a machine checks it by API 617 and 684 in the operating range of --range or
    --rated, and continues into contact: where its response closes a clearance it is run up and down
    with its contacts.

    paths: Folder of a run, or of two runs to compare, or of a study.
    rotor: Machine file; its report is written instead of that of a run.
    node: With --rotor: node of a probe, from 1; repeatable; default: the nodes with the largest
        orbits.
    mode: With --rotor: place the unbalances of API 617 (4W/N) for this mode, from 1; default: the
        machine's own unbalances and bows, or mode 1 if it has none.
    is_live: Write the page on which the run's machine runs, with the run's settings.
    """
    of_machine = {
        "--range": operating,
        "--rated": rated,
        "--node": node,
        "--mode": mode,
        "--clearance": clearance,
        "--stage": stage,
        "--cross-coupling": cross_coupling,
    }
    if rotor is None:
        for option, value in of_machine.items():
            if value is not None and value != []:
                raise InputError(f"{option}: is of the report of a machine, which needs --rotor")
        return _report_of_runs(paths or [], is_live, units, out)
    if is_live:
        raise InputError("--live and --rotor: `rotor-fmu page` writes the page of a machine")
    if paths:
        raise InputError(f"{paths[0]} and --rotor: the report is of a run or of a machine")
    machine = machine_in_units(rotor, units)
    ends = operating_range(operating, rated, machine)
    if ends is None:
        raise InputError(
            "--range: must be given, such as --range 9000:11000rpm, or --rated, or the "
            "machine's [operation]"
        )
    gaps = clearances_of(clearance)
    check_nodes(machine, "--node", node or ())
    check_nodes(machine, "--clearance", gaps)
    couplings = cross_couplings(machine, ends[1], stage, cross_coupling)
    from ..machine_report.report_page import ReportOptions, machine_report

    options = ReportOptions(*ends, node, mode, gaps, couplings)
    check_page(out)
    result = machine_report(machine, options, partial(typer.echo, err=True))
    write_text(result.html, out)
    write_json(dict(result.numbers), out.with_suffix(".json"))
    for conclusion in result.conclusions:
        typer.echo(conclusion.text)
    typer.echo(out)
    return {"out": out, **result.numbers}


def _report_of_runs(
    paths: list[Path], is_live: bool, units: str | None, out: Path
) -> dict[str, Any]:
    """Write the page of one or two runs, of a study, or the one on which a run's machine runs."""
    is_study = _check_runs(paths, is_live)
    check_page(out)
    if is_live:
        page = _live_page(paths[0], units)
    elif is_study:
        page = _study_page(paths[0], units, out.parent)
    else:
        page = _runs_page(paths, units)
    write_text(page, out)
    typer.echo(out)
    return {"out": out}


def _check_runs(paths: list[Path], is_live: bool) -> bool:
    """Raise `InputError` for folders that no page can be of; return whether it is of a study."""
    if not paths:
        raise InputError("RUN_OR_STUDY: must be given, or a machine by --rotor")
    from ..saved_results import is_study

    for path in paths:
        if not path.exists():
            raise InputError(f"{path}: is not there; give the folder of a run or of a study")
    studies = [path for path in paths if is_study(path)]
    if studies and len(paths) > 1:
        raise InputError(f"{studies[0]}: is a study, which has a page of its own; give it alone")
    if len(paths) > 2:
        raise InputError(f"{len(paths)} runs: a page shows one or two")
    if is_live and (studies or len(paths) > 1):
        raise InputError("--live: a page on which a machine runs is of one run")
    return bool(studies)


def _live_page(path: Path, units: str | None) -> str:
    from ..live.controls import machine_of_run, settings_of_run
    from ..live.live_page import solver_page
    from ..saved_results import read_run

    run = read_run(path)
    recorded = machine_of_run(run)
    choose(units, recorded.rotor.units)
    return solver_page(recorded, settings_of_run(run, recorded))


def _study_page(path: Path, units: str | None, beside: Path) -> str:
    from ..report.study_page import pages_of_runs, study_page
    from ..saved_results import read_study, rows_of_quantiles

    about, rows = read_study(path)
    choose(units, about.get("units", ""))
    drawn = rows_of_quantiles(about, rows)
    return study_page(about, rows, pages_of_runs(path, beside), drawn)


def _runs_page(paths: list[Path], units: str | None) -> str:
    from ..report.run_page import runs_page
    from ..saved_results import read_run, read_summary, with_unique_names

    runs = with_unique_names([read_run(path) for path in paths], paths)
    choose(units, runs[0].shown_units)
    return runs_page(runs, [read_summary(path) for path in paths])


@with_output_options
def page(
    rotor: RotorFile = None, units: Units = None, out: Page = Path("page.html")
) -> dict[str, Any]:
    """Write a page on which the machine runs: its solver, sliders and pictures in one file, which
    needs no network."""
    from ..fmi.packing.machine_files import machine_of
    from ..live.live_page import solver_page
    from ..machine_file.loading import load_rotor

    toml, machine = load_rotor(rotor)
    choose(units, machine.units, rotor or "")
    check_page(out)
    warnings = warned(machine)
    write_text(solver_page(machine_of(toml)), out)
    typer.echo(out)
    return {"out": out, "bytes": out.stat().st_size, "warnings": warnings}
