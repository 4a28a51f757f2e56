"""What paper A ran, run again: every case through the FMU, beside what the paper says of it."""

import json
import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from rotor_fmu.model.machine.toml import rig_toml
from rotor_fmu.model.message_templates import Message

from rotor_fmu.files import unfinished, write_text
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import fmu_in, package_name
from rotor_fmu.output_options import write_json
from rotor_fmu.run_status import messages_and_codes
from rotor_fmu.runs.job import Job, execute, execute_recorded, prepare
from rotor_fmu.runs.recording import Recording, load_recording
from rotor_fmu.runs.run_down import Run
from rotor_fmu.runs.summary import summary

_PHASE_STEP = 1e-5  # between perturbed runs, of all unbalances [rad]
PLACE = "disc[3]"  # whose motion the paper draws
SECONDS = 40.0  # of a run-down


@dataclass(frozen=True)
class PaperRun:
    """One of the runs: its settings as `--set` texts, how many perturbed repetitions beside it, and
    what the paper says of it."""

    name: str
    title: str
    sets: tuple[str, ...]
    repetitions: int
    paper: str


def _method(name: str, **parameters: float) -> tuple[str, ...]:
    return (
        "solver.preset=paper",
        f"solver.method={name}",
        *(f"solver.{key}={value!r}" for key, value in parameters.items()),
    )


CASES = (
    PaperRun(
        "converged",
        "converged: Chung-Hulbert 0.2, h = 0.1 ms",
        ("solver.preset=robust", "solver.h=1e-4"),
        0,
        "(not in the paper)",
    ),
    PaperRun(
        "controlled",
        "controlled (the default): Chung-Hulbert 0.3, tolerance 1e-3",
        (),
        8,
        "(not in the paper)",
    ),
    PaperRun(
        "robust",
        "robust: Chung-Hulbert 0.2, h = 0.5 ms",
        ("solver.preset=robust",),
        8,
        "(not in the paper)",
    ),
    PaperRun(
        "paper",
        "generalized-alpha 0.1 / 0.08, h = 4 ms",
        ("solver.preset=paper",),
        12,
        "optimal; 10,000 steps, 2.5 h; agrees with the experiment",
    ),
    PaperRun(
        "damped",
        "generalized-alpha 0.15 / 0.1, h = 4 ms",
        _method("generalized-alpha", alpha_f=0.15, alpha_m=0.1),
        12,
        "lower displacements; 2 h",
    ),
    PaperRun("hht", "HHT 0.1, h = 4 ms", _method("hht", alpha_f=0.1), 12, "strongly damps; 2.25 h"),
    PaperRun("newmark", "Newmark, h = 4 ms", _method("newmark"), 12, "low accuracy, false results"),
    PaperRun(
        "wbz", "WBZ 0.08, h = 4 ms", _method("wbz", alpha_m=0.08), 0, "diverges at the beginning"
    ),
    PaperRun(
        "adaptive",
        "generalized-alpha 0.1 / 0.08, h = 4 to 20 ms",
        ("solver.preset=paper-adaptive",),
        12,
        "very similar to the fixed step; 6950 steps, 1.5 h",
    ),
    PaperRun(
        "adaptive-wide",
        "the same, limits 0.85 and 1.6",
        ("solver.preset=paper-adaptive", "solver.eps_min=0.85", "solver.eps_max=1.6"),
        12,
        "limits too high damp, too low diverge",
    ),
)


@dataclass(frozen=True)
class Result:
    """A case that was run: the run, its `summary`, those of its perturbed repetitions, and the run
    at its own steps."""

    case: PaperRun
    run: Run
    figures: Mapping[str, Any]
    repeated: tuple[Mapping[str, Any], ...]
    steps: Recording

    def spread(self, key: str) -> tuple[float, float, float] | None:
        """Median, least and largest of a figure over all repetitions; None if the run failed."""
        values = [f[key] for f in (self.figures, *self.repeated) if f[key] is not None]
        if not values or self.figures["status"].startswith("failed"):
            return None
        return statistics.median(values), min(values), max(values)


def run_cases(out: Path, announce: Callable[[str], None]) -> list[Result]:
    """Run all cases through the FMU, and their repetitions, which have the same numbers, without it
    and its warnings; those finished by an earlier call are read from `out`/runs."""
    fmu = fmu_in(out, machine_of())
    store = out / "runs" / f"{package_name()}-{sha256(rig_toml().encode()).hexdigest()[:8]}"
    store.mkdir(parents=True, exist_ok=True)

    def run(name: str, job: Job, label: str, is_first: bool = True) -> Run:
        through = fmu if is_first else None
        return _stored(
            store / f"{name}.npz", lambda: execute(job, through, label, is_silent=not is_first)
        )

    results = []
    for case in CASES:
        job = prepare(None, None, case.sets, None, SECONDS, None)
        first = run(case.name, job, case.title)
        repeated = tuple(
            summary(
                run(
                    f"{case.name}-{i}",
                    _perturbed(job, i * _PHASE_STEP),
                    f"{case.title}, {i + 1} of {case.repetitions}",
                    is_first=False,
                ),
                PLACE,
            )
            for i in range(1, case.repetitions)
        )
        steps = _recorded(store / f"{case.name}-steps.npz", job, case.title)
        results.append(Result(case, first, summary(first, PLACE, steps), repeated, steps))
        announce(f"{case.title}: {first.status.split(':')[0]}")
    return results


