"""What drives a run: input signals over time, from a law, from a CSV file, or held constant."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..fmu.variables import Variable
from ..units import units_for

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
        """Rate of the speed at the start, t = 0 [rad/s2]: none before the first time given, nor
        after the last."""
        after = int(np.searchsorted(self.t, 0.0, "right"))
        if not 0 < after < len(self.t):
            return 0.0
        speed = self.values["speed"]
        return float((speed[after] - speed[after - 1]) / (self.t[after] - self.t[after - 1]))


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
    """Read a CSV file: a header `time` and names of inputs, then rows of numbers.

    A name may carry its unit, `speed [rpm]`; without one it is SI. Commas, tabs or semicolons
    (numbers then with decimal points or commas) part the columns; lines that begin with # are
    comments. Raises `InputError` in one line for an unknown column, a gap, a value that is not a
    finite number, or a time that does not increase.
    """
    known = {"time": "s"} | {v.name: v.unit for v in table if v.causality == "input"}
    rows = _rows(path)
    if not rows:
        raise InputError(f"{path}: is empty; a header line with `time` is needed")
    columns = [_column(path, text, known) for text in rows[0][1]]
    header = [name for name, _ in columns]
    for name in header:
        if header.count(name) > 1:
            raise InputError(f"{path}: column {name!r} is given twice")
    if "time" not in header:
        raise InputError(f"{path}: column 'time' is missing")
    if len(rows) < 2:
        raise InputError(f"{path}: has no rows after its header")
    data = np.array([_numbers(path, line, row, header) for line, row in rows[1:]])
    data *= [factor for _, factor in columns]
    t = data[:, header.index("time")]
    for (line, _), (before, after) in zip(rows[2:], pairwise(t), strict=True):
        if not after > before:
            raise InputError(
                f"{path}, line {line}: time = {after:g} s after {before:g} s: must increase"
            )
    return Signals(t, {name: data[:, i] for i, name in enumerate(header) if name != "time"})


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Number and cells of every line that is neither empty nor a comment."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    between = next((mark for mark in ";\t" if lines and mark in lines[0][1]), ",")
    rows = []
    for number, line in lines:
        plain = line if between == "," else line.replace(",", ".")
        rows.append((number, [cell.strip().strip('"') for cell in plain.split(between)]))
    return rows


def _column(path: Path, text: str, known: Mapping[str, str]) -> tuple[str, float]:
    """Name of an input, and what its unit is in SI, of `speed` or `speed [rpm]`."""
    name, unit = text, None
    if name not in known and name.endswith("]"):
        name, _, unit = (part.strip() for part in text[:-1].rpartition("["))
    if name not in known:
        near = get_close_matches(text.partition(" ")[0], known, 3) or list(known)
        raise InputError(f"{path}: column {text!r} is unknown; did you mean {', '.join(near)}?")
    units = units_for(known[name])
    if unit is not None and unit not in units:
        raise InputError(f"{path}: column {name!r} in {unit!r}: must be in {' or '.join(units)}")
    return name, units.get(unit or known[name], 1.0)


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
