"""An instance of the FMU as FMI 2.0.x has it: which call is allowed when, with which variables and
values, and what each does. A wrapper for a host goes around it.

The phases are the states of the standard's section 4.2.4. Where it leaves a choice: an instance
without setupExperiment starts at 0 s, without an end and with the preset's tolerance; values that
a host may set can be read in every phase; Integers and Booleans can be read as Reals too, as some
masters do with every output; a call that is refused changes nothing, so that the host may go on
after it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from enum import Enum

import numpy as np

from ..model.code import waits_for_compiler
from ..model.simulation import Simulation, StepFailure
from .binding import build_simulation
from .face import Face
from .state import pack, unpack
from .variables import Variable

# What a master's time may be off by, in communication steps: its round-off, its idea of the end.
_SLACK, _SLACK_AT_STOP = 1e-6, 1e-3
# Spacings of the floating-point numbers near t that a communication step has to span at least.
_RESOLVED = 100
# Variables that are instants: the model counts time from the start.
_INSTANTS = ("solver.trapped_at", "solver.overdamped_at")
_RECOVER = "reset the FMU, or set a state from before"
COMPILING = "compiling the solver, once on this machine: about half a minute"

Say = Callable[[str, str], None]
_said: set[str] = set()


class FmuError(RuntimeError):
    """A call that is refused: what it was, its value and what is allowed."""


class Phase(Enum):
    """Where in its life an instance is."""

    INSTANTIATED = "instantiated"
    INITIALIZING = "initializing"
    STEPPING = "stepping"
    FAILED = "failed"
    TERMINATED = "terminated"


class Instance:
    """One instance of the FMU.

    build: what identifies the FMU that a state belongs to; say(level, message) takes what the host
    is told beside errors, level `note` or `warning`. Methods raise `FmuError` for what is not
    allowed, and, of a model that cannot be, `QuantityError`, `SettingsError`, `EquilibriumError`,
    `StepFailure` and `StateError`.
    """

    def __init__(self, face: Face, build: str, say: Say) -> None:
        self._face = face
        self._build_name = build
        self._say = say
        self._values = [v.start if v.start is not None else 0.0 for v in face.table]
        self._of_kind = {
            kind: frozenset(i for i, v in enumerate(face.table) if v.kind == kind)
            for kind in ("Real", "Integer", "Boolean", "String")
        }
        self._readable = {**self._of_kind, "Real": frozenset(range(len(face.table)))}
        self._inputs = frozenset(i for i, v in enumerate(face.table) if v.causality == "input")
        self._loads = np.zeros(len(face.load_at) // 2, dtype=complex)
        self._load_parts = self._loads.view(float)
        self._phase = Phase.INSTANTIATED
        self._start_time, self._stop_time = 0.0, math.inf
        self._time = 0.0
        self._tolerance: float | None = None
        self._simulation: Simulation | None = None
        self._is_stale = True
        self._failure = ""
        self._warned: set[str] = set()

    # --- phases ------------------------------------------------------------------------------

    def setup_experiment(self, start: float, stop: float | None, tolerance: float | None) -> None:
        """Say when the simulation starts and, if known, ends [s], and its relative tolerance."""
        self._allow("setupExperiment", Phase.INSTANTIATED)
        if not math.isfinite(start):
            raise FmuError(f"setupExperiment: start time = {start:g} s: must be finite")
        if stop is not None and not stop >= start:
            raise FmuError(
                f"setupExperiment: stop time = {stop:g} s: must not lie before the start time, "
                f"{start:g} s"
            )
        if tolerance is not None and not 0 < tolerance <= 1:
            raise FmuError(f"setupExperiment: tolerance = {tolerance:g}: must be > 0 and at most 1")
        self._start_time = self._time = start
        self._stop_time = math.inf if stop is None else stop
        self._tolerance = tolerance

    def enter_initialization(self) -> None:
        """From here on the outputs can be read."""
        self._allow("enterInitializationMode", Phase.INSTANTIATED)
        self._phase = Phase.INITIALIZING

    def exit_initialization(self) -> None:
        """Build the simulation from the values that are set now."""
        self._allow("exitInitializationMode", Phase.INITIALIZING)
        self._refresh()
        self._phase = Phase.STEPPING

    def terminate(self) -> None:
        """End the simulation; its values stay readable."""
        self._allow("terminate", Phase.STEPPING, Phase.FAILED)
        self._phase = Phase.TERMINATED

    def _allow(self, call: str, *phases: Phase) -> None:
        if self._phase in phases:
            return
        reason = {
            Phase.INSTANTIATED: "the initialization has not begun",
            Phase.INITIALIZING: "the initialization has not ended",
            Phase.STEPPING: "the initialization has ended",
            Phase.FAILED: f"an earlier step failed ({self._failure}); {_RECOVER}",
            Phase.TERMINATED: f"the simulation was terminated; {_RECOVER}",
        }[self._phase]
        if self._phase is Phase.INITIALIZING and Phase.INSTANTIATED in phases:
            reason = "the initialization has begun"
        raise FmuError(f"{call}: {reason}")

    # --- steps -------------------------------------------------------------------------------

    def step(self, current: float, size: float) -> None:
        """March from the time `current` [s] over `size` [s]."""
        if self._phase is not Phase.STEPPING:
            self._allow("doStep", Phase.STEPPING)
        self._check_step(current, size)
        simulation, values = self._simulation, self._values
        assert simulation is not None  # the phase begins with one
        self._load_parts[:] = [values[i] for i in self._face.load_at]
        self._is_stale = True
        # until the step has ended, so that whatever ends it before is a failure
        self._phase, self._failure = Phase.FAILED, "interrupted"
        try:
            to = current - self._start_time + size
            simulation.advance(to, values[self._face.drive_at], self._loads)
        except StepFailure as error:
            self._failure = self._dated(str(error))
            raise StepFailure(self._failure) from error
        self._phase, self._failure = Phase.STEPPING, ""
        self._time = current + size

    def _check_step(self, current: float, size: float) -> None:
        now = self._time
        if not 0 < size < math.inf:
            raise FmuError(f"doStep over {size:g} s: the step must be > 0 and finite")
        spacing = math.ulp(max(abs(now), abs(now + size)))
        if size < _RESOLVED * spacing:
            raise FmuError(
                f"doStep over {size:g} s: near t = {now:.15g} s time is a multiple of "
                f"{spacing:.2g} s; the step must be at least {_RESOLVED * spacing:.2g} s"
            )
        if not abs(current - now) <= max(_SLACK * size, 2 * spacing):
            raise FmuError(
                f"doStep from {current:.15g} s: the FMU stands at {now:.15g} s; "
                "communication steps must follow each other without gap or overlap"
            )
        if current + size > self._stop_time + max(_SLACK_AT_STOP * size, 2 * spacing):
            raise FmuError(
                f"doStep to {current + size:.15g} s: past the stop time, {self._stop_time:.15g} s, "
                "that was given to setupExperiment"
            )

    def _dated(self, message: str) -> str:
        """A message of the model, which counts time from the start."""
        if self._start_time == 0 or " t = " not in f" {message}":
            return message
        return f"{message} (t from the start, {self._start_time:.15g} s)"

    # --- values ------------------------------------------------------------------------------

    def get(self, kind: str, references: Sequence[int]) -> list[float]:
        """Values of variables of one kind: Real, Integer, Boolean or String."""
        if not self._readable[kind].issuperset(references):
            raise self._wrong_reference("get", kind, references)
        if self._is_stale and references and max(references) >= self._face.observed_at:
            if self._phase is Phase.INSTANTIATED:
                name = self._face.table[max(references)].name
                raise FmuError(f"{name}: is computed, and not before the initialization begins")
            self._refresh()
        values = self._values
        return [values[reference] for reference in references]

    def set(self, kind: str, references: Sequence[int], values: Sequence[float]) -> None:
        """Set variables of one kind, all of them or, if one is refused, none."""
        if not self._of_kind[kind].issuperset(references):
            raise self._wrong_reference("set", kind, references)
        if not references:
            return
        if self._phase is not Phase.STEPPING:
            self._allow(f"set{kind}", Phase.INSTANTIATED, Phase.INITIALIZING, Phase.STEPPING)
        inputs = self._inputs
        for reference, value in zip(references, values, strict=True):
            if reference not in inputs or not -math.inf < value < math.inf:
                self._check(self._face.table[reference], value)
        for reference, value in zip(references, values, strict=True):
            self._values[reference] = value
        if self._phase is not Phase.STEPPING:
            self._simulation = None
            self._is_stale = True

    def _check(self, variable: Variable, value: float) -> None:
        """Refuse what may not be set now, or not to this value."""
        if not math.isfinite(value):
            raise FmuError(f"{variable.name} = {value}: must be a finite number")
        if variable.is_observed:
            raise FmuError(f"{variable.name}: is computed and cannot be set")
        if variable.causality == "parameter" and self._phase is Phase.STEPPING:
            raise FmuError(f"{variable.name}: a fixed parameter cannot be set after initialization")
        if variable.low is None or variable.high is None or variable.kind != "Integer":
            return
        if not variable.low <= value <= variable.high:
            raise FmuError(
                f"{variable.name} = {value}: must be an integer from {variable.low} to "
                f"{variable.high}"
            )

    def _wrong_reference(self, call: str, kind: str, references: Sequence[int]) -> FmuError:
        table = self._face.table
        allowed = self._readable if call == "get" else self._of_kind
        wrong = next(r for r in references if r not in allowed[kind])
        if 0 <= wrong < len(table):
            what = f"{table[wrong].name}: is of type {table[wrong].kind}"
        else:
            # a wrapper may hand over the unsigned number as a signed one
            what = f"value reference {wrong % 2**32}: there is none; they go to {len(table) - 1}"
        return FmuError(f"{call}{kind}: {what}")

    def _refresh(self) -> None:
        """Bring what the model computes up to date, building the model first if need be."""
        if not self._is_stale:
            return
        if self._simulation is None:
            self._simulation = self._build(self._values, self._tolerance)
        self._values[self._face.observed_at :] = self._simulation.observed.tolist()
        if self._start_time != 0:
            for name in _INSTANTS:
                at = self._face.index[name]
                if self._values[at] >= 0:
                    self._values[at] += self._start_time
        self._is_stale = False

    def _build(self, values: Sequence[float], tolerance: float | None) -> Simulation:
        if COMPILING not in _said and waits_for_compiler():
            _said.add(COMPILING)
            self._say("note", COMPILING)
        named = dict(zip(self._face.index, values, strict=True))
        return build_simulation(self._face.rotor, self._face.table, named, self._warn, tolerance)

    def _warn(self, message: str) -> None:
        """Say what makes the run doubtful, once, however often the model is built anew."""
        if message not in self._warned:
            self._warned.add(message)
            self._say("warning", self._dated(message))

    # --- state -------------------------------------------------------------------------------

    def state(self) -> bytes:
        """Everything that `restore` needs to go on from here, bit for bit."""
        simulation = self._simulation
        about = {
            "values": self._values,
            "start_time": self._start_time,
            "stop_time": None if self._stop_time == math.inf else self._stop_time,
            "time": self._time,
            "tolerance": self._tolerance,
            "phase": self._phase.value,
            "is_built": simulation is not None,
            "failure": self._failure,
        }
        return pack(self._build_name, about, [simulation.snapshot()] if simulation else ())

    def restore(self, state: bytes) -> None:
        """Go back to a state of this instance or of another one of the same FMU."""
        about, chunks = unpack(self._build_name, state)
        simulation = None
        if about["is_built"]:
            fixed = [i for i, v in enumerate(self._face.table) if v.causality == "parameter"]
            is_same = about["tolerance"] == self._tolerance and all(
                about["values"][i] == self._values[i] for i in fixed
            )
            simulation = self._simulation if is_same else None
            if simulation is None:
                simulation = self._build(about["values"], about["tolerance"])
            simulation.restore(chunks[0])
        self._simulation = simulation
        self._values = about["values"]
        self._start_time = about["start_time"]
        self._stop_time = math.inf if about["stop_time"] is None else about["stop_time"]
        self._time = about["time"]
        self._tolerance = about["tolerance"]
        self._phase = Phase(about["phase"])
        self._failure = about["failure"]
        self._is_stale = True
