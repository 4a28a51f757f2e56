"""A machine's runs as the subject of a study."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..fmi.binding import build_simulation
from ..fmi.interface import interface
from ..fmi.variables import Variable
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.message_templates import Message
from ..model.quantities import QuantityError
from ..model.settings import Settings, SettingsError
from ..model.simulation import EquilibriumError, Simulation, StepFailure
from ..model.time_loop.recorder import Record, recordable
from ..run_status import FAILED, messages_and_codes, status_of, with_doubt
from ..runs.recording import Recording
from ..runs.verify_run import NOT_CONFIRMED_CODE, allowed, finer
from ..studies.study import Cell, Column, Result
from .metric_cells import cells
from .metrics import KINDS, Metric
from .monitor import RECORDER_ROWS, Monitor
from .run_excitation import FREE, Excitation, excite

RUN = "run."
VERIFICATION = "verification"  # the column of a study whose runs are verified


class Machine(NamedTuple):
    """A machine as a worker keeps it: the rotor, its variables, their start values."""

    rotor: Rotor
    table: tuple[Variable, ...]
    start: Mapping[str, float]


@lru_cache(maxsize=4)
def machine_of(toml: str, is_free: bool) -> Machine:
    """Return the machine of a TOML text, made once in a process."""
    rotor = parse_rotor(toml)
    table = interface(rotor, is_free)
    return Machine(rotor, table, {v.name: v.start for v in table if v.start is not None})


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

    @property
    def is_free(self) -> bool:
        """Whether the rotor's speed is a state."""
        return self.how.kind in FREE

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a run by name, with their units."""
        table = machine_of(self.toml, self.is_free).table
        return {v.name: v.unit for v in table if v.is_observed}

    @cached_property
    def identity(self) -> str:
        """The machine, the run and the metrics, as text."""
        how = self.how
        signals = None
        if how.signals is not None:
            columns = {name: value.tolist() for name, value in how.signals.values.items()}
            signals = [how.signals.t.tolist(), columns]
        kick = None if how.kick is None else vars(how.kick)
        metrics = [[k.name, k.kind, k.of, k.options, k.scale] for k in self.metrics]
        identity = [
            self.toml,
            dict(self.values),
            how.kind,
            dict(how.numbers),
            signals,
            kick,
            metrics,
        ]
        identity += [VERIFICATION] if self.is_verified else []
        return json.dumps(identity, sort_keys=True)

    def warm(self) -> None:
        """Compile what runs need, or load it, by a start and a short step."""
        try:
            _, simulation = self._prepared({}, [], self._needs(False))
            speed = 0.0 if self.is_free else self.how.start["speed"]
            simulation.advance(1e-6, speed)
        except (InputError, EquilibriumError, StepFailure):
            return  # the runs will say so, each for itself

    def run(self, values: Mapping[str, float]) -> Result:
        """Make one run; a failure in it, impossible values included, is its status. A verified one
        has the largest difference of its metrics from the same run, solved more finely."""
        result, settings = self._run(values)
        if not self.is_verified or settings is None or result.status.startswith(FAILED):
            return result
        finer_result, _ = self._run({**values, **finer(settings)})
        if finer_result.status.startswith(FAILED):
            return Result(with_doubt(result.status, NOT_CONFIRMED_CODE), result.cells)
        difference = _difference(result.cells, finer_result.cells)
        is_near = difference <= allowed(settings)
        status = result.status if is_near else with_doubt(result.status, NOT_CONFIRMED_CODE)
        return Result(status, {**result.cells, VERIFICATION: difference})

    def _run(self, values: Mapping[str, float]) -> tuple[Result, Settings | None]:
        """Make one run; return it and its settings, None if it could not begin."""
        settings = None
        try:
            messages: list[Message] = []
            how, simulation = self._prepared(values, messages, self._needs(False))
            settings = simulation.settings
            has_exponent = any(metric.kind == "lyapunov" for metric in self.metrics)
            monitor = Monitor(
                simulation, self._needs(False), self._needs(True), has_exponent=has_exponent
            )
            windows = list(excite(simulation, how, monitor))
        except StepFailure as error:
            return Result(f"{FAILED}{error}", {}), settings
        except (InputError, QuantityError, SettingsError, EquilibriumError) as error:
            return Result(f"{FAILED}{error}", {}), settings
        row_cells = {metric.name: cells(metric, windows, how) for metric in self.metrics}
        return Result(status_of(messages), row_cells), settings

    def record(self, values: Mapping[str, float]) -> Recording:
        """Record one run at its own steps, up to its end or failure; the same run as its row's."""
        from ..runs.run_down import usual  # with FMPy, which no worker needs

        machine = machine_of(self.toml, self.is_free)
        names = ("phi", "w", *usual(machine.rotor), *self._needs(False), *self._needs(True))
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
        units = {str(entry.name): entry.output.unit for entry in recordable(machine.rotor)}
        about = {
            "machine": machine.rotor.name,
            "toml": self.toml,
            "parameters": {**self.values, **values},
            "run": {"kind": how.kind, **how.numbers},
            "status": status_of(messages, failure),
            **messages_and_codes(messages),
        }
        return Recording(seen.t, seen.columns, {name: units[name] for name in names}, about)

    def _needs(self, by_turns: bool) -> tuple[str, ...]:
        """Return the outputs that the metrics need, at the solver's steps or by turns at equal
        angles."""
        chosen = (metric for metric in self.metrics if KINDS[metric.kind].in_turns == by_turns)
        return tuple(dict.fromkeys(name for metric in chosen for name in metric.needs))

    def _prepared(
        self, values: Mapping[str, float], messages: list[Message], recorded: Sequence[str]
    ) -> tuple[Excitation, Simulation]:
        own = {name.removeprefix(RUN): v for name, v in values.items() if name.startswith(RUN)}
        of_machine = {name: v for name, v in values.items() if not name.startswith(RUN)}
        how = self.how.changed(own)
        machine = machine_of(self.toml, self.is_free)
        everything = {**machine.start, **how.start, **self.values, **of_machine}
        recorder = Record(recorded, 0.0, RECORDER_ROWS)
        return how, build_simulation(
            machine.rotor, machine.table, everything, messages.append, record=recorder
        )


def _difference(cells: Mapping[str, Cell], finer_cells: Mapping[str, Cell]) -> float:
    """Return the largest difference of what two runs have, of the size of each [1]; what neither
    has differs by nothing, what one has by all."""
    largest = 0.0
    for name, cell in cells.items():
        one, other = np.atleast_1d(cell), np.atleast_1d(finer_cells[name])
        if one.shape != other.shape or (np.isnan(one) != np.isnan(other)).any():
            return math.inf
        size = np.nanmax(np.abs(other), initial=0.0)
        apart = np.nanmax(np.abs(one - other), initial=0.0)
        largest = max(largest, float(apart / size) if size else float(apart > 0))
    return largest
