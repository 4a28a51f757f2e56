"""The kinds of runs that a study of a machine may have, with their numbers."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import InputError
from ..model.quantities import ANY, NOT_NEGATIVE, POSITIVE, Quantity, Rule, check
from ..studies.design import MOST

_STANDS = 1e-9  # of the highest speed, what rounding leaves of none


class Number(NamedTuple):
    """A number of a kind of run: its unit, its default (None: must be given; a name: that of the
    machine's `OperatingSpeeds`), what it is, its rule, and whether it must be an integer."""

    unit: str
    default: float | str | None
    text: str
    rule: Rule = ANY
    is_whole: bool = False

    def check(self, name: str, value: float) -> None:
        """Raise `InputError` for a value that the number cannot have."""
        check(f"run.{name}", Quantity(self.unit, self.text, self.rule), value)
        if self.is_whole and (value != int(value) or value > MOST):
            raise InputError(f"run.{name} = {value:g}: must be an integer, at most {MOST}")


@dataclass(frozen=True)
class RunKind:
    """A kind of run.

    name; numbers: all of which can be varied as `run.NAME`; is_free: whether the rotor's speed is a
    state; holds_speeds: whether speeds are held, each a window of its own.
    """

    name: str
    numbers: Mapping[str, Number]
    is_free: bool = False
    holds_speeds: bool = False

    def check(self, values: Mapping[str, float]) -> None:
        """Raise `InputError` for values that the numbers cannot have, or not together."""
        for name, number in self.numbers.items():
            number.check(name, values[name])
        if self.holds_speeds and not values["measure"]:
            speeds = np.abs(self.speeds(values))
            if speeds.min() <= _STANDS * speeds.max():
                ends = ("speed",) if "speed" in values else ("from", "to")
                given = ", ".join(f"run.{name} = {values[name]:g}" for name in ends)
                raise InputError(
                    f"{given} rad/s: held speeds must not be 0 (whole revolutions are evaluated)"
                )
        if "rate" in values and values["from"] == values["to"]:
            raise InputError(f"run.to = {values['to']:g} rad/s: must differ from run.from")

    def idle(self, values: Mapping[str, float]) -> dict[str, str]:
        """Return the numbers that have no effect beside the others, with the reason."""
        if not self.holds_speeds:
            return {}
        if values["measure"]:
            return dict.fromkeys(("turns", "per_turn"), "with run.measure")
        return {"step": "without run.measure"}

    def speeds(self, values: Mapping[str, float]) -> np.ndarray:
        """Return the speeds that are held [rad/s], in their order."""
        if "speed" in values:
            return np.array([values["speed"]])
        up = np.linspace(values["from"], values["to"], int(values["count"]))
        return np.concatenate([up, up[-2::-1]]) if values["back"] else up


STOP = Number("s", None, "end of the run", POSITIVE)
_STEP = Number("s", 0.04, "communication step, at which the speed is updated", POSITIVE)
_RATE_TEXT = "rate of the speed, without sign"
_DOWN = {
    "from": Number("rad/s", "trip", "speed at the start"),
    "to": Number("rad/s", 0.0, "speed at the end"),
    "rate": Number("rad/s2", "run_down_rate", _RATE_TEXT, POSITIVE),
    "step": _STEP,
}
_UP = {
    "from": Number("rad/s", 0.0, "speed at the start"),
    "to": Number("rad/s", "highest", "highest speed"),
    "rate": Number("rad/s2", "run_up_rate", _RATE_TEXT, POSITIVE),
    "step": _STEP,
}
_MEASURED = {
    "settle": Number("s", 1.0, "time that each speed is held before it is evaluated", NOT_NEGATIVE),
    "turns": Number("1", 64.0, "turns evaluated", POSITIVE, is_whole=True),
    "per_turn": Number("1", 32.0, "samples per turn, of metrics over whole turns", POSITIVE, True),
    "measure": Number("s", 0.0, "time evaluated, instead of turns", NOT_NEGATIVE),
    "step": Number("s", 1e-3, "communication step, where measure is given", POSITIVE),
}
_STEPS = {
    "from": Number("rad/s", None, "first speed"),
    "to": Number("rad/s", None, "last speed"),
    "count": Number("1", None, "number of speeds", POSITIVE, is_whole=True),
    "back": Number("1", 0.0, "1: and back to the first", NOT_NEGATIVE, is_whole=True),
}
_DROP = {
    "speed": Number("rad/s", None, "speed at the release"),
    "stop": STOP,
    "step": Number("s", 1e-4, "communication step", POSITIVE),
}
# A motor with a torque limit that follows a ramp.
MOTOR = {
    "torque": Number("N.m", None, "torque limit of the motor", POSITIVE),
    "target": Number("rad/s", "rated", "speed that the motor is to reach"),
    "ramp": Number("rad/s2", "run_up_rate", "rate of the speed that it follows", POSITIVE),
    "gain": Number("N.m.s/rad", 0.1, "torque per speed error", POSITIVE),
    "from": Number("rad/s", 1.0, "speed at the start"),
    "stop": STOP,
    "step": Number("s", 2e-3, "interval between two commands to the motor", POSITIVE),
}
_SPEED = {"speed": Number("rad/s", None, "speed")}
CONSTANT = RunKind("constant", _SPEED | _MEASURED, holds_speeds=True)
STEPS = RunKind("steps", _STEPS | _MEASURED, holds_speeds=True)
DOWN, UP = RunKind("run-down", _DOWN), RunKind("run-up", _UP)
UP_AND_DOWN = RunKind("up-and-down", _UP)
DROP = RunKind("drop", _DROP, is_free=True)
BY_MOTOR = RunKind("motor", MOTOR, is_free=True)
SIGNALS = RunKind("signals", {"stop": STOP, "step": _STEP})
IN_TIME = (DOWN, UP, UP_AND_DOWN, CONSTANT, STEPS, SIGNALS, DROP, BY_MOTOR)
