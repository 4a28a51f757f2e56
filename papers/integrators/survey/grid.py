"""A grid of runs on all cores: rows kept as they finish, nothing run twice."""

import csv
import gzip
import hashlib
import io
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import MofNCompleteColumn, Progress, TimeRemainingColumn

from papers.integrators.members import Scheme
from rotor_fmu.errors import InputError
from rotor_fmu.files import unfinished

Row = dict[str, Any]  # words and numbers by their column
TABLE = "survey.csv"
# What a row says of the job, then what the job found; all that an experiment may return.
IDENTITY = ("key", "experiment", "scheme", "alpha_f", "alpha_m", "beta", "gamma", "h", "case")
FOUND = (
    "status",
    "error",  # against the converged or analytic solution, relative [1]
    "error_x",  # rotor: of the peaks, relative [1]
    "error_y",
    "plateau",  # bars: RMS error of the tip velocity while they touch [m/s]
    "released",  # bars: mean tip velocity after the release [m/s]
    "fast",  # ratchet: high-frequency content of the pawl's speed [rad/s]
    "trapped",  # rotor: share of the steps in the false state [1]
    "trapped_at",  # since when [s]
    "trapped_speed",  # from that speed of rotation [rad/s]
    "trapped_until",  # to that one
    "impact_speed",  # greatest of a journal in the converged run [m/s]
    "energy_made",  # by the integrator [J], or of what there is [1] (bars, ratchet)
    "power",  # planted: energy made a second while in the false state [W]
    "power_predicted",
    "bears",  # planted: load that the cycle should bear [N]
    "load",  # planted: load that the unbalance puts on it [N]
    "word",  # planted: the cycle
    "steps",
    "newton",  # iterations, or solutions of the linear system
    "cutbacks",
    "cpu_s",
)
COLUMNS = (*IDENTITY, *FOUND)
_DIGITS = 6


@dataclass(frozen=True)
class Experiment:
    """One thing on which the integrators are tried.

    steps: lengths [s]; cases: names of the variants or repetitions of each pair of scheme and step;
    version: text that changes whenever the results may; run: makes the columns of `FOUND` that it
    has from (scheme, h, index of the case, folder with what `prepare` made); takes: whether it can
    run a scheme; prepare: makes once what all runs compare with, in a folder.
    """

    name: str
    steps: tuple[float, ...]
    cases: tuple[str, ...]
    version: Callable[[], str]
    run: Callable[[Scheme, float, int, Path], Row]
    takes: Callable[[Scheme], bool] = lambda scheme: True
    prepare: Callable[[Path], None] = lambda folder: None


@dataclass(frozen=True)
class Job:
    """One run of the grid; key: of all that determines its row."""

    key: str
    experiment: str
    label: str
    scheme: Scheme
    h: float
    case: int
    case_name: str

    def identity(self) -> Row:
        """The row's first columns."""
        of_scheme = self.scheme._asdict()
        return {
            "key": self.key,
            "experiment": self.experiment,
            "scheme": self.label,
            **{name: of_scheme[name] for name in ("alpha_f", "alpha_m", "beta", "gamma")},
            "h": self.h,
            "case": self.case_name,
        }


def jobs_of(experiments: Sequence[Experiment], schemes: Mapping[str, Scheme]) -> list[Job]:
    """Every run of the grid, the first case of all before the second of any: a grid that is stopped
    has a bit of everything."""
    result = []
    for experiment in experiments:
        version = experiment.version()
        for label, scheme in schemes.items():
            if not experiment.takes(scheme):
                continue
            for h in experiment.steps:
                for i, case in enumerate(experiment.cases):
                    # the label is not in it: two names of one scheme share their runs
                    text = repr((experiment.name, version, tuple(scheme), h, case))
                    key = hashlib.sha256(text.encode()).hexdigest()[:12]
                    result.append(Job(key, experiment.name, label, scheme, h, i, case))
    return sorted(result, key=lambda job: (job.case, job.h))


def read_table(path: Path) -> list[Row]:
    """Rows of a table, compressed if its name ends in .gz; numbers as such, empty cells left out.

    A line that a killed process left unfinished is passed over. Raises `InputError` for a file that
    cannot be read or is no such table.
    """
    try:
        data = path.read_bytes()
        text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode("utf-8")
    except (OSError, UnicodeDecodeError, EOFError, gzip.BadGzipFile) as error:
        raise InputError(f"--table {path}: cannot be read: {error}") from error
    lines = csv.reader(io.StringIO(text))
    header = next(lines, [])
    if not set(IDENTITY) <= set(header):
        raise InputError(f"--table {path}: is not the table of a survey: columns missing")
    return [
        {name: _value(name, cell) for name, cell in zip(header, line, strict=True) if cell}
        for line in lines
        if len(line) == len(header)
    ]


