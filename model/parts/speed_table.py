"""Columns of a table over the speed, interpolated monotonically (PCHIP: Fritsch and Carlson 1980).

A row is a speed, and for each column the cubic of the interval that begins there, four numbers.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..kernels.jit import jit
from ..quantities import QuantityError


@jit
def row_at(tables, first, rows, width, speed):
    """Return the index of the last row of `width` numbers that does not lie beyond a speed, or of
    the first."""
    at, left = first, rows
    while left > 1:
        half = left // 2
        if tables[at + half * width] <= speed:
            at += half * width
            left -= half
        else:
            left = half
    return at


@jit
def cubic(tables, at, s):
    """Return a cubic of s, highest power first."""
    return ((tables[at] * s + tables[at + 1]) * s + tables[at + 2]) * s + tables[at + 3]


def interpolant(over: Sequence[float], values: Sequence[float] | np.ndarray) -> Any:
    """Return the interpolating function of values over ascending numbers."""
    # imported where a table is: it takes longer than all else that a machine is made of
    from scipy.interpolate import PchipInterpolator

    return PchipInterpolator(over, values)


def speed_table(
    speed: Sequence[float], columns: Sequence[str], values: Mapping[str, Sequence[float]]
) -> np.ndarray:
    """Return the rows of columns over speeds [rad/s], constant beyond the last; a column without
    values is 0."""
    rows = np.zeros((len(speed), 1 + 4 * len(columns)))
    rows[:, 0] = speed
    for i, name in enumerate(columns):
        if name in values:
            first = 1 + 4 * i
            rows[:-1, first : first + 4] = interpolant(speed, values[name]).c.T
            rows[-1, first + 3] = values[name][-1]
    return rows


def check_ascending(name: str, unit: str, values: Sequence[float]) -> None:
    """Raise `QuantityError` unless the values of a table's first column ascend."""
    for i, (low, high) in enumerate(pairwise(values), 2):
        if not low < high:
            raise QuantityError(f"{name}[{i}] = {high:g} {unit}: must be above {low:g}")


def check_column(name: str, values: Sequence[float], over: str, count: int) -> None:
    """Raise `QuantityError` unless a column has as many values as its abscissae."""
    if len(values) != count:
        raise QuantityError(f"{name}: {len(values)} given, {count} needed, as many as {over} has")
