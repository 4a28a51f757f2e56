"""Checks of the arguments of analyses, which are of any type when they come from Python."""

import math
import reprlib
from numbers import Real
from typing import Any

from .errors import InputError
from .quantities import POSITIVE


def shown_value(name: str, value: object) -> str:
    """Return an argument and its value in one line, shortened."""
    return f"{name} = {' '.join(reprlib.repr(value).split())}"


def number(name: str, value: Any) -> float:
    """Return a number of Python or numpy, or an array of no dimension, as a float; `InputError` for
    anything else."""
    given = value.item() if getattr(value, "ndim", None) == 0 else value
    if isinstance(given, bool) or not isinstance(given, Real):
        raise InputError(f"{shown_value(name, value)}: must be a number")
    return float(given)


def check_positive(
    name: str, value: float, unit: str = "", error: type[InputError] = InputError
) -> None:
    """Raise an error unless a number is above 0 and finite; unit: its SI unit."""
    if not 0.0 < value < math.inf:
        raise error(f"{name} = {value:g}{unit and f' {unit}'}: {POSITIVE.words}")


def numbers(name: str, values: Any) -> list[float]:
    """Return the numbers of a list or an array; `InputError` for anything else."""
    try:
        return [number(name, value) for value in values]
    except (TypeError, InputError):
        raise InputError(f"{shown_value(name, values)}: must be a list of numbers") from None


def rows(name: str, values: Any, form: str) -> list[tuple[int, float, float]]:
    """Return a list of a node and two numbers each; form: what they are; `InputError` for anything
    else."""
    try:
        return [(node, number(name, a), number(name, b)) for node, a, b in values]
    except (TypeError, ValueError):
        raise InputError(f"{shown_value(name, values)}: must be a list of {form}") from None
