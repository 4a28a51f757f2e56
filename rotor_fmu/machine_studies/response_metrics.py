"""The metrics of a periodic response, a function a kind: what its curve comes to.

A quantity is PART.QUANTITY as `rf.response(...).curve` has it, such as `disc[3].r_amp`; of the
whole curve also `parameter`, the one along it, `stable`, 1 or 0, and `branch`, from 1.
"""

import math
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from .metric import ListAxis, Metric, MetricKind, bin_middles, declared, edges_of
from .run_excitation import Excitation

if TYPE_CHECKING:
    from ..periodic.result import Curve, ResponseResult

KINDS: dict[str, MetricKind] = {}
_kind = partial(declared, KINDS)
_WHICH = ("lowest", "highest")
PARAMETER, STABLE, BRANCH = "parameter", "stable", "branch"


def check(metric: Metric, how: Excitation) -> None:
    """Raise `InputError` for a metric that no response has."""
    from ..model.periodic.branch import BIFURCATIONS

    kind = metric.kind.name
    if kind == "bifurcation" and metric.of not in BIFURCATIONS:
        listed = ", ".join(BIFURCATIONS)
        raise metric.refusal(f"bifurcation = {metric.of!r}: must be one of {listed}")
    if kind != "curve" and metric.of in (PARAMETER, STABLE, BRANCH):
        raise metric.refusal(f"{metric.of}: only of a curve")
    which = metric.option("which")
    if which is not None and which not in _WHICH:
        raise metric.refusal(f"which = {which!r}: must be one of {', '.join(_WHICH)}")
    low, high, at = how.numbers["from"], how.numbers["to"], metric.option("at")
    if at is not None and not low <= at <= high:
        raise metric.refusal(f"at = {at:g}: must be from {low:g} to {high:g}")


@_kind("largest of the stable motions, of {of}")
def _peak(metric: Metric, result: "ResponseResult") -> float:
    """Return the largest stable value; nan without stable motions."""
    curve = result.curve(metric.of)
    return max(curve.value[curve.stable].tolist(), default=math.nan)


@_kind("largest of the stable motions at {at:g}, of {of}", "at")
def _value(metric: Metric, result: "ResponseResult") -> float:
    """Return the largest stable value at a value of the parameter; nan without stable motions."""
    part, _, quantity = metric.of.rpartition(".")
    stable = [p for p in result.at(metric.option("at")) if p.is_stable]
    return max((result.amplitude(p, part, quantity) for p in stable), default=math.nan)


def _bin_axis(metric: Metric, how: Excitation) -> ListAxis:
    middles = bin_middles(metric.option("bins"))
    return ListAxis(f"{metric.name} {PARAMETER}", middles, how.abscissa_unit)


@_kind("largest of the stable motions in each bin, of {of}", "bins", axis=_bin_axis)
def _amplitude(metric: Metric, result: "ResponseResult") -> list[float]:
    return _in_bins(result.curve(metric.of), metric.option("bins"))


@_kind("{which} value with a {of}", optional={"which": _WHICH[0]}, outputs=None)
def _bifurcation(metric: Metric, result: "ResponseResult") -> float:
    """Return the value of the parameter at a bifurcation; nan without one."""
    values = [b.value for b in result.bifurcations if b.kind == metric.of]
    pick = min if metric.option("which") == _WHICH[0] else max
    return float(pick(values, default=math.nan))


def _point_axis(metric: Metric, how: Excitation) -> ListAxis:
    return ListAxis("point")


@_kind("{of} at every point of the curve", axis=_point_axis)
def _curve(metric: Metric, result: "ResponseResult") -> list[float]:
    if metric.of == BRANCH:
        return [float(i) for i, b in enumerate(result.branches, 1) for _ in b.points]
    if metric.of in (PARAMETER, STABLE):
        of = {PARAMETER: "value", STABLE: "is_stable"}[metric.of]
        return [float(getattr(p, of)) for p in result.points]
    return result.curve(metric.of).value.tolist()


def _in_bins(curve: "Curve", bins: Mapping[str, Any]) -> list[float]:
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
