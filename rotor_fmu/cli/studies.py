"""`rotor-fmu study`: many runs of a machine, their rows, and the evaluation."""

import math
import os
import re
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from ..cells import cell, column_head
from ..display import choose, current
from ..errors import InputError, optional, writable_folder
from ..machine_studies.machine_runs import MachineRuns
from ..machine_studies.machine_tables import read_study
from ..machine_studies.response_runs import ResponseRuns
from ..output_options import with_output_options
from ..run_status import has_failed
from ..runs.recording import RECORDING
from ..saved_results import refuse_other
from ..screen import progress_of, text_table
from ..studies.executors import ExecutorConfig, engine
from ..studies.runner import Progress, run_study
from ..studies.study import Study
from .shared import Units

_NO_VALUES = ("count", "infinite", "quantiles")  # of a column's statistics
_WIDEST = 10_000  # characters of a table's line


@with_output_options
def study(
    file: Annotated[Path, typer.Argument(metavar="STUDY.toml")],
    out: Path,
    jobs: Annotated[int | None, typer.Option(min=1)] = None,
    scheduler: str = "",
    cluster: str = "",
    is_quick: Annotated[bool, typer.Option("--quick")] = False,
    is_analysed: Annotated[bool, typer.Option("--analyse")] = False,
    is_drawn: Annotated[bool, typer.Option("--diagram")] = False,
    select: str = "",
    units: Units = None,
) -> dict[str, Any]:
    """Make many runs of a machine, store one row for each, and evaluate them.

    A call that was stopped, for whatever reason, continues where it was; finished runs are not
    repeated.

    file: File of the study.
    out: Folder of the study; a study begun there is continued.
    jobs: Number of processes; default: one per processor.
    scheduler: Address of a Dask scheduler that distributes the runs.
    cluster: local:N starts a Dask cluster of N workers on this machine.
    is_quick: Run the small version that the study's table 'quick' describes.
    is_analysed: Compute quantiles, limits, and Sobol or Morris indices.
    is_drawn: Draw Poincare sections over the quantity that is varied, with the periodic motions
        beneath.
    select: Repeat the run of this id or number and record all its signals.
    """
    for module in ("pyarrow", "SALib", "xarray"):
        optional(module, "study", "study")
    definition = read_study(file, is_quick=is_quick)
    choose(units, definition.units)
    refuse_other(out, RECORDING)
    where = _where(jobs, scheduler, cluster)
    if is_drawn:
        from ..machine_studies.diagram import sections_of

        sections_of(definition)  # refuses a study of which there is no diagram
    if select:
        return _select(definition, select, out)
    with _progress_bar(definition) as report:
        try:
            progress = run_study(definition, out, partial(engine, where), report)
        except KeyboardInterrupt:
            say = f"{definition.name}: its rows are saved; the same call continues from there"
            print(say, file=sys.stderr, flush=True)
            raise
    figures = _say_result(definition, out, progress)
    if is_analysed:
        figures["analysis"] = _analyse(definition, out)
    if is_drawn:
        figures["diagrams"] = _draw(definition, out)
    return figures


def _where(jobs: int | None, scheduler: str, cluster: str) -> ExecutorConfig:
    if sum(map(bool, (jobs, scheduler, cluster))) > 1:
        raise InputError("--jobs, --scheduler, --cluster: only one of them")
    if not cluster:
        return ExecutorConfig(jobs or os.cpu_count() or 1, scheduler)
    kind, _, count = cluster.partition(":")
    if kind != "local" or not count.isdecimal() or not int(count):
        raise InputError(f"--cluster {cluster}: must be local:N, N the number of workers")
    return ExecutorConfig(cluster=int(count))


@contextmanager
def _progress_bar(definition: Study) -> Iterator[Callable[[Progress], None]]:
    """Show how far a study is, and at what rate; what comes before the first rows is compiling."""
    begun, first = math.nan, 0
    with progress_of(definition.name, len(definition.design), first=0.0) as update:

        def report(progress: Progress) -> None:
            nonlocal begun, first
            now, done = time.perf_counter(), progress.before + progress.now
            if progress.now and math.isnan(begun):
                begun, first = now, progress.now
            parts = [f"{done} of {progress.runs} runs"]
            if progress.now > first:
                rate = (progress.now - first) / (now - begun)
                parts.append(f"{rate:.3g} a second")
                if done < progress.runs:
                    parts.append(f"{_duration((progress.runs - done) / rate)} left")
            if progress.failed:
                parts.append(f"{progress.failed} failed")
            update(done, lambda: ", ".join(parts), done == progress.runs)

        yield report


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _say_result(definition: Study, out: Path, progress: Progress) -> dict[str, Any]:
    from ..studies.analysis import worst
    from ..studies.store import open_dataset

    data = open_dataset(out)
    states = data.status.values.astype(str)
    counts = Counter("failed" if has_failed(status) else status for status in states)
    shown = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    typer.echo(f"{definition.name}: {progress.runs} runs, {progress.now} of them now: {shown}")
    figures: dict[str, Any] = {
        "name": definition.name,
        "runs": progress.runs,
        "made_now": progress.now,
        "counts": counts,
        "worst_of": None,
        "worst": [],
        "analysis": None,
        "out": str(out),
    }
    ranked = [c for c in definition.model.columns if not c.dimension]
    if ranked:
        named = next((c for c in ranked if c.name in definition.limits), ranked[0])
        unit = current().of_si(named.unit).word
        limit = definition.limits.get(named.name)
        has_sign = limit is None and bool((data[named.name].values < 0.0).any())
        size = " in size" if has_sign else ""
        end = "smallest" if limit and limit.is_least else "largest"
        typer.echo(f"the {end} of {named.name} [{unit}]{size}, what failed first:")
        figures["worst_of"] = named.name
        figures["worst"] = worst(data, named.name, limit=limit)
        _print_table([_in_units(definition, row) for row in figures["worst"]])
    typer.echo(f"written to {out}")
    return figures


