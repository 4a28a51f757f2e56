"""A machine's runs as the subject of a study."""

import json
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..errors import InputError, meant
from ..fmi.binding import build_simulation
from ..fmi.interface import interface, parameter_variable
from ..fmi.variables import Variable, start_values
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.message_templates import Message
from ..model.settings import Settings
from ..model.simulation import Simulation, StepFailure
from ..model.time_loop.recorder import Record, recordable
from ..run_status import FAILED, has_failed, messages_and_codes, not_confirmed, status_of
from ..runs.recording import Recording
from ..runs.run_down import RECORDER_ROWS, usual
from ..runs.settings_text import as_set
from ..runs.verify_run import STILL, allowed, finer
from ..studies.study import Cell, Column, Result
from . import run_metrics
from .metric import Metric, MetricKind
from .run_excitation import Excitation, Monitor, Window, excite

RUN = "run."
VERIFICATION = "verification"  # the column of a study whose runs are verified
# Variables that follow from the excitation.
_OF_THE_EXCITATION = ("speed", "speed_rate", "speed_continuation", "w_start", "tau_drive")


class MachineModel(NamedTuple):
    """A machine as a worker keeps it: the rotor, its variables, their start values."""

    rotor: Rotor
    table: tuple[Variable, ...]
    start: Mapping[str, float]

    @property
    def units(self) -> dict[str, str]:
        """Units of the numbers of the machine itself, by name."""
        return {name: of.quantity.unit for name, of in self.rotor.numbers().items()}


@lru_cache(maxsize=4)
def machine_of(toml: str, is_free: bool) -> MachineModel:
    """Return the machine of a TOML text, made once in a process."""
    rotor = parse_rotor(toml)
    table = interface(rotor, is_free)
    return MachineModel(rotor, table, start_values(table))


