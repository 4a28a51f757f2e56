"""The inputs of a run over time: a ramp of the speed, from a CSV file, or held constant."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..errors import InputError, read_text
from ..fmi.variables import Variable
from ..model.machine.rotor import Rotor
from ..model.near_names import near_names
from ..model.simulation import Simulation
from ..operating_speeds import operating_speeds
from ..units import factor, in_si, split

_ROUNDING = 1e-11  # of an input's values: what is no bend of its course
_SLIVER = 1e-9  # of an interval: a bend so near to its end is its end
_RAMP_UNITS = {"--from": "rad/s", "--to": "rad/s", "--rate": "rad/s2", "--hold": "s"}


@dataclass(frozen=True)
class Signals:
    """Inputs over time: t, shape (n,) [s], ascending; values by the input's name, shape (n,)."""

    t: np.ndarray
    values: Mapping[str, np.ndarray]

    def at(self, name: str, t: float) -> float:
        """Return an input's value at time t [s], by FMPy's interpolation, bit for bit."""
        return float(self.interpolated(self.values[name], t))

    def interpolated(self, rows: np.ndarray, t: float) -> np.ndarray:
        """Return the values at time t [s] of inputs with a row of values for each time, as `at`."""
        index = int(self.t.searchsorted(t))
        if index == 0 or len(self.t) < 2:
            return np.asarray(rows[0])
        if index == len(self.t):
            return np.asarray(rows[-1])
        before, after = self.t[index - 1], self.t[index]
        weight = (after - t) / (after - before)
        return np.asarray(weight * rows[index - 1] + (1 - weight) * rows[index])

    def as_structured(self) -> np.ndarray:
        """Return the structured array that FMPy takes."""
        columns = {"time": self.t, **self.values}
        return np.rec.fromarrays([*columns.values()], [(name, float) for name in columns])

    @cached_property
    def bends(self) -> np.ndarray:
        """Times after the start between which all inputs are linear [s], ascending."""
        if len(self.t) < 2:
            return np.zeros(0)
        intervals = np.diff(self.t)
        bends = np.zeros(len(self.t), dtype=bool)
        for column in self.values.values():
            # before the first time and after the last an input is held
            slopes = np.concatenate([[0.0], np.diff(column) / intervals, [0.0]])
            change = np.abs(np.diff(slopes)) * np.minimum(
                np.append(intervals, np.inf), np.insert(intervals, 0, np.inf)
            )
            bends |= change > _ROUNDING * np.abs(column).max()
        return self.t[bends & (self.t > 0.0)]

    def is_held(self, stop: float) -> bool:
        """Whether an FMU that holds its loads between communication points, and continues its
        speed, follows these inputs exactly until `stop` [s]."""
        loads = (column for name, column in self.values.items() if name != "speed")
        is_bent = bool((self.bends < stop).any())
        return not is_bent and all(np.ptp(column) == 0.0 for column in loads)

    def loads(self, stop: float) -> dict[str, list[float]]:
        """Return the least and the largest value, until `stop` [s], of each input but the speed
        that is not 0 all the time."""
        between = (self.t > 0.0) & (self.t < stop)
        courses = {
            name: [self.at(name, 0.0), *column[between].tolist(), self.at(name, stop)]
            for name, column in self.values.items()
            if name != "speed"
        }
        return {name: [min(of), max(of)] for name, of in courses.items() if any(of)}

    @property
    def first_rate(self) -> float:
        """Rate of the speed at the start, t = 0 [rad/s2]: none before the first time given, nor
        after the last."""
        after = int(np.searchsorted(self.t, 0.0, "right"))
        if not 0 < after < len(self.t):
            return 0.0
        speed = self.values["speed"]
        return float((speed[after] - speed[after - 1]) / (self.t[after] - self.t[after - 1]))


class Driver:
    """Takes a simulation along signals, exactly whatever the intervals: each ends where an input
    bends, and between two bends loads are linear in time.

    loads: names of the inputs (x, y) of the loads; is_held: whether the speed is held over an
    interval instead of being continued.
    """

    def __init__(
        self, signals: Signals, loads: Sequence[tuple[str, str]], is_held: bool = False
    ) -> None:
        self._signals, self._is_held = signals, is_held
        x_and_y = [signals.values[name] for pair in loads for name in pair]
        self._loads = np.array(x_and_y).reshape(len(x_and_y), len(signals.t)).T.copy()
        self._segment, self._duration = 0, math.inf

    def advance(self, simulation: Simulation, start: float, to: float) -> None:
        """Advance from `start` to `to` [s]. Raises `StepFailure`."""
        sliver = _SLIVER * (to - start)
        bends = self._signals.bends
        first, last = bends.searchsorted(start + sliver, "right"), bends.searchsorted(to - sliver)
        inside = bends[first:last]
        for begin, end in pairwise((start, *inside.tolist(), to)):
            segment = int(bends.searchsorted(0.5 * (begin + end)))
            forces, later = self.forces(begin), self.forces(end)
            speed, rate = self._signals.at("speed", begin), None
            # within a segment the model continues the speed itself, as in an FMU
            is_continued = segment == self._segment and end - begin <= 2.0 * self._duration
            if not is_continued and not self._is_held:
                rate = (self._signals.at("speed", end) - speed) / (end - begin)
            rates = (later - forces) / (end - begin) if (later != forces).any() else None
            self._segment, self._duration = segment, end - begin
            # the sum that an FMU makes of the current time and the step size
            simulation.advance(begin + (end - begin), speed, forces, rate=rate, load_rates=rates)

    def forces(self, t: float) -> np.ndarray:
        """Return the loads at time t [s], x + i y each, in their units."""
        return self._signals.interpolated(self._loads, t).view(complex)


