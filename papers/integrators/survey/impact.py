"""The survey's runs of paper B's experiments: two elastic bars, a pawl in a ratchet wheel."""

import math
import time
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from papers.integrators.members import Scheme
from papers.ishikawa_koguchi import impact as impact_package

from .grid import Experiment, Row
from .sources import file_digest, source_digest

if TYPE_CHECKING:
    from ...ishikawa_koguchi.impact.stepping.march import Run

# What runs them is imported where they run: finite elements load slowly.
BARS_STEPS = (8e-4, 4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
RATCHET_STEPS = (2e-5, 1e-5, 5e-6)
IMPACTS = ("no", "average-time")
_CAP = 10_000  # paper B's, of the increments


def meet(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """The bars against the solution of the wave equation; opening 0.01 m, hard contact.

    error: root mean square of the tip velocity's error from the impact on, over the speed.
    """
    from ...ishikawa_koguchi.impact.bars import Bars, run_bars

    bars = Bars()
    begun = time.process_time()
    made = run_bars(bars, scheme, h, IMPACTS[case], cap=_CAP)
    row = _ended(made.run, begun)
    if made.run.is_done:
        row |= {
            "error": made.rms_error() / bars.speed,
            "plateau": made.rms_error("plateau"),
            "released": made.mean_after_release,
            "energy_made": made.energy_change,
        }
    return row


def slide(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """The ratchet that comes with the package.

    error: of the wheel's deceleration while the pawl slides, against a rigid pawl's; fast: the
    pawl's high-frequency content then; energy_made: until the locking face, over the work done.
    """
    from ...ishikawa_koguchi.impact.ratchet import parse_ratchet, ratchet_toml, run_ratchet

    machine = parse_ratchet(ratchet_toml())
    begun = time.process_time()
    made = run_ratchet(machine, scheme, h, IMPACTS[case], cap=_CAP)
    row = _ended(made.run, begun)
    for name, value in (
        ("error", abs(made.slope / machine.acceleration - 1.0)),
        ("fast", made.fast_content),
        ("energy_made", made.energy_sliding),
    ):
        if math.isfinite(value):
            row[name] = value
    return row


def _ended(run: "Run", begun: float) -> Row:
    return {
        "status": "ok" if run.is_done else f"{_end_of(run)} at {run.t[-1]:.4g} s",
        "steps": float(run.increments),
        "newton": float(run.solves),
        "cutbacks": float(run.cutbacks),
        "cpu_s": time.process_time() - begun,
    }


def _end_of(run: "Run") -> str:
    return "stalled" if run.is_capped else run.status.split()[0]


def _bars_version() -> str:
    return f"{source_digest('papers.ishikawa_koguchi.impact.bars')} {file_digest(__file__)}"


def _ratchet_version() -> str:
    toml = files(impact_package).joinpath("ratchet.toml").read_text(encoding="utf-8")
    return f"{source_digest(f'{impact_package.__name__}.ratchet')} {file_digest(__file__)} {toml}"


ON_BARS = Experiment("bars", BARS_STEPS, IMPACTS, _bars_version, meet)
ON_RATCHET = Experiment("ratchet", RATCHET_STEPS, IMPACTS, _ratchet_version, slide)
