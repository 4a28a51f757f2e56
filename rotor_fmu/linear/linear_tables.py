"""What tables of linear analyses show, and their numbers for JSON."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..cells import five_digits
from ..display import speed_with_unit
from ..model.prominent_peaks import prominent_peaks

_ROUNDING = 1e-8  # of the largest of values of one kind
_DIGITS = 6  # of an angle in degrees behind the point: what follows is rounding
_PROMINENT = 1e-4  # of a peak, by which it rises above what lies beside it: less is rounding
# properties that stand beside the fields of a result
_DERIVED = (
    *("damped", "natural", "damping_ratio", "log_dec", "whirl", "forwardness", "major"),
    *("amplification", "is_one_sided", "is_met", "ratio", "is_level_2_required"),
    *("depends_on_density", "residual", "conclusion"),
)


def shown_either_way(speed: float) -> str:
    """Return a speed [rad/s] of either sense of rotation as it is shown, and in rad/s."""
    return f"{speed_with_unit(abs(speed))} ({abs(speed):.6g} rad/s)"


def whirls_where(is_first: bool, turns: Sequence[str], whirls: str) -> str:
    """Return between which of these values something whirls, which at each of them begins to, or
    ends; is_first: whether it does below them; whirls: the word for it."""
    if not turns:
        return whirls if is_first else "does not whirl"
    places = [f"below {turns[0]}"] if is_first else []
    rest = turns[is_first:]
    places += [f"from {begin} to {end}" for begin, end in zip(rest[::2], rest[1::2], strict=False)]
    places += [f"above {rest[-1]}"] if len(rest) % 2 else []
    return f"{whirls} {' and '.join(places)}"


def state_in_words(speed: float, contacts: str) -> str:
    """Return the speed of rotation [rad/s] and the state of the contacts for a heading."""
    return f"{speed_with_unit(speed)} ({five_digits(speed)} rad/s), contacts {contacts}"


def peaks(size: np.ndarray) -> list[int]:
    """Return the places of a curve's maxima, of its largest value where there is none inside."""
    with np.errstate(divide="ignore"):
        height = np.log(size)
    inner = prominent_peaks(height, _PROMINENT)[0].tolist()
    # of two of one height each is as prominent as both together, though nothing lies between them
    apart = [
        i
        for k, i in enumerate(inner)
        if k == 0 or height[i] - height[inner[k - 1] : i].min() >= _PROMINENT
    ]
    return apart or [int(np.argmax(size))]


def numbers(result: Any) -> dict[str, object]:
    """Return all numbers of a linear analysis for JSON, SI units, complex as [real, imaginary]."""
    return {name: _plain(getattr(result, name)) for name in names_of(result)}


def names_of(result: Any) -> tuple[str, ...]:
    """Return the keys of a result, or of its class: its fields, and what follows from them."""
    if hasattr(result, "_fields"):
        return tuple(result._fields)
    return (*result.__dataclass_fields__, *(name for name in _DERIVED if hasattr(result, name)))


def _plain(value: Any) -> Any:
    if hasattr(value, "__dataclass_fields__") or hasattr(value, "_fields"):
        return numbers(value)
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return [value.real, value.imag] if isinstance(value, complex) else value


def clean_damping(ratio: Any) -> Any:
    """Return dampings with rounding errors set to 0."""
    return np.where(np.abs(ratio) < 1e-10, 0.0, ratio)[()]


def degrees_of(value: complex) -> float:
    """Return the angle of a complex number [deg], what is rounding set to 0."""
    return round(math.degrees(np.angle(value)), _DIGITS) + 0.0  # no -0


def is_rounding(values: np.ndarray, beside: np.ndarray) -> bool:
    """Whether values are rounding, or nothing, beside the largest of values of their kind."""
    return bool(np.abs(values).max() <= _ROUNDING * np.abs(beside).max())


def without_rounding(factor: float, *values: np.ndarray) -> list[list[float]]:
    """Return values of one kind times a factor, 0 where they are rounding beside the largest."""
    least = _ROUNDING * max(np.abs(of).max(initial=0.0) for of in values)
    return [np.where(np.abs(of) > least, of * factor, 0.0).tolist() for of in values]
