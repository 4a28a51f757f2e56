"""What drives a run: input signals over time, from a law, from a CSV file, or held constant."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..fmu.variables import Variable

# Paper A's run-down: 400 - 10 t rad/s, over 40 s.
RUN_DOWN_SPEED = 400.0
RUN_DOWN_RATE = -10.0
RUN_DOWN_STOP = 40.0


@dataclass(frozen=True)
class Signals:
    """Inputs over time: t, shape (n,) [s], ascending; values by the input's name, shape (n,)."""

    t: np.ndarray
    values: Mapping[str, np.ndarray]

    def at(self, name: str, t: float) -> float:
        """Value of one input at time t [s], by the interpolation that FMPy makes (bit for bit)."""
        index = int(np.searchsorted(self.t, t))
        column = self.values[name]
        if index == 0 or len(self.t) < 2:
            return float(column[0])
        if index == len(self.t):
            return float(column[-1])
        before, after = self.t[index - 1], self.t[index]
        weight = (after - t) / (after - before)
        return float(weight * column[index - 1] + (1 - weight) * column[index])

    def as_structured(self) -> np.ndarray:
        """The structured array that FMPy takes."""
        columns = {"time": self.t, **self.values}
        table = np.zeros(len(self.t), dtype=[(name, float) for name in columns])
        for name, column in columns.items():
            table[name] = column
        return table

    @property
    def first_rate(self) -> float:
        """Rate of the speed at the start [rad/s2]."""
        if len(self.t) < 2:
            return 0.0
        speed = self.values["speed"]
        return float((speed[1] - speed[0]) / (self.t[1] - self.t[0]))


def make_signals(
    table: Sequence[Variable],
    stop: float,
    constants: Mapping[str, float],
    recorded: Signals | None = None,
) -> Signals:
    """All inputs of a run to `stop` [s]: recorded signals, else constants, else the run-down of
    paper A for the speed and the start value for what is left."""
    if recorded is None:
        end = max(stop, RUN_DOWN_STOP)
        t = np.array([0.0, RUN_DOWN_STOP, end][: 3 if end > RUN_DOWN_STOP else 2])
        speed = np.maximum(RUN_DOWN_SPEED + RUN_DOWN_RATE * t, 0.0)
        recorded = Signals(t, {} if "speed" in constants else {"speed": speed})
    values = {}
    for variable in table:
        if variable.causality != "input" or variable.start is None:
            continue
        if variable.name in recorded.values:
            values[variable.name] = recorded.values[variable.name]
        else:
            constant = constants.get(variable.name, variable.start)
            values[variable.name] = np.full(len(recorded.t), float(constant))
    return Signals(recorded.t, values)


def read_signals(path: Path, table: Sequence[Variable]) -> Signals:
    """Read a CSV file: a header `time` [s] and names of inputs (SI units), then rows of numbers.

    Raises `InputError` in one line for an unknown column, a gap, a value that is not a finite
    number, or a time that does not increase.
    """
    inputs = [variable.name for variable in table if variable.causality == "input"]
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    if not rows:
        raise InputError(f"{path}: is empty; a header line with `time` is needed")
    header = [name.strip() for name in rows[0]]
    for name in header:
        if name != "time" and name not in inputs:
            raise InputError(
                f"{path}: column {name!r} is unknown; known are time, {', '.join(inputs)}"
            )
        if header.count(name) > 1:
            raise InputError(f"{path}: column {name!r} is given twice")
    if "time" not in header:
        raise InputError(f"{path}: column 'time' is missing")
    if len(rows) < 2:
        raise InputError(f"{path}: has no rows after its header")
    data = np.array([_numbers(path, line, row, header) for line, row in enumerate(rows[1:], 2)])
    t = data[:, header.index("time")]
    for line, (before, after) in enumerate(pairwise(t), 3):
        if not after > before:
            raise InputError(
                f"{path}, line {line}: time = {after:g} s after {before:g} s: must increase"
            )
    return Signals(t, {name: data[:, i] for i, name in enumerate(header) if name != "time"})


def _numbers(path: Path, line: int, row: list[str], header: list[str]) -> list[float]:
    if len(row) != len(header):
        raise InputError(f"{path}, line {line}: {len(row)} values, {len(header)} are needed")
    numbers = []
    for name, text in zip(header, row, strict=True):
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            shown = text.strip() or "(nothing)"
            raise InputError(f"{path}, line {line}: {name} = {shown}: must be a finite number")
        numbers.append(number)
    return numbers
