"""`rotor-fmu study`: many runs of a machine, their rows, and the evaluation."""

from __future__ import annotations

import math
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import Progress as Bar
from rich.progress import TextColumn
from rich.table import Table

from ..errors import InputError, optional, writable_folder
from ..output_options import with_output_options
from ..status import FAILED
from ..studies.executors import ExecutorConfig, engine
from ..studies.machine.runs import MachineRuns
from ..studies.reading import read_study
from ..studies.runner import Progress, run_study
from ..studies.study import Study

_LINE_EVERY = 10.0  # lines of progress where there is no terminal [s]
_errors = Console(stderr=True)


@with_output_options
def study(
    file: Annotated[Path, typer.Argument(metavar="STUDY.toml", help="What to run and keep.")],
    out: Annotated[Path, typer.Option(help="Folder of the study; one that is begun goes on.")],
    jobs: Annotated[
        int | None, typer.Option(help="Processes. [default: one a processor]", min=1)
    ] = None,
    scheduler: Annotated[
        str, typer.Option(help="Address of a Dask scheduler that shares the work out.")
    ] = "",
    cluster: Annotated[
        str, typer.Option(help="local:N, a Dask cluster of N workers on this machine.")
    ] = "",
    is_quick: Annotated[
        bool, typer.Option("--quick", help="With the study's table [quick]: a small one.")
    ] = False,
    is_analysed: Annotated[
        bool, typer.Option("--analyse", help="Quantiles, limits, Sobol or Morris indices.")
    ] = False,
    select: Annotated[
        str, typer.Option(help="Run one again with all its signals: its id, or its number.")
    ] = "",
) -> dict[str, Any]:
    """Make many runs of a machine, store one row for each, and evaluate them.

    A call that was stopped, for whatever reason, continues where it was; finished runs are not
    repeated.
    """
    _need_extra()
    definition = read_study(file, is_quick=is_quick)
    where = _where(jobs, scheduler, cluster)
    if select:
        return _select(definition, select, out)
    with _progress_bar(definition) as report:
        try:
            progress = run_study(definition, out, partial(engine, where), report)
        except KeyboardInterrupt:
            say = f"{definition.name}: its rows are kept; the same call goes on from there"
            print(say, file=sys.stderr, flush=True)
            raise
    figures = _say_result(definition, out, progress)
    if is_analysed:
        figures["analysis"] = _analyse(out)
    return figures


def _need_extra() -> None:
    for module in ("filelock", "pyarrow", "SALib", "xarray"):
        optional(module, "study", "study")


def _where(jobs: int | None, scheduler: str, cluster: str) -> ExecutorConfig:
    if sum(map(bool, (jobs, scheduler, cluster))) > 1:
        raise InputError("--jobs, --scheduler, --cluster: only one of them")
    if not cluster:
        return ExecutorConfig(jobs or os.cpu_count() or 1, scheduler)
    kind, _, count = cluster.partition(":")
    if kind != "local" or not count.isdecimal() or not int(count):
        raise InputError(f"--cluster {cluster}: must be local:N, N the number of workers")
    return ExecutorConfig(cluster=int(count))


class _RunRate:
    """Runs a second, from the first rows on: what comes before is compiling."""

    def __init__(self) -> None:
        self._begun, self._first = math.nan, 0

    def sentence(self, progress: Progress) -> str:
        """How far a study is, with rate and time left."""
        now = time.perf_counter()
        if progress.now and math.isnan(self._begun):
            self._begun, self._first = now, progress.now
        done = progress.before + progress.now
        parts = [f"{done} of {progress.runs} runs"]
        if progress.now > self._first:
            rate = (progress.now - self._first) / (now - self._begun)
            parts.append(f"{rate:.3g} a second")
            if done < progress.runs:
                parts.append(f"{_duration((progress.runs - done) / rate)} left")
        if progress.failed:
            parts.append(f"{progress.failed} failed")
        return ", ".join(parts)


