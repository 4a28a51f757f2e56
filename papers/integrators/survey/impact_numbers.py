"""The page's numbers of paper B's impacts: bars that collide, and the ratchet."""

import math
from collections.abc import Callable
from typing import Any

from .findings import Findings, rebound_of, scheme_of, title_of
from .grid import Row
from .words import listed, ms, scheme_table

_CLEAN = 0.3  # RMS error of the bars' tip velocity, of which the mesh's own is some 0.15 [1]
_QUIETER = 50.0  # than Newmark's method, the high-frequency content of the ratchet [1]


def of_the_impacts(findings: Findings) -> dict[str, Any]:
    """Bars that collide and the ratchet: what rings, what stalls."""
    h = findings.nearest_step("bars", 5e-5)
    plain, averaged = (findings.of("bars", h=h, case=case) for case in ("no", "average-time"))
    clean = [row for row in plain if row.get("error", math.inf) < _CLEAN]
    # what does not damp the fastest oscillations rings, whatever its restitution
    others = [r for r in plain if r not in clean and scheme_of(r).rho_infinity < 0.999]
    undamped = next(row for row in plain if row["scheme"] == "newmark=0.5,0.5")
    slow = findings.nearest_step("ratchet", 1e-5)
    sliding = findings.of("ratchet", h=slow, case="no")
    newmark = next(row["fast"] for row in sliding if row["scheme"] == "newmark")
    quiet = [row["scheme"] for row in sliding if row.get("fast", math.inf) < newmark / _QUIETER]
    stalls = findings.of("ratchet", case="average-time")
    return {
        "bars_h": ms(h),
        "bars_limit": f"{_CLEAN:g}",
        "bars_clean": len(clean),
        "bars_runs": len(plain),
        "bars_clean_rebound": f"{max(map(rebound_of, clean)):.3g}",
        "bars_other_rebound": f"{min(map(rebound_of, others)):.3g}",
        "bars_undamped": f"{undamped['error']:.2g}",
        "bars_undamped_rebound": f"{rebound_of(undamped):.3g}",
        "bars_averaged": sum(row.get("error", math.inf) < _CLEAN for row in averaged),
        "bars_floor": f"{min(row['error'] for row in averaged if 'error' in row):.2g}",
        "bars_table": _bars_table(findings),
        "ratchet_h": f"{slow * 1e3:g}",
        "noisy": listed(
            [title_of(scheme) for scheme in findings.schemes("ratchet") if scheme not in quiet]
        ),
        "quieter": f"{_QUIETER:g}",
        "ratchet_table": _ratchet_table(findings),
        "through": listed(
            [
                title_of(row["scheme"])
                for row in findings.of("ratchet", h=slow, case="average-time", status="ok")
            ]
        )
        or "no integrator",
        "stalled": sum(row["status"].startswith("stalled") for row in stalls),
        "stall_runs": len(stalls),
    }


def _bars_table(findings: Findings) -> str:
    steps = [findings.nearest_step("bars", h) for h in (8e-4, 5e-5)]
    columns = {f"{ms(h)} ms, {case}": (h, case) for h in steps for case in ("no", "average-time")}
    return _table(findings, "bars", columns, _bars_cell)


def _bars_cell(row: Row) -> str:
    if row["status"] != "ok":
        return row["status"]
    return f"{row['error']:.3g} ({row['energy_made']:+.2g})"


def _ratchet_table(findings: Findings) -> str:
    cases = {"no": "fast [rad/s]", "average-time": "average time"}
    steps = findings.steps("ratchet")
    columns = {f"{ms(h)} ms, {what}": (h, case) for case, what in cases.items() for h in steps}
    return _table(findings, "ratchet", columns, _ratchet_cell)


def _ratchet_cell(row: Row) -> str:
    if row["status"] != "ok":
        return row["status"].replace("stalled at", "stall at")
    return f"{row['fast']:.2g}" if math.isfinite(row.get("fast", math.nan)) else "-"


def _table(
    findings: Findings,
    experiment: str,
    columns: dict[str, tuple[float, str]],
    cell_of: Callable[[Row], str],
) -> str:
    """A row a scheme, a column a step length and case."""

    def cell(scheme: str, at: tuple[float, str]) -> str:
        """Return what there is to say of the one row, a dash if there is none."""
        rows = findings.of(experiment, scheme=scheme, h=at[0], case=at[1])
        return cell_of(rows[0]) if rows else "-"

    return scheme_table(findings.schemes(experiment), columns, cell, "")
