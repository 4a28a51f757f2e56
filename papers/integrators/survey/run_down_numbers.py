"""The page's numbers of the run-downs: error, work, energy made, runs in the false state."""

from collections.abc import Sequence
from typing import Any

from rotor_fmu.cells import markdown_table

from .findings import Findings, median, safe_schemes, scheme_of, title_of
from .words import listed, ms, percent, step_table

_PAPER_A, _MD = "generalized-alpha=0.1,0.08", "moderate-dissipation"
_TARGETS = (0.1, 0.05, 0.02, 0.01)


def _error(findings: Findings, scheme: str, h: float) -> float | None:
    return median(findings.of("rotor", scheme=scheme, h=h), "error")


def of_the_run_downs(findings: Findings) -> dict[str, Any]:
    """Errors, work and energy of the run-downs, and how often each fell into the false state."""
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
        "longest": ms(steps[0]),
        "shortest": ms(steps[-1]),
        "safe": listed([title_of(s) for s in safe]) or "none",
        "targets": _target_table(findings, safe),
        "error_table": _error_table(findings, schemes, steps),
        "coarse": ms(max(resolved)) if resolved else ms(steps[-1]),
        "coarse_best": percent(coarse[best]),
        "coarse_best_scheme": title_of(best),
        "coarse_paper": percent(coarse.get(_PAPER_A)),
        "coarse_newmark": percent(coarse.get("newmark")),
        "wbz_failed": sum(row["status"] not in ("ok", "false state") for row in wbz),
        "wbz_runs": len(wbz),
        "repetitions": len({row["case"] for row in findings.of("rotor")}),
        "energy_table": _energy_table(findings),
        "work_table": _work_table(findings),
        "paper_trapped": _where_trapped(findings, _PAPER_A),
        "newmark_trapped": _where_trapped(findings, "newmark"),
        "md_trapped": _where_trapped(findings, _MD),
    }


def _errors(findings: Findings, schemes: Sequence[str], h: float) -> list[float]:
    return [e for s in schemes if (e := _error(findings, s, h)) is not None]


def _where_trapped(findings: Findings, scheme: str) -> str:
    parts = []
    for h in findings.steps("rotor"):
        rows = findings.of("rotor", scheme=scheme, h=h)
        count = sum(row["status"] == "false state" for row in rows)
        if count:
            parts.append(f"{count} of {len(rows)} at {ms(h)} ms")
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
                f"{ms(h)} ms",
                f"{percent(error)} %",
                f"{median(runs, 'cpu_s'):.2g} s",
            ]
        )
    head = ["error wanted", "integrator", "step", "error", "CPU time of the run-down (40 s)"]
    return markdown_table(head, rows)


def _error_table(findings: Findings, schemes: Sequence[str], steps: Sequence[float]) -> str:
    def cell(scheme: str, h: float) -> str:
        """Return the error, with the share of runs in the false state in brackets."""
        share, text = findings.trapped_share(scheme, h), percent(_error(findings, scheme, h))
        return f"{text} ({100 * share:.0f} %)" if share else text

    return step_table(schemes, steps, cell)


def _energy_table(findings: Findings) -> str:
    def cell(scheme: str, h: float) -> str:
        """Return the energy made."""
        made = median(findings.of("rotor", scheme=scheme, h=h), "energy_made")
        return "-" if made is None else f"{made:+.2g}"

    steps = [findings.nearest_step("rotor", h) for h in (4e-3, 1e-3, 5e-4, 2.5e-4, 1e-4)]
    return step_table(findings.schemes("rotor"), steps, cell)


def _work_table(findings: Findings) -> str:
    def cell(scheme: str, h: float) -> str:
        """Return Newton's iterations and the cost of a step."""
        runs = [r for r in findings.of("rotor", scheme=scheme, h=h) if "newton" in r]
        newton = median(runs, lambda row: row["newton"] / row["steps"])
        cost = median(runs, lambda row: row["cpu_s"] / row["steps"] * 1e6)
        return "-" if newton is None else f"{newton:.1f}, {cost:.1f} µs"

    steps = [findings.nearest_step("rotor", h) for h in (4e-3, 1e-3, 2.5e-4, 1e-4)]
    return step_table(findings.schemes("rotor"), steps, cell)
