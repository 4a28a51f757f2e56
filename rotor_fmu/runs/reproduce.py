"""What paper A ran, run again: every case through the FMU, beside what the paper says of it."""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from ..figures import save
from ..model.machine.toml import rig_toml
from ..packing.bundle import package_name
from . import figures
from .job import Job, execute, fmu_in, prepare, write_json
from .run_down import Run, summary

_PHASE_STEP = 1e-5  # between perturbed runs, of all unbalances [rad]


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
    """A case that was run: the run, its `summary`, and those of its perturbed repetitions."""

    case: PaperRun
    run: Run
    figures: Mapping[str, Any]
    repeated: tuple[Mapping[str, Any], ...]

    def spread(self, key: str) -> tuple[float, float, float] | None:
        """Median, least and largest of a figure over all repetitions; None if the run failed."""
        values = [f[key] for f in (self.figures, *self.repeated) if f[key] is not None]
        if not values or self.figures["status"].startswith("failed"):
            return None
        return statistics.median(values), min(values), max(values)


def run_cases(out: Path, announce: Callable[[str], None]) -> list[Result]:
    """Run all cases through the FMU; those finished by an earlier call are read from `out`/runs."""
    fmu = fmu_in(out, rig_toml())
    store = out / "runs" / f"{package_name()}-{sha256(rig_toml().encode()).hexdigest()[:8]}"
    store.mkdir(parents=True, exist_ok=True)

    def run(name: str, job: Job, label: str) -> Run:
        return _stored(store / f"{name}.npz", lambda: execute(job, fmu, label))

    results = []
    for case in CASES:
        job = prepare(None, None, case.sets, None, 40.0, None)
        first = run(case.name, job, case.title)
        repeated = tuple(
            summary(
                run(
                    f"{case.name}-{i}",
                    _perturbed(job, i * _PHASE_STEP),
                    f"{case.title}, {i + 1} of {case.repetitions}",
                )
            )
            for i in range(1, case.repetitions)
        )
        results.append(Result(case, first, summary(first), repeated))
        announce(f"{case.title}: {first.status.split(':')[0]}")
    return results


def _perturbed(job: Job, phase: float) -> Job:
    phases = {v.name: phase for v in job.table if v.name.endswith(".phase")}
    return replace(job, parameters={**job.parameters, **phases}, step=max(job.step, 0.04))


def _stored(path: Path, make: Callable[[], Run]) -> Run:
    """A run from its file, or made now and put there whole."""
    if path.exists():
        with np.load(path) as data:
            about = json.loads(str(data["about"]))
            columns = dict(zip(about.pop("names"), data["columns"], strict=True))
            messages = tuple(about.pop("messages"))
            return Run(data["t"], columns, messages=messages, **about)
    run = make()
    about = {
        "names": list(run.columns),
        "status": run.status,
        "messages": run.messages,
        "wall_s": run.wall_s,
    }
    unfinished = path.with_suffix(".part.npz")
    np.savez_compressed(
        unfinished, t=run.t, columns=np.array(list(run.columns.values())), about=json.dumps(about)
    )
    unfinished.replace(path)
    return run


def write_figures(results: list[Result], out: Path) -> list[Path]:
    """The paper's figures 3 to 6 and 9 to 15; in grey behind the amplitudes the converged run."""
    by_name = {result.case.name: result for result in results}
    converged = by_name["converged"].run
    fixed, damped, adaptive = (by_name[name] for name in ("paper", "damped", "adaptive"))
    label, lower = "0.1 / 0.08, h = 4 ms", "0.15 / 0.1, h = 4 ms"
    peak = fixed.figures["x_peak_hz"]
    amplitude, angle = figures.amplitude, figures.contact_angle
    pictures = {
        "figure_03_x": amplitude(fixed.run, "x", f"Paper A, Fig. 3: {label}", converged),
        "figure_04_y": amplitude(fixed.run, "y", f"Paper A, Fig. 4: {label}", converged),
        "figure_05_psi": angle(fixed.run, f"Paper A, Fig. 5: {label}"),
        "figure_06_orbit": figures.orbit(
            fixed.run, peak, f"Paper A, Fig. 6: orbit at {peak:.1f} Hz"
        ),
        "figure_09_x": amplitude(damped.run, "x", f"Paper A, Fig. 9: {lower}", converged),
        "figure_10_y": amplitude(damped.run, "y", f"Paper A, Fig. 10: {lower}", converged),
        "figure_11_x": amplitude(
            adaptive.run, "x", "Paper A, Fig. 11: 0.1 / 0.08, variable step", converged
        ),
        "figure_12_y": amplitude(
            adaptive.run, "y", "Paper A, Fig. 12: 0.1 / 0.08, variable step", converged
        ),
        "figure_13_psi": angle(adaptive.run, "Paper A, Fig. 13: 0.1 / 0.08, variable step"),
        "figure_14_error": figures.error_indicator(
            adaptive.run, "Paper A, Fig. 14: error indicator of Zienkiewicz and Xie"
        ),
        "figure_15_h": figures.step_length(adaptive.run, "Paper A, Fig. 15: step length"),
        "converged_psi": angle(converged, "Converged run, h = 0.1 ms: contact angle"),
        "converged_orbit": figures.orbit(
            converged,
            by_name["converged"].figures["x_peak_hz"],
            "Converged run: orbit at the horizontal peak",
        ),
    }
    return [save(figure, out / f"{name}.png") for name, figure in pictures.items()]


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
            "-" if failed else f"{psi[0]:.0f} to {psi[1]:.0f}",
            "-" if failed else "never" if circle is None else f"{circle[0]:.1f} to {circle[1]:.1f}",
            _steps(result),
            f"{f['newton_per_step']:.1f}" if f["newton_per_step"] else "-",
            f"{f['wall_s']:.2g}",
            result.case.paper,
        ]
        rows.append("| " + " | ".join(cells) + " |")
    failures = [f"- {r.case.title}: {r.figures['status']}" for r in results if r.run.status != "ok"]
    runs = max(result.case.repetitions for result in results)
    note = (
        f"\nMedians, and in brackets the range, of up to {runs} runs whose unbalances are turned "
        f"by {_PHASE_STEP:g} rad each. X: largest |x| of disc 3, Y: largest |y - y at rest|, both "
        "for t > 2 s.\n"
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
    """Run what paper A ran and write figures, `table.md` and `table.json` to the folder `out`."""
    results = run_cases(out, announce)
    write_figures(results, out)
    text = table(results)
    (out / "table.md").write_text(text, encoding="utf-8")
    write_json(
        {r.case.name: {**r.figures, "repeated": list(r.repeated)} for r in results},
        out / "table.json",
    )
    return results
