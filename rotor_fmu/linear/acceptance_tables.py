"""Tables of the checks of API 617 and 684."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from ..display import current, range_with_unit, speed_with_unit
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


def critical_map_table(result: CriticalMap) -> Table:
    """Return a table with one row for each crossing of a line by a bearing's own stiffness."""
    what = "Undamped forward critical speeds"
    if not result.synchronous:
        what = "Natural frequencies at standstill"
    title = (
        f"{what} where a bearing has the stiffness that all have; first one on rigid bearings "
        f"{speed_with_unit(result.rigid)}"
    )
    if not result.crossings:
        title += "; no bearing's own stiffness meets a line within the map"
    d = current()
    heads = (
        *("bearing", "axis", "mode", f"stiffness [{d.stiffness_unit}]"),
        *("critical [rad/s]", f"[{d.speed_unit}]"),
    )
    rows = [
        (
            *(c.bearing, c.axis, c.mode + 1, float(c.stiffness) * d.stiffness),
            *(float(c.speed), float(c.speed) * d.speed),
        )
        for c in result.crossings
    ]
    return Table(title, heads, rows)


def peaks_table(criticals: Sequence[ProbeCritical]) -> Table:
    """Return a table with one row for each peak of a node."""
    d = current()
    heads = ("node", "axis", f"critical [{d.speed_unit}]", d.amplitude_words, "N1", "N2", "AF")
    rows = [_peak(c) for c in criticals]
    return Table("Critical speeds with their amplification factors (API 684)", heads, rows)


def _peak(critical: ProbeCritical) -> tuple[object, ...]:
    peak, d = critical.peak, current()
    return (
        *(critical.node, critical.axis, peak.speed * d.speed, peak.amplitude * d.amplitude),
        *(peak.below * d.speed, peak.above * d.speed, peak.amplification),
    )


def unbalance_check_table(result: UnbalanceCheck) -> Table:
    """Return a table with one row for each critical speed of a probe, for each probe, and for each
    clearance."""
    d = current()
    small = d.small_word
    heads = (
        *("what", f"at [{d.speed_unit}]", small, "N1", "N2", "AF"),
        *("required [%]", "actual [%]", "met"),
    )
    title = (
        f"API 617 {range_with_unit(result.low, result.high)}, contacts "
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
    small, speed = current().small, current().speed
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
        yield (where, p.speed * speed, p.peak_to_peak * small, "", "", "", 100.0, share, met)
    for g in result.clearances:
        share = 100 * g.scaled / g.clearance
        where = f"clearance {g.name}"
        yield (where, g.speed * speed, g.scaled * small, "", "", "", 75.0, share, _MET[g.is_met])


def level_1_table(result: StabilityLevel1) -> Table:
    """Return a table of the figures that level 1 asks for."""
    conclusion = "level 2 is required" if result.is_level_2_required else "level 2 is not required"
    title = (
        f"Stability level 1 at {speed_with_unit(result.speed)}, cross coupling at node "
        f"{result.node}: {conclusion}"
    )
    q, unit = current().stiffness, current().stiffness_unit
    none = "unstable nowhere"
    threshold = none if result.threshold is None else result.threshold * q
    rows: list[tuple[object, ...]] = [
        ("least log dec without cross coupling [1]", result.log_dec_alone, ""),
        ("that of the first forward mode [1]", result.first_alone, ""),
        (f"QA, anticipated cross coupling [{unit}]", result.anticipated * q, ""),
        ("least log dec with QA [1]", result.log_dec_anticipated, f">= {LEAST_LOG_DEC:g}"),
        ("that of the first forward mode [1]", result.first_anticipated, ""),
        (f"Q0, where the rotor becomes unstable [{unit}]", threshold, ""),
        (
            "Q0 / QA [1]",
            result.ratio if math.isfinite(result.ratio) else "-",
            f">= {LEAST_RATIO:g}",
        ),
        (f"sensitivity of the least log dec [1/({unit})]", result.sensitivity / q, ""),
        ("critical speed ratio [1]", result.critical_speed_ratio, ""),
    ]
    return Table(title, ("", "value", "API 617"), rows)


def level_2_table(result: StabilityLevel2) -> Table:
    """Return a table with one row for each case."""
    verdict = "met" if result.is_met else "NOT met"
    title = (
        f"Stability level 2 at {speed_with_unit(result.speed)}: least log dec of the forward modes "
        f">= {LEAST_LOG_DEC:g} {verdict}"
    )
    d = current()
    rows = [
        (
            *(c.name, float(c.log_dec), c.frequency * d.speed),
            *(float(c.first_log_dec), c.first_frequency * d.speed),
        )
        for c in result.cases
    ]
    unit = f"f_d [{d.frequency_unit}]"
    return Table(title, ("what acts", "least log dec", unit, "first forward", unit), rows)
