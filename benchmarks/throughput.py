"""Runs a second of a study: `python -m benchmarks.throughput`.

The rig's run-down at the tolerance 1e-2 over clearances, one after another in a bare loop, then as
a study in one process, in as many as there are processors, and through Dask. Rates are counted from
the first rows on, without start and compiling; CPU time is all that the processes took, start
included, and hangs less on what else the machine does.
"""

import os
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Annotated, NamedTuple

import typer
from rich.console import Console

from rotor_fmu import studies
from rotor_fmu.errors import run, writable_folder
from rotor_fmu.files import write_text
from rotor_fmu.machine_studies.machine_runs import MachineRuns
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.output_options import write_json
from rotor_fmu.studies.executors import ExecutorConfig, engine
from rotor_fmu.studies.runner import Progress, run_study
from rotor_fmu.studies.study import Study

from .report import table
from .store import machine_name

STUDY = """
[run]
kind = "run-down"
[set]
"solver.tolerance" = 1e-2
[vary]
clearance = { names = "bearing[*].clearance", grid = { from = 30e-6, to = 70e-6, count = COUNT } }
[keep]
X = { peak = "disc[3].x_amp", after = 2 }
Y = { peak = "disc[3].y_amp", after = 2 }
"""
LOOP = "a bare loop"


class Measured(NamedTuple):
    """Runs a second, and CPU time a run in the processes that made them [s]."""

    rate: float
    cpu: float


app = typer.Typer(add_completion=False)
_console = Console(stderr=True)


@app.command()
def main(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = Path("out/throughput"),
    runs: Annotated[int, typer.Option(min=10, help="Run-downs of each engine.")] = 1000,
) -> None:
    """Measure run-downs a second, alone, in processes and through Dask."""
    writable_folder(out)
    cores = os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        study = study_of(folder, runs)
        few = study_of(folder, max(10, runs // 10))
        result, ready = {LOOP: alone(few)}, readied(few)
        _say(LOOP, result[LOOP])
        engines = {
            "one process": ExecutorConfig(jobs=1),
            f"{cores} processes": ExecutorConfig(jobs=cores),
            f"Dask, {cores} workers": ExecutorConfig(cluster=cores),
        }
        for engine_name, where in engines.items():
            result[engine_name] = measured(study, folder / engine_name, where)
            _say(engine_name, result[engine_name])
        rows = [studies.open(folder / engine_name) for engine_name in engines]
        are_equal = all(other.identical(rows[0]) for other in rows[1:])
    page = page_of(result, cores, runs, are_equal, ready)
    described = {engine_name: one._asdict() for engine_name, one in result.items()}
    write_json(
        {"measured": described, "runs": runs, "equal": are_equal, "ready_s": ready},
        out / "throughput.json",
    )
    write_text(page, out / "throughput.md")
    typer.echo(page)


def _say(name: str, result: Measured) -> None:
    _console.print(f"{name}: {result.rate:.3g} runs a second, {result.cpu:.3g} s of CPU a run")


def study_of(folder: Path, runs: int) -> Study:
    """The study of so many run-downs."""
    path = folder / "study.toml"
    path.write_text(STUDY.replace("COUNT", str(runs)), encoding="utf-8")
    return read_study(path)


def alone(study: Study) -> Measured:
    """A loop in this process, warmed."""
    study.model.warm()
    values = [study.design.values(i) for i in range(len(study.design))]
    begun, cpu = time.perf_counter(), time.process_time()
    for point in values:
        study.model.run(point)
    n = len(values)
    return Measured(n / (time.perf_counter() - begun), (time.process_time() - cpu) / n)


def readied(study: Study) -> float:
    """CPU time of making a machine ready for its run: assembly, rest, search for whirls [s]."""
    assert isinstance(study.model, MachineRuns)
    values = [study.design.values(i) for i in range(len(study.design))]
    begun = time.process_time()
    for point in values:
        study.model._prepared(point, [], ())
    return (time.process_time() - begun) / len(values)


def measured(study: Study, folder: Path, where: ExecutorConfig) -> Measured:
    """A study in an engine, its rate from the first rows to the last."""
    before = os.times()
    seen: list[tuple[float, int]] = []

    def report(progress: Progress) -> None:
        seen.append((time.perf_counter(), progress.now))

    run_study(study, folder, partial(engine, where), report)
    (begun, first), (ended, last) = next(x for x in seen if x[1]), seen[-1]
    after = os.times()
    cpu = after.children_user + after.children_system
    cpu -= before.children_user + before.children_system
    return Measured((last - first) / (ended - begun), cpu / last)


def page_of(
    result: dict[str, Measured], cores: int, runs: int, are_equal: bool, ready: float
) -> str:
    """The results as a page of Markdown."""
    one = result["one process"].rate
    lines = []
    for name, (rate, cpu) in result.items():
        used = 1 if name in (LOOP, "one process") else cores
        lines.append((name, f"{rate:.2f}", f"{rate / used:.2f}", f"{rate / one:.2f}", f"{cpu:.3f}"))
    head = ("engine", "runs a second", "and core", "to one process", "CPU a run [s]")
    rows = "are" if are_equal else "are NOT"
    return (
        f"# Run-downs a second\n\n{machine_name()}; {runs} of the rig, tolerance 1e-2.\n\n"
        f"{table(head, lines)}\n\nThe rows of all engines {rows} equal bit for bit. Of a run, "
        f"{1e3 * ready:.1f} ms are making the machine ready.\n"
    )


if __name__ == "__main__":
    run(app)
