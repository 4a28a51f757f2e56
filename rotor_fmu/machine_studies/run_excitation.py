"""The excitation of a run of a study, and its windows.

Ramps, signals, drops and motors are one window; of runs at constant speeds every speed is a window
of its own, of whole turns after it has settled. A window is sampled at the solver's own steps and,
in whole turns, at equal angles too, so that one sample per turn is a point of the Poincare section.
"""

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..model.simulation import Simulation, StepFailure
from ..runs.input_signals import Driver, Signals
from ..runs.run_down import RECORDER_ROWS
from .run_kinds import BY_MOTOR, DROP, SIGNALS, UP_AND_DOWN, RunKind

LEAST_TURNS = 16  # over which an exponent is a mean
_INTERFACES_PER_TURN = 512  # samples of the interfaces at least, of an exponent


class Samples(NamedTuple):
    """Outputs at instants: t, shape (n,) [s]; columns by name, shape (n,)."""

    t: np.ndarray
    columns: Mapping[str, np.ndarray]

    def quantity(self, of: str) -> np.ndarray:
        """Return an output by its name, or of PART.r the distance of PART.x, PART.y from 0."""
        if of.endswith(".r") and of not in self.columns:
            part = of.removesuffix(".r")
            return np.hypot(self.columns[f"{part}.x"], self.columns[f"{part}.y"])
        return self.columns[of]


class Window(NamedTuple):
    """A part of a run that is looked at: at the solver's own steps, its ends among them; in whole
    turns at equal angles; the speed that is held [rad/s], nan where it varies; samples a turn, 0
    where they are none; the largest Lyapunov exponent [1/s], nan where it is not asked for.
    """

    steps: Samples
    turns: Samples
    speed: float
    per_turn: int
    exponent: float = math.nan


class Monitor:
    """The samples taken while a simulation advances: `names` at the solver's steps, which it must
    record, and `by_turns` at chosen instants; is_whole: whether samples between windows are stored
    too; has_exponent: whether the largest Lyapunov exponent of each window is computed."""

    def __init__(
        self,
        simulation: Simulation,
        names: Sequence[str],
        by_turns: Sequence[str] = (),
        is_whole: bool = False,
        has_exponent: bool = False,
    ) -> None:
        self._simulation, self._is_whole = simulation, is_whole
        self._has_exponent = has_exponent
        self._names, self._by_turns = names, by_turns
        self._at = [simulation.names.index(name) for name in by_turns]
        self._count = simulation.names.index("solver.steps")
        self._recordings: list[np.ndarray] = []
        self.begin()

    def begin(self) -> None:
        """Drop all samples but the present state."""
        self._times: list[float] = []
        self._rows: list[np.ndarray] = []
        self._interfaces: list[tuple] = []
        self.sample_interfaces()
        self._taken = self._simulation.observed[self._count]
        recordings = [*self._recordings, self._simulation.drain()] if self._names else []
        if self._recordings and not self._is_whole:
            now = [self._simulation.time, *map(self._simulation.read, self._names)]
            recordings = [np.array([now])]
        self._recordings = recordings

    def record(self, is_end: bool = False) -> None:
        """Take what was recorded, when there is much of it or at the end of a window; `StepFailure`
        where it is not every step."""
        taken = self._simulation.observed[self._count] - self._taken
        if not self._names or not (is_end or taken > RECORDER_ROWS / 64):
            return
        self._taken += taken
        self._recordings.append(self._simulation.drain())
        if len(self._recordings[-1]) < taken:
            raise StepFailure(
                f"t = {self._simulation.time:.6g} s: more than {RECORDER_ROWS} steps of the solver "
                "in a communication step, which are not all recorded; take a shorter run.step"
            )

    def sample(self) -> None:
        """Take a sample at this instant."""
        self._times.append(self._simulation.time)
        self._rows.append(self._simulation.observed[self._at])

    def parts(self, per_turn: int) -> int:
        """Return into how many advances the interval between two samples at equal angles goes."""
        return math.ceil(_INTERFACES_PER_TURN / per_turn) if self._has_exponent else 1

    def sample_interfaces(self) -> None:
        """Take what an exponent is computed of at this instant."""
        if self._has_exponent:
            from ..model.periodic.lyapunov import sample

            self._interfaces.append(sample(self._simulation))

    def window(self, speed: float = math.nan, per_turn: int = 0) -> Window:
        """Return the window since `begin`; `StepFailure` if steps are missing in it."""
        self.record(is_end=True)
        recorder = np.concatenate([np.zeros((0, 1 + len(self._names))), *self._recordings]).T
        steps = Samples(recorder[0], dict(zip(self._names, recorder[1:], strict=True)))
        rows = np.array(self._rows).reshape(len(self._rows), len(self._by_turns)).T
        turns = Samples(np.array(self._times), dict(zip(self._by_turns, rows, strict=True)))
        exponent = math.nan
        if self._has_exponent:
            from ..model.periodic.lyapunov import InterfaceSamples, largest_exponent

            seen = InterfaceSamples(*map(np.array, zip(*self._interfaces, strict=True)))
            each = per_turn * self.parts(per_turn)
            exponent = largest_exponent(self._simulation.rotor, seen, speed, each)
        return Window(steps, turns, speed, per_turn, exponent)


