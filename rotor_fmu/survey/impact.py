"""The survey's runs of paper B's experiments: two elastic bars, a pawl in a ratchet wheel."""

from __future__ import annotations

import math
import time
from pathlib import Path

from model.impact.bars import Bars, run_bars
from model.impact.failures import Diverged
from model.schemes import Scheme

from .grid import Experiment, Row
from .sources import source_digest

BARS = Bars()
BARS_STEPS = (8e-4, 4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
IMPACTS = ("no", "average-time")


def bars(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """The bars against the solution of the wave equation; opening 0.01 m, hard contact.

    error: root mean square of the tip velocity's error from the impact on, over the speed.
    """
    begun = time.process_time()
    # short steps for an impact treated by cutbacks may need more increments than the paper's cap
    cap = max(10_000, math.ceil(20 * 0.04 / h))
    try:
        run = run_bars(BARS, scheme, h, IMPACTS[case], cap=cap)
    except Diverged as failure:
        return {"status": f"failed at {failure.t:.4g} s", "cpu_s": time.process_time() - begun}
    if not run.run.is_done:
        return {
            "status": f"stalled at {run.t[-1]:.4g} s",
            "cutbacks": float(run.run.cutbacks),
            "steps": float(run.run.increments),
            "cpu_s": time.process_time() - begun,
        }
    return {
        "status": "ok",
        "error": run.rms_error() / BARS.speed,
        "plateau": run.rms_error("plateau"),
        "released": run.mean_after_release,
        "energy_made": run.energy_change,
        "steps": float(run.run.increments),
        "newton": float(run.run.solves),
        "cutbacks": float(run.run.cutbacks),
        "cpu_s": time.process_time() - begun,
    }


def _bars_version() -> str:
    return f"{source_digest('model.impact.bars')} {BARS!r}"


BARS_EXPERIMENT = Experiment(
    name="bars",
    steps=BARS_STEPS,
    cases=IMPACTS,
    version=_bars_version,
    run=bars,
)
