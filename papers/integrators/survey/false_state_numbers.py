"""The page's numbers of the false state: where it is, how long it lasts, the power it makes."""

from typing import Any

import numpy as np
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.structure.assembly import assemble

from papers.integrators.members import chung_hulbert, wbz
from rotor_fmu.cells import markdown_table

from ..false_state import cycles as false_state
from ..false_state import one_axis
from .false_state_figures import free_growth, phase_limit
from .findings import Findings, false_state_power, median, rebound_of, scheme_of, title_of
from .words import listed, ms

_MD = "moderate-dissipation"


def of_the_false_state(findings: Findings) -> dict[str, Any]:
    """When it was seen, how long planted cycles last, and what bounds it."""
    seen = [
        h
        for h in findings.steps("rotor")
        if any(findings.trapped_share(s, h) for s in findings.schemes("rotor"))
    ]
    shortest = findings.steps("rotor")[-1]
    planted = [row for row in findings.of("planted", h=shortest) if row["status"] == "ok"]
    low, high = (findings.of("planted", scheme=f"chung-hulbert={r}") for r in ("0.2", "0.3"))
    free = [row for row in findings.of("planted", status="ok") if "." in row["word"]]
    speeds = np.arange(20.0, 401.0, 1.0)
    structure = assemble(rig())
    loads = [one_axis.unbalance_loads(structure, speed).max() for speed in speeds]
    gap = rig().bearings[0].clearance
    return {
        "trapped_shortest": ms(min(seen)) if seen else "-",
        "trapped_longest": ms(max(seen)) if seen else "-",
        "bears_02": f"{max((row.get('bears', 0.0) for row in low), default=0.0):.2g}",
        "bears_03": f"{max((row.get('bears', 0.0) for row in high), default=0.0):.0f}",
        "correlation": f"{np.corrcoef(np.array(findings.predictions())[:, :2].T)[0, 1]:.2f}",
        "free_planted": len(free),
        "free_lasting": sum(row["trapped"] > 0.99 for row in free),
        "lasting_03": sum(row.get("trapped", 0.0) > 0.99 for row in high),
        "planted_03": sum(row["status"] == "ok" for row in high),
        "lasting_short": sum(row.get("trapped", 0.0) > 0.99 for row in planted),
        "planted_short": len(planted),
        "resonance": f"{speeds[int(np.argmax(loads))]:.0f}",
        "rho_limit": f"{phase_limit(chung_hulbert, 0.0, 1.0):.2f}",
        "wbz_limit": f"{phase_limit(wbz, -0.99, 0.0):.2f}",
        "free_growth": f"{free_growth():.2g}",
        "when_table": _when_table(findings),
        "rebounds": _rebounds(findings),
        "impact_speed": f"{findings.impact_speed():.2g}",
        "crossing_short": f"{2 * gap / shortest:.2g}",
    }


def _when_table(findings: Findings) -> str:
    """Between which speeds the runs that fell into the false state were in it, medians."""
    steps = [findings.nearest_step("rotor", h) for h in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    rows = []
    for scheme in findings.schemes("rotor"):
        cells = []
        for h in steps:
            runs = findings.of("rotor", scheme=scheme, h=h, status="false state")
            speeds = [median(runs, name) for name in ("trapped_speed", "trapped_until")]
            cells.append(f"{speeds[0]:.0f} to {speeds[1]:.0f}" if runs else "-")
        if any(cell != "-" for cell in cells):
            rows.append([title_of(scheme), *cells])
    return markdown_table(["h [ms]", *map(ms, steps)], rows)


def _rebounds(findings: Findings) -> str:
    parts = []
    for scheme in ("chung-hulbert=0.2", _MD, "hht=0.5", "chung-hulbert=0.3", "newmark"):
        rows = findings.of("rotor", scheme=scheme)
        if rows:
            runs = sum(row["status"] == "false state" for row in rows)
            value = f"{rebound_of(rows[0]):.3g}"
            parts.append(f"{value} for {title_of(scheme)} ({runs} of {len(rows)} runs trapped)")
    return listed(parts)


def of_its_power(findings: Findings) -> dict[str, Any]:
    """The energy that it makes, seen and predicted."""
    rows = [row for row in findings.of("planted") if row.get("trapped", 0.0) > 0.99]
    ratio = np.array([row["power"] / row["power_predicted"] - 1.0 for row in rows])
    h = findings.nearest_step("rotor", 2.5e-4)
    axis = one_axis.axis_of(rig(), 0, one_axis.X)
    table = []
    for scheme in findings.schemes("rotor"):
        runs = [
            row
            for row in findings.of("rotor", scheme=scheme, h=h, status="false state")
            if row["trapped"] > 0.25
        ]
        words = [
            cycle
            for cycle in (false_state.cycles(axis, scheme_of(runs[0]), h, 4) if runs else ())
            if cycle.word == "RRLL"
        ]
        if words:
            seen = median(runs, false_state_power)
            table.append([title_of(scheme), f"{seen:.1f}", f"{words[0].power:.1f}", str(len(runs))])
    return {
        "power_good": f"{100 * np.mean(np.abs(ratio) < 0.05):.0f}",
        "power_count": len(rows),
        "power_median": f"{100 * np.median(ratio):.1f}",
        "power_h": ms(h),
        "power_table": markdown_table(["", "seen [W]", "predicted [W]", "run-downs"], table),
    }
