"""A run of one rotor: its state, `advance(to)`, `snapshot()` and `restore()`."""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from . import messages, outcomes
from .backend import Backend, bound_entry_points, selected_backend, why_interpreted
from .errors import InputError
from .kernels.kernel import interpreted
from .kernels.library import RAISED
from .laws_at_rest.oil import machine_with_oil
from .machine.rotor import Rotor
from .message_templates import MOST_ARGUMENTS, Message, choice, fill_template
from .settings import DEFAULT_PRESET, PRESETS, Settings
from .step.step import Motion
from .step.step_status import DONE
from .structure.assembly import interface_names
from .structure.reduction import assembled
from .structure.structure import Structure
from .time_loop.block import LAYOUT, RunData, new_block
from .time_loop.equilibrium import AT_EQUILIBRIUM
from .time_loop.observe import observed_names
from .time_loop.recorder import Record, channels_of, write
from .warnings import RUN_WARNINGS


class EquilibriumError(InputError, RuntimeError):
    """There is no static equilibrium at the start."""


class StepFailure(RuntimeError):
    """A step failed; the message says when, where, and what to try."""


class RotorWarning(UserWarning):
    """A warning that a result is not to be trusted: an unstable scheme, the integrator's false
    state, an instability that the steps hide."""


class RotorNote(UserWarning):
    """A note that does not affect the quality of a run: a machine that is unstable, a setting
    without effect, long computing time."""


HYSTERETIC_AS_SLOWER = Message(
    "shaft.eta_h: runs and periodic responses take every whirl as slower than the rotation: they "
    "feed one that is faster, where hysteresis damps it, so that it may seem unstable; modes and "
    "unbalance tell them apart",
    "hysteretic-as-slower",
)


def warn(message: Message, stacklevel: int = 3) -> None:
    """Issue a message of a run as a `RotorNote` or a `RotorWarning`."""
    warnings.warn(message, RotorNote if message.is_note else RotorWarning, stacklevel=stacklevel)


@dataclass(frozen=True)
class CouplingOptions:
    """What the master of a coupled system may ask of a run; nothing by default.

    has_sensitivities: whether sensitivities are propagated; limit_displacement, limit_force: the
    displacement of a probe [m] and the force of an interface [N] at which an advance ends early, 0
    for none; stops_at_contact: whether it ends when a contact closes or opens; drive_impedance: of
    the line through which a torque drives a free rotor [N.m.s/rad].
    """

    has_sensitivities: bool = False
    limit_displacement: float = 0.0
    limit_force: float = 0.0
    stops_at_contact: bool = False
    drive_impedance: float = 0.0


NO_COUPLING = CouplingOptions()