@dataclass(frozen=True)
class Kick:
    """A force on a port at the start of a run: its size [N], the rate at which it turns [rad/s],
    how long it lasts [s]."""

    port: str
    force: float
    rate: float
    duration: float


@dataclass(frozen=True)
class Excitation:
    """How a run is driven: its kind, the kind's numbers, recorded signals, a kick, the names of the
    loads; of a response the parameter along the curve, empty for the speed, and its unit."""

    kind: RunKind
    numbers: Mapping[str, float]
    signals: Signals | None = None
    kick: Kick | None = None
    loads: tuple[tuple[str, str], ...] = field(default=())
    over: str = ""
    abscissa_unit: str = "rad/s"

    def __post_init__(self) -> None:
        if self.kick is None:
            return
        is_ramp = "rate" in self.numbers
        if not is_ramp and not self.kind.holds_speeds:
            raise InputError(f"run {self.kind.name}: has no kick")
        if is_ramp and self.kick.duration >= self.ramp_time:
            raise InputError(
                f"run kick duration = {self.kick.duration:g} s: must be below the "
                f"{self.ramp_time:g} s of the ramp"
            )

    def changed(self, values: Mapping[str, float]) -> "Excitation":
        """Return the excitation with other numbers; `InputError` for impossible ones."""
        if not values:
            return self
        numbers = dict(self.numbers) | dict(values)
        self.kind.check(numbers)
        return replace(self, numbers=numbers)

    @property
    def speeds(self) -> np.ndarray:
        """The speeds of a run at constant speeds [rad/s], in the order in which they are held."""
        return self.kind.speeds(self.numbers)

    @property
    def no_loads(self) -> np.ndarray:
        """Zeros for each load [N], complex."""
        return np.zeros(len(self.loads), dtype=complex)

    @property
    def ranges_of_loads(self) -> dict[str, list[float]]:
        """The least and the largest value of each load that is not 0 all the time."""
        if self.signals is not None:
            return self.signals.loads(self.numbers["stop"])
        if self.kick is None:
            return {}
        most = abs(self.kick.force)
        return {f"{self.kick.port}.{way}": [-most, most] for way in ("fx", "fy")}

    @property
    def slope(self) -> float:
        """The rate of a ramp with its sign [rad/s2]."""
        return math.copysign(self.numbers["rate"], self.numbers["to"] - self.numbers["from"])

    @property
    def ramp_time(self) -> float:
        """The time that a ramp takes to its end [s]."""
        return (self.numbers["to"] - self.numbers["from"]) / self.slope

    @property
    def start(self) -> dict[str, float]:
        """Values of the machine's variables at the start."""
        n = self.numbers
        if self.kind.is_free:
            return {"w_start": n.get("speed", n.get("from", 0.0)), "tau_drive": 0.0}
        if self.kind.holds_speeds:
            return {"speed": float(self.speeds[0]), "speed_continuation": 1}
        if self.signals is not None:
            given = {name: self.signals.at(name, 0.0) for name in self.signals.values}
            return given | {"speed_rate": self.signals.first_rate}
        return {"speed": n["from"], "speed_rate": self.slope}


def excite(simulation: Simulation, how: Excitation, monitor: Monitor) -> Iterator[Window]:
    """Advance through a run; yields its windows as they end.

    Raises `StepFailure` where the run stops.
    """
    if how.kind.holds_speeds:
        yield from _held_speeds(simulation, how, monitor)
        return
    by_kind = {SIGNALS.name: _signals, DROP.name: _free_fall, BY_MOTOR.name: _motor}
    for _ in by_kind.get(how.kind.name, _ramp)(simulation, how):
        monitor.record()
    yield monitor.window()