@contextmanager
def _progress_bar(definition: Study) -> Iterator[Callable[[Progress], None]]:
    """Progress with rate and time left: a bar on a terminal, a line now and then elsewhere."""
    rate, last = _RunRate(), -math.inf
    if _errors.is_terminal:
        columns = (*Bar.get_default_columns()[:-1], TextColumn("{task.fields[speed]}"))
        with Bar(*columns, console=_errors, transient=True) as bar:
            task = bar.add_task(definition.name, total=len(definition.design), speed="")

            def update(progress: Progress) -> None:
                done = progress.before + progress.now
                bar.update(task, completed=done, speed=rate.sentence(progress))

            yield update
        return

    def line(progress: Progress) -> None:
        nonlocal last
        now, sentence = time.perf_counter(), rate.sentence(progress)
        is_end = progress.before + progress.now == progress.runs
        if now - last >= _LINE_EVERY or is_end:
            last = now
            print(f"{definition.name}: {sentence}", file=sys.stderr, flush=True)

    yield line


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _say_result(definition: Study, out: Path, progress: Progress) -> dict[str, Any]:
    from ..studies.analysis import worst
    from ..studies.dataset import open_dataset

    data = open_dataset(out)
    states = data.status.values.astype(str)
    counts: dict[str, int] = {}
    for status in states:
        kind = "failed" if status.startswith(FAILED) else status
        counts[kind] = counts.get(kind, 0) + 1
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
        typer.echo(f"the largest of {named.name} [{named.unit}], what failed first:")
        figures["worst_of"] = named.name
        figures["worst"] = worst(data, named.name)
        _print_table(figures["worst"])
    typer.echo(f"written to {out}")
    return figures


def _print_table(rows: list[dict[str, Any]]) -> None:
    if not rows:
        return
    table = Table(box=None)
    for key in rows[0]:
        table.add_column(key, overflow="fold", no_wrap=key != "status")
    for row in rows:
        cells = (f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values())
        table.add_row(*cells)
    Console(width=max(Console().width, 120), highlight=False).print(table)


def _analyse(out: Path) -> dict[str, Any]:
    from ..runs.job import write_json
    from ..studies.analysis import analyse

    report = analyse(out)
    write_json(report, out / "analysis.json")
    rows = []
    for name, result in report["columns"].items():
        if result["count"]:
            row = {"column": name, **result}
            rows.append(row | row.pop("quantiles", {}))
    typer.echo("columns:")
    _print_table(rows)
    for name, result in report["limits"].items():
        if result["count"]:
            typer.echo(f"{name} > {result['limit']:g}: {_counted(result)}")
    for sentence in report["says"]:
        typer.echo(sentence)
    for name, result in report.get("sensitivity", {}).items():
        if result:
            typer.echo(f"{name}, indices from {result['blocks']} of {result['of']} blocks:")
            _print_table([{"parameter": axis, **row} for axis, row in result["indices"].items()])
        else:
            typer.echo(f"{name}: no indices: fewer than two whole blocks, or it does not vary")
    typer.echo(f"written to {out / 'analysis.json'}")
    return report


def _counted(result: dict[str, Any]) -> str:
    """How many runs pass a limit, and the share."""
    counted = f"{result['above']} of {result['count']} runs"
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
    """Make one run again with all its signals, in a folder of its own."""
    from ..runs.job import write_json

    model = definition.model
    if not isinstance(model, MachineRuns):
        raise InputError("--select: only of a machine's runs")
    number = _number_of(definition, select)
    values = definition.design.settings(definition.design.point(number))
    run_id = definition.row_id(values)
    recording = model.record(values)
    folder = writable_folder(out / "runs" / run_id)
    recording.save(folder / "recording.npz")
    about = {"run": number, "id": run_id, "status": recording.about["status"], "values": values}
    about["messages"] = recording.about["messages"]
    write_json(about, folder / "summary.json")
    typer.echo(f"run {number}, {run_id}: {recording.about['status']}")
    typer.echo(f"written to {folder}")
    return about | {"out": str(folder)}


def _number_of(definition: Study, select: str) -> int:
    design = definition.design
    if select.isdecimal() and int(select) < len(design):
        return int(select)
    for number in range(len(design)):
        if definition.row_id(design.settings(design.point(number))) == select:
            return number
    raise InputError(
        f"--select {select}: no run of this study has that id; numbers go to {len(design) - 1}"
    )
