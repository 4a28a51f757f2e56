"""Periodic responses as the subject of a study: a run is a whole curve with its jumps, and its
metrics, a function a kind, are what that comes to.

A quantity is PART.QUANTITY as `rf.response(...).curve` has it, such as `disc[3].r_amp`; of the
whole curve also `parameter`, the one along it, `stable`, 1 or 0, and `branch`, from 1.
"""

import json
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..display import Shown
from ..errors import InputError, check_one_of, known_name
from ..model.quantities import POSITIVE
from ..run_status import FAILED, status_of
from ..studies.study import Column, Result
from .machine_runs import RUN, MachineRuns
from .metric import ListAxis, Metric, MetricKind, bin_middles, declared, edges_of
from .run_excitation import Excitation
from .run_kinds import Number, RunKind

if TYPE_CHECKING:
    from ..periodic.curves import Curve
    from ..periodic.result import ResponseResult

KINDS: dict[str, MetricKind] = {}
_kind = partial(declared, KINDS)
WHICH = ("lowest", "highest")
PARAMETER, STABLE, BRANCH = "parameter", "stable", "branch"


@dataclass(frozen=True)
class _ResponseKind(RunKind):
    """The kind of runs that are periodic responses."""

    def check(self, values: Mapping[str, float]) -> None:
        """Raise `InputError` for values that the numbers cannot have, or not together."""
        super().check(values)
        if values["speed"] == 0 and values["from"] <= 0 <= values["to"]:
            raise InputError(
                f"run.from = {values['from']:g} rad/s: must be > 0, as run.to is, or both below 0"
            )
        if not values["from"] < values["to"]:
            raise InputError(
                f"run.from = {values['from']:g}: must be below run.to = {values['to']:g}"
            )


RESPONSE = _ResponseKind(
    "response",
    {
        "from": Number("", None, "lowest speed [rad/s], or value of `over`"),
        "to": Number("", None, "highest"),
        "speed": Number("rad/s", 0.0, "the one speed, with `over`"),
        "period": Number("1", 1.0, "revolutions in a period", POSITIVE, is_whole=True),
        "harmonics": Number("1", 60.0, "harmonics of the speed, at most", POSITIVE, is_whole=True),
        "share": Number(
            "1", 1e-4, "truncation tolerance: largest share of the highest harmonics", POSITIVE
        ),
        "length": Number("1", 0.1, "longest step along the curve", POSITIVE),
        "branches": Number(
            "1", 0.0, "1: branches from period doublings and branch points", is_whole=True
        ),
    },
)


@dataclass(frozen=True)
class ResponseRuns(MachineRuns):
    """Periodic responses of a machine over its speed or another parameter."""

    metric_kinds: ClassVar[Mapping[str, MetricKind]] = KINDS
    can_be_verified: ClassVar[bool] = False
    has_solver: ClassVar[bool] = False

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a curve by name, with their units."""
        from ..periodic.curves import UNITS, probes

        places = probes(self.machine.rotor)
        of_places = {f"{place}.{q}": unit for place in places for q, unit in UNITS.items()}
        return of_places | {PARAMETER: self.how.abscissa_unit, STABLE: "1", BRANCH: "1"}

    @property
    def variable_units(self) -> dict[str, str]:
        """Return the units of all that can be varied, by name."""
        units = {n: unit for n, unit in super().variable_units.items() if n != self.how.over}
        return units | {f"{RUN}{end}": self.how.abscissa_unit for end in ("from", "to")}

    def check_metric(self, metric: Metric, how: Excitation) -> None:
        """Raise `InputError` for a metric that no response has."""
        from ..model.periodic.branch import BIFURCATIONS

        kind = metric.kind.name
        if kind == "bifurcation":
            where = f"keep {metric.name}: bifurcation = {metric.of!r}"
            check_one_of(where, metric.of, BIFURCATIONS)
        if kind != "curve" and metric.of in (PARAMETER, STABLE, BRANCH):
            raise metric.error(f"{metric.of}: only of a curve")
        low, high, at = how.numbers["from"], how.numbers["to"], metric.option("at")
        if at is not None and not low <= at <= high:
            limit = Shown(1.0, how.abscissa_unit).text(high)
            raise metric.error(f"at = {at:g}: must be from {low:g} to {limit}")
        if kind != "bifurcation":
            known_name(f"keep {metric.name}:", metric.of, self.units)

    def column_of(self, metric: Metric, varied: Collection[str]) -> Column:
        """Return the column of a metric; of a bifurcation its value is one of the parameter."""
        unit = self.units.get(metric.of, self.how.abscissa_unit)
        axis = metric.kind.axis
        at = metric.option("at")
        shown = {} if at is None else {"at": Shown(1.0, self.how.abscissa_unit).text(at)}
        return metric.column(unit, axis and axis(metric, self.how), **shown)

    @cached_property
    def identity(self) -> str:
        """The machine, the response and what is kept, as text."""
        return json.dumps([super().identity, self.how.over])

    def warm(self) -> None:
        """Load the laws' tangents, by a machine that is condensed to them."""
        from ..model.periodic.linear_structure import CondensedMachine

        CondensedMachine(self.machine.rotor)

    def run(self, values: Mapping[str, float]) -> Result:
        """Compute one response; a failure in it, impossible values included, is its status."""
        try:
            result = self.response(values)
        except InputError as error:
            return Result(f"{FAILED}{error}", {})
        cells = {metric.name: metric.kind.make(metric, result) for metric in self.metrics}
        return Result(status_of(result.notes), cells)

    def response(self, values: Mapping[str, float]) -> "ResponseResult":
        """Return the response of a run. Raises `InputError` for impossible values."""
        from ..periodic.request import compute_response, response_request

        how, of_machine = self.split(values)
        n = how.numbers
        ends = n["from"], n["to"]
        request = response_request(
            self.machine.rotor,
            parameters=of_machine,
            speed=n["speed"] if how.over else ends,
            over=(how.over, *ends) if how.over else None,
            period=int(n["period"]),
            harmonics=int(n["harmonics"]),
            share=n["share"],
            step=n["length"],
            branches=n["branches"] != 0,
        )
        return compute_response(request)


@_kind("largest of the stable motions, of {of}")
def _peak(metric: Metric, result: "ResponseResult") -> float:
    """Return the largest stable value; nan without stable motions."""
    curve = result.curve(metric.of)
    return max(curve.value[curve.stable].tolist(), default=math.nan)


@_kind("largest of the stable motions at {at}, of {of}", "at")
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


@_kind("{which} value with a {of}", optional={"which": WHICH[0]}, outputs=None)
def _bifurcation(metric: Metric, result: "ResponseResult") -> float:
    """Return the value of the parameter at a bifurcation; nan without one."""
    values = [b.value for b in result.bifurcations if b.kind == metric.of]
    pick = min if metric.option("which") == WHICH[0] else max
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
