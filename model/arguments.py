"""Checks of the arguments of analyses, which are of any type when they come from Python."""

import math
import os
import reprlib
from collections.abc import Collection, Hashable, Mapping
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from .errors import InputError
from .near_names import suggestion
from .quantities import POSITIVE


def shown_value(name: str, value: object) -> str:
    """Return an argument and its value in one line, shortened."""
    return f"{name} = {' '.join(reprlib.repr(value).split())}"


def is_one_of(value: object, known: Collection[object]) -> bool:
    """Return whether an argument of any type is among the known values, as no list or array is."""
    return isinstance(value, Hashable) and value in tuple(known)


def check_one_of(
    given: str, value: object, known: Collection[str], error: type[InputError] = InputError
) -> None:
    """Raise an error for a value that is not among the known ones; the message asks if one that is
    like it was meant.

    given: the value and what it is of, in the words of who gave it.
    """
    if not is_one_of(value, known):
        raise error(f"{given}: must be one of {', '.join(known)}{suggestion(value, known)}")


def number(name: str, value: Any) -> float:
    """Return a number of Python or numpy, or an array of no dimension, as a float; `InputError` for
    anything else."""
    given = value.item() if getattr(value, "ndim", None) == 0 else value
    if isinstance(given, bool) or not isinstance(given, Real):
        raise InputError(f"{shown_value(name, value)}: must be a number")
    try:
        return float(given)
    except OverflowError:  # an integer of hundreds of digits
        raise InputError(f"{shown_value(name, value)}: must be a finite number") from None


def switch(name: str, value: Any) -> bool:
    """Return an argument that is true or false, of Python or numpy, as a bool; `InputError` for
    anything else, which Python would take for one of them."""
    given = value.item() if getattr(value, "ndim", None) == 0 else value
    if not isinstance(given, bool):
        raise InputError(f"{shown_value(name, value)}: must be True or False")
    return given


def check_integer(
    name: str, value: object, low: int, high: float = math.inf, error: type[InputError] = InputError
) -> None:
    """Raise an error unless an argument of any type is an integer of Python or numpy within bounds,
    as no bool is."""
    is_whole = isinstance(value, Integral) and not isinstance(value, bool)
    if not (is_whole and low <= value <= high):  # type: ignore[operator]
        bounds = f", at least {low}" if high == math.inf else f" from {low} to {high}"
        raise error(f"{shown_value(name, value)}: must be an integer{bounds}")


def check_positive(
    name: str, value: float, unit: str = "", error: type[InputError] = InputError
) -> None:
    """Raise an error unless a number is above 0 and finite; unit: its SI unit."""
    if not 0.0 < number(name, value) < math.inf:
        raise error(f"{name} = {value:g}{unit and f' {unit}'}: {POSITIVE.words}")


def numbers(name: str, values: Any) -> list[float]:
    """Return the numbers of a list or an array; `InputError` for anything else."""
    try:
        return [number(name, value) for value in values]
    except (TypeError, InputError):
        raise InputError(f"{shown_value(name, values)}: must be a list of numbers") from None


def listed(name: str, values: Any, what: str) -> list[Any]:
    """Return what a list, an array or the like holds; what: that is, in words; `InputError` for
    anything else, a text too."""
    try:
        if not isinstance(values, (str, bytes)):
            return list(values)
    except TypeError:
        pass
    raise InputError(f"{shown_value(name, values)}: must be a list of {what}")


def mapped(name: str, values: Any) -> dict[Any, Any]:
    """Return a mapping as a dictionary, an empty one of None; `InputError` for anything else."""
    if values is not None and not isinstance(values, Mapping):
        raise InputError(f"{shown_value(name, values)}: must be a dictionary")
    return dict(values or {})


def path_of(name: str, value: Any) -> Path:
    """Return the path of a file or a folder; `InputError` for what is none."""
    if not isinstance(value, (str, os.PathLike)):
        raise InputError(f"{shown_value(name, value)}: must be a path")
    return Path(value)


def rows(name: str, values: Any, form: str) -> list[tuple[Any, float, float]]:
    """Return a list of a node and two numbers each, or `InputError`; form: what they are."""
    try:
        return [(node, number(name, a), number(name, b)) for node, a, b in values]
    except (TypeError, ValueError):
        raise InputError(f"{shown_value(name, values)}: must be a list of {form}") from None
