"""A machine's runs as what a study runs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..fmu.binding import build_simulation
from ..fmu.interface import interface
from ..fmu.variables import Variable
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.quantities import QuantityError
from ..model.settings import SettingsError
from ..model.simulation import EquilibriumError, Simulation, StepFailure
from ..runs.recording import Recording
from .driving import FREE, Drive, Window, drive
from .keeping import Keep, cells
from .study import FAILED, OK, Column, Result

RUN = "run."


class Machine(NamedTuple):
    """A machine as a worker keeps it: the rotor, its variables, their start values."""

    rotor: Rotor
    table: tuple[Variable, ...]
    start: Mapping[str, float]


@lru_cache(maxsize=4)
def machine_of(toml: str, is_free: bool) -> Machine:
    """The machine of a TOML text, made once in a process."""
    rotor = parse_rotor(toml)
    table = interface(rotor, is_free)
    return Machine(rotor, table, {v.name: v.start for v in table if v.start is not None})


@dataclass(frozen=True)
class MachineRuns:
    """Runs of a machine: its TOML, values that are the same in all runs, how it is driven, and what
    is kept."""

    toml: str
    values: Mapping[str, float]
    how: Drive
    keeps: tuple[Keep, ...]
    columns: tuple[Column, ...] = field(default=())

    @property
    def is_free(self) -> bool:
        """Whether the rotor's speed is a state."""
        return self.how.kind in FREE

    @cached_property
    def identity(self) -> str:
        """The machine, the run and what is kept, as text."""
        how = self.how
        signals = None
        if how.signals is not None:
            columns = {name: value.tolist() for name, value in how.signals.values.items()}
            signals = [how.signals.t.tolist(), columns]
        kick = None if how.kick is None else vars(how.kick)
        keeps = [[k.name, k.kind, k.of, k.options, k.scale] for k in self.keeps]
        told = [self.toml, dict(self.values), how.kind, dict(how.numbers), signals, kick, keeps]
        return json.dumps(told, sort_keys=True)

    def warm(self) -> None:
        """Compile what runs need, or load it, by a start and a short step."""
        machine = machine_of(self.toml, self.is_free)
        try:
            simulation = self._begin(machine, self.how, self.values, [])
            speed = 0.0 if self.is_free else self.how.start["speed"]
            simulation.advance(1e-6, speed)
        except (InputError, EquilibriumError, StepFailure):
            return  # the runs will say so, each for itself

    def run(self, values: Mapping[str, float]) -> Result:
        """One run; what fails in it, impossible values included, is its status."""
        try:
            how, simulation = self._prepared(values, [])
            windows = list(drive(simulation, how, self._sampled))
        except StepFailure as error:
            return Result(f"{FAILED}{error}", {})
        except (InputError, QuantityError, SettingsError, EquilibriumError) as error:
            return Result(f"{FAILED}{error}", {})
        kept = {keep.name: cells(keep, windows, how) for keep in self.keeps}
        return Result(status_of(simulation), kept)

    def record(self, values: Mapping[str, float]) -> Recording:
        """One run with all that can be read, as far as it comes."""
        messages: list[str] = []
        how, simulation = self._prepared(values, messages)
        names = simulation.names
        windows: list[Window] = []
        status = ""
        try:
            windows += drive(simulation, how, names)
        except StepFailure as error:
            status = f"{FAILED}{error}"
        units = {v.name: v.unit for v in machine_of(self.toml, self.is_free).table}
        about = {
            "parameters": dict(values),
            "status": status or status_of(simulation),
            "messages": messages,
            "toml": self.toml,
            "run": {"kind": how.kind, **how.numbers},
        }
        t = np.concatenate([w.t for w in windows]) if windows else np.zeros(0)
        columns = {
            name: np.concatenate([w.columns[name] for w in windows]) if windows else np.zeros(0)
            for name in names
        }
        return Recording(t, columns, {name: units[name] for name in names}, about)

    @property
    def _sampled(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(name for keep in self.keeps for name in keep.needs))

    def _prepared(
        self, values: Mapping[str, float], messages: list[str]
    ) -> tuple[Drive, Simulation]:
        own = {name.removeprefix(RUN): v for name, v in values.items() if name.startswith(RUN)}
        of_machine = {name: v for name, v in values.items() if not name.startswith(RUN)}
        how = self.how.changed(own)
        machine = machine_of(self.toml, self.is_free)
        return how, self._begin(machine, how, {**self.values, **of_machine}, messages)

    def _begin(
        self, machine: Machine, how: Drive, values: Mapping[str, float], messages: list[str]
    ) -> Simulation:
        everything = {**machine.start, **how.start, **values}
        return build_simulation(machine.rotor, machine.table, everything, messages.append)


def status_of(simulation: Simulation) -> str:
    """How much a run that came to its end is to be trusted."""
    if simulation.read("solver.trapped") > 0:
        return "false state"
    since = simulation.read("solver.overdamped_at")
    return f"overdamped since {since:.4g} s" if since >= 0 else OK
