"""The task of a response computation, and its result."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, cast

import numpy as np

from ..kernels.kernel import interpreted
from ..laws_at_rest.oil import machine_with_oil
from ..machine.rotor import Rotor
from ..machine.speed_ranges import BEYOND_TABLE, speed_ranges
from ..message_templates import Message
from ..parts.rolling_bearing import ROLLING_BEARING, cage_ratio
from ..quantities import QuantityError
from .arclength import ContinuationSteps
from .balance import HarmonicBalance, Orbit
from .branch import Branch
from .harmonic_count import Accuracy
from .linear_structure import CondensedMachine

SPEED = "speed"
_SLOWEST = 1e-6  # rad/s, a turn in ten weeks; a machine that turns slower is one of wrong units
_BETWEEN = 0.382  # of a range: where a whole number is none
KEPT = 8  # machines, or equations, at the last values of a parameter

Machines = Callable[[float], CondensedMachine]  # of a value of the parameter


class PeriodicError(QuantityError):
    """A response that cannot be computed; says why."""


@dataclass(frozen=True)
class Task:
    """A response to be computed: the parameter over [low, high]; `speed` [rad/s] if it is not the
    parameter; constant `loads` on the ports [N]; `turns` in a period; accuracy and step lengths;
    `seeds`: values of the parameter at which time integration looks for further branches; is_whirl:
    self-excited whirl of the machine without unbalance; start_orbit: the only orbit from which
    branches are followed, at the machine's own value of the parameter; follows_bifurcations:
    whether branches from period doublings and branch points are followed too."""

    low: float
    high: float
    name: str = SPEED
    speed: float = 0.0
    turns: int = 1
    loads: np.ndarray | None = None
    accuracy: Accuracy = field(default_factory=Accuracy)
    steps: ContinuationSteps = field(default_factory=lambda: ContinuationSteps(longest=0.1))
    seeds: tuple[float, ...] = ()
    is_whirl: bool = False
    start_orbit: Orbit | None = None
    follows_bifurcations: bool = False

    def speed_at(self, value: float) -> float:
        """Return the speed at a value of the parameter [rad/s]."""
        return value if self.name == SPEED else self.speed

    def rotor_at(self, rotor: Rotor, value: float) -> Rotor:
        """Return the machine with a value of the parameter."""
        return rotor if self.name == SPEED else rotor.with_value(self.name, value)

    def needs_shooting(self, orbit: Orbit) -> bool:
        """Return whether an orbit has more harmonics than harmonic balance may use, a forced one:
        whirls are solved for by it alone."""
        return not self.is_whirl and orbit.H * self.turns > self.accuracy.most * orbit.turns

    def problem(
        self, machines: Machines, at: float, H: int, turns: int = 1, omega: float = 0.0, **more: Any
    ) -> HarmonicBalance:
        """Return the harmonic balance equations about a value of the parameter, with H
        harmonics."""
        more |= {"speed": self.speed, "turns": turns, "is_autonomous": self.is_whirl}
        scale = self.high - self.low
        return HarmonicBalance(machines, self.name, scale, at, H, omega=omega, **more)

    def coarse_problem(self, machines: Machines, at: float) -> HarmonicBalance:
        """Return these equations with as few harmonics as a motion is begun with."""
        H = max(self.accuracy.least, 3) * self.turns
        return self.problem(machines, at, H, self.turns)


class Note(Message):
    """A message with values of the parameter; as text it gives them in SI units."""

    __slots__ = ("parts", "unit")
    parts: tuple[str | float, ...]
    unit: str

    def __new__(cls, code: str, unit: str, *parts: str | float) -> "Note":
        """Return a message of texts and values; unit: of the values."""
        note = cast(Note, super().__new__(cls, _joined(parts, 1.0, unit), code))
        note.parts, note.unit = parts, unit
        return note

    def __getnewargs__(self) -> tuple[Any, ...]:
        return self.code, self.unit, *self.parts

    def shown(self, factor: float, unit: str) -> Message:
        """Return the message with its values in another unit; factor: to that unit."""
        return Message(_joined(self.parts, factor, unit), self.code)


def _joined(parts: tuple[str | float, ...], factor: float, unit: str) -> str:
    behind = "" if unit in ("", "1") else f" {unit}"
    return "".join(p if isinstance(p, str) else f"{factor * p:.5g}{behind}" for p in parts)


@dataclass
class Response:
    """The branches of a task and the notes on them, a line each; is_stopped: whether the
    computation was interrupted."""

    rotor: Rotor
    task: Task
    branches: list[Branch] = field(default_factory=list)
    notes: list[Message] = field(default_factory=list)
    is_stopped: bool = False

    @property
    def unit(self) -> str:
        """The SI unit of the parameter."""
        if self.task.name == SPEED:
            return "rad/s"
        return self.rotor.numbers()[self.task.name].quantity.unit

    def machines(self) -> Machines:
        """Return the machine as a function of the parameter."""
        return machines_of(self.rotor, self.task)


def check(rotor: Rotor, task: Task) -> list[Message]:
    """Return messages on speeds that a machine is not made for; raise `PeriodicError` or
    `QuantityError` for a task that it does not allow."""
    if not task.low < task.high:
        raise PeriodicError(f"{task.name} = {task.low:g}:{task.high:g}: FROM must be below TO")
    if task.is_whirl and task.turns != 1:
        raise PeriodicError(f"period = {task.turns}: must be 1 with whirl, whose period is its own")
    if task.is_whirl and task.follows_bifurcations:
        raise PeriodicError("branches: not with whirl, at whose bifurcations none are followed")
    check_parts(rotor)
    _check_returning(rotor)
    speeds = (task.low, task.high) if task.name == SPEED else (task.speed,)
    if task.name == SPEED and task.low < 0.0 < task.high:
        shown = f"speed = {task.low:g}:{task.high:g} rad/s"
        raise PeriodicError(f"{shown}: must not pass through 0, where a turn never ends")
    for speed in speeds:
        if not _SLOWEST <= abs(speed) < math.inf:
            raise PeriodicError(
                f"speed = {speed:g} rad/s: must be at least {_SLOWEST:g} rad/s in size, and finite"
            )
    if task.name != SPEED:
        check_range(rotor, task.name, task.low, task.high)
    beyond = []
    for allowed in speed_ranges(machine_with_oil(rotor)):
        if left := [speed for speed in speeds if not allowed.holds(speed)]:
            beyond.append(allowed.message(max(left, key=abs)))
            if allowed.code == BEYOND_TABLE:
                raise PeriodicError(f"{beyond[-1]}; no periodic response is computed there")
    return beyond


def check_range(rotor: Rotor, name: str, low: float, high: float) -> None:
    """Raise `QuantityError` for a range of a machine's number whose ends it cannot have, or what is
    between: a number of balls is never followed."""
    for value in (low, high, low + _BETWEEN * (high - low)):
        rotor.with_value(name, value)


def check_parts(rotor: Rotor) -> None:
    """Raise `PeriodicError` for a part whose tangents are not constant over many turns."""
    for where, part in rotor.named_parts():
        if any(law.bow is not None for law in part.LAWS):
            raise PeriodicError(
                f"{where}: its thermal bow is slower than one period; use a [[contact]] without "
                "heating"
            )


def _check_returning(rotor: Rotor) -> None:
    """Raise `PeriodicError` for a part that does not return after whole revolutions."""
    for where, part in rotor.named_parts():
        if ROLLING_BEARING in part.LAWS:
            ratio = interpreted(cage_ratio)(part)
            raise PeriodicError(
                f"{where}: its cage turns {ratio:.4g} times in a revolution of the shaft and does "
                "not come round with it; run the machine in time, or take a [[linear_bearing]]"
            )


def machines_of(rotor: Rotor, task: Task) -> Machines:
    """Return the machine as a function of the parameter."""
    if task.name == SPEED:
        machine = CondensedMachine(rotor, task.loads)
        return lambda _: machine
    first = CondensedMachine(rotor.with_value(task.name, task.low), task.loads)
    return lru_cache(KEPT)(lambda value: first.with_rotor(rotor.with_value(task.name, value)))