@dataclass(frozen=True)
class MachineRuns:
    """Runs of a machine: its TOML, values that are the same in all runs, the excitation, the
    metrics, and whether each is compared with the same run, solved more finely."""

    toml: str
    values: Mapping[str, float]
    how: Excitation
    metrics: tuple[Metric, ...]
    columns: tuple[Column, ...] = field(default=())
    is_verified: bool = False

    metric_kinds: ClassVar[Mapping[str, MetricKind]] = run_metrics.KINDS
    can_be_verified: ClassVar[bool] = True
    can_be_selected: ClassVar[bool] = True
    has_solver: ClassVar[bool] = True  # of runs in time, whose settings may be varied

    @property
    def machine(self) -> MachineModel:
        """The machine that runs."""
        return machine_of(self.toml, self.how.kind.is_free)

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a run by name, with their units."""
        return {v.name: v.unit for v in self.machine.table if v.is_observed}

    @property
    def settable(self) -> dict[str, Variable]:
        """Return what may be set or varied, by name: parameters of the FMU, and the machine's other
        numbers."""
        table = self.machine.table if self.has_solver else ()
        known = [v for v in table if v.causality == "parameter"]
        rotor = as_set(self.machine.rotor, self.own_numbers({}))
        numbers = [parameter_variable(*of) for of in rotor.numbers().values()]
        by_name = {v.name: v for v in (*known, *numbers)}
        return {name: v for name, v in by_name.items() if name not in _OF_THE_EXCITATION}

    def own_numbers(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return the machine's own numbers of the values of all runs and others."""
        own = self.machine.units
        return {n: v for n, v in {**self.values, **values}.items() if n in own}

    @property
    def variable_units(self) -> dict[str, str]:
        """Return the units of all that can be varied, by name."""
        numbers = {f"{RUN}{name}": self.how.kind.numbers[name].unit for name in self.how.numbers}
        return {name: v.unit or "1" for name, v in self.settable.items()} | numbers

    def check_metric(self, metric: Metric, how: Excitation) -> None:
        """Raise `InputError` for a metric that does not suit the runs."""
        run_metrics.check(metric, how)
        if metric.kind.name == "lyapunov":
            # with SciPy, which other studies do without
            from ..model.periodic.problem import check_parts

            check_parts(self.machine.rotor)
        for output in metric.kind.samples(metric.of):
            if output not in self.units:
                raise metric.error(f"{metric.of}: unknown name; {self._suggestion(metric, output)}")

    def _suggestion(self, metric: Metric, output: str) -> str:
        """Return a suggestion for the name of an unknown quantity or part."""
        if output.startswith(f"{metric.of}."):
            end = output.removeprefix(metric.of)
            return meant(metric.of, [n.removesuffix(end) for n in self.units if n.endswith(end)])
        radii = (f"{name[:-1]}r" for name in self.units if name.endswith(".x"))
        return meant(metric.of, {*self.units, *radii})

    def column_of(self, metric: Metric, varied: Collection[str]) -> Column:
        """Return the column of a metric; varied: names of the parameters that are varied."""
        unit = self.units.get(metric.of, self.units.get(f"{metric.of.removesuffix('.r')}.x", "1"))
        is_varied = not {f"{RUN}from", f"{RUN}to"}.isdisjoint(varied)
        return metric.column(unit, run_metrics.axis_of(metric, self.how, is_varied))

    @cached_property
    def identity(self) -> str:
        """The machine, the run and the metrics, as text."""
        how = self.how
        signals = None
        if how.signals is not None:
            columns = {name: value.tolist() for name, value in how.signals.values.items()}
            signals = [how.signals.t.tolist(), columns]
        kick = None if how.kick is None else vars(how.kick)
        metrics = [[k.name, k.kind.name, k.of, k.options] for k in self.metrics]
        identity = [self.toml, dict(self.values), how.kind.name, dict(how.numbers), signals, kick]
        identity += [metrics, VERIFICATION] if self.is_verified else [metrics]
        return json.dumps(identity, sort_keys=True)

    def warm(self) -> None:
        """Compile what runs need, or load it, by a start and a short step."""
        try:
            _, simulation = self._prepared({}, [], self.samples(False))
            speed = 0.0 if self.how.kind.is_free else self.how.start["speed"]
            simulation.advance(1e-6, speed)
        except (InputError, StepFailure):
            return  # which each run reports in its own row

    def run(self, values: Mapping[str, float]) -> Result:
        """Make one run; a failure in it, impossible values included, is its status. A verified one
        has the largest difference of its metrics from the same run, solved more finely."""
        result, settings, least = self._run(values)
        if not self.is_verified or settings is None or has_failed(result.status):
            return result
        finer_result, *_ = self._run({**values, **finer(settings)})
        if has_failed(finer_result.status):
            return Result(not_confirmed(result.status), result.cells)
        directions = {metric.name for metric in self.metrics if metric.is_direction}
        difference = _difference(result.cells, finer_result.cells, least, directions)
        is_near = difference <= allowed(settings)
        status = result.status if is_near else not_confirmed(result.status)
        return Result(status, {**result.cells, VERIFICATION: difference})

    def _run(
        self, values: Mapping[str, float]
    ) -> tuple[Result, Settings | None, Mapping[str, float]]:
        """Make one run; return it, its settings, None if it could not begin, and the least sizes of
        its cells, to which their differences are relative."""
        settings = None
        try:
            messages: list[Message] = []
            how, simulation = self._prepared(values, messages, self.samples(False))
            settings = simulation.settings
            has_exponent = any(metric.kind.name == "lyapunov" for metric in self.metrics)
            samples = self.samples(False), self.samples(True)
            monitor = Monitor(simulation, *samples, has_exponent=has_exponent)
            windows = list(excite(simulation, how, monitor))
        except (InputError, StepFailure) as error:
            return Result(f"{FAILED}{error}", {}), settings, {}
        still, units = STILL * self.machine.rotor.length, {c.name: c.unit for c in self.columns}
        least = {m.name: m.least_size(windows, units[m.name], still) for m in self.metrics}
        return Result(status_of(messages), self.cells_of(windows, how)), settings, least

    def cells_of(self, windows: list[Window], how: Excitation) -> dict[str, Cell]:
        """Return the cells of a finished run by the names of their columns."""
        return {metric.name: run_metrics.cell(metric, windows, how) for metric in self.metrics}

    def record(self, values: Mapping[str, float]) -> Recording:
        """Record one run at its own steps, up to its end or failure; the same run as its row's."""
        rotor = self.machine.rotor
        names = ("phi", "w", *usual(rotor), *self.samples(False), *self.samples(True))
        names = tuple(dict.fromkeys(names))
        messages: list[Message] = []
        how, simulation = self._prepared(values, messages, names)
        monitor, failure = Monitor(simulation, names, is_whole=True), None
        try:
            for _ in excite(simulation, how, monitor):
                pass
        except StepFailure as error:
            failure = str(error)
        seen = monitor.window().steps
        units = {str(entry.name): entry.output.unit for entry in recordable(rotor)}
        about = self.description(values, how, messages, failure)
        return Recording(seen.t, seen.columns, {name: units[name] for name in names}, about)

    def description(
        self,
        values: Mapping[str, float],
        how: Excitation,
        messages: Sequence[Message],
        failure: str | None,
    ) -> dict[str, Any]:
        """Return the description of a run for its recording."""
        return {
            "machine": self.machine.rotor.name,
            "toml": self.toml,
            "parameters": {**self.values, **values},
            "parameter_units": {n: unit for n, unit in self.variable_units.items() if n in values},
            "loads": how.ranges_of_loads,
            "run": {"kind": how.kind.name, **how.numbers},
            "status": status_of(messages, failure),
            **messages_and_codes(messages),
        }

    def samples(self, in_turns: bool) -> tuple[str, ...]:
        """Return the outputs that the metrics need, at the solver's steps or at equal angles."""
        chosen = [m for m in self.metrics if bool(m.kind.held) == in_turns]
        return tuple(dict.fromkeys(name for m in chosen for name in m.kind.samples(m.of)))

    def split(self, values: Mapping[str, float]) -> tuple[Excitation, dict[str, float]]:
        """Return the excitation of a run, and the values of the machine's variables, of the values
        of the varied parameters."""
        of_run = {name.removeprefix(RUN): v for name, v in values.items() if name.startswith(RUN)}
        of_machine = {name: v for name, v in values.items() if not name.startswith(RUN)}
        return self.how.changed(of_run), {**self.values, **of_machine}

    def _prepared(
        self, values: Mapping[str, float], messages: list[Message], recorded: Sequence[str]
    ) -> tuple[Excitation, Simulation]:
        how, of_machine = self.split(values)
        machine, record = self.machine, Record(recorded, 0.0, RECORDER_ROWS)
        everything = {**machine.start, **how.start, **of_machine}
        return how, build_simulation(
            machine.rotor, machine.table, everything, messages.append, record=record
        )


def _difference(
    cells: Mapping[str, Cell],
    finer_cells: Mapping[str, Cell],
    least: Mapping[str, float],
    directions: Collection[str],
) -> float:
    """Return the largest difference of two runs' cells, relative to the size of each, which is at
    least `least`, of directions to a radian [1]; infinite where only one run has a value."""
    largest = 0.0
    for name, cell in cells.items():
        one, other = np.atleast_1d(cell), np.atleast_1d(finer_cells[name])
        if one.shape != other.shape or (np.isnan(one) != np.isnan(other)).any():
            return math.inf
        size = np.nanmax(np.abs(other), initial=least[name])
        apart = np.nanmax(np.abs(one - other), initial=0.0)
        if name in directions:
            size, apart = 1.0, np.nanmax(np.abs(np.exp(1j * one) - np.exp(1j * other)), initial=0.0)
        largest = max(largest, float(apart / size) if size else float(apart > 0))
    return largest
