"""`python -m papers.ishikawa_koguchi ratchet`: its runs, table, pictures and animation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rotor_fmu.errors import writable_folder
from rotor_fmu.figures import save
from rotor_fmu.files import write_text
from rotor_fmu.runs.report import Column, Report

from . import figures as pictures
from .cases import PAPER_RATCHET, ImpactCase, carried_out, finish
from .impact.ratchet import RatchetRun, parse_ratchet, ratchet_toml, run_ratchet
from .ratchet_drawing import animate, drawing, frame_interval

COLUMNS = (
    Column("label", "scheme"),
    Column("dt", "dt [s]", ".0e", False),
    Column("slope", "slope\n[rad/s2]", ".0f"),
    Column("t_reversal", "turns at\n[ms]", ".2f"),
    Column("lowest", "before\n[rad/s]", ".1f"),
    Column("highest", "after\n[rad/s]", "+.1f"),
    Column("fast_content", "fast\n[rad/s]", ".2g"),
    Column("energy_sliding", "energy made while sliding [of the work]", "+.4f", False),
    Column("energy_change", "until the end", "+.3f", False),
    Column("increments", "increments", "d", False),
    Column("cutbacks", "cut-\nbacks", "d"),
    Column("t_end", "until\n[ms]", ".3g"),
    Column("wall_time", "time [s]", ".2f", False),
    Column("status", "status", "", False),
)
_ONE_TOOTH = 1.75  # of the time to the locking face: there and back


def present(
    chosen: Sequence[ImpactCase], dt: float, geometry: str | None, stop: float, cap: int, out: Path
) -> dict[str, Any]:
    """Run every case; write, print and return what came out.

    geometry: TOML text, None for the ratchet that comes with the package. Raises `ImpactError` for
    a ratchet that cannot be, before anything is written.
    """
    ratchet = parse_ratchet(ratchet_toml() if geometry is None else geometry)
    ratchet.plate  # noqa: B018 the mesh is checked before anything is written
    writable_folder(out)
    jobs = [
        (
            f"{case.label}, dt = {dt:g} s",
            stop,
            lambda progress, case=case, k=k: run_ratchet(
                ratchet,
                case.scheme,
                dt,
                case.impact,
                stop,
                cap,
                progress,
                frame_interval() if k == 0 else np.inf,
            ),
        )
        for k, case in enumerate(chosen)
    ]
    results = carried_out("ratchet", jobs)
    runs = {case: run for case, (run, _) in zip(chosen, results, strict=True)}
    rows = [_row(case, dt, *found) for case, found in zip(chosen, results, strict=True)]
    title = (
        f"Ratchet; a rigid pawl slides with {ratchet.acceleration:.0f} rad/s2 "
        f"and locks at {1e3 * ratchet.t_locking:.2f} ms"
    )
    report = Report(COLUMNS, rows, title)
    report.write(out / "ratchet.csv", out / "ratchet.md")
    _write_pictures(runs, out)
    for case, found in runs.items():
        if case.impact == "average-time":
            text = "\n".join(map(str, found.run.log)) + "\n"
            write_text(text, out / f"status_{case.slug}.txt")
    failures = [
        f"{case.label}: {found.run.status}"
        for case, found in runs.items()
        if not found.run.is_done and not found.run.is_capped
    ]
    return finish([report], chosen, failures, out)


def _row(case: ImpactCase, dt: float, found: RatchetRun, wall: float) -> dict[str, Any]:
    speed = found.wheel_speed
    row = {"label": case.label, "dt": dt, "slope": found.slope}
    row |= {"t_reversal": 1e3 * found.t_reversal, "fast_content": found.fast_content}
    if found.t_reversal == found.t_reversal:
        once = found.t < 1.6 * found.t_reversal
        row |= {"lowest": float(speed[once].min()), "highest": float(speed[once].max())}
    row |= {"energy_sliding": found.energy_sliding}
    row |= {"energy_change": found.energy_change, "increments": found.run.increments}
    row |= {"cutbacks": found.run.cutbacks, "t_end": 1e3 * float(found.t[-1])}
    return row | {"wall_time": wall, "status": found.run.status}


def _write_pictures(runs: Mapping[ImpactCase, RatchetRun], out: Path) -> None:
    by_label = {case.label: found for case, found in runs.items()}
    is_papers = tuple(case.name for case in runs) == PAPER_RATCHET
    caption = "Paper B, Figure 10: the ratchet wheel" if is_papers else "The ratchet wheel"
    save(pictures.wheel_speeds(by_label, caption), out / "figure_10_wheel.png")
    drawn = next(iter(runs.values()))
    label = next(iter(by_label))
    for found_label, found in by_label.items():
        if not found.run.is_capped:
            continue
        others = {key: run for key, run in by_label.items() if key != found_label}
        caption = f"Paper B, Figure 11: {found.run.cutbacks} cutbacks and no progress"
        save(pictures.stall(found_label, found, others, caption), out / "figure_11_stall.png")
    newmark = next((key for key in by_label if key.startswith("newmark")), None)
    if newmark and newmark != label:
        pair = {newmark: by_label[newmark], label: drawn}
        caption = "Paper B, Figure 12: the pawl while it slides"
        save(pictures.shaking(pair, caption), out / "figure_12_shaking.png")
    save(drawing(drawn, f"The ratchet, {label}"), out / "ratchet.png")
    end = _ONE_TOOTH * drawn.ratchet.t_locking
    kept = drawn.shape_t <= end
    tooth = replace(
        drawn,
        shape_t=drawn.shape_t[kept],
        shape_angle=drawn.shape_angle[kept],
        shapes=drawn.shapes[kept],
    )
    animate(tooth, out / "ratchet.gif", f"One tooth, {label}")
