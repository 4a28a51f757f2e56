"""`bearings`: paper B's impact option on a rotor in hard stops."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor

from papers.integrators.members import MODERATE_DISSIPATION
from rotor_fmu.cells import markdown_table
from rotor_fmu.errors import writable_folder
from rotor_fmu.files import write_text

from .cases import IMPACTS, ImpactCase, carried_out, finish
from .impact.journals import JournalRun, RunDown, run_journals
from .result_table import Column, ResultTable

COLUMNS = (
    Column("label", "scheme"),
    Column("eta_v", "eta_v\n[s]", "g"),
    Column("dt", "dt [s]", ".3g"),
    Column("x_peak", "X [µm]", ".1f"),
    Column("error", "RMS error\n[µm]", ".2f"),
    Column("increments", "incre-\nments", "d"),
    Column("cutbacks", "cut-\nbacks", "d"),
    Column("t_end", "until\n[s]", ".3f"),
    Column("impacts", "impacts", "d", False),
    Column("crossings", "wall to wall", "d", False),
    Column("wall_time", "time [s]", ".2f", False),
    Column("status", "status", "", False),
)
_FINER = 8  # of the shortest increment asked for: the run that the others are compared with


@dataclass(frozen=True)
class Trial:
    """A run that is to be made: the integrator, the rotor and its run-down, the increment [s]."""

    case: ImpactCase
    run_down: RunDown
    dt: float


def present(
    chosen: Sequence[ImpactCase],
    steps: Sequence[float],
    rotor: Rotor,
    speed: tuple[float, float],
    stop: float,
    cap: int,
    out: Path,
) -> dict[str, Any]:
    """Run every scheme with every impact option, with and without the shaft's damping.

    speed: at the start [rad/s] and its rate [rad/s2]. Raises `ImpactError` for a rotor that cannot
    be, before anything is written.
    """
    shafts = [rotor] if rotor.eta_v == 0 else [rotor, replace(rotor, eta_v=0.0)]
    downs = [RunDown(shaft, *speed) for shaft in shafts]
    fine = min(steps) / _FINER
    reference = ImpactCase("moderate-dissipation", MODERATE_DISSIPATION, "no")
    trials = [Trial(reference, down, fine) for down in downs]
    trials += [
        Trial(replace(case, impact=impact), down, dt)
        for down in downs
        for case in chosen
        for dt in steps
        for impact in IMPACTS
    ]
    writable_folder(out)
    jobs = [
        (
            f"{t.case.label}, dt = {t.dt:g} s",
            stop,
            lambda progress, t=t: run_journals(
                t.run_down,
                t.case.scheme,
                t.dt,
                t.case.impact,
                stop,
                max(cap, 2 * round(stop / t.dt)) if t.dt == fine else cap,
                progress,
            ),
        )
        for t in trials
    ]
    results = carried_out("bearings", jobs)
    right = {t.run_down: run for t, (run, _) in zip(trials, results, strict=True) if t.dt == fine}
    rows = [
        _row(trial, run, right[trial.run_down], wall)
        for trial, (run, wall) in zip(trials, results, strict=True)
    ]
    title = f"Rotor in hard stops, {speed[0]:g} rad/s and {speed[1]:g} rad/s2, {stop:g} s"
    report = ResultTable(COLUMNS, rows, title)
    report.write(out / "bearings.csv", out / "bearings.md")
    write_text(_outcomes(trials, rows, fine, stop), out / "outcomes.md")
    return finish([report], chosen, [], out)


def _row(trial: Trial, result: JournalRun, right: JournalRun, wall: float) -> dict[str, Any]:
    row = {"label": trial.case.label, "eta_v": trial.run_down.rotor.eta_v, "dt": trial.dt}
    row |= {"increments": result.run.increments, "cutbacks": result.run.cutbacks}
    row |= {"t_end": float(result.t[-1]), "impacts": result.impacts, "crossings": result.crossings}
    if result.run.is_done:
        row["x_peak"] = 1e6 * float(np.abs(result.disc[:, 0]).max())
        exact = np.stack([np.interp(result.t, right.t, axis) for axis in right.disc.T], axis=1)
        error = ((result.disc - exact) ** 2).sum(axis=1)
        row["error"] = 1e6 * float(np.sqrt(error.mean()))
    return row | {"wall_time": wall, "status": result.run.status}


def _outcomes(trials: Sequence[Trial], rows: Sequence[Mapping], fine: float, stop: float) -> str:
    """Scheme and increment against impact option and shaft, as Markdown: who arrives, and how
    well."""
    cells: dict[tuple[str, str], str] = {}
    lines: dict[str, None] = {}
    columns: dict[str, None] = {}
    for trial, row in zip(trials, rows, strict=True):
        if trial.dt == fine:
            continue
        name = f"{trial.case.name}, {1e3 * trial.dt:g} ms"
        shaft = "damped" if trial.run_down.rotor.eta_v else "undamped"
        column = f"{shaft}: {trial.case.impact}"
        lines[name] = columns[column] = None
        if row["status"] == "done":
            more = row["increments"] * trial.dt / stop
            work = f", x {more:.1f}" if more > 1.01 else ""
            cells[name, column] = f"{row['error']:.3g} µm{work}"
        else:
            outcome = "stalled" if row["status"].startswith("gave up") else "diverged"
            cells[name, column] = f"{outcome}, {row['t_end']:.3f} s"
    table = [[name, *(cells.get((name, column), "-") for column in columns)] for name in lines]
    return markdown_table(["", *columns], table) + "\n"
