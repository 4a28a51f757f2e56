"""The common slave of partners' FMUs: all its variables are Real and listed in one table.

It lies beside the partner's script in its FMU. Standard library and pythonfmu only.
"""

import functools
import math
import uuid
from abc import abstractmethod
from array import array
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from pythonfmu import Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability
from pythonfmu import Real as FmiReal

try:
    import rotor_fmu_wrapper as wrapper  # beside this file in the FMU
except ImportError:
    from rotor_fmu.fmi.python import wrapper  # in the source tree

# for scripts of partners: an invalid input, parameter or call raises `Refused` with a message that
# names it and says what is allowed
hold, Refused = wrapper.hold, wrapper.CallFailed

# name, causality, unit, start, lowest value allowed, description
Listed = tuple[str, str, str, float | None, float | None, str]
BEGUN: Listed = ("begun", "local", "1", None, None, "1 once the initialization has ended")
_LONGEST = 700  # characters of a message, as of the rotor's FMU


def described(call: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a call from the host so that an error, of the partner's own code too, leaves the slave
    alive: the wrapper drops its references to it on any exception."""

    @functools.wraps(call)
    def guarded(self: Fmi2Slave, *arguments: object) -> Any:
        try:
            return call(self, *arguments)
        except BaseException as error:  # whatever leaves here unheld would crash the host
            wrapper.held(self)
            said = str(error) if isinstance(error, Refused) else f"{type(error).__name__}: {error}"
            if isinstance(error, KeyboardInterrupt):
                said = wrapper.INTERRUPTED
            raise Refused(wrapper.escaped(wrapper.in_one_line(said)[:_LONGEST])) from None

    return guarded


class TableSlave(Fmi2Slave):
    """A slave whose variables are the attributes listed in its table `VARIABLES`, `BEGUN` among
    them. A wrong call or value raises `Refused` and changes nothing."""

    VARIABLES: ClassVar[tuple[Listed, ...]]
    begun: float
    author = "The rotor-fmu authors"
    license = "MIT"

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        wrapper.settle_exit(self.resources)
        # the module's name in the FMU follows its content
        self.guid = uuid.uuid5(uuid.NAMESPACE_URL, type(self).__module__)
        taken = set(dir(self))
        for name, causality, _, start, _, text in self.VARIABLES:
            if name in taken:
                raise Refused(f"VARIABLES: {name}: is an attribute of the slave already")
            setattr(self, name, start or 0.0)
            is_parameter = causality == "parameter"
            initial = {"parameter": Fmi2Initial.exact, "input": None}
            variable = FmiReal(
                name,
                causality=Fmi2Causality[causality],
                variability=Fmi2Variability.fixed if is_parameter else Fmi2Variability.continuous,
                initial=initial.get(causality, Fmi2Initial.calculated),
                description=text,
            )
            self.register_variable(variable)

    # --- values ---

    @described
    def get_real(self, references: Sequence[int]) -> list[float]:
        """Return the values of Reals; while the initialization lasts, those of computed ones are
        what they would be if it ended now."""
        entries = [self._entry("getReal", reference) for reference in references]
        if self.begun or not any(causality in ("output", "local") for _, causality, *_ in entries):
            return [self._number(name) for name, *_ in entries]
        before = [getattr(self, name) for name, *_ in self.VARIABLES]
        try:
            self._begin()
            return [self._number(name) for name, *_ in entries]
        finally:
            for (name, *_), value in zip(self.VARIABLES, before, strict=True):
                setattr(self, name, value)

    @described
    def set_real(self, references: Sequence[int], values: Sequence[float]) -> None:
        """Set Reals, all or none: inputs at any time, parameters before the initialization ends."""
        entries = [self._entry("setReal", reference) for reference in references]
        for name, causality, *_ in entries:
            if causality not in ("input", "parameter"):
                raise Refused(f"{name}: is computed and cannot be set")
            if causality == "parameter" and self.begun:
                raise Refused(f"{name}: is fixed once the initialization has ended")
        for (name, *_), value in zip(entries, values, strict=True):
            setattr(self, name, value)

    @described
    def _no_such(self, references: Sequence[int], *values: object) -> list[Any]:
        if references:
            raise Refused(f"value reference {references[0]}: all variables are Real")
        return []

    get_integer = get_boolean = get_string = _no_such
    set_integer = set_boolean = set_string = _no_such

    def _entry(self, call: str, reference: int) -> Listed:
        if not 0 <= reference < len(self.VARIABLES):
            raise Refused(
                f"{call}: value reference {reference}: must be from 0 to {len(self.VARIABLES) - 1}"
            )
        return self.VARIABLES[reference]

    # --- state: all variables, after the FMU's identifier ---

    @described
    def _get_fmu_state(self) -> bytes:
        values = array("d", (self._number(name) for name, *_ in self.VARIABLES))
        return self.guid.bytes + values.tobytes()

    @wrapper.HeldFromLookUp
    @described
    def _set_fmu_state(self, state: bytes) -> None:
        guid, values = state[: len(self.guid.bytes)], state[len(self.guid.bytes) :]
        if guid != self.guid.bytes or len(values) != 8 * len(self.VARIABLES):
            raise Refused("the FMU state is damaged, or of another FMU")
        for (name, *_), value in zip(self.VARIABLES, array("d", values), strict=True):
            setattr(self, name, value)

    @staticmethod
    def _fmu_state_to_bytes(state: bytes) -> bytes:
        return state

    @staticmethod
    def _fmu_state_from_bytes(state: bytes) -> bytes:
        return state  # is checked when it is set: here the host would not get the reason

    # --- steps ---

    @described
    def exit_initialization_mode(self) -> None:
        """Check what was set, and begin."""
        if self.begun:
            raise Refused("exitInitializationMode: the initialization has ended")
        self._begin()
        self.begun = 1.0

    def _begin(self) -> None:
        self._check(("input", "parameter"))
        self.begin()

    @described
    def do_step(self, current_time: float, step_size: float) -> bool:
        """Check the inputs and step from `current_time` over `step_size` [s]."""
        if not self.begun:
            raise Refused("doStep: the initialization has not ended")
        self._check(("input",))
        if not (step_size > 0 and math.isfinite(step_size)):
            raise Refused(f"doStep over {step_size:g} s: the step must be > 0 and finite")
        self.step(current_time, step_size)
        return True

    @abstractmethod
    def begin(self) -> None:
        """Give all variables that are computed their values at the start. Called at the end of the
        initialization, and before whenever a host reads one of them."""

    @abstractmethod
    def step(self, t: float, h: float) -> None:
        """Carry out the slave's step from t over h [s]."""

    def _number(self, name: str) -> float:
        try:
            return float(getattr(self, name))
        except (TypeError, ValueError):
            raise Refused(f"{name} = {getattr(self, name)!r}: must be a number") from None

    def _check(self, causalities: tuple[str, ...]) -> None:
        for name, causality, unit, _, low, _ in self.VARIABLES:
            value = self._number(name)
            if causality in causalities and not math.isfinite(value):
                raise Refused(f"{name} = {value} {unit}: must be a finite number")
            if causality in causalities and low is not None and value < low:
                raise Refused(f"{name} = {value:g} {unit}: must be >= {low:g}")
