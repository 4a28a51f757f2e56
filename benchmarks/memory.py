"""Memory of a long study: python -m benchmarks.memory

A study of 100 000 runs of a Jeffcott rotor, 2 ms each (5 ms of CPU: what is left are the machine's
making and the row), by `rotor-fmu study`; resident memory of the process that conducts it and of
the largest of its workers over time. Needs psutil.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Annotated, NamedTuple

import psutil
import typer

from rotor_fmu import studies
from rotor_fmu.errors import run, writable_folder
from rotor_fmu.files import write_text

from .report import table
from .store import machine_name

STUDY = """
machine = "jeffcott_rub/jeffcott.toml"
[run]
kind = "constant"
speed = 150
settle = 0
measure = 2e-3
[set]
"solver.tolerance" = 1e-2
[vary]
"contact[1].mu" = { grid = { from = 0.01, to = 0.2, count = COUNT } }
"contact[1].clearance" = { grid = { from = 0.5e-3, to = 1.5e-3, count = 100 } }
[keep]
r = { peak = "disc.r" }
"""
_EVERY = 0.5  # between two looks [s]
_LINES = 10


class Seen(NamedTuple):
    """At a time since the start [s]: resident memory of the conductor and of the largest worker
    [MB], and rows that are there [1]."""

    t: float
    conductor: float
    worker: float
    rows: int


app = typer.Typer(add_completion=False)


@app.command()
def main(
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = Path("out/memory"),
    runs: Annotated[int, typer.Option(min=100, help="Runs, in hundreds.")] = 100_000,
    jobs: Annotated[int, typer.Option(help="Workers.")] = os.cpu_count() or 1,
) -> None:
    """Measure the memory of a study over its time."""
    writable_folder(out)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = folder / "study.toml"
        file.write_text(STUDY.replace("COUNT", str(runs // 100)), encoding="utf-8")
        seen = watched(file, folder / "rows", jobs)
        rows = studies.open(folder / "rows").sizes["run"]
    page = page_of(seen, rows, jobs)
    write_text(page, out / "memory.md")
    typer.echo(page)


def watched(file: Path, folder: Path, jobs: int) -> list[Seen]:
    """Conduct a study in processes of its own and look at them until they end."""
    cli = "from rotor_fmu.cli import main; main()"
    command = [sys.executable, "-c", cli, "study", str(file), "--out", str(folder)]
    begun, seen = time.perf_counter(), []
    with subprocess.Popen([*command, "--jobs", str(jobs)], stdout=subprocess.DEVNULL) as process:
        conductor = psutil.Process(process.pid)
        while process.poll() is None:
            try:
                sizes = [p.memory_info().rss / 1e6 for p in (conductor, *conductor.children())]
            except psutil.NoSuchProcess:
                continue
            rows = _rows(folder)
            seen.append(
                Seen(time.perf_counter() - begun, sizes[0], max(sizes[1:], default=0.0), rows)
            )
            time.sleep(_EVERY)
    return seen


def _rows(folder: Path) -> int:
    """Rows that are there, but for those of a part that is merged this moment."""
    import pyarrow.parquet as pq

    count = 0
    for path in folder.glob("rows/*.parquet"):
        try:
            count += pq.read_metadata(path).num_rows
        except OSError:
            continue
    return count


def page_of(seen: list[Seen], rows: int, jobs: int) -> str:
    """The results as a page of Markdown."""
    at = [round(k * (len(seen) - 1) / _LINES) for k in range(1, _LINES + 1)]
    lines = [
        (f"{s.t:.0f}", f"{min(s.rows, rows)}", f"{s.conductor:.0f}", f"{s.worker:.0f}")
        for s in (seen[i] for i in at)
    ]
    head = ("time [s]", "rows", "conductor [MB]", "largest worker [MB]")
    most = max(s.conductor for s in seen), max(s.worker for s in seen)
    return (
        f"# Memory of a study\n\n{machine_name()}; {rows} runs in {jobs} workers.\n\n"
        f"{table(head, lines)}\n\nAt most {most[0]:.0f} MB in the conductor, {most[1]:.0f} MB in a "
        "worker.\n"
    )


if __name__ == "__main__":
    run(app)