def _recorded(path: Path, job: Job, label: str) -> Recording:
    """The same run without the FMU, at its own steps: from its file, or made now and put there."""
    if not path.exists():
        execute_recorded(job, f"{label}, recorded", is_silent=True)[1].save(path)
    return load_recording(path)


def _perturbed(job: Job, phase: float) -> Job:
    phases = {v.name: phase for v in job.table if v.name.endswith(".phase")}
    return replace(job, parameters={**job.parameters, **phases}, step=max(job.step, 0.04))


def _stored(path: Path, make: Callable[[], Run]) -> Run:
    """A run from its file, or made now and put there whole."""
    if path.exists():
        with np.load(path) as data:
            about = json.loads(str(data["about"]))
            columns = dict(zip(about.pop("names"), data["columns"], strict=True))
            messages = tuple(map(Message, about.pop("messages"), about.pop("codes")))
            return Run(data["t"], columns, messages=messages, **about)
    run = make()
    about = {
        "names": list(run.columns),
        "status": run.status,
        **messages_and_codes(run.messages),
        "wall_s": run.wall_s,
    }
    with unfinished(path) as part:
        np.savez_compressed(
            part, t=run.t, columns=np.array(list(run.columns.values())), about=json.dumps(about)
        )
    return run


def table(results: list[Result]) -> str:
    """The comparison as Markdown: every run beside the converged one and the paper's words."""
    reference = next(r for r in results if r.case.name == "converged").figures
    rows = [
        "| run | X [µm] at [Hz] | to converged | Y [µm] at [Hz] | to converged | psi at X [deg] "
        "| full circle [Hz] | steps | Newton / step | time [s] | paper A says |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for result in results:
        cells = [result.case.title]
        for axis in "xy":
            cells += _peak_cells(result, axis, reference[f"{axis}_peak_um"])
        f = result.figures
        failed = f["status"].startswith("failed")
        psi, circle = f["psi_at_x_peak_deg"], f["circulation_hz"]
        cells += [
            "-" if failed or psi is None else f"{psi[0]:.0f} to {psi[1]:.0f}",
            "-" if failed else "never" if circle is None else f"{circle[0]:.1f} to {circle[1]:.1f}",
            _steps(result),
            f"{f['newton_per_step']:.1f}" if f["newton_per_step"] else "-",
            f"{f['solver_s']:.2g}",
            result.case.paper,
        ]
        rows.append("| " + " | ".join(cells) + " |")
    failures = [f"- {r.case.title}: {r.figures['status']}" for r in results if r.run.status != "ok"]
    runs = max(result.case.repetitions for result in results)
    note = (
        f"\nMedians, and in brackets the range, of up to {runs} runs whose unbalances are turned "
        f"by {_PHASE_STEP:g} rad each. X: largest |x| of disc 3, Y: largest |y - y at rest|, both "
        "after the start-up, the first 1.96 s.\n"
    )
    return "\n".join([*rows, note, *failures]) + "\n"


def _steps(result: Result) -> str:
    counts = [f["steps"] for f in (result.figures, *result.repeated)]
    return f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)} to {max(counts)}"


def _peak_cells(result: Result, axis: str, reference: float) -> list[str]:
    size, at = result.spread(f"{axis}_peak_um"), result.spread(f"{axis}_peak_hz")
    if size is None or at is None:
        return ["-", "-"]
    spread = f" ({size[1]:.0f} to {size[2]:.0f})" if size[2] - size[1] > 0.5 else ""
    return [f"{size[0]:.1f}{spread} at {at[0]:.2f}", f"{100 * (size[0] / reference - 1):+.1f} %"]


def reproduce(out: Path, announce: Callable[[str], None]) -> list[Result]:
    """Run what paper A ran and write `table.md` and `table.json` to the folder `out`."""
    results = run_cases(out, announce)
    text = table(results)
    write_text(text, out / "table.md")
    write_json(figures_of(results), out / "table.json")
    return results


def figures_of(results: list[Result]) -> dict[str, Any]:
    """The figures of every run and of its repetitions, by the run's name."""
    return {r.case.name: {**r.figures, "repeated": list(r.repeated)} for r in results}