@dataclass(frozen=True)
class Ramp:
    """A speed that goes from `first` to `last` [rad/s] at a rate [rad/s2], without sign, after it
    was held at the first for `before` and until it is held at the last for `after` [s]."""

    first: float
    last: float
    rate: float
    before: float = 0.0
    after: float = 0.0

    @property
    def end(self) -> float:
        """When all of it is over [s]."""
        return self.before + abs(self.last - self.first) / self.rate + self.after

    def signals(self, stop: float) -> Signals:
        """Return the speed until `stop` [s] or its own end, whichever is later."""
        bends = [0.0, self.before, self.end - self.after, max(stop, self.end)]
        t = np.unique(bends)
        speed = np.interp(t, bends[1:3], [self.first, self.last])
        return Signals(t, {"speed": speed})


@dataclass(frozen=True)
class RampGiven:
    """What a user gave of a ramp: whether it goes up, and texts with units, or None."""

    is_up: bool = False
    first: str | None = None
    last: str | None = None
    rate: str | None = None
    hold: str | None = None

    @property
    def options(self) -> Mapping[str, str]:
        """The options that were given, with their texts."""
        texts = (self.first, self.last, self.rate, self.hold)
        return {o: text for o, text in zip(_RAMP_UNITS, texts, strict=True) if text is not None}

    def on(self, rotor: Rotor) -> Ramp:
        """Return the ramp of this machine; `InputError` for one that cannot be."""
        usual = operating_speeds(rotor)
        given = {
            option: in_si(option, text, _RAMP_UNITS[option])
            for option, text in self.options.items()
        }
        first = given.get("--from", 0.0 if self.is_up else usual.trip)
        last = given.get("--to", usual.highest if self.is_up else 0.0)
        rate = given.get("--rate", usual.run_up_rate if self.is_up else usual.run_down_rate)
        hold = given.get("--hold", 0.0)
        if not rate > 0:
            raise InputError(f"--rate {self.rate}: must be > 0; the speeds say whether up or down")
        if not hold >= 0:
            raise InputError(f"--hold {self.hold}: must be >= 0")
        begins, ends = self._shown("--from", first), self._shown("--to", last)
        if first == last:
            raise InputError(
                f"--from {begins}: must differ from --to {ends}; a constant speed is given by "
                f"--set speed={ends.replace(' ', '')}"
            )
        if (abs(last) > abs(first)) != self.is_up:
            way, other = ("larger", "run-down") if self.is_up else ("smaller", "run-up")
            raise InputError(
                f"--to {ends}: must be {way} in size than --from = {begins}; the other way is "
                f"{other}"
            )
        return Ramp(first, last, rate, *((0.0, hold) if self.is_up else (hold, 0.0)))

    def _shown(self, option: str, speed: float) -> str:
        """Return a speed [rad/s] as it was given with its unit, else in rad/s."""
        given = split(self.options.get(option, ""))
        return self.options[option] if given and given[1] else f"{speed:g} rad/s"


def make_signals(
    table: Sequence[Variable],
    stop: float,
    constants: Mapping[str, float],
    ramp: Ramp,
    recorded: Signals | None = None,
) -> Signals:
    """Return all inputs of a run to `stop` [s]: recorded signals, else constants, else the ramp for
    the speed and the start value for what is left."""
    ramped = ramp.signals(stop)
    parts = [recorded or Signals(ramped.t, {})]
    if "speed" not in {*constants, *parts[0].values}:
        parts.append(ramped)
    t = np.unique(np.concatenate([part.t for part in parts]))
    courses = {n: np.interp(t, part.t, of) for part in parts for n, of in part.values.items()}
    held = {
        variable.name: np.full(len(t), float(constants.get(variable.name, variable.start)))
        for variable in table
        if variable.causality == "input" and variable.start is not None
    }
    return Signals(t, held | courses)


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
    """Return the number and cells of every line that is neither empty nor a comment."""
    text = read_text("", path)
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
    """Return the name of an input, and what its unit is in SI, of `speed` or `speed [rpm]`."""
    name, unit = text, None
    if name.endswith("]"):
        name, _, unit = (part.strip() for part in text[:-1].rpartition("["))
    if name not in known:
        near = near_names(text.partition(" ")[0], known, 3)
        hint = f"did you mean {', '.join(near)}?" if near else f"known are {', '.join(known)}"
        raise InputError(f"{path}: column {text!r} is unknown; {hint}")
    shown = f"{path}: column {text!r}"
    return name, 1.0 if unit is None else factor(shown, unit, known[name])


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
