"""`docs/explanation/integrators.md`: a template, and the numbers of a survey's table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.schemes.family import chung_hulbert, wbz
from rotor_fmu.model.structure.assembly import assemble

from rotor_fmu.figure_style import save

from .. import order_five, tolerances
from ..false_state import cycles as false_state
from ..false_state import one_axis
from . import false_state_figures, survey_plots
from .false_state_figures import free_growth, phase_limit
from .findings import Findings, false_state_power, median, rebound_of, scheme_of, title_of
from .grid import Row
from .hidden import hidden_head, hidden_rows

PAGE, _TEMPLATE = "explanation/integrators.md", "integrators.md"
_PAPER_A, _MD = "generalized-alpha=0.1,0.08", "moderate-dissipation"
_TARGETS = (0.1, 0.05, 0.02, 0.01)
_CLEAN = 0.3  # RMS error of the bars' tip velocity, of which the mesh's own is some 0.15 [1]
_QUIETER = 50.0  # than Newmark's method, the high-frequency content of the ratchet [1]


def write_page(rows: Sequence[Row], out: Path) -> Path:
    """Write the page and its pictures to `out`, laid out as docs/ is; returns the page's path."""
    findings = Findings(rows)
    folder = out / "figures"
    folder.mkdir(exist_ok=True)
    pictures = {
        "error": survey_plots.error(findings),
        "false_state": survey_plots.false_states(findings),
        "bars": survey_plots.bars(findings),
        "ratchet": survey_plots.ratchet(findings),
        "orbit": false_state_figures.orbits(),
        "power": false_state_figures.power(findings),
        "lasting": false_state_figures.lasting(findings),
        "phase": false_state_figures.phases(),
        "bounce": false_state_figures.impacts(findings),
    }
    for name, figure in pictures.items():
        save(figure, folder / f"integrators_{name}.png")
    page = out / PAGE
    page.parent.mkdir(exist_ok=True)
    page.write_text(page_text(findings), encoding="utf-8")
    return page


def page_text(findings: Findings) -> str:
    """The page: the template beside this module, and the numbers of the table."""
    template = files(__package__).joinpath(_TEMPLATE).read_text(encoding="utf-8")
    numbers = {
        **_of_the_run_down(findings),
        **_of_the_false_state(findings),
        **_of_its_power(findings),
        **_of_the_impacts(findings),
        "work_table": _work_table(findings),
        "hidden_table": _table(hidden_head(), hidden_rows()),
        "tolerance_table": _table(tolerances.head(), tolerances.table(tolerances.rows())),
        "worst_table": _table(tolerances.worst_head(), tolerances.worst(tolerances.rows())),
        **tolerances.in_words(tolerances.rows()),
        "five_table": _table(order_five.head(), order_five.table(order_five.rows())),
        "five_tolerance_table": _table(
            order_five.tolerance_head(order_five.rows()),
            order_five.tolerance_table(order_five.rows()),
        ),
        **order_five.in_words(order_five.rows()),
    }
    return Template(template).substitute(numbers)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _ms(h: float) -> str:
    return f"{h * 1e3:.3g}"


def _percent(value: float | None) -> str:
    return (
        "-" if value is None else f"{100 * value:.2g}" if value < 0.0995 else f"{100 * value:.0f}"
    )


def _error(findings: Findings, scheme: str, h: float) -> float | None:
    return median(findings.of("rotor", scheme=scheme, h=h), "error")


def safe_schemes(findings: Findings) -> list[str]:
    """Integrators of which no run-down, no impact and no planted cycle is in the false state."""
    result = []
    for scheme in findings.schemes("rotor"):
        rows = findings.of("rotor", scheme=scheme)
        # a planted cycle may begin with a few steps in its state, but has to stay in it
        others = findings.of("bounce", scheme=scheme) + findings.of("planted", scheme=scheme)
        is_free = all(row["status"] == "ok" for row in rows)
        if is_free and not any(row.get("trapped", 0.0) > 0.0 for row in others):
            result.append(scheme)
    return result


