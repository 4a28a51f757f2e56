"""`python -m papers.ishikawa_koguchi bars`: its runs, table, pictures and status logs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rotor_fmu.errors import writable_folder
from rotor_fmu.files import write_text
from rotor_fmu.plotting.figure_style import save

from . import impact_plots as pictures
from .cases import FIGURE_8_OPENING, PAPER_BARS, ImpactCase, carried_out, console, finish
from .impact.bars import WINDOWS, Bars, BarsRun, build, run_bars
from .impact.stepping.state import Line
from .result_table import Column, ResultTable

COLUMNS = (
    Column("label", "scheme"),
    Column("opening", "opening [m]", "g", False),
    Column("dt", "dt [s]", ".0e"),
    Column("rms", "RMS\nerror", ".3f"),
    Column("rms_plateau", "in the\nplateau", ".2g"),
    Column("rms_released", "after\nrelease", ".3f"),
    Column("mean_released", "mean after release [m/s]", "+.4f", False),
    Column("energy_change", "change of\nenergy", "+.4f"),
    Column("increments", "incre-\nments", "d"),
    Column("cutbacks", "cut-\nbacks", "d"),
    Column("wall_time", "time [s]", ".2f", False),
    Column("status", "status", "", False),
)
_FIGURE = {name: number for number, name in enumerate(PAPER_BARS, 3)}


def present(
    chosen: Sequence[ImpactCase],
    steps: Sequence[float],
    openings: Sequence[float],
    options: Mapping[str, Any],
    stop: float,
    wants_figure_8: bool,
    out: Path,
) -> dict[str, Any]:
    """Run every case at every step and opening; write, print and return what came out.

    Raises `ImpactError` for bars that cannot be, before anything is written.
    """
    plan = [(c, Bars(opening=g, **options), dt) for g in openings for c in chosen for dt in steps]
    if wants_figure_8:
        timed = [c for c in chosen if c.impact == "average-time"]
        plan += [(c, Bars(opening=FIGURE_8_OPENING, **options), min(steps)) for c in timed]
    build(plan[0][1])  # refuses bars that cannot be before anything is written
    writable_folder(out)
    jobs = [
        (
            f"{case.label}, dt = {dt:g} s",
            stop,
            lambda progress, case=case, bars=bars, dt=dt: run_bars(
                bars, case.scheme, dt, case.impact, stop, progress=progress
            ),
        )
        for case, bars, dt in plan
    ]
    results = carried_out("bars", jobs)
    runs = [(case, dt, run) for (case, _, dt), (run, _) in zip(plan, results, strict=True)]
    rows = [_row(*result, wall) for result, (_, wall) in zip(runs, results, strict=True)]
    ResultTable(COLUMNS, rows).write(out / "bars.csv", out / "bars.md")
    reports = [
        ResultTable(
            COLUMNS,
            [row for row in rows if row["opening"] == opening],
            f"Velocity of the left bar's end against the wave solution, opening {opening:g} m",
        )
        for opening in openings
    ]
    for opening in openings:
        _write_pictures([r for r in runs if r[2].bars.opening == opening], opening, out)
    _write_logs(runs, wants_figure_8, out)
    failures = [
        f"{case.label}, dt = {dt:g} s: {run.run.status}"
        for case, dt, run in runs
        if not run.run.is_done
    ]
    return finish(reports, chosen, failures, out)


def _row(case: ImpactCase, dt: float, result: BarsRun, wall: float) -> dict[str, Any]:
    row: dict[str, Any] = {"label": case.label, "opening": result.bars.opening, "dt": dt}
    row |= {"increments": result.run.increments, "cutbacks": result.run.cutbacks}
    row |= {"energy_change": result.energy_change, "wall_time": wall, "status": result.run.status}
    if result.is_complete:
        rms = [result.rms_error(window) for window in WINDOWS]
        row |= dict(zip(("rms", "rms_plateau", "rms_released"), rms, strict=True))
        row["mean_released"] = result.mean_after_release
    return row


def _write_pictures(
    runs: Sequence[tuple[ImpactCase, float, BarsRun]], opening: float, out: Path
) -> None:
    suffix = "" if opening == runs[0][2].bars.opening == 0.01 else f"_opening_{opening:g}"
    by_case: dict[str, list[tuple[ImpactCase, float, BarsRun]]] = {}
    for case, dt, run in runs:
        by_case.setdefault(case.label, []).append((case, dt, run))
    for result in by_case.values():
        case = result[0][0]
        number = _FIGURE.get(case.name)
        is_papers = number and case.impact == ("average-time" if number == 7 else "no")
        caption = f"Paper B, Figure {number}: {case.label}" if is_papers else case.label
        name = f"figure_{number}" if is_papers else f"tip_velocity_{case.slug}"
        figure = pictures.tip_velocity([(dt, run) for _, dt, run in result], caption)
        save(figure, out / f"{name}{suffix}.png")
    finest = min(dt for _, dt, _ in runs)
    compared = {case.label: run for case, dt, run in runs if dt == finest}
    save(pictures.bars_energy(compared, finest), out / f"energy{suffix}.png")
    save(pictures.bars_momentum(compared, finest), out / f"momentum{suffix}.png")


def _write_logs(
    runs: Sequence[tuple[ImpactCase, float, BarsRun]], wants_figure_8: bool, out: Path
) -> None:
    """The status log of each run that can cut back; Figure 8's lines of it to the screen."""
    for case, dt, result in runs:
        if case.impact != "average-time":
            continue
        name = f"status_{case.slug}_{result.bars.opening:g}_{dt:g}.txt"
        text = "\n".join(map(str, result.run.log)) + "\n"
        write_text(text, out / name)
        if wants_figure_8 and result.bars.opening == FIGURE_8_OPENING:
            excerpt = "\n".join(map(str, around_cutback(result.run.log)))
            write_text(excerpt + "\n", out / "figure_8_status.txt")
            console.print(
                f"Paper B, Figure 8: {case.name}, opening {FIGURE_8_OPENING:g} m\n{excerpt}"
            )


def around_cutback(log: Sequence[Line]) -> Sequence[Line]:
    """Three lines before the first cutback, and seven from it on."""
    at = next((k for k, line in enumerate(log) if line.is_cut_back), 3)
    return log[max(at - 3, 0) : at + 7]
