"""`python -m benchmarks`: all measurements, resumed where they were stopped, then the report."""

import os

# before numpy: one thread, so that CPU time is time
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"

import datetime  # noqa: E402
import tempfile  # noqa: E402
from pathlib import Path  # noqa: E402
from typing import Annotated  # noqa: E402

import typer  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.progress import Progress  # noqa: E402

from rotor_fmu.errors import run, writable_folder  # noqa: E402
from rotor_fmu.fmi.packing.machine_files import machine_of  # noqa: E402
from rotor_fmu.fmi.packing.python_fmu import build  # noqa: E402

from .dissipation import dissipation  # noqa: E402
from .growth import growth  # noqa: E402
from .hosting import hosting  # noqa: E402
from .processes import processes  # noqa: E402
from .race import race  # noqa: E402
from .report import write_report  # noqa: E402
from .scatter import scatter  # noqa: E402
from .starting import starting  # noqa: E402
from .step_cost import step_cost  # noqa: E402
from .store import Store  # noqa: E402

app = typer.Typer(add_completion=False)
_console = Console(stderr=True)
_RESULTS = Path(__file__).parent / "results"


@app.command()
def main(
    out: Annotated[
        Path | None, typer.Option(help="Folder of the results. [default: benchmarks/results/DATE]")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="4 s of the run-down, once.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Measure everything anew.")] = False,
    repetitions: Annotated[int, typer.Option(min=1, help="Runs of which medians are taken.")] = 3,
) -> None:
    """Measure this project and its peers on the rig's run-down; write table and pictures."""
    name = datetime.date.today().isoformat() + ("-quick" if quick else "")
    folder = writable_folder(out or _RESULTS / name)
    times = 1 if quick else repetitions
    store = Store(folder, "quick" if quick else "full", times, fresh)
    if store.is_resumed:
        _console.print(f"resumed from {store.path}", highlight=False)
    with Progress(console=_console, transient=True) as bar:
        task = bar.add_task("", total=1.0)

        def report(what: str, share: float) -> None:
            bar.update(task, description=what, completed=share)

        step_cost(store, times, report)
        starting(store, times, report)
        growth(store, times, quick, report)
        race(store, times, quick, report)
        dissipation(store, quick, report)
        scatter(store, quick, report)
        with tempfile.TemporaryDirectory() as temporary:
            fmu = build(Path(temporary), machine_of())
            hosting(store, fmu, times, quick, report)
            processes(store, fmu, times, quick, report)
    for path in write_report(store, folder):
        _console.print(path, highlight=False, soft_wrap=True)


if __name__ == "__main__":
    run(app)