def _of_the_run_down(findings: Findings) -> dict[str, Any]:
    steps, schemes = findings.steps("rotor"), findings.schemes("rotor")
    safe = safe_schemes(findings)
    coarse = {s: e for s in schemes if (e := _error(findings, s, steps[0])) is not None}
    best = min(coarse, key=lambda scheme: coarse[scheme])
    wbz = findings.of("rotor", scheme="wbz=0.08")
    resolved = [h for h in steps if min(_errors(findings, schemes, h)) <= 0.1]
    return {
        "count": len(findings.rows),
        "rotor_rows": len(findings.of("rotor")),
        "rotor_schemes": len({scheme_of(row) for row in findings.of("rotor")}),
        "rotor_steps": len(steps),
        "longest": _ms(steps[0]),
        "shortest": _ms(steps[-1]),
        "safe": _listed([title_of(s) for s in safe]) or "none",
        "targets": _target_table(findings, safe),
        "error_table": _error_table(findings, schemes, steps),
        "coarse": _ms(max(resolved)) if resolved else _ms(steps[-1]),
        "coarse_best": _percent(coarse[best]),
        "coarse_best_scheme": title_of(best),
        "coarse_paper": _percent(coarse.get(_PAPER_A)),
        "coarse_newmark": _percent(coarse.get("newmark")),
        "wbz_failed": sum(row["status"] not in ("ok", "false state") for row in wbz),
        "wbz_runs": len(wbz),
        "repetitions": len({row["case"] for row in findings.of("rotor")}),
        "energy_table": _energy_table(findings),
        "paper_trapped": _where_trapped(findings, _PAPER_A),
        "newmark_trapped": _where_trapped(findings, "newmark"),
        "md_trapped": _where_trapped(findings, _MD),
    }


def _errors(findings: Findings, schemes: Sequence[str], h: float) -> list[float]:
    return [e for s in schemes if (e := _error(findings, s, h)) is not None]


def _listed(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _where_trapped(findings: Findings, scheme: str) -> str:
    parts = []
    for h in findings.steps("rotor"):
        rows = findings.of("rotor", scheme=scheme, h=h)
        count = sum(row["status"] == "false state" for row in rows)
        if count:
            parts.append(f"{count} of {len(rows)} at {_ms(h)} ms")
    return ", ".join(parts) or "in no run"


def _target_table(findings: Findings, safe: Sequence[str]) -> str:
    rows = []
    for target in _TARGETS:
        candidates = [
            (h, scheme, error)
            for scheme in safe
            for h in findings.steps("rotor")
            if (error := _error(findings, scheme, h)) is not None and error <= target
        ]
        if not candidates:
            continue
        h = max(candidate[0] for candidate in candidates)
        _, scheme, error = min((c for c in candidates if c[0] == h), key=lambda c: c[2])
        runs = findings.of("rotor", scheme=scheme, h=h)
        rows.append(
            [
                f"{100 * target:g} %",
                title_of(scheme),
                f"{_ms(h)} ms",
                f"{_percent(error)} %",
                f"{median(runs, 'cpu_s'):.2g} s",
            ]
        )
    head = ["error wanted", "integrator", "step", "error", "CPU time of the run-down (40 s)"]
    return _table(head, rows)


def _error_table(findings: Findings, schemes: Sequence[str], steps: Sequence[float]) -> str:
    rows = []
    for scheme in schemes:
        cells = [title_of(scheme)]
        for h in steps:
            error, share = _error(findings, scheme, h), findings.trapped_share(scheme, h)
            text = _percent(error)
            cells.append(f"{text} ({100 * share:.0f} %)" if share else text)
        rows.append(cells)
    return _table(["h [ms]", *map(_ms, steps)], rows)


def _of_the_false_state(findings: Findings) -> dict[str, Any]:
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
        "trapped_shortest": _ms(min(seen)) if seen else "-",
        "trapped_longest": _ms(max(seen)) if seen else "-",
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
    return _table(["h [ms]", *map(_ms, steps)], rows)


def _rebounds(findings: Findings) -> str:
    parts = []
    for scheme in ("chung-hulbert=0.2", _MD, "hht=0.5", "chung-hulbert=0.3", "newmark"):
        rows = findings.of("rotor", scheme=scheme)
        if rows:
            runs = sum(row["status"] == "false state" for row in rows)
            value = f"{rebound_of(rows[0]):.3g}"
            parts.append(f"{value} for {title_of(scheme)} ({runs} of {len(rows)} runs trapped)")
    return _listed(parts)


def _of_its_power(findings: Findings) -> dict[str, Any]:
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
        "power_h": _ms(h),
        "power_table": _table(["", "seen [W]", "predicted [W]", "run-downs"], table),
    }


