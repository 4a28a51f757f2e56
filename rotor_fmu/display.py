"""The units in which tables, pictures and pages show speeds and displacements, chosen once."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from functools import wraps
from typing import Any, NamedTuple, TypeVar, cast

from .cells import five_digits
from .errors import InputError
from .model.near_names import suggestion

Method = TypeVar("Method", bound=Callable[..., Any])
INCH, POUND, LBF = 0.0254, 0.45359237, 0.45359237 * 9.80665
OUNCE = POUND / 16


def in_letters(unit: str) -> str:
    """A unit in letters that every terminal has."""
    return unit.replace("µ", "u")


class Shown(NamedTuple):
    """Factor from an SI unit to the unit that is shown, and that unit."""

    factor: float
    unit: str

    @property
    def word(self) -> str:
        """The unit in letters that every terminal has."""
        return in_letters(self.unit)

    def text(self, value: float, digits: int = 5) -> str:
        """Return a value in the SI unit as it is shown, with the unit if there is one."""
        behind = "" if self.unit in ("", "1") else f" {self.word}"
        return f"{self.factor * value:.{digits}g}{behind}"


@dataclass(frozen=True)
class Display:
    """Names of units, and what one SI unit is in each: of speeds [rad/s], displacements [m],
    lengths [m], masses [kg], forces [N], stiffnesses [N/m], dampings [N.s/m], torques [N.m],
    pressures [Pa], unbalances [kg.m]; whether amplitudes are peak-to-peak."""

    speed_unit: str = "Hz"
    speed: float = 1 / (2 * math.pi)
    small_unit: str = "µm"
    small: float = 1e6
    length_unit: str = "mm"
    length: float = 1e3
    mass_unit: str = "kg"
    mass: float = 1.0
    force_unit: str = "N"
    force: float = 1.0
    stiffness_unit: str = "N/m"
    stiffness: float = 1.0
    damping_unit: str = "N.s/m"
    damping: float = 1.0
    torque_unit: str = "N.m"
    torque: float = 1.0
    pressure_unit: str = "MPa"
    pressure: float = 1e-6
    unbalance_unit: str = "g.mm"
    unbalance: float = 1e6
    is_pp: bool = False

    @property
    def small_word(self) -> str:
        """Unit of displacements in letters that every terminal has."""
        return in_letters(self.small_unit)

    @property
    def amplitude(self) -> float:
        """Factor from m 0-p to the unit of amplitudes."""
        return self.small * (2 if self.is_pp else 1)

    @property
    def amplitude_unit(self) -> str:
        """Unit of amplitudes, with what is measured."""
        return f"{self.small_unit} {'pp' if self.is_pp else '0-p'}"

    @property
    def amplitude_words(self) -> str:
        """Unit of amplitudes in letters that every terminal has."""
        return in_letters(self.amplitude_unit)

    @property
    def speed_label(self) -> str:
        """Label of an axis of speeds."""
        return f"Rotational speed n [{self.speed_unit}]"

    def of_si(self, unit: str) -> Shown:
        """How a quantity in an SI unit is shown, metres as displacements, angles in degrees; what
        has no other unit is shown as it is."""
        shown = {
            "rad/s": (self.speed, self.speed_unit),
            "rad/s2": (self.speed, f"{self.speed_unit}/s"),
            "rad": (180.0 / math.pi, "deg"),
            "m": (self.small, self.small_unit),
            "kg": (self.mass, self.mass_unit),
            "N": (self.force, self.force_unit),
            "N/m": (self.stiffness, self.stiffness_unit),
            "N.s/m": (self.damping, self.damping_unit),
            "N.m": (self.torque, self.torque_unit),
            "Pa": (self.pressure, self.pressure_unit),
            "kg.m": (self.unbalance, self.unbalance_unit),
        }
        return Shown(*shown.get(unit, (1.0, unit)))

    @property
    def frequency_unit(self) -> str:
        """Unit of frequencies beside speeds in Hz or rpm."""
        return "cpm" if self.speed_unit == "rpm" else self.speed_unit

    @property
    def frequency_label(self) -> str:
        """Label of an axis of frequencies."""
        return f"Frequency [{self.frequency_unit}]"


_RPM = {"speed_unit": "rpm", "speed": 30 / math.pi}
_MIL = {"small_unit": "mil", "small": 1e3 / INCH}
_INCHES = {
    **{"length_unit": "in", "length": 1 / INCH},
    **{"mass_unit": "lb", "mass": 1 / POUND, "force_unit": "lbf", "force": 1 / LBF},
    **{"stiffness_unit": "lbf/in", "stiffness": INCH / LBF},
    **{"damping_unit": "lbf.s/in", "damping": INCH / LBF},
    **{"torque_unit": "lbf.in", "torque": 1 / (LBF * INCH)},
    **{"pressure_unit": "psi", "pressure": INCH**2 / LBF},
    **{"unbalance_unit": "oz.in", "unbalance": 1 / (OUNCE * INCH)},
}
# What each word of `--units` changes.
_US: dict[str, object] = _RPM | _MIL | _INCHES
_WORDS: dict[str, dict[str, object]] = {
    "si": {name: getattr(Display(), name) for name in _US},
    "us": _US,
    "Hz": {"speed_unit": "Hz", "speed": 1 / (2 * math.pi)},
    "rpm": _RPM,
    "um": {"small_unit": "µm", "small": 1e6},
    "mil": _MIL,
    "0-p": {"is_pp": False},
    "pp": {"is_pp": True},
}
_SYSTEMS = ("si", "us")  # of which the other words change a part, wherever they stand
_current: ContextVar[Display | None] = ContextVar("display", default=None)


def current() -> Display:
    """Return the units that are shown now."""
    return _current.get() or Display()


def display_of(shown: str, text: str) -> Display:
    """Return the units of words such as `us` or `rpm, mil, pp`; shown: what gives them. Raises
    `InputError` for another word, and for two that change the same."""
    result, chosen = Display(), dict[tuple[str, ...], str]()
    known = {word.lower(): change for word, change in _WORDS.items()}
    words = text.replace(",", " ").split()
    for word in sorted(words, key=lambda word: word.lower() not in _SYSTEMS):
        if word.lower() not in known:
            hint = suggestion(word.lower(), known)
            raise InputError(f"{shown} {text}: {word!r} must be one of {', '.join(_WORDS)}{hint}")
        change = known[word.lower()]
        before = chosen.setdefault(tuple(change), word)
        if before.lower() != word.lower():
            raise InputError(f"{shown} {text}: {before!r} and {word!r} are units of the same")
        result = replace(result, **change)  # type: ignore[arg-type]
    return result


def shown_speed(omega: float) -> str:
    """Return a speed [rad/s] in the unit that is shown: four digits, or all before the point."""
    value = float(omega) * current().speed
    return f"{value:.4g}" if abs(value) < 9999.5 else f"{value:.0f}"


def speed_with_unit(omega: float) -> str:
    """Return a speed [rad/s] in the unit that is shown, to five digits, with the unit."""
    return f"{five_digits(float(omega) * current().speed)} {current().speed_unit}"


def range_with_unit(low: float, high: float) -> str:
    """Return a range of speeds [rad/s], which may be one speed, in words: `at 8000 rpm`."""
    if low == high:
        return f"at {speed_with_unit(high)}"
    return f"between {five_digits(low * current().speed)} and {speed_with_unit(high)}"


@contextmanager
def restored() -> Iterator[None]:
    """Whatever units are chosen within are chosen for that long."""
    token = _current.set(_current.get())
    try:
        yield
    finally:
        _current.reset(token)


def in_its_units(show: Method) -> Method:
    """A method that shows the units of `shown_units`, a machine's, unless others are chosen."""

    @wraps(show)
    def in_units(self: Any, *arguments: Any, **options: Any) -> Any:
        with restored():
            if _current.get() is None:
                choose(None, self.shown_units)
            return show(self, *arguments, **options)

    return cast(Method, in_units)


def choose(option: str | None, of_file: str = "", file: object = "") -> None:
    """Show the units of `--units`, else those that a machine's file says; file: its name."""
    where = f"{file}: units =" if file else "units ="
    given = ("--units", option) if option is not None else (where, of_file)
    _current.set(display_of(*given))