class Simulation:
    """One rotor in motion.

    The rotor starts at rest in its static equilibrium under gravity and `loads` (complex, on the
    ports in their order [N]) at time t [s], turning at `speed` [rad/s]. `rate` [rad/s2] is the rate
    of the speed over the first interval; later ones continue the speed linearly from the last two
    values given, or, without `continues_speed`, hold the last. Given a `drive_torque` [N.m], the
    rotor is free: from that speed on the torque drives it. `record`: signals to record at every
    step for `drain`, as names or a `Record`; it changes no number of the run. `coupling`: what a
    master of a coupled system asks for. Warnings go to `warn`
    (default: a `RotorWarning`): settings that make oscillations grow, the false state, a missing
    compiler. Raises `EquilibriumError`, and `ValueError` for a signal that cannot be recorded.
    """

    def __init__(
        self,
        rotor: Rotor,
        settings: Settings = PRESETS[DEFAULT_PRESET],
        *,
        t: float = 0.0,
        speed: float = 0.0,
        rate: float = 0.0,
        continues_speed: bool = True,
        drive_torque: float | None = None,
        loads: np.ndarray | None = None,
        record: Record | Sequence[str] = (),
        coupling: CouplingOptions = NO_COUPLING,
        warn: Callable[[Message], None] = warn,
    ) -> None:
        self._warn = warn
        if selected_backend() is Backend.PYTHON:
            warn(Message(why_interpreted(), "interpreted"))
        self.rotor = rotor
        self.settings = settings
        structure, self._ranges = assembled(machine_with_oil(rotor), int(settings.reduction))
        self.names = observed_names(rotor)
        for warning in settings.warnings:
            self._warn(warning)
        if rotor.eta_h > 0.0:
            self._warn(HYSTERETIC_AS_SLOWER)
        recorded = record if isinstance(record, Record) else Record(record)
        channels = channels_of(rotor, recorded)
        rows = recorded.rows if channels else 0
        self._block = new_block(structure, len(self.names), len(channels), rows)
        self._run: RunData = LAYOUT.view_in_python(self._block)
        self._entry_points = bound_entry_points(self._block)
        self._run.recorder.channels[:] = channels
        self._run.recorder.head[0].least = recorded.angle
        self._run.method.numbers[0] = settings.numbers

        numbers = self._run.memory.record[0]
        numbers.t = t
        numbers.h = settings.h
        numbers.max_iterations = settings.max_iterations
        numbers.continues = continues_speed
        self.is_free = drive_torque is not None  # its speed is a state
        numbers.is_free = self.is_free
        for name, value in asdict(coupling).items():
            numbers[name] = value
        if loads is not None:
            self._run.memory.loads[:] = loads
        # views of single fields: a record's attributes cost a microsecond each
        self._time = self._run.memory.record["t"]
        self._run_warnings = [
            (self._run.memory.record[run_warning.since], run_warning)
            for run_warning in RUN_WARNINGS
        ]
        self._loads = self._run.memory.loads
        self._load_rates = self._run.memory.load_rates
        self.observed = self._run.outputs.observed  # in the order of `names`, a live array
        self._arguments = np.zeros(MOST_ARGUMENTS)
        contacts = interface_names(rotor)
        self._places = {
            "{where}": messages.closed_at(contacts, self._run.structure.interfaces),
            "{names}": choice(contacts),
        }
        last = "tangent" if coupling.has_sensitivities else "memory"
        whole = (LAYOUT.extent(self._block, "motion"), LAYOUT.extent(self._block, last))
        self._state = self._block[whole[0].start : whole[1].stop]
        drive = speed if drive_torque is None else drive_torque
        status = self._entry_points.start(float(speed), float(drive), float(rate))
        if status == RAISED:
            raise EquilibriumError("internal error at the start")
        if status != AT_EQUILIBRIUM:
            raise EquilibriumError(self._message(outcomes.no_rest, self._run, status))
        self._warn_outside_ranges(speed)
        self._speed = self._run.memory.record["omega"]
        self._has_warned_of_whirls = False
        self._has_warned_of_growth = False
        self._surveyed_from = self._run.memory.record["surveyed_from"]
        self._surveyed_to = self._run.memory.record["surveyed_to"]
        self._survey(True)

    @property
    def structure(self) -> Structure:
        """The machine in matrices and records (live arrays, read-only by convention)."""
        return self._run.structure

    @property
    def time(self) -> float:
        """The time reached [s]."""
        return float(self._time[0])

    @property
    def motion(self) -> Motion:
        """The present state (live arrays, read-only by convention)."""
        return self._run.motion

    def read(self, name: str) -> float:
        """Return one observed quantity by its name, as in `observed_names`."""
        return float(self.observed[self.names.index(name)])

    def advance(
        self,
        to: float,
        drive: float,
        loads: np.ndarray | None = None,
        *,
        rate: float | None = None,
        load_rates: np.ndarray | None = None,
    ) -> None:
        """Advance to time `to` [s].

        drive: the speed now [rad/s], or a free rotor's drive torque [N.m]; loads: complex forces
        x + i y on the machine's ports, in the order of `Structure.load_dof`, now [N], of a base its
        acceleration [m/s2]; None: as they are. rate, load_rates: of these until `to`, over which
        they are linear in time [rad/s2, N.m/s], [N/s]; without them loads and torque are constant,
        and the speed goes on as its last two values say.

        Raises `ValueError`, without a step, for a value that is not finite or a time in the past,
        and `StepFailure`, with the state after the last good step, also after the settings'
        `max_iterations`; a further call then continues from there.
        """
        if not math.isfinite(to):
            raise ValueError(f"to = {to}: must be finite")
        for name, value in (("torque" if self.is_free else "speed", drive), ("rate", rate or 0.0)):
            if not math.isfinite(value):
                raise ValueError(f"{name} = {value}: must be finite")
        if to < self.time:
            raise ValueError(f"to = {to:.9g} s: must not lie before {self.time:.9g} s, now")
        for name, values in (("loads", loads), ("load_rates", load_rates)):
            if values is not None and not np.isfinite(values).all():
                raise ValueError(f"{name} = {values}: must be finite")
        if loads is not None:
            self._loads[:] = loads
        self._load_rates[:] = 0.0 if load_rates is None else load_rates
        status = self._entry_points.advance(
            float(to), float(drive), math.nan if rate is None else rate
        )
        if status != DONE:
            raise StepFailure(self._failure(status))
        if self._ranges:
            self._warn_outside_ranges(float(self._run.memory.record["omega"][0]))
        if not self._surveyed_from[0] <= abs(self._speed[0]) <= self._surveyed_to[0]:
            self._survey(False)
        for entry in tuple(self._run_warnings):
            since, warning = entry
            if since[0] == since[0]:
                self._run_warnings.remove(entry)
                self._warn(Message(fill_template(warning.words, since), warning.code))

    def derivatives(self) -> np.ndarray:
        """Return the first and second time derivatives of `observed` at the time reached, shape (2,
        observed) [1/s, 1/s2]; 0 for what is constant between two events."""
        self._entry_points.differentiate(-1)
        return self._run.outputs.derivatives.copy()

    def sensitivities(self, row: int) -> np.ndarray:
        """Return the derivatives of `observed` with respect to an input of the last `advance`,
        shape (observed,); row: 0 for the drive, 1 + 2 i and 2 + 2 i for load i along x and along y.

        Raises `ValueError` unless the coupling options ask for them.
        """
        if not self._run.memory.record[0].has_sensitivities:
            raise ValueError("sensitivities: must be asked for by CouplingOptions")
        self._entry_points.differentiate(row)
        return self._run.outputs.derivatives[0].copy()

    def snapshot(self) -> np.ndarray:
        """Return a copy of the whole state, as bytes, from which `restore` continues bit for
        bit."""
        return self._state.copy()

    def restore(self, snapshot: np.ndarray | bytes) -> None:
        """Go back to a snapshot, or its bytes, of this or of an equal simulation."""
        self._state[:] = np.frombuffer(snapshot, np.uint8)
        self._entry_points.refresh_outputs()
        recorder = self._run.recorder
        recorder.head[0].written = np.searchsorted(
            recorder.rows[: recorder.head[0].written, 0], self.time, "right"
        )

    def drain(self) -> np.ndarray:
        """Return the rows recorded since the last call, shape (n, 1 + names recorded): time [s]
        and, in their order, the names.

        The first row ever is the state at the start, the others are ends of steps. Where more than
        the most rows were due in between, every second was dropped, and so on. A restored snapshot
        takes back what was recorded after it, except what was drained.
        """
        recorder = self._run.recorder
        head = recorder.head[0]
        rows = recorder.rows[: head.written].copy()
        head.written = 0
        head.spacing = head.least
        head.covered = 0.0
        return rows

    def record_now(self) -> None:
        """Record a row of the present state, though none may be due."""
        run = self._run
        interpreted(write)(
            *(run.structure, run.motion, run.memory, run.work, run.recorder, run.outputs.observed)
        )

    def _survey(self, is_start: bool) -> None:
        """Survey the growing whirls up to the present speed, and warn of those that the steps
        hide."""
        self._entry_points.survey(float(self._speed[0]), is_start)
        survey = self._run.survey
        grows = self._message(outcomes.growth_at_rest, complex(survey.rest[0]))
        if grows:
            self._warn(grows)
        unstable = self._message(outcomes.unstable, self._run)
        if unstable and not self._has_warned_of_growth:
            self._has_warned_of_growth = True
            self._warn(unstable)
        if survey.counted[0] == 0 or self._has_warned_of_whirls:
            return
        hidden = self._message(outcomes.hidden, self._run)
        if hidden:
            self._has_warned_of_whirls = True
            self._warn(hidden)

    def _warn_outside_ranges(self, speed: float) -> None:
        """Warn once for every range that the speed [rad/s] has left."""
        for allowed in list(self._ranges):
            if not allowed.holds(speed):
                self._ranges.remove(allowed)
                self._warn(allowed.message(speed))

    def _failure(self, status: int) -> str:
        if status == RAISED:
            return "internal error in a step"
        self._entry_points.survey(float(self._run.memory.record[0].surveyed_at), False)
        return self._message(outcomes.failure, self._run, status)

    def _message(self, kernel: Callable[..., int], *arguments: object) -> Message:
        """Return the message that a kernel of `outcomes` chooses, "" if it chooses none."""
        code = interpreted(kernel)(*arguments, self._arguments)
        text = messages.SENTENCES[code]
        for place, own in self._places.items():
            text = text.replace(place, own)
        return Message(fill_template(text, self._arguments), messages.CODES[code])