def _of_the_impacts(findings: Findings) -> dict[str, Any]:
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
        "bars_h": _ms(h),
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
        "noisy": _listed(
            [title_of(scheme) for scheme in findings.schemes("ratchet") if scheme not in quiet]
        ),
        "quieter": f"{_QUIETER:g}",
        "ratchet_table": _ratchet_table(findings),
        "through": _listed(
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
    head = ["", *(f"{_ms(h)} ms, {case}" for h in steps for case in ("no", "average-time"))]
    rows = []
    for scheme in findings.schemes("bars"):
        cells = [title_of(scheme)]
        for h in steps:
            for case in ("no", "average-time"):
                result = findings.of("bars", scheme=scheme, h=h, case=case)
                cells.append(_bars_cell(result[0]) if result else "-")
        rows.append(cells)
    return _table(head, rows)


def _bars_cell(row: Row) -> str:
    if row["status"] != "ok":
        return row["status"]
    return f"{row['error']:.3g} ({row['energy_made']:+.2g})"


def _ratchet_table(findings: Findings) -> str:
    steps = findings.steps("ratchet")
    head = [
        "",
        *(f"{_ms(h)} ms, fast [rad/s]" for h in steps),
        *(f"{_ms(h)} ms, average time" for h in steps),
    ]
    rows = []
    for scheme in findings.schemes("ratchet"):
        cells = [title_of(scheme)]
        for case in ("no", "average-time"):
            for h in steps:
                result = findings.of("ratchet", scheme=scheme, h=h, case=case)
                cells.append(_ratchet_cell(result[0]) if result else "-")
        rows.append(cells)
    return _table(head, rows)


def _ratchet_cell(row: Row) -> str:
    if row["status"] != "ok":
        return row["status"].replace("stalled at", "stall at")
    return f"{row['fast']:.2g}" if math.isfinite(row.get("fast", math.nan)) else "-"


def _energy_table(findings: Findings) -> str:
    steps = [findings.nearest_step("rotor", h) for h in (4e-3, 1e-3, 5e-4, 2.5e-4, 1e-4)]
    rows = []
    for scheme in findings.schemes("rotor"):
        cells = [title_of(scheme)]
        for h in steps:
            made = median(findings.of("rotor", scheme=scheme, h=h), "energy_made")
            cells.append("-" if made is None else f"{made:+.2g}")
        rows.append(cells)
    return _table(["h [ms]", *map(_ms, steps)], rows)


def _work_table(findings: Findings) -> str:
    steps = [findings.nearest_step("rotor", h) for h in (4e-3, 1e-3, 2.5e-4, 1e-4)]
    rows = []
    for scheme in findings.schemes("rotor"):
        cells = [title_of(scheme)]
        for h in steps:
            runs = [r for r in findings.of("rotor", scheme=scheme, h=h) if "newton" in r]
            newton = median(runs, lambda row: row["newton"] / row["steps"])
            cost = median(runs, lambda row: row["cpu_s"] / row["steps"] * 1e6)
            cells.append("-" if newton is None else f"{newton:.1f}, {cost:.1f} µs")
        rows.append(cells)
    return _table(["h [ms]", *map(_ms, steps)], rows)
