"""The FMI 2.0 slave: pythonfmu's thin skin over `instance.Instance`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TypeVar
from xml.etree.ElementTree import Element

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
from ..model.code import chosen
from ..model.machine.toml import rig_toml
from ..model.quantities import QuantityError
from ..model.settings import Settings, SettingsError
from ..model.simulation import EquilibriumError, StepFailure
from .description import complete, guid
from .face import face
from .instance import FmuError, Instance
from .state import StateError
from .variables import Variable
from .wrapper import HeldFromLookUp, hold, settle_exit

# In an FMU's resources: the rotor as TOML, and what drives it, speed or torque.
ROTOR_FILE, DRIVE_FILE = "rotor.toml", "drive.txt"
# Now, since the FMU's folder may be gone when the first run begins.
chosen()
_KINDS = {"Real": Real, "Integer": Integer, "Boolean": Boolean}
_LEVELS = {"note": Fmi2Status.ok, "warning": Fmi2Status.warning}
# Errors whose message says all; of any other the kind is named too.
_PLAIN = (FmuError, QuantityError, SettingsError, EquilibriumError, StepFailure, StateError)
INTERRUPTED = "interrupted by the user"

Result = TypeVar("Result")


class CallFailed(RuntimeError):
    """What the host is told when a call cannot be carried out."""

    def __repr__(self) -> str:
        """The sentence alone: the wrapper logs the representation."""
        return str(self)


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


class RotorBearing(Fmi2Slave):  # type: ignore[misc]  # pythonfmu has no types
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
        rotor = face(_resource(self.resources, ROTOR_FILE, rig_toml), is_free)
        self._table = rotor.table
        self.guid = guid(self._table, f"{Path(__file__).parents[1].name} {rotor.toml}")
        self.default_experiment = DefaultExperiment(
            start_time=0.0, stop_time=40.0, step_size=0.04, tolerance=Settings.tolerance
        )
        self._instance = Instance(rotor, str(self.guid), self._tell)

    def to_xml(self, model_options: dict[str, str] | None = None) -> Element:
        """The model description, completed from the variable table."""
        for variable in self._table:
            self.register_variable(_registered(variable))
        return complete(super().to_xml(model_options or {}), self._table, RELEASED)

    # --- life of an instance -----------------------------------------------------------------

    def setup_experiment(
        self, start_time: float, stop_time: float | None, tolerance: float | None
    ) -> None:
        """Take the start and the stop time [s] and the relative tolerance [1]."""
        self._guard(self._instance.setup_experiment, start_time, stop_time, tolerance)

    def enter_initialization_mode(self) -> None:
        """Begin the initialization."""
        self._guard(self._instance.enter_initialization)

    def exit_initialization_mode(self) -> None:
        """End the initialization."""
        self._guard(self._instance.exit_initialization)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """March from current_time [s] over step_size [s]."""
        self._guard(self._instance.step, current_time, step_size)
        return True

    def terminate(self) -> None:
        """End the simulation."""
        self._guard(self._instance.terminate)

    # --- state -------------------------------------------------------------------------------

    def _get_fmu_state(self) -> bytes:
        return self._guard(self._instance.state)

    @HeldFromLookUp
    def _set_fmu_state(self, state: bytes) -> None:
        self._guard(self._instance.restore, state)

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        # checked when it is set: here the host could not be told
        return state

    # --- values ------------------------------------------------------------------------------

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values of Real variables."""
        return self._guard(self._instance.get, "Real", vrs)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Values of Integer variables."""
        return [int(value) for value in self._guard(self._instance.get, "Integer", vrs)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Values of Boolean variables."""
        return [bool(value) for value in self._guard(self._instance.get, "Boolean", vrs)]

    def get_string(self, vrs: list[int]) -> list[str]:
        """Values of String variables, of which there are none."""
        self._guard(self._instance.get, "String", vrs)
        return []

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set Real variables."""
        self._guard(self._instance.set, "Real", vrs, values)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """Set Integer variables."""
        self._guard(self._instance.set, "Integer", vrs, values)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """Set Boolean variables."""
        self._guard(self._instance.set, "Boolean", vrs, values)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Set String variables, of which there are none."""
        self._guard(self._set_strings, vrs)

    def _set_strings(self, vrs: list[int]) -> None:
        try:
            self._instance.set("String", vrs, ())
        except SystemError:  # the wrapper's, left pending by text that is not UTF-8
            raise FmuError("setString: a value is not UTF-8 text") from None

    # --- what goes wrong ---------------------------------------------------------------------

    def _guard(self, call: Callable[..., Result], *arguments: object) -> Result:
        """Carry out a call; on failure tell the host in one plain sentence.

        The wrapper hands queued messages to the host's logger, which may itself be Python, while
        the exception is pending: so the queue is emptied, and the exception is the message.
        """
        try:
            return call(*arguments)
        except BaseException as error:  # whatever leaves here unheld would crash the host
            if isinstance(error, KeyboardInterrupt):
                reason = INTERRUPTED
            elif isinstance(error, _PLAIN):
                reason = str(error)
            else:
                reason = f"internal error, {type(error).__name__}: {error}"
            message = self._print("error", reason)
            self.log_queue.clear()
            hold(self, self.log_queue, type(self))
            raise CallFailed(message) from None

    def _tell(self, level: str, message: str) -> None:
        self.log(self._print(level, message), _LEVELS[level])

    def _print(self, level: str, message: str) -> str:
        """Print a message, since hosts drop them unless logging was switched on; returns it in one
        line and without percent signs, which the host's logger would read as a printf format."""
        plain = " ".join(message.replace("%", " percent").split())
        with suppress(OSError, ValueError):  # a host may have closed it, or have none
            print(f"{self.instance_name}: {level}: {plain}", file=sys.stderr, flush=True)
        return plain


def _registered(variable: Variable) -> Real | Integer | Boolean:
    """A variable as pythonfmu describes it; only settable ones are ever read through it."""
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
        getter=lambda: variable.start,
    )