def _instants(start: float, stop: float, step: float) -> Iterator[float]:
    """Yield times after `start` to `stop` [s], the last step changed by less than half a step."""
    count = max(1, round((stop - start) / step))
    for n in range(1, count):
        yield start + n * step
    yield stop


def _over_kick(
    simulation: Simulation, how: Excitation, speed: float, slope: float = 0.0
) -> Iterator[float]:
    """Advance over the kick, its direction updated 64 times per turn, at the speed [rad/s] that
    changes at the rate `slope` [rad/s2]; yields the times reached."""
    kick = how.kick
    if kick is None:
        return
    loads = how.no_loads
    at = [x for x, _ in how.loads].index(f"{kick.port}.fx")
    turn = math.tau / abs(kick.rate) if kick.rate else kick.duration
    for t in _instants(0.0, kick.duration, min(turn / 64, kick.duration)):
        middle = 0.5 * (simulation.time + t)
        loads[at] = cmath.rect(kick.force, kick.rate * middle)
        simulation.advance(t, speed + slope * simulation.time, loads)
        yield t


def _held_speeds(simulation: Simulation, how: Excitation, monitor: Monitor) -> Iterator[Window]:
    n = how.numbers
    for _ in _over_kick(simulation, how, float(how.speeds[0])):
        monitor.record()
    for speed in how.speeds.tolist():
        simulation.advance(simulation.time + n["settle"], speed, how.no_loads)
        begun, per_turn = simulation.time, 0
        if n["measure"]:
            count = max(1, round(n["measure"] / n["step"]))
            interval = n["measure"] / count
        else:
            # on to the keyphasor's mark, phi a multiple of a turn
            sense = math.copysign(1.0, speed)
            begun += -sense * simulation.read("phi") % math.tau / abs(speed)
            simulation.advance(begun, speed)
            per_turn = int(n["per_turn"])
            count, interval = int(n["turns"]) * per_turn, math.tau / abs(speed) / per_turn
        monitor.begin()
        parts = monitor.parts(per_turn) if per_turn else 1
        for k in range(1, count + 1):
            for j in range(1, parts):
                simulation.advance(begun + (k - 1 + j / parts) * interval, speed)
                monitor.sample_interfaces()
            simulation.advance(begun + k * interval, speed)
            monitor.sample_interfaces()
            monitor.record()
            if per_turn:
                monitor.sample()
        yield monitor.window(speed, per_turn)


def _ramp(simulation: Simulation, how: Excitation) -> Iterator[float]:
    n, slope, top = how.numbers, how.slope, how.ramp_time
    yield from _over_kick(simulation, how, n["from"], slope)
    for t in _instants(simulation.time, top, n["step"]):
        simulation.advance(t, n["from"] + slope * simulation.time, how.no_loads)
        yield t
    if how.kind.name == UP_AND_DOWN.name:
        rate: float | None = -slope  # at the top; later it follows from the speeds
        for t in _instants(top, 2 * top, n["step"]):
            simulation.advance(t, n["from"] + slope * (2 * top - simulation.time), rate=rate)
            rate = None
            yield t


def _signals(simulation: Simulation, how: Excitation) -> Iterator[float]:
    signals = how.signals
    assert signals is not None  # as checked when the study was read
    driver = Driver(signals, how.loads)
    for t in _instants(0.0, how.numbers["stop"], how.numbers["step"]):
        driver.advance(simulation, simulation.time, t)
        yield t


def _free_fall(simulation: Simulation, how: Excitation) -> Iterator[float]:
    for t in _instants(0.0, how.numbers["stop"], how.numbers["step"]):
        simulation.advance(t, 0.0)
        yield t


def _motor(simulation: Simulation, how: Excitation) -> Iterator[float]:
    """A motor that follows a ramp, with a torque in proportion to the speed error and a limit."""
    n = how.numbers
    inertia = simulation.read("J")
    w = simulation.names.index("w")
    way = n["target"] - n["from"]
    for t in _instants(0.0, n["stop"], n["step"]):
        gone = n["ramp"] * simulation.time
        ahead = math.copysign(inertia * n["ramp"], way) if gone < abs(way) else 0.0
        commanded = n["from"] + math.copysign(min(gone, abs(way)), way)
        error = commanded - float(simulation.observed[w])
        torque = max(-n["torque"], min(n["torque"], n["gain"] * error + ahead))
        simulation.advance(t, torque)
        yield t
