"""The FMI 2.0 slave: a thin skin over `model.simulation.Simulation`."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from pythonfmu import (
    Boolean,
    DefaultExperiment,
    Fmi2Causality,
    Fmi2Initial,
    Fmi2Slave,
    Fmi2Variability,
    Integer,
    Real,
)
from pythonfmu.enums import Fmi2Status

from ..about import RELEASED, __version__
from ..model.kernels.compiled import has_to_compile
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor, rig_toml
from ..model.march import entries
from ..model.quantities import QuantityError
from ..model.settings import Settings, SettingsError
from ..model.simulation import EquilibriumError, Simulation, StepFailure
from .binding import build_simulation, load_names
from .description import complete, guid
from .interface import interface
from .state import StateError, pack, unpack
from .variables import Variable
from .wrapper import hold, settle_exit

# What the master may be off in its time, of a step or absolutely [s].
_TIME_TOLERANCE = 1e-9
# In an FMU's resources: the rotor as TOML, and what drives it, speed or torque.
ROTOR_FILE, DRIVE_FILE = "rotor.toml", "drive.txt"
_KINDS = {"Real": Real, "Integer": Integer, "Boolean": Boolean}


class FmuError(RuntimeError):
    """What the host is told when a call cannot be carried out."""

    def __repr__(self) -> str:
        """The sentence alone: the wrapper logs the representation."""
        return str(self)


# Errors whose message says all; of any other the kind is named too.
_PLAIN = (FmuError, QuantityError, SettingsError, EquilibriumError, StepFailure, StateError)
INTERRUPTED = "interrupted by the user"
COMPILING = "compiling the solver, once on this machine: about half a minute"

_said: set[str] = set()


@dataclass(frozen=True)
class Face:
    """What an FMU's rotor makes of it: the rotor, its variables, and where they stand."""

    toml: str
    rotor: Rotor
    table: tuple[Variable, ...]
    index: dict[str, int]
    inputs: frozenset[int]

    @property
    def observed_at(self) -> int:
        """Where the variables begin that the model computes."""
        return next(i for i, variable in enumerate(self.table) if variable.is_observed)


@cache
def face(toml: str, is_free: bool) -> Face:
    """The face of an FMU with this rotor, made once for all its instances."""
    rotor = parse_rotor(toml)
    table = interface(rotor, is_free)
    index = {variable.name: i for i, variable in enumerate(table)}
    inputs = frozenset(i for i, variable in enumerate(table) if variable.causality == "input")
    return Face(toml, rotor, table, index, inputs)


_texts_read: dict[Path, str] = {}


def _resource(resources: str | None, name: str, otherwise: Callable[[], str]) -> str:
    """Text of a file in an FMU's resources, or `otherwise()` without an FMU. It is remembered,
    since a reset makes the instance anew and the folder may be gone by then."""
    if resources is None:
        return otherwise()
    file = Path(resources, name)
    if file.is_file() or file not in _texts_read:
        _texts_read[file] = file.read_text(encoding="utf-8")
    return _texts_read[file]