def _value(name: str, cell: str) -> str | float:
    if name in ("key", "experiment", "scheme", "case", "status", "word"):
        return cell
    return float(cell)


def write_table(rows: Iterable[Row], path: Path) -> None:
    """A table, whole or not at all; equal rows give equal bytes."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(_cells(row) for row in rows)
    data = text.getvalue().encode()
    with unfinished(path) as part:
        part.write_bytes(gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)


def _cells(row: Row) -> list[str]:
    cells = []
    for name in COLUMNS:
        value = row.get(name, "")
        is_result = isinstance(value, float) and name in FOUND
        cells.append(f"{value:.{_DIGITS}g}" if is_result else str(value))
    return cells


def run_grid(
    experiments: Sequence[Experiment],
    schemes: Mapping[str, Scheme],
    out: Path,
    processes: int | None = None,
) -> list[Row]:
    """Run what the table in `out` does not hold yet; returns the rows of this grid.

    Rows of other code or settings leave the table for `stale.csv`. Stopped at any moment, it goes
    on from the rows that were finished.
    """
    jobs = jobs_of(experiments, schemes)
    path = out / TABLE
    stored = _without_stale(read_table(path), jobs, out) if path.exists() else []
    by_key = {row["key"]: row for row in stored}
    versions = {e.name: hashlib.sha256(e.version().encode()).hexdigest()[:8] for e in experiments}
    stores = {e.name: out / "reference" / f"{e.name}-{versions[e.name]}" for e in experiments}
    write_table(stored, path)
    left = list({job.key: job for job in jobs if job.key not in by_key}.values())
    console = Console(stderr=True)
    columns = (*Progress.get_default_columns()[:-1], MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        for experiment in experiments:
            if any(job.experiment == experiment.name for job in left):
                task = bar.add_task(f"{experiment.name}: reference", total=None)
                stores[experiment.name].mkdir(parents=True, exist_ok=True)
                experiment.prepare(stores[experiment.name])
                bar.remove_task(task)
        task = bar.add_task("survey", total=len(jobs), completed=len(jobs) - len(left))
        with path.open("a", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            for row in _finished(experiments, left, stores, processes):
                by_key[row["key"]] = row
                writer.writerow(_cells(row))
                file.flush()
                bar.advance(task)
    # a scheme of two names has one run, and a row under each
    rows = [by_key[job.key] | {"scheme": job.label} for job in jobs]
    own = {(row["key"], row["scheme"]) for row in rows}
    others = [row for row in stored if (row["key"], row["scheme"]) not in own]
    write_table(sorted(rows + others, key=_order), path)
    return rows


def _order(row: Row) -> tuple[object, ...]:
    return row["experiment"], row["scheme"], -row["h"], row["case"]


def _without_stale(rows: Sequence[Row], jobs: Sequence[Job], out: Path) -> list[Row]:
    """Rows but those whose place in the grid another version has taken: they go to another file."""
    place = {(job.experiment, job.scheme, job.h, job.case_name): job.key for job in jobs}
    stored: list[Row] = []
    stale: list[Row] = []
    for row in rows:
        scheme = Scheme(row["alpha_m"], row["alpha_f"], row["beta"], row["gamma"])
        now = place.get((row["experiment"], scheme, row["h"], row["case"]), row["key"])
        (stored if now == row["key"] else stale).append(row)
    if stale:
        write_table(stale, out / "stale.csv")
    return stored


def _finished(experiments, left, stores, processes) -> Iterable[Row]:
    by_name = {experiment.name: experiment for experiment in experiments}
    tasks = [(by_name[job.experiment].run, job, stores[job.experiment]) for job in left]
    if processes == 1 or len(tasks) < 2:
        yield from map(_carry_out, tasks)
        return
    # a process a core, and each with one thread: its matrices are small
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    # Ctrl-C is the parent's to handle: leaving the block ends the others at once
    context = multiprocessing.get_context("spawn")
    count = min(processes or os.cpu_count() or 1, len(tasks))
    with context.Pool(count, _leave_ctrl_c) as pool:
        yield from pool.imap_unordered(_carry_out, tasks)


def _leave_ctrl_c() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _carry_out(task: tuple[Callable, Job, Path]) -> Row:
    run, job, store = task
    return job.identity() | run(job.scheme, job.h, job.case, store)
