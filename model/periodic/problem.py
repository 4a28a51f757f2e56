"""What is asked of a machine's periodic motions, and the branches that answer it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from ..machine.rotor import Rotor
from ..machine.speed_tables import tables_of
from ..message_templates import Message
from ..quantities import QuantityError
from .arclength import Steps
from .balance import Orbit, Parameter, Problem, cached
from .branch import Branch
from .harmonic_count import Accuracy
from .linear_structure import Condensed

SPEED = "speed"

Machines = Callable[[float], Condensed]  # of a value of the parameter


class PeriodicError(QuantityError):
    """A periodic answer that cannot be had; says why."""


@dataclass(frozen=True)
class Task:
    """What is asked for: the parameter over [low, high], `speed` [rad/s] where it is another one,
    constant `loads` on the ports [N], `turns` in a period, how exact, how long the steps are,
    values at which runs in time seed further branches; is_whirl: of the machine
    without unbalance, that which whirls by itself; begin: an orbit
    from which alone branches are followed, at the machine's own value of the parameter;
    has_branches: whether those are followed too that begin at period doublings and branch
    points."""

    low: float
    high: float
    name: str = SPEED
    speed: float = 0.0
    turns: int = 1
    loads: np.ndarray | None = None
    accuracy: Accuracy = field(default_factory=Accuracy)
    steps: Steps = field(default_factory=lambda: Steps(most=0.1))
    seeds: tuple[float, ...] = ()
    is_whirl: bool = False
    begin: Orbit | None = None
    has_branches: bool = False

    @property
    def parameter(self) -> Parameter:
        """What is varied, with the length of its range."""
        return Parameter(self.name, self.high - self.low)

    def speed_at(self, value: float) -> float:
        """The speed at a value of the parameter [rad/s]."""
        return value if self.name == SPEED else self.speed

    def rotor_at(self, rotor: Rotor, value: float) -> Rotor:
        """The machine with a value of the parameter."""
        return rotor if self.name == SPEED else rotor.with_value(self.name, value)

    def is_shot(self, orbit: Orbit) -> bool:
        """Whether an orbit has more harmonics than may be balanced, and so is one of `shooting`."""
        return orbit.H * self.turns > self.accuracy.most * orbit.turns

    def problem(self, machines: Machines, at: float, H: int, **options: Any) -> Problem:
        """The equations about a value of the parameter, with H harmonics."""
        return Problem(machines, self.parameter, at, H, speed=self.speed, **options)


class Note(Message):
    """A message about values of what is varied; as text it has them in SI units."""

    __slots__ = ("parts", "unit")
    parts: tuple[str | float, ...]
    unit: str

    def __new__(cls, code: str, unit: str, *parts: str | float) -> Note:
        """Return a message of texts and values; unit: of the values."""
        note = cast(Note, super().__new__(cls, _joined(parts, 1.0, unit), code))
        note.parts, note.unit = parts, unit
        return note

    def __getnewargs__(self) -> tuple[Any, ...]:
        """Return the arguments of a copy."""
        return self.code, self.unit, *self.parts

    def shown(self, factor: float, unit: str) -> Message:
        """Return it with its values in another unit; factor: to that."""
        return Message(_joined(self.parts, factor, unit), self.code)


def _joined(parts: tuple[str | float, ...], factor: float, unit: str) -> str:
    behind = "" if unit in ("", "1") else f" {unit}"
    return "".join(p if isinstance(p, str) else f"{factor * p:.5g}{behind}" for p in parts)


@dataclass
class Response:
    """Branches of a task, and what is to be said of them, a line each; is_stopped: whether
    it was interrupted."""

    rotor: Rotor
    task: Task
    branches: list[Branch] = field(default_factory=list)
    notes: list[Message] = field(default_factory=list)
    is_stopped: bool = False

    @property
    def unit(self) -> str:
        """The SI unit of what is varied."""
        if self.task.name == SPEED:
            return "rad/s"
        return {str(n): of.unit for n, of, _ in self.rotor.parameters()}[self.task.name]

    def machines(self) -> Machines:
        """The machine over the parameter."""
        return machines_of(self.rotor, self.task)


def check(rotor: Rotor, task: Task) -> None:
    """Raise `PeriodicError` or `QuantityError` for what cannot be asked of a machine."""
    if not task.low < task.high:
        raise PeriodicError(f"{task.name} = {task.low:g}:{task.high:g}: FROM must be below TO")
    check_parts(rotor)
    speeds = (task.low, task.high) if task.name == SPEED else (task.speed,)
    for speed in speeds:
        if not 0 < speed < math.inf:
            raise PeriodicError(f"speed = {speed:g} rad/s: must be > 0 and finite")
        for allowed in tables_of(rotor):
            if not allowed.low <= speed <= allowed.high:
                raise PeriodicError(allowed.beyond.format(speed=speed))
    if task.name != SPEED:
        for value in (task.low, task.high):
            rotor.with_value(task.name, value)


def check_parts(rotor: Rotor) -> None:
    """Raise `PeriodicError` for a part whose tangents do not hold over a turn."""
    for where, part in rotor.named_parts():
        if any(law.bow is not None for law in part.LAWS):
            raise PeriodicError(
                f"{where}: its heat bows the shaft more slowly than a motion repeats; a contact in "
                "its place rubs without heat"
            )


def machines_of(rotor: Rotor, task: Task) -> Machines:
    """The machine over the parameter."""
    if task.name == SPEED:
        machine = Condensed(rotor, task.loads)
        return lambda _: machine
    first = Condensed(rotor.with_value(task.name, task.low), task.loads)
    return cached(lambda value: first.with_rotor(rotor.with_value(task.name, value)))
