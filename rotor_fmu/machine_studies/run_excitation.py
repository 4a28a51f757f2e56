"""The excitation of a run of a study, and its windows.

Ramps, signals, drops and motors are one window; at constant speeds every speed is a window of its
own, of whole turns after it has settled. A window is seen at the solver's own steps and, in whole
turns, at equal angles too, so that a sample a turn is a point of the Poincare section.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..model.simulation import Simulation
from ..runs.input_signals import Driver, Signals
from .monitor import Monitor, Window


class Number(NamedTuple):
    """A number of a kind of run: its unit, its default (None: must be given; a name: that of the
    machine's `OperatingSpeeds`), its bound, and what it is."""

    unit: str
    default: float | str | None
    is_positive: bool
    text: str


_STEP = Number("s", 0.04, True, "communication step, at which the speed is taken up")
_STOP = Number("s", None, True, "end of the run")
_RAMP = {
    "from": Number("rad/s", "trip", False, "speed at the start"),
    "to": Number("rad/s", 0.0, False, "speed at the end"),
    "rate": Number("rad/s2", "run_down_rate", True, "rate of the speed, without sign"),
    "step": _STEP,
}
_UP = _RAMP | {
    "from": Number("rad/s", 0.0, False, "speed at the start"),
    "to": Number("rad/s", "highest", False, "highest speed"),
    "rate": Number("rad/s2", "run_up_rate", True, "rate of the speed, without sign"),
}
_MEASURED = {
    "settle": Number("s", 1.0, False, "time that each speed is held before it is looked at"),
    "turns": Number("1", 64.0, True, "turns looked at"),
    "per_turn": Number("1", 32.0, True, "samples per turn, for metrics over whole turns"),
    "measure": Number("s", 0.0, False, "time looked at, in the place of turns"),
    "step": Number("s", 1e-3, True, "communication step, where measure is given"),
}
# The numbers of each kind of run, all of which can be varied as `run.NAME`.
KINDS: Mapping[str, Mapping[str, Number]] = {
    "run-down": _RAMP,
    "run-up": _UP,
    "up-and-down": _UP,
    "constant": {"speed": Number("rad/s", None, False, "speed")} | _MEASURED,
    "steps": {
        "from": Number("rad/s", None, False, "first speed"),
        "to": Number("rad/s", None, False, "last speed"),
        "count": Number("1", None, True, "speeds"),
        "back": Number("1", 0.0, False, "1: and back to the first"),
    }
    | _MEASURED,
    "signals": {"stop": _STOP, "step": _STEP},
    "drop": {
        "speed": Number("rad/s", None, False, "speed at the release"),
        "stop": _STOP,
        "step": Number("s", 1e-4, True, "communication step"),
    },
    "motor": {
        "torque": Number("N.m", None, True, "largest torque of the motor"),
        "target": Number("rad/s", "rated", True, "speed that the motor is to reach"),
        "ramp": Number("rad/s2", "run_up_rate", True, "rate of the speed that it follows"),
        "gain": Number("N.m.s/rad", 0.1, True, "torque of a speed that is missing"),
        "from": Number("rad/s", 1.0, False, "speed at the start"),
        "stop": _STOP,
        "step": Number("s", 2e-3, True, "interval between two commands to the motor"),
    },
    "drive-train": {
        "torque": Number("N.m", None, True, "largest torque of the motor"),
        "target": Number("rad/s", "rated", True, "speed that the motor is to reach"),
        "ramp": Number("rad/s2", "run_up_rate", True, "rate of the speed that it follows"),
        "gain": Number("N.m.s/rad", 0.1, True, "torque of a speed that is missing"),
        "integral": Number("N.m/rad", 0.2, False, "torque of an angle that is missing"),
        "inertia": Number("kg.m2", 1e-3, True, "moment of inertia of the motor"),
        "stiffness": Number("N.m/rad", 400.0, True, "of the coupling between motor and rotor"),
        "damping": Number("N.m.s/rad", 0.03, False, "of the coupling between motor and rotor"),
        "from": Number("rad/s", 1.0, False, "speed at the start"),
        "stop": _STOP,
        "step": Number("s", 2e-3, True, "communication step of the two FMUs"),
    },
    "response": {
        "from": Number("", None, False, "lowest speed [rad/s], or value of `over`"),
        "to": Number("", None, False, "highest"),
        "speed": Number("rad/s", 0.0, False, "the one speed, with `over`"),
        "period": Number("1", 1.0, True, "revolutions in a period"),
        "harmonics": Number("1", 60.0, True, "harmonics of the speed, at most"),
        "share": Number("1", 1e-4, True, "what the highest harmonics may be of the motion"),
        "length": Number("1", 0.1, True, "longest step along the curve"),
        "branches": Number("1", 0.0, False, "1: branches from period doublings and branch points"),
    },
}
FREE = ("drop", "motor")  # the rotor's speed is a state
WHOLE = ("turns", "per_turn", "count", "back", "period", "harmonics", "branches")
_NOT_NEGATIVE = ("settle", "measure", "back", "integral", "damping")
LEVELS = ("constant", "steps")
COUPLED = "drive-train"  # the kind of which a run is two FMUs
RESPONSE = "response"  # the kind of which a run is a periodic response, and nothing in time
_STANDS = 1e-9  # share of the highest speed that rounding leaves of none


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
    """How a run is driven: its kind, the kind's numbers, recorded signals, a kick; of a
    response what is varied along the curve, empty for the speed."""

    kind: str
    numbers: Mapping[str, float]
    signals: Signals | None = None
    kick: Kick | None = None
    loads: tuple[tuple[str, str], ...] = field(default=())
    over: str = ""

    def changed(self, values: Mapping[str, float]) -> Excitation:
        """Return the drive with some of its numbers replaced; `InputError` for impossible ones."""
        if not values:
            return self
        numbers = dict(self.numbers) | dict(values)
        check_numbers(self.kind, numbers)
        return replace(self, numbers=numbers)

    @property
    def speeds(self) -> np.ndarray:
        """The speeds of a run at constant speeds [rad/s], in the order in which they are held."""
        n = self.numbers
        if self.kind == "constant":
            return np.array([n["speed"]])
        up = np.linspace(n["from"], n["to"], int(n["count"]))
        return np.concatenate([up, up[-2::-1]]) if n["back"] else up

    @property
    def start(self) -> dict[str, float]:
        """What the machine's variables are at the start."""
        n = self.numbers
        if self.kind in FREE:
            first = n["speed"] if self.kind == "drop" else n["from"]
            return {"w_start": first, "tau_drive": 0.0}
        if self.kind in LEVELS:
            return {"speed": float(self.speeds[0]), "speed_continuation": 1}
        if self.signals is not None:
            given = {name: self.signals.at(name, 0.0) for name in self.signals.values}
            return given | {"speed_rate": self.signals.first_rate}
        way = math.copysign(n["rate"], n["to"] - n["from"])
        return {"speed": n["from"], "speed_rate": way}


def check_numbers(kind: str, numbers: Mapping[str, float]) -> None:
    """Raise `InputError` for numbers that a kind of run cannot have."""
    for name, commanded in KINDS[kind].items():
        value, unit = numbers[name], "" if commanded.unit == "1" else f" {commanded.unit}"
        if commanded.is_positive and not value > 0:
            raise InputError(f"run.{name} = {value:g}{unit}: must be > 0")
        if value < 0 and name in _NOT_NEGATIVE:
            raise InputError(f"run.{name} = {value:g}{unit}: must be >= 0")
        if name in WHOLE and value != int(value):
            raise InputError(f"run.{name} = {value:g}: must be an integer")
    if kind in LEVELS and not numbers["measure"]:
        speeds = np.abs(Excitation(kind, numbers).speeds)
        if speeds.min() <= _STANDS * speeds.max():
            ends = ("speed",) if kind == "constant" else ("from", "to")
            given = ", ".join(f"run.{name} = {numbers[name]:g}" for name in ends)
            raise InputError(f"{given} rad/s: no speed that is held may be 0, to make turns")
    if kind == RESPONSE and not numbers["from"] < numbers["to"]:
        raise InputError(
            f"run.from = {numbers['from']:g}: must be below run.to = {numbers['to']:g}"
        )
    if "rate" in numbers and numbers["from"] == numbers["to"]:
        raise InputError(f"run.to = {numbers['to']:g} rad/s: must differ from run.from")


def excite(simulation: Simulation, how: Excitation, monitor: Monitor) -> Iterator[Window]:
    """Advance through a run; yields its windows as they end.

    Raises `StepFailure` where the run stops.
    """
    if how.kind in LEVELS:
        yield from _levels(simulation, how, monitor)
        return
    advance = {"signals": _by_signals, "drop": _dropping, "motor": _by_motor}.get(how.kind, _ramp)
    for _ in advance(simulation, how):
        monitor.record()
    yield monitor.window()


def _instants(start: float, stop: float, step: float) -> Iterator[float]:
    """Times after `start` to `stop`, the last cut or stretched by less than half a step."""
    count = max(1, round((stop - start) / step))
    for n in range(1, count):
        yield start + n * step
    yield stop


def _kick_off(simulation: Simulation, how: Excitation, excite: float) -> None:
    """Advance over the kick, its direction renewed sixty-four times a turn."""
    kick = how.kick
    if kick is None:
        return
    loads = np.zeros(len(how.loads), dtype=complex)
    at = [x for x, _ in how.loads].index(f"{kick.port}.fx")
    turn = math.tau / abs(kick.rate) if kick.rate else kick.duration
    for t in _instants(0.0, kick.duration, min(turn / 64, kick.duration)):
        middle = 0.5 * (simulation.time + t)
        loads[at] = cmath.rect(kick.force, kick.rate * middle)
        simulation.advance(t, excite, loads)
    simulation.advance(simulation.time, excite, 0.0 * loads)


def _levels(simulation: Simulation, how: Excitation, monitor: Monitor) -> Iterator[Window]:
    n = how.numbers
    _kick_off(simulation, how, float(how.speeds[0]))
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
    way = math.copysign(n["rate"], n["to"] - n["from"])
    top = abs(n["to"] - n["from"]) / n["rate"]
    _kick_off(simulation, how, n["from"])
    for t in _instants(simulation.time, top, n["step"]):
        simulation.advance(t, n["from"] + way * simulation.time)
        yield t
    if how.kind == "up-and-down":
        rate: float | None = -way  # from the top on; later the speeds themselves say so
        for t in _instants(top, 2 * top, n["step"]):
            simulation.advance(t, n["from"] + way * (2 * top - simulation.time), rate=rate)
            rate = None
            yield t


def _by_signals(simulation: Simulation, how: Excitation) -> Iterator[float]:
    signals = how.signals
    assert signals is not None  # the reader sees to it
    driver = Driver(signals, how.loads)
    for t in _instants(0.0, how.numbers["stop"], how.numbers["step"]):
        driver.advance(simulation, simulation.time, t)
        yield t


def _dropping(simulation: Simulation, how: Excitation) -> Iterator[float]:
    for t in _instants(0.0, how.numbers["stop"], how.numbers["step"]):
        simulation.advance(t, 0.0)
        yield t


def _by_motor(simulation: Simulation, how: Excitation) -> Iterator[float]:
    """A motor that follows a ramp with a torque in proportion to what is missing, and its limit."""
    n = how.numbers
    inertia = simulation.read("J")
    w = simulation.names.index("w")
    for t in _instants(0.0, n["stop"], n["step"]):
        commanded = n["from"] + n["ramp"] * simulation.time
        ahead = inertia * n["ramp"] if commanded < n["target"] else 0.0
        missing = min(commanded, n["target"]) - float(simulation.observed[w])
        torque = max(-n["torque"], min(n["torque"], n["gain"] * missing + ahead))
        simulation.advance(t, torque)
        yield t