def _in_units(definition: Study, row: dict[str, Any]) -> dict[str, Any]:
    """Return a row with what is varied and what is kept in the units that are shown."""
    units = {axis.name: axis.unit for axis in definition.design.axes}
    units |= {column.name: column.unit for column in definition.model.columns}
    result = {}
    for name, value in row.items():
        shown = current().of_si(units.get(name, ""))
        in_unit = value if shown.factor == 1.0 else shown.factor * value
        result[column_head(name, shown.word)] = in_unit
    return result


def _print_table(rows: list[dict[str, Any]]) -> None:
    if not rows:
        return
    cells = [[cell(v) for v in row.values()] for row in rows]
    table = text_table("", list(rows[0]), cells, folds=["status"])
    least = Console(width=_WIDEST).measure(table).minimum  # a number is never cut off
    Console(width=max(Console().width, 120, least), highlight=False).print(table)


def _analyse(definition: Study, out: Path) -> dict[str, Any]:
    from ..output_options import write_json
    from ..studies.analysis import analyse

    report = analyse(out)
    write_json(report, out / "analysis.json")
    shown = {c.name: current().of_si(c.unit) for c in definition.model.columns}
    rows, empty = [], []
    for name, result in report["columns"].items():
        if not result["count"] and not result.get("infinite"):
            empty.append(name)
        elif result["count"]:
            factor, unit = shown[name].factor, shown[name].word
            values = result | result.get("quantiles", {})
            lengths = {k: factor * v for k, v in values.items() if k not in _NO_VALUES}
            rows.append({"column": column_head(name, unit), "count": result["count"], **lengths})
    if rows:
        typer.echo("columns:")
        _print_table(rows)
    if empty:
        typer.echo(f"no run has a value of {', '.join(empty)}")
    for name, result in report["limits"].items():
        if result["count"]:
            limit = shown[name].text(result["limit"], digits=6)
            typer.echo(f"{name} {'<' if result['is_least'] else '>'} {limit}: {_counted(result)}")
    for sentence in report["says"]:
        typer.echo(sentence)
    for name, result in report.get("sensitivity", {}).items():
        if result:
            # Sobol's indices are shares, those of Morris in the unit of the column
            is_share = definition.design.kind != "morris"
            factor, unit = (1.0, "") if is_share else (shown[name].factor, shown[name].word)
            blocks = f"{result['blocks']} of {result['of']} blocks"
            typer.echo(f"{column_head(name, unit)}, indices from {blocks}:")
            indices = result["indices"].items()
            table = [{"parameter": a} | {k: factor * v for k, v in r.items()} for a, r in indices]
            _print_table(table)
        else:
            typer.echo(f"{name}: no indices: fewer than two whole blocks, or it does not vary")
    typer.echo(f"written to {out / 'analysis.json'}")
    return report


def _draw(definition: Study, out: Path) -> list[str]:
    from ..machine_studies.diagram import diagrams
    from ..plotting.figure_style import save
    from ..studies.store import open_dataset
    from .periodic import response_progress

    drawn = []
    data = open_dataset(out)
    for name, figure in diagrams(definition, data, typer.echo, response_progress).items():
        word = re.sub(r"[/\\:]", "_", name)  # which no file's name has
        drawn.append(str(save(figure, out / f"diagram_{word}.png")))
        typer.echo(f"written to {drawn[-1]}")
    return drawn


def _counted(result: dict[str, Any]) -> str:
    counted = f"{result['beyond']} of {result['count']} runs"
    if result["failed"]:
        counted += f" and {result['failed']} that failed"
    if "share" in result:
        counted += f", {result['share']:.2%}"
    if "interval" in result:
        low, high = result["interval"]
        kind = "95 %, conservative" if result["conservative"] else "95 %"
        counted += f" ({kind}: {low:.2%} to {high:.2%})"
    return counted


def _select(definition: Study, select: str, out: Path) -> dict[str, Any]:
    """Make one run again in a folder of its own: with all its signals, of a response with its
    picture, page and numbers."""
    from ..output_options import write_json
    from ..studies.store import Store

    model = definition.model
    if not (isinstance(model, MachineRuns) and model.can_be_selected):
        raise InputError("--select: only of a machine's runs in time, and of its responses")
    number = _number_of(definition, select)
    Store(out, definition)  # refuses a folder of another study
    values = definition.design.values(number)
    run_id = definition.row_id(values)
    folder = out / "runs" / run_id
    about: dict[str, Any] = {"run": number, "id": run_id}
    if isinstance(model, ResponseRuns):
        from .periodic import write_response

        result = model.response(values)
        writable_folder(folder)
        about |= {"values": values}
        write_response(result, f"{definition.name}, run {number}", about | result.summary, folder)
        typer.echo(result.table().text())
    else:
        recording = model.record(values)
        recording.save(writable_folder(folder) / RECORDING)
        status, messages = recording.about["status"], recording.about["messages"]
        about |= {"status": status, "values": values, "messages": messages}
        write_json(about, folder / "summary.json")
        typer.echo(f"run {number}, {run_id}: {status}")
    typer.echo(f"written to {folder}")
    return about | {"out": str(folder)}


def _number_of(definition: Study, select: str) -> int:
    design = definition.design
    if select.isdecimal() and int(select) < len(design):
        return int(select)
    for number in range(len(design)):
        if definition.row_id(design.values(number)) == select:
            return number
    raise InputError(
        f"--select {select}: no run of this study has that id; numbers go to {len(design) - 1}"
    )
