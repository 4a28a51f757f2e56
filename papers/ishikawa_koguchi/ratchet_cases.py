"""`python -m papers.ishikawa_koguchi ratchet`: its runs, table, pictures and animation."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from rotor_fmu.errors import writable_folder
from rotor_fmu.files import write_text
from rotor_fmu.plotting.figure_style import save

from . import impact_plots as pictures
from .cases import PAPER_RATCHET, ImpactCase, carried_out, finish
from .impact.ratchet import RatchetRun, parse_ratchet, ratchet_toml, run_ratchet
from .ratchet_drawing import animate, drawing, frame_interval
from .result_table import Column, ResultTable

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
    rows = [_row(case, dt, *result) for case, result in zip(chosen, results, strict=True)]
    title = (
        f"Ratchet; a rigid pawl slides with {ratchet.acceleration:.0f} rad/s2 "
        f"and locks at {1e3 * ratchet.t_locking:.2f} ms"
    )
    report = ResultTable(COLUMNS, rows, title)
    report.write(out / "ratchet.csv", out / "ratchet.md")
    _write_pictures(runs, out)
    for case, result in runs.items():
        if case.impact == "average-time":
            text = "\n".join(map(str, result.run.log)) + "\n"
            write_text(text, out / f"status_{case.slug}.txt")
    failures = [
        f"{case.label}: {result.run.status}"
        for case, result in runs.items()
        if not result.run.is_done and not result.run.is_capped
    ]
    return finish([report], chosen, failures, out)


def _row(case: ImpactCase, dt: float, result: RatchetRun, wall: float) -> dict[str, Any]:
    speed = result.wheel_speed
    row = {"label": case.label, "dt": dt, "slope": result.slope}
    row |= {"t_reversal": 1e3 * result.t_reversal, "fast_content": result.fast_content}
    if result.t_reversal == result.t_reversal:
        once = result.t < 1.6 * result.t_reversal
        row |= {"lowest": float(speed[once].min()), "highest": float(speed[once].max())}
    row |= {"energy_sliding": result.energy_sliding}
    row |= {"energy_change": result.energy_change, "increments": result.run.increments}
    row |= {"cutbacks": result.run.cutbacks, "t_end": 1e3 * float(result.t[-1])}
    return row | {"wall_time": wall, "status": result.run.status}


def _write_pictures(runs: Mapping[ImpactCase, RatchetRun], out: Path) -> None:
    by_label = {case.label: result for case, result in runs.items()}
    is_papers = tuple(case.name for case in runs) == PAPER_RATCHET
    caption = "Paper B, Figure 10: the ratchet wheel" if is_papers else "The ratchet wheel"
    save(pictures.wheel_speeds(by_label, caption), out / "figure_10_wheel.png")
    drawn = next(iter(runs.values()))
    label = next(iter(by_label))
    for found_label, result in by_label.items():
        if not result.run.is_capped:
            continue
        others = {key: run for key, run in by_label.items() if key != found_label}
        caption = f"Paper B, Figure 11: {result.run.cutbacks} cutbacks and no progress"
        save(pictures.stall(found_label, result, others, caption), out / "figure_11_stall.png")
    newmark = next((key for key in by_label if key.startswith("newmark")), None)
    if newmark and newmark != label:
        pair = {newmark: by_label[newmark], label: drawn}
        caption = "Paper B, Figure 12: the pawl while it slides"
        save(pictures.shaking(pair, caption), out / "figure_12_shaking.png")
    save(drawing(drawn, f"The ratchet, {label}"), out / "ratchet.png")
    end = _ONE_TOOTH * drawn.ratchet.t_locking
    retained = drawn.shape_t <= end
    tooth = replace(
        drawn,
        shape_t=drawn.shape_t[retained],
        shape_angle=drawn.shape_angle[retained],
        shapes=drawn.shapes[retained],
    )
    animate(tooth, out / "ratchet.gif", f"One tooth, {label}")