class RotorBearing(Fmi2Slave):
    """A flexible rotor that rubs in clearance bearings, driven by its speed or by a torque.

    One class for both: pythonfmu's wrapper finds direct subclasses of its own only.
    """

    author = "The rotor-fmu authors"
    license = "MIT"
    version = __version__
    copyright = "The rotor-fmu authors"

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        is_free = _resource(self.resources, DRIVE_FILE, lambda: "speed") == "torque"
        self.modelName = "RotorBearingFree" if is_free else "RotorBearing"
        self.description = (
            "Flexible rotor with discs that rubs in two clearance bearings with dry friction, "
            f"driven by {'a torque' if is_free else 'its speed'}"
        )
        settle_exit(self.resources, self.modelName)
        self._face = face(_resource(self.resources, ROTOR_FILE, rig_toml), is_free)
        self._table = self._face.table
        self._observed_at = self._face.observed_at
        self._drive_at = self._face.index["tau_drive" if is_free else "speed"]
        self._load_at = [self._face.index[n] for pair in load_names(self._face.rotor) for n in pair]
        self._loads = np.zeros(len(self._load_at) // 2, dtype=complex)
        self._load_parts = self._loads.view(float)
        self._values = [v.start if v.start is not None else 0.0 for v in self._table]
        self.guid = guid(self._table, f"{Path(__file__).parents[1].name} {self._face.toml}")
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=40.0, step_size=0.04, tolerance=Settings.tolerance
        )
        self._simulation: Simulation | None = None
        self._start_time = 0.0
        self._tolerance: float | None = None
        self._is_initializing = False
        self._is_running = False
        self._is_stale = False
        self._failure = ""
        for index, variable in enumerate(self._table):
            self.register_variable(self._fmi_variable(index, variable))

    def _fmi_variable(self, index: int, variable: Variable) -> Real | Integer | Boolean:
        is_parameter = variable.causality == "parameter"
        if is_parameter:
            variability = Fmi2Variability.fixed
        elif variable.kind == "Real":
            variability = Fmi2Variability.continuous
        else:
            variability = Fmi2Variability.discrete
        return _KINDS[variable.kind](
            variable.name,
            causality=Fmi2Causality[variable.causality],
            variability=variability,
            initial=Fmi2Initial.exact
            if is_parameter
            else Fmi2Initial.calculated
            if variable.is_observed
            else None,
            description=variable.text,
            getter=lambda: self._values[index],
            setter=lambda value: self._set([index], [value]),
        )

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """The model description, completed from the variable table."""
        return complete(super().to_xml(model_options or {}), self._table, RELEASED)

    # --- life of an instance -----------------------------------------------------------------

    def setup_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Remember when the simulation starts [s] and its relative tolerance [1]."""
        self._start_time = start_time
        self._tolerance = tolerance

    def enter_initialization_mode(self) -> None:
        """From here on the outputs can be read."""
        self._is_initializing = True
        self._is_stale = True

    def exit_initialization_mode(self) -> None:
        """Build the simulation from the values that are set now."""
        self._guard(self._refresh)
        self._is_initializing = False
        self._is_running = True

    def do_step(self, current_time: float, step_size: float) -> bool:
        """March from current_time [s] over step_size [s]."""
        self._guard(self._march, current_time, step_size)
        return True

    def _march(self, current_time: float, step_size: float) -> None:
        simulation = self._simulation
        if simulation is None or not self._is_running:
            raise FmuError("doStep: the initialization has not ended")
        if self._failure:
            raise FmuError(
                f"doStep: an earlier step failed ({self._failure}); reset the FMU, or set a state "
                "from before"
            )
        slack = _TIME_TOLERANCE * max(1.0, abs(current_time))
        if not abs(current_time - simulation.time) <= slack:
            raise FmuError(
                f"doStep from {current_time:.9g} s: the FMU stands at {simulation.time:.9g} s; "
                "communication steps must follow each other without gap or overlap"
            )
        if not (step_size > 0 and math.isfinite(step_size)):
            raise FmuError(f"doStep over {step_size:g} s: the step must be > 0")
        values = self._values
        self._load_parts[:] = [values[i] for i in self._load_at]
        self._is_stale = True
        try:
            simulation.advance(current_time + step_size, values[self._drive_at], self._loads)
        except StepFailure as error:
            self._failure = str(error)
            raise

    # --- state -------------------------------------------------------------------------------

    def _get_fmu_state(self) -> bytes:
        simulation = self._simulation
        about = {
            "values": self._values,
            "start_time": self._start_time,
            "tolerance": self._tolerance,
            "is_initializing": self._is_initializing,
            "is_running": self._is_running,
            "is_built": simulation is not None,
            "failure": self._failure,
        }
        return pack(str(self.guid), about, [simulation.snapshot()] if simulation else ())

    def _set_fmu_state(self, state: bytes) -> None:
        self._guard(self._restore, state)

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        # checked when it is set: here the host could not be told
        return state

    def _restore(self, state: bytes) -> None:
        about, chunks = unpack(str(self.guid), state)
        fixed = [i for i, v in enumerate(self._table) if v.causality == "parameter"]
        is_same = about["tolerance"] == self._tolerance and all(
            about["values"][i] == self._values[i] for i in fixed
        )
        self._values = about["values"]
        self._start_time = about["start_time"]
        self._tolerance = about["tolerance"]
        self._is_initializing = about["is_initializing"]
        self._is_running = about["is_running"]
        self._failure = about["failure"]
        self._is_stale = True
        if not about["is_built"]:
            self._simulation = None
            return
        if self._simulation is None or not is_same:
            self._simulation = self._build()
        self._simulation.restore(chunks[0])

    # --- values ------------------------------------------------------------------------------

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Real variables."""
        self._guard(self._refresh)
        values = self._values
        return [values[vr] for vr in vrs]

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Values of Integer variables."""
        return [int(value) for value in self.get_real(vrs)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Values of Boolean variables."""
        return [bool(value) for value in self.get_real(vrs)]

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real variables."""
        self._guard(self._set, vrs, values)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer variables."""
        self._guard(self._set, vrs, values)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean variables."""
        self._guard(self._set, vrs, values)

    def _set(self, vrs: list[int], values: list[float]) -> None:
        inputs = self._face.inputs
        for vr, value in zip(vrs, values, strict=True):
            if vr in inputs and -math.inf < value < math.inf:
                self._values[vr] = value
                continue
            variable = self._table[vr]
            if not math.isfinite(value):
                raise FmuError(f"{variable.name} = {value}: must be a finite number")
            if variable.causality == "parameter" and self._is_running:
                raise FmuError(
                    f"{variable.name}: a fixed parameter cannot be set after initialization"
                )
            if variable.is_observed:
                raise FmuError(f"{variable.name}: is computed and cannot be set")
            if variable.choices and not 0 <= value < len(variable.choices):
                highest = len(variable.choices) - 1
                raise FmuError(f"{variable.name} = {value}: must be an integer from 0 to {highest}")
            self._values[vr] = value
        if not self._is_running:
            self._simulation = None
            self._is_stale = True

    def _refresh(self) -> None:
        """Bring what the model computes up to date, building the model first if need be."""
        if not self._is_stale or not (self._is_initializing or self._is_running):
            return
        if self._simulation is None:
            self._simulation = self._build()
        self._values[self._observed_at :] = self._simulation.observed.tolist()
        self._is_stale = False

    def _build(self) -> Simulation:
        if COMPILING not in _said and has_to_compile(entries.advance):
            _said.add(COMPILING)
            self.log(self._say("note", COMPILING), Fmi2Status.ok)
        values = dict(zip(self._face.index, self._values, strict=True))
        rotor = self._face.rotor
        return build_simulation(
            rotor, self._table, values, self._start_time, self._warn, self._tolerance
        )

    # --- what goes wrong ---------------------------------------------------------------------

    def _guard(self, call: Callable[..., object], *arguments: object) -> None:
        """Carry out a call; on failure tell the host in one plain sentence.

        The wrapper hands queued messages to the host's logger, which may itself be Python, while
        the exception is pending: so the queue is emptied, and the exception is the message.
        """
        try:
            call(*arguments)
        except BaseException as error:  # whatever leaves here unheld would crash the host
            if isinstance(error, KeyboardInterrupt):
                reason = INTERRUPTED
            elif isinstance(error, _PLAIN):
                reason = str(error)
            else:
                reason = f"internal error, {type(error).__name__}: {error}"
            message = self._say("error", reason)
            self.log_queue.clear()
            hold(self, self.log_queue, type(self))
            raise FmuError(message) from None

    def _warn(self, message: str) -> None:
        self.log(self._say("warning", message), Fmi2Status.warning)

    def _say(self, level: str, message: str) -> str:
        """Print a message, since hosts drop them unless logging was switched on; returns it in one
        line and without percent signs, which the host's logger would read as a printf format."""
        plain = " ".join(message.replace("%", " percent").split())
        print(f"{self.instance_name}: {level}: {plain}", file=sys.stderr, flush=True)
        return plain
