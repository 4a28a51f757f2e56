"""Linear answers as the subject of a study: a run is a machine at a speed and over a range of
speeds, and its metrics, a function a kind, are what its modes and its response to unbalance come
to."""

import math
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from ..errors import InputError, check_one_of, known_name
from ..model.machine.rotor import Rotor
from ..model.message_templates import Message
from ..model.parts.base import BASE
from ..run_status import FAILED, status_of
from ..studies.study import Column, Result
from .machine_runs import MachineRuns
from .metric import Metric, MetricKind, declared, is_whole
from .run_excitation import Excitation
from .run_kinds import Number, RunKind

if TYPE_CHECKING:
    from .linear_answers import LinearAnswers

KINDS: dict[str, MetricKind] = {}
_kind = partial(declared, KINDS)
LOG_DEC, FREQUENCY, SPEED = "log_dec", "frequency", "speed"
_UNITS = {LOG_DEC: "1", FREQUENCY: "rad/s", SPEED: "rad/s"}
_FIRST = {"number": 1.0}  # the default of an option


class _LinearKind(RunKind):
    """The kind of runs that are linear answers."""

    def check(self, values: Mapping[str, float]) -> None:
        """Raise `InputError` for values that the numbers cannot have, or not together."""
        super().check(values)
        if not 0 <= values["from"] < values["to"]:
            raise InputError(
                f"run.from = {values['from']:g} rad/s: must be >= 0 and below run.to = "
                f"{values['to']:g} rad/s"
            )


LINEAR = _LinearKind(
    "linear",
    {
        "speed": Number("rad/s", "rated", "speed of the modes, the response and the loads"),
        "from": Number("rad/s", 0.0, "lowest speed of the range"),
        "to": Number("rad/s", "trip", "highest speed of the range"),
    },
)


@dataclass(frozen=True)
class LinearRuns(MachineRuns):
    """Linear answers of a machine."""

    metric_kinds: ClassVar[Mapping[str, MetricKind]] = KINDS
    can_be_verified: ClassVar[bool] = False
    can_be_selected: ClassVar[bool] = False
    has_solver: ClassVar[bool] = False

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of modes and of critical speeds, with their units."""
        return _UNITS

    def check_metric(self, metric: Metric, how: Excitation) -> None:
        """Raise `InputError` for a metric that no machine, or not this one, has."""
        where, name = f"keep {metric.name}:", metric.kind.name
        if name in _OF:
            check_one_of(f"{where} {name} = {metric.of!r}", metric.of, _OF[name])
        elif name == "load":
            from ..model.linear.linear_machine import shared_machine

            known_name(where, metric.of, shared_machine(self.machine.rotor).supports.names)
        else:
            known_name(where, metric.of, places_of(self.machine.rotor))
        number = metric.option("number")
        if number is not None and not (is_whole(number) and number >= 1):
            raise metric.error(f"number = {number:g}: must be an integer, 1 or more")

    def column_of(self, metric: Metric, varied: Collection[str]) -> Column:
        """Return the column of a metric."""
        number = metric.option("number")
        shown = {} if number is None else {"number": f"{number:g}"}
        return metric.column(self.units.get(metric.of, "1"), None, **shown)

    def warm(self) -> None:
        """Load what linear answers need; what this machine lacks each run says in its row."""
        with suppress(InputError):
            _ = self.answers({}).modes

    def run(self, values: Mapping[str, float]) -> Result:
        """Compute one machine's answers; a failure, impossible values included, is its status."""
        try:
            answers = self.answers(values)
            cells = {metric.name: metric.kind.make(metric, answers) for metric in self.metrics}
            beyond = self._beyond(answers)
        except InputError as error:
            return Result(f"{FAILED}{error}", {})
        return Result(status_of(beyond), cells)

    def _beyond(self, answers: "LinearAnswers") -> list[Message]:
        """Return what is said of speeds beyond tables, of turbulent films, of discs that burst."""
        from ..linear.where_linearized import where_beyond_ranges

        over = {metric.kind.varying for metric in self.metrics}
        speeds = [answers.speed] if False in over else []
        speeds += answers.range[[0, -1]].tolist() if True in over else []
        return where_beyond_ranges(answers.rotor, speeds)

    def answers(self, values: Mapping[str, float]) -> "LinearAnswers":
        """Return the answers of a run. Raises `InputError` for impossible values."""
        from .linear_answers import LinearAnswers

        how, of_machine = self.split(values)
        n = how.numbers
        rotor = self.machine.rotor.with_values(of_machine)
        asked = (m.option("number") for m in self.metrics if m.kind.name == "mode")
        count = int(max(asked, default=0))
        return LinearAnswers(rotor, places_of(rotor), n["speed"], n["from"], n["to"], count)


def places_of(rotor: Rotor) -> dict[str, tuple[int, float]]:
    """Return the node (from 1) of each part that has one, and how far its place lies beyond [m], by
    the part's name."""
    beyond = {name: getattr(of, "offset", 0.0) for name, of in rotor.named_elements()}
    nodes = {name: getattr(part, "node", BASE) for name, part in rotor.named_parts()}
    return {name: (node, beyond.get(name, 0.0)) for name, node in nodes.items() if node != BASE}


# What a metric may be of, by its kind.
_OF = {
    "subsynchronous": (LOG_DEC, FREQUENCY),
    "mode": (LOG_DEC, FREQUENCY),
    "critical": (SPEED, LOG_DEC),
    "threshold": (SPEED,),
}


@_kind("{of} of the least damped whirl slower than run.speed, which pads that tilt follow")
def _subsynchronous(metric: Metric, answers: "LinearAnswers") -> float:
    return float(getattr(answers.slower, metric.of))


@_kind("{of} of mode {number} at run.speed, counted by natural frequency", optional=_FIRST)
def _mode(metric: Metric, answers: "LinearAnswers") -> float:
    found = answers.modes
    values = {LOG_DEC: found.log_dec, FREQUENCY: found.damped}[metric.of]
    return _at(values.tolist(), metric)


@_kind("{of} of critical speed {number} in the range", optional=_FIRST, varying=True)
def _critical(metric: Metric, answers: "LinearAnswers") -> float:
    """Return a critical speed, or its logarithmic decrement, critically damped ones left out."""
    field = {SPEED: "speed", LOG_DEC: "log_dec"}[metric.of]
    return _at([getattr(of, field) for of in answers.critical], metric)


@_kind("{of} from which on the machine is unstable, in the range", varying=True)
def _threshold(metric: Metric, answers: "LinearAnswers") -> float:
    """Return the threshold of stability, nan of a machine that is stable in the range."""
    found = answers.campbell.threshold
    return math.nan if found is None else found


@_kind("response of {of} to unbalance at run.speed, major semi-axis", unit="m")
def _amplitude(metric: Metric, answers: "LinearAnswers") -> float:
    return answers.orbit(metric.of)(answers.speed)


@_kind(
    "largest response of {of} to unbalance in the range, major semi-axis", unit="m", varying=True
)
def _peak(metric: Metric, answers: "LinearAnswers") -> float:
    return answers.peak(metric.of)


@_kind("load on {of} at rest, at run.speed", unit="N")
def _load(metric: Metric, answers: "LinearAnswers") -> float:
    return answers.loads[metric.of]


def _at(values: list[float], metric: Metric) -> float:
    """Return the value of the metric's number, from 1; nan where there are fewer."""
    number = int(metric.option("number"))
    return float(values[number - 1]) if number <= len(values) else math.nan
