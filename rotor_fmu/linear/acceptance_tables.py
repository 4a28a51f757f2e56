"""Tables of the checks of API 617 and 684."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from ..display import current
from ..model.linear.amplification import DAMPED
from ..model.linear.critical_map import CriticalMap
from ..model.linear.stability_levels import (
    LEAST_LOG_DEC,
    LEAST_RATIO,
    StabilityLevel1,
    StabilityLevel2,
)
from ..model.linear.unbalance_check import ProbeCritical, UnbalanceCheck
from .linear_tables import Table

_MET = {True: "yes", False: "NO"}


def rpm(omega: float) -> float:
    """Return rev/min of rad/s."""
    return float(omega) * 30 / math.pi


def critical_map_table(result: CriticalMap) -> Table:
    """Return a table with one row for each crossing of a line by a bearing's own stiffness."""
    what = "Undamped forward critical speeds"
    if not result.synchronous:
        what = "Natural frequencies at standstill"
    title = (
        f"{what} where a bearing has the stiffness that all have; first one on rigid bearings "
        f"{rpm(result.rigid):.5g} rev/min"
    )
    if not result.crossings:
        title += "; no bearing's own stiffness meets a line within the map"
    heads = ("bearing", "axis", "mode", "stiffness [N/m]", "[rad/s]", "[rev/min]")
    rows = [
        (c.bearing, c.axis, c.mode + 1, float(c.stiffness), float(c.speed), rpm(c.speed))
        for c in result.crossings
    ]
    return Table(title, heads, rows)


def peaks_table(criticals: Sequence[ProbeCritical]) -> Table:
    """Return a table with one row for each peak of a node."""
    heads = ("node", "axis", "critical [rev/min]", current().amplitude_words, "N1", "N2", "AF")
    rows = [_peak(c) for c in criticals]
    return Table("Critical speeds with their amplification factors (API 684)", heads, rows)


def _peak(critical: ProbeCritical) -> tuple[object, ...]:
    peak = critical.peak
    return (
        critical.node,
        critical.axis,
        rpm(peak.speed),
        peak.amplitude * current().amplitude,
        rpm(peak.below),
        rpm(peak.above),
        peak.amplification,
    )


def unbalance_check_table(result: UnbalanceCheck) -> Table:
    """Return a table with one row for each critical speed of a probe, for each probe, and for each
    clearance."""
    d = current()
    small = d.small_word
    heads = (
        *("what", "critical [rev/min]", small, "N1", "N2", "AF"),
        *("required [%]", "actual [%]", "met"),
    )
    title = (
        f"API 617 between {rpm(result.low):.5g} and {rpm(result.high):.5g} rev/min, contacts "
        f"{result.contacts}: critical speeds ({d.amplitude_words}) with separation margins, probes "
        f"({small} p-p) against {result.limit * d.small:.4g} {small}, clearances "
        f"({small} 0-p{_scaled(result)}) against 75 %"
    )
    return Table(title, heads, list(_check_rows(result)))


def _why_none(amplification: float) -> str:
    """Return why a peak needs no separation."""
    if math.isnan(amplification):
        return "flat"
    return "damped" if amplification < DAMPED else "yes"


def _scaled(result: UnbalanceCheck) -> str:
    if not 1 < result.scale < math.inf:
        return ""
    return f" of the unbalance times {result.scale:.3g}, which brings the probes to that limit"


def _check_rows(result: UnbalanceCheck) -> Iterable[tuple[object, ...]]:
    small = current().small
    for c in result.criticals:
        node, axis, *numbers = _peak(c)
        if c.margin is not None:
            needed, there = 100 * c.margin.required, 100 * c.margin.actual
            met = _MET[c.margin.is_met] if needed else _why_none(c.peak.amplification)
            yield (f"node {node} {axis}", *numbers, needed, there, met)
    for p in result.probes:
        met = _MET[p.peak_to_peak <= result.limit]
        share = 100 * p.peak_to_peak / result.limit
        where = f"probe at node {p.node}"
        yield (where, rpm(p.speed), p.peak_to_peak * small, "", "", "", 100.0, share, met)
    for g in result.clearances:
        share = 100 * g.scaled / g.clearance
        where = f"clearance {g.name}"
        yield (where, rpm(g.speed), g.scaled * small, "", "", "", 75.0, share, _MET[g.is_met])


def level_1_table(result: StabilityLevel1) -> Table:
    """Return a table of the figures that level 1 asks for."""
    conclusion = "level 2 is required" if result.is_level_2_required else "level 2 is not required"
    title = (
        f"Stability level 1 at {rpm(result.speed):.5g} rev/min, cross coupling at node "
        f"{result.node}: {conclusion}"
    )
    none = "unstable nowhere"
    threshold = none if result.threshold is None else result.threshold
    rows: list[tuple[object, ...]] = [
        ("log dec without cross coupling [1]", result.log_dec_alone, ""),
        ("QA, anticipated cross coupling [N/m]", result.anticipated, ""),
        ("log dec with QA [1]", result.log_dec_anticipated, f">= {LEAST_LOG_DEC:g}"),
        ("Q0, where the rotor becomes unstable [N/m]", threshold, ""),
        (
            "Q0 / QA [1]",
            result.ratio if math.isfinite(result.ratio) else "-",
            f">= {LEAST_RATIO:g}",
        ),
        ("sensitivity of the log dec [m/N]", result.sensitivity, ""),
        ("critical speed ratio [1]", result.critical_speed_ratio, ""),
    ]
    return Table(title, ("", "value", "API 617"), rows)


def level_2_table(result: StabilityLevel2) -> Table:
    """Return a table with one row for each case."""
    verdict = "met" if result.is_met else "NOT met"
    title = (
        f"Stability level 2 at {rpm(result.speed):.5g} rev/min: log dec >= {LEAST_LOG_DEC:g} "
        f"{verdict}"
    )
    rows = [(c.name, float(c.log_dec), c.frequency / (2 * math.pi)) for c in result.cases]
    return Table(title, ("what acts", "log dec", "f_d [Hz]"), rows)
