"""A machine's runs as what a study runs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import NamedTuple

from ...errors import InputError
from ...fmi.binding import build_simulation
from ...fmi.interface import interface
from ...fmi.variables import Variable
from ...model.machine.rotor import Rotor
from ...model.machine.toml import parse_rotor
from ...model.march.tape import Record, recordable
from ...model.quantities import QuantityError
from ...model.settings import SettingsError
from ...model.simulation import EquilibriumError, Simulation, StepFailure
from ...model.spelling import Message
from ...runs.recording import Recording
from ...runs.status import FAILED, messages_and_codes, status_of
from ..study import Column, Result
from .driving import FREE, Drive, drive
from .keeping import KINDS, Keep, cells
from .watch import TAPE_ROWS, Watch

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

    @property
    def units(self) -> dict[str, str]:
        """What can be kept of a run, by name, and its unit."""
        table = machine_of(self.toml, self.is_free).table
        return {v.name: v.unit for v in table if v.is_observed}

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
        try:
            _, simulation = self._prepared({}, [], self._needs(False))
            speed = 0.0 if self.is_free else self.how.start["speed"]
            simulation.advance(1e-6, speed)
        except (InputError, EquilibriumError, StepFailure):
            return  # the runs will say so, each for itself

    def run(self, values: Mapping[str, float]) -> Result:
        """One run; what fails in it, impossible values included, is its status."""
        try:
            messages: list[Message] = []
            how, simulation = self._prepared(values, messages, self._needs(False))
            watch = Watch(simulation, self._needs(False), self._needs(True))
            windows = list(drive(simulation, how, watch))
        except StepFailure as error:
            return Result(f"{FAILED}{error}", {})
        except (InputError, QuantityError, SettingsError, EquilibriumError) as error:
            return Result(f"{FAILED}{error}", {})
        kept = {keep.name: cells(keep, windows, how) for keep in self.keeps}
        return Result(status_of(messages), kept)

    def record(self, values: Mapping[str, float]) -> Recording:
        """One run at its own steps, as far as it comes; the same run as its row's."""
        from ...runs.run_down import usual  # with FMPy, which no worker needs

        machine = machine_of(self.toml, self.is_free)
        names = ("phi", "w", *usual(machine.rotor), *self._needs(False), *self._needs(True))
        names = tuple(dict.fromkeys(names))
        messages: list[Message] = []
        how, simulation = self._prepared(values, messages, names)
        watch, failure = Watch(simulation, names, is_whole=True), None
        try:
            for _ in drive(simulation, how, watch):
                pass
        except StepFailure as error:
            failure = str(error)
        seen = watch.window().steps
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
        """The outputs that are kept of, at the solver's steps or by turns at equal angles."""
        chosen = (keep for keep in self.keeps if KINDS[keep.kind].in_turns == by_turns)
        return tuple(dict.fromkeys(name for keep in chosen for name in keep.needs))

    def _prepared(
        self, values: Mapping[str, float], messages: list[Message], recorded: Sequence[str]
    ) -> tuple[Drive, Simulation]:
        own = {name.removeprefix(RUN): v for name, v in values.items() if name.startswith(RUN)}
        of_machine = {name: v for name, v in values.items() if not name.startswith(RUN)}
        how = self.how.changed(own)
        machine = machine_of(self.toml, self.is_free)
        everything = {**machine.start, **how.start, **self.values, **of_machine}
        tape = Record(recorded, 0.0, TAPE_ROWS)
        return how, build_simulation(
            machine.rotor, machine.table, everything, messages.append, record=tape
        )
