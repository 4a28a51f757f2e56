"""Periodic responses as the subject of a study: a run is a whole curve with its jumps."""

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

from ..errors import InputError
from ..fmi.variables import Variable
from ..run_status import FAILED, status_of
from ..studies.study import Column, Result
from ..studies.study_tables import known_name
from . import response_metrics
from .machine_runs import RUN, MachineRuns
from .metric import Metric, MetricKind
from .response_metrics import BRANCH, PARAMETER, STABLE
from .run_excitation import Excitation
from .run_kinds import POSITIVE, Number, RunKind

if TYPE_CHECKING:
    from ..periodic.result import ResponseResult


@dataclass(frozen=True)
class _ResponseKind(RunKind):
    """The kind of runs that are periodic responses."""

    def check(self, values: Mapping[str, float]) -> None:
        """Raise `InputError` for values that the numbers cannot have, or not together."""
        super().check(values)
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

    metric_kinds: ClassVar[Mapping[str, MetricKind]] = response_metrics.KINDS
    can_be_verified: ClassVar[bool] = False

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a curve by name, with their units."""
        from ..periodic.result import UNITS, probes

        places = probes(self.machine.rotor)
        of_places = {f"{place}.{q}": unit for place in places for q, unit in UNITS.items()}
        return of_places | {PARAMETER: self.how.abscissa_unit, STABLE: "1", BRANCH: "1"}

    @property
    def settable(self) -> dict[str, Variable]:
        """Return the machine's own parameters, without the solver's, by name."""
        return {n: v for n, v in super().settable.items() if n in self.machine.units}

    @property
    def variable_units(self) -> dict[str, str]:
        """Return the units of all that can be varied, by name."""
        units = {n: unit for n, unit in super().variable_units.items() if n != self.how.over}
        return units | {f"{RUN}{end}": self.how.abscissa_unit for end in ("from", "to")}

    def check_metric(self, metric: Metric, how: Excitation) -> None:
        """Raise `InputError` for a metric that no response has."""
        response_metrics.check(metric, how)
        for quantity in metric.kind.samples(metric.of):
            known_name(f"keep {metric.name}:", quantity, self.units)

    def column_of(self, metric: Metric, varied: Collection[str]) -> Column:
        """Return the column of a metric; of a bifurcation its value is one of the parameter."""
        unit = self.units.get(metric.of, self.how.abscissa_unit)
        axis = metric.kind.axis
        return metric.column(unit, axis and axis(metric, self.how))

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
        from ..periodic.request import answer

        how, of_machine = self.split(values)
        return answer(self.machine.rotor, parameters=of_machine, **_options(how))


def _options(how: Excitation) -> dict[str, Any]:
    """Return the options of `answer` for the numbers of a response."""
    n = how.numbers
    ends = n["from"], n["to"]
    return {
        "speed": n["speed"] if how.over else ends,
        "over": (how.over, *ends) if how.over else None,
        "period": int(n["period"]),
        "harmonics": int(n["harmonics"]),
        "share": n["share"],
        "step": n["length"],
        "branches": n["branches"] != 0,
    }
