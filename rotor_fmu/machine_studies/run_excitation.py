"""The excitation of a run of a study, and its windows.

Ramps, signals, drops and motors are one window; of runs at constant speeds every speed is a window
of its own, of whole turns after it has settled. A window is sampled at the solver's own steps and,
in whole turns, at equal angles too, so that one sample per turn is a point of the Poincare section.
"""

import cmath
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..model.simulation import Simulation
from ..runs.input_signals import Driver, Signals
from .monitor import Monitor, Window
from .run_kinds import BY_MOTOR, DROP, SIGNALS, UP_AND_DOWN, RunKind


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

    def changed(self, values: Mapping[str, float]) -> "Excitation":
        """Return the excitation with some of its numbers replaced; `InputError` for impossible
        ones."""
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
        slope = math.copysign(n["rate"], n["to"] - n["from"])
        return {"speed": n["from"], "speed_rate": slope}


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


def _advance_over_kick(simulation: Simulation, how: Excitation, speed: float) -> None:
    """Advance over the kick, its direction updated 64 times per turn."""
    kick = how.kick
    if kick is None:
        return
    loads = np.zeros(len(how.loads), dtype=complex)
    at = [x for x, _ in how.loads].index(f"{kick.port}.fx")
    turn = math.tau / abs(kick.rate) if kick.rate else kick.duration
    for t in _instants(0.0, kick.duration, min(turn / 64, kick.duration)):
        middle = 0.5 * (simulation.time + t)
        loads[at] = cmath.rect(kick.force, kick.rate * middle)
        simulation.advance(t, speed, loads)
    simulation.advance(simulation.time, speed, 0.0 * loads)


def _held_speeds(simulation: Simulation, how: Excitation, monitor: Monitor) -> Iterator[Window]:
    n = how.numbers
    _advance_over_kick(simulation, how, float(how.speeds[0]))
    for speed in how.speeds.tolist():
        simulation.advance(simulation.time + n["settle"], speed)
        begun, interval, count, per_turn = simulation.time, n["step"], 0, 0
        if n["measure"]:
            count = max(1, round(n["measure"] / n["step"]))
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
    n = how.numbers
    slope = math.copysign(n["rate"], n["to"] - n["from"])
    top = abs(n["to"] - n["from"]) / n["rate"]
    _advance_over_kick(simulation, how, n["from"])
    for t in _instants(simulation.time, top, n["step"]):
        simulation.advance(t, n["from"] + slope * simulation.time)
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
    for t in _instants(0.0, n["stop"], n["step"]):
        commanded = n["from"] + n["ramp"] * simulation.time
        ahead = inertia * n["ramp"] if commanded < n["target"] else 0.0
        error = min(commanded, n["target"]) - float(simulation.observed[w])
        torque = max(-n["torque"], min(n["torque"], n["gain"] * error + ahead))
        simulation.advance(t, torque)
        yield t
