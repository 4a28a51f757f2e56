"""The metrics of a periodic response: what can be kept of its curve, with its column and cell.

A quantity is PART.QUANTITY as `rf.response(...).curve` has it, such as `disc[3].r_amp`; of the
whole curve also `parameter`, what is varied along it, `stable`, 1 or 0, and `branch`, from 1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..studies.study import Cell, Column
from .metrics import Kind, Metric, bin_middles, edges_of
from .run_excitation import Excitation

if TYPE_CHECKING:
    from ..periodic.result import Curve, ResponseResult

KINDS: Mapping[str, Kind] = {
    "peak": Kind((), {}, False, "largest of the stable motions, of {of}"),
    "value": Kind(("at",), {}, False, "largest of the stable motions at {at:g}, of {of}"),
    "amplitude": Kind(("bins",), {}, False, "largest of the stable motions in each bin, of {of}"),
    "bifurcation": Kind((), {"which": "lowest"}, False, "{which} value with a {of}"),
    "curve": Kind((), {}, False, "{of} at every point of the curve"),
}
WHICH = ("lowest", "highest")
PARAMETER, STABLE, BRANCH = "parameter", "stable", "branch"


def check(metric: Metric, how: Excitation) -> None:
    """Raise `InputError` for a metric that no response has."""
    from ..model.periodic.branch import BIFURCATIONS

    where, options = f"keep {metric.name}", dict(metric.options)
    if metric.kind == "bifurcation" and metric.of not in BIFURCATIONS:
        raise InputError(
            f"{where}: bifurcation = {metric.of!r}: must be one of {', '.join(BIFURCATIONS)}"
        )
    if metric.kind != "curve" and metric.of in (PARAMETER, STABLE, BRANCH):
        raise InputError(f"{where}: {metric.of}: only of a curve")
    if options.get("which", WHICH[0]) not in WHICH:
        raise InputError(
            f"{where}: which = {options['which']!r}: must be one of {', '.join(WHICH)}"
        )
    low, high = how.numbers["from"], how.numbers["to"]
    if metric.kind == "value" and not low <= options["at"] <= high:
        raise InputError(f"{where}: at = {options['at']:g}: must be from {low:g} to {high:g}")


def column(metric: Metric, unit: str, of_parameter: str) -> Column:
    """Return the column of a metric; unit: the quantity's, of_parameter: of what is varied along
    the curve."""
    options = {**KINDS[metric.kind].optional, **dict(metric.options), "of": metric.of}
    text = KINDS[metric.kind].text.format(**options)
    if metric.kind == "bifurcation":
        return Column(metric.name, of_parameter, text)
    if metric.kind == "curve":
        return Column(metric.name, unit, text, "point")
    if metric.kind == "amplitude":
        middles = bin_middles(options["bins"])
        dimension = f"{metric.name} {PARAMETER}"
        return Column(metric.name, unit, text, dimension, middles, of_parameter)
    return Column(metric.name, unit, text)


def cells(metric: Metric, result: ResponseResult) -> Cell:
    """Return the cell of a response; nan where it has no such motion or bifurcation."""
    options = {**KINDS[metric.kind].optional, **dict(metric.options)}
    if metric.kind == "bifurcation":
        values = [b.value for b in result.bifurcations if b.kind == metric.of]
        pick = min if options["which"] == WHICH[0] else max
        return float(pick(values, default=math.nan))
    if metric.kind == "curve":
        return _along(metric.of, result)
    if metric.kind == "value":
        part, _, quantity = metric.of.rpartition(".")
        stable = [p for p in result.at(options["at"]) if p.is_stable]
        sizes = [result.amplitude(p, part, quantity) for p in stable]
        return max(sizes, default=math.nan)
    curve = result.curve(metric.of)
    if metric.kind == "peak":
        return (
            float(curve.value[curve.stable].max(initial=-math.inf))
            if any(curve.stable)
            else (math.nan)
        )
    return _in_bins(curve, options["bins"])


def _along(name: str, result: ResponseResult) -> list[float]:
    if name == BRANCH:
        return [float(i) for i, b in enumerate(result.branches, 1) for _ in b.points]
    if name in (PARAMETER, STABLE):
        of = {PARAMETER: "value", STABLE: "is_stable"}[name]
        return [float(getattr(p, of)) for p in result.points]
    return result.curve(name).value.tolist()


def _in_bins(curve: Curve, bins: Mapping[str, Any]) -> list[float]:
    """Return the largest stable value in each bin, of the curve as lines between its points."""
    edges = edges_of(bins)
    largest = np.full(len(edges) - 1, math.nan)
    joined = curve.stable[1:] & curve.stable[:-1] & (curve.branch[1:] == curve.branch[:-1])
    for i in np.flatnonzero(joined):
        (a, b), (u, v) = curve.parameter[i : i + 2], curve.value[i : i + 2]
        ends = np.clip(np.sort([a, b]), edges[0], edges[-1])
        cuts = np.unique([*ends, *edges[(edges > ends[0]) & (edges < ends[1])]])
        values = u + (v - u) * (cuts - a) / (b - a) if a != b else np.full(len(cuts), max(u, v))
        for k in range(len(cuts) - 1):
            at = min(int(np.searchsorted(edges, cuts[k], "right")) - 1, len(largest) - 1)
            largest[at] = np.fmax(largest[at], max(values[k : k + 2]))
    return largest.tolist()
