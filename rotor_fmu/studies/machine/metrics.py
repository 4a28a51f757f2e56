"""The metrics of a run: numbers and lists made from its windows.

A quantity is an output by its name, or PART.r, the distance of PART.x and PART.y from zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...errors import InputError
from ..study import Cell, Column
from .monitor import Samples, Window
from .run_excitation import COUPLED, LEVELS, Excitation

Options = Mapping[str, Any]


class Kind(NamedTuple):
    """A way to make a cell of a window: what it needs beside the quantity, what it may have with
    its default, whether only at constant speed in whole turns, and what it is, to be filled in
    with the options; whether nothing less than the solver's own steps will do."""

    needed: tuple[str, ...]
    optional: Mapping[str, float]
    in_turns: bool
    text: str
    is_fine: bool = False


KINDS: Mapping[str, Kind] = {
    "peak": Kind((), {"after": 0.0}, False, "largest absolute value"),
    "rms": Kind((), {"after": 0.0}, False, "root of the mean square over time"),
    "mean": Kind((), {"after": 0.0}, False, "mean over time"),
    "last": Kind((), {}, False, "value at the end"),
    "value": Kind(("speed",), {}, False, "value when the speed first passes {speed:g} rad/s,"),
    "amplitude": Kind(("bins",), {}, False, "largest absolute value in each bin of the speed"),
    "poincare": Kind((), {}, True, "value once a turn, at the keyphasor's mark"),
    "order": Kind(("order",), {}, True, "amplitude of order {order:g} of the speed,"),
    "passing": Kind(
        ("order", "speed"),
        {},
        False,
        "amplitude of order {order:g} where {speed:g} rad/s is first passed,",
        is_fine=True,
    ),
    "spectrum": Kind(("orders",), {}, True, "full spectrum, negative orders backward,"),
    "contact": Kind((), {"after": 0.0}, False, "time in contact", is_fine=True),
    "dissipated": Kind((), {}, False, "work of friction at a contact", is_fine=True),
    "whirl": Kind((), {}, False, "mean rate at which PART.x, PART.y turn about zero", is_fine=True),
    "jump": Kind(("way",), {"least": 0.2}, False, "speed of the largest jump {way} of the mean"),
}
# Kinds whose quantity is a part, with the outputs that they look at.
_OF_PARTS = {
    "contact": ("contact",),
    "dissipated": ("ft", "x", "y"),
    "whirl": ("x", "y"),
    "spectrum": ("x", "y"),
}
WAYS = ("up", "down")
# Orders are passed in turns resampled at 64 angles at least.
_MOST_PASSED = 32


@dataclass(frozen=True)
class Metric:
    """A cell of a row: the column's name, one of `KINDS`, of what, and the kind's options.

    scale: what `dissipated` needs, the journal's radius [m].
    """

    name: str
    kind: str
    of: str
    options: tuple[tuple[str, Any], ...] = ()
    scale: float = 0.0

    @property
    def needs(self) -> tuple[str, ...]:
        """The outputs that must be sampled."""
        also = ("w",) if self.kind in ("value", "amplitude") else ()
        also = ("phi",) if self.kind in ("dissipated", "passing") else also
        if self.kind in _OF_PARTS:
            return (*(f"{self.of}.{output}" for output in _OF_PARTS[self.kind]), *also)
        if self.of.endswith(".r"):
            part = self.of.removesuffix(".r")
            return (f"{part}.x", f"{part}.y", *also)
        return (self.of, *also)


def column(metric: Metric, unit: str, drive: Excitation, is_varied: bool) -> Column:
    """Return the column of a metric; unit: the quantity's; is_varied: whether the held speeds
    differ from run to run."""
    options = dict(metric.options)
    text = f"{KINDS[metric.kind].text.format(**options)} of {metric.of}"
    own = {"contact": "s", "dissipated": "J", "whirl": "rad/s", "jump": "rad/s", "spectrum": "m"}
    unit = own.get(metric.kind, unit)
    if metric.kind == "jump":
        return Column(metric.name, unit, text)
    if metric.kind == "amplitude":
        bins = options["bins"]
        edges = np.linspace(bins["from"], bins["to"], int(bins["count"]) + 1)
        middles = tuple((0.5 * (edges[1:] + edges[:-1])).tolist())
        return Column(metric.name, unit, text, f"{metric.name} speed", middles, "rad/s")
    if metric.kind == "poincare":
        return Column(metric.name, unit, text, "turn")
    if metric.kind == "spectrum":
        orders = tuple(spectrum_orders(options["orders"], int(drive.numbers["turns"])).tolist())
        return Column(metric.name, unit, text, f"{metric.name} order", orders)
    if drive.kind == "steps":
        held = () if is_varied else tuple(drive.speeds.tolist())
        return Column(metric.name, unit, text, "held speed", held, "rad/s")
    return Column(metric.name, unit, text)


def cells(metric: Metric, windows: list[Window], drive: Excitation) -> Cell:
    """Return the cell of a finished run."""
    options = {**KINDS[metric.kind].optional, **dict(metric.options)}
    if metric.kind == "jump":
        return _jump(metric, windows, options)
    if metric.kind in ("poincare", "spectrum"):
        result = [_LISTS[metric.kind](metric, window, options) for window in windows]
        return np.concatenate(result).tolist()
    if metric.kind == "amplitude":
        return _amplitude(metric, windows[0], options)
    numbers = [_NUMBERS[metric.kind](metric, window, options) for window in windows]
    return numbers if drive.kind == "steps" else numbers[0]


def check(metric: Metric, how: Excitation) -> None:
    """Raise `InputError` for a metric that does not suit the excitation of the run."""
    kind, options = KINDS[metric.kind], dict(metric.options)
    where, n = f"keep {metric.name}", how.numbers
    if how.kind == COUPLED and kind.is_fine:
        raise InputError(
            f"{where}: {metric.kind} looks at the solver's own steps, which no FMU shows"
        )
    held = LEVELS if metric.kind == "order" else ("constant",)
    if kind.in_turns and (how.kind not in held or n["measure"]):
        raise InputError(f"{where}: {metric.kind} needs runs at constant speed in whole turns")
    if metric.kind == "jump" and how.kind != "steps":
        raise InputError(f"{where}: jump needs runs in steps of the speed")
    if metric.kind in ("value", "amplitude", "passing") and how.kind in LEVELS:
        raise InputError(f"{where}: {metric.kind} needs runs whose speed varies continuously")
    if options.get("after", 0.0) < 0:
        raise InputError(f"{where}: after = {options['after']:g} s: must be >= 0")
    if metric.kind == "passing":
        order = options["order"]
        if not 0 < order < _MOST_PASSED or not _is_whole(2 * order):
            raise InputError(
                f"{where}: order = {order:g}: must be a multiple of 0.5 from 0.5 to "
                f"{_MOST_PASSED - 0.5:g}"
            )
    if metric.kind == "order":
        order, turns, per_turn = options["order"], n["turns"], n["per_turn"]
        if not 0 < order < per_turn / 2:
            raise InputError(
                f"{where}: order = {order:g}: must be > 0 and below half of run.per_turn = "
                f"{per_turn:g}"
            )
        if not _is_whole(order * turns):
            raise InputError(
                f"{where}: order = {order:g}: must make whole periods in run.turns = {turns:g}"
            )
    if metric.kind == "spectrum" and not 0 < options["orders"] < n["per_turn"] / 2:
        raise InputError(
            f"{where}: orders = {options['orders']:g}: must be > 0 and below half of run.per_turn "
            f"= {n['per_turn']:g}"
        )


def _is_whole(number: float) -> bool:
    return abs(number - round(number)) < 1e-9


def _quantity(metric: Metric, seen: Samples) -> np.ndarray:
    columns = seen.columns
    if metric.of.endswith(".r") and metric.of not in columns:
        part = metric.of.removesuffix(".r")
        return np.hypot(columns[f"{part}.x"], columns[f"{part}.y"])
    return columns[metric.of]


def _late(metric: Metric, window: Window, options: Options) -> tuple[np.ndarray, np.ndarray]:
    """Return the times and values from `after` on, counted from the window's beginning; none where
    it ends before."""
    t = window.steps.t
    first = int(np.searchsorted(t, t[0] + options["after"]))
    return t[first:], _quantity(metric, window.steps)[first:]


def _peak(metric: Metric, window: Window, options: Options) -> float:
    values = np.abs(_late(metric, window, options)[1])
    return float(values.max()) if len(values) else math.nan


def _averaged(t: np.ndarray, values: np.ndarray) -> float:
    """Return the average by the trapezoidal rule over all steps; nan if there are none."""
    return float(np.trapezoid(values, t) / (t[-1] - t[0])) if len(t) > 1 else math.nan


def _rms(metric: Metric, window: Window, options: Options) -> float:
    t, values = _late(metric, window, options)
    return math.sqrt(_averaged(t, values**2))


def _mean(metric: Metric, window: Window, options: Options) -> float:
    return _averaged(*_late(metric, window, options))


def _last(metric: Metric, window: Window, options: Options) -> float:
    return float(_quantity(metric, window.steps)[-1])


def _value(metric: Metric, window: Window, options: Options) -> float:
    """Return the value at a speed, linear between two steps; nan if it is never passed."""
    w, values = window.steps.columns["w"] - options["speed"], _quantity(metric, window.steps)
    passed = np.flatnonzero(w[1:] * w[:-1] <= 0)
    if not len(passed):
        return math.nan
    at = passed[0]
    share = w[at] / (w[at] - w[at + 1]) if w[at] != w[at + 1] else 0.0
    return float(values[at] + share * (values[at + 1] - values[at]))


def _amplitude(metric: Metric, window: Window, options: Options) -> list[float]:
    bins = options["bins"]
    edges = np.linspace(bins["from"], bins["to"], int(bins["count"]) + 1)
    values, w = np.abs(_quantity(metric, window.steps)), window.steps.columns["w"]
    at = np.digitize(w, edges) - 1
    at[w == edges[-1]] = len(edges) - 2  # the last bin has both of its ends
    largest = np.full(len(edges) - 1, math.nan)
    inside = (at >= 0) & (at < len(largest))
    np.fmax.at(largest, at[inside], values[inside])
    return largest.tolist()


def _poincare(metric: Metric, window: Window, options: Options) -> np.ndarray:
    return _quantity(metric, window.turns)[window.per_turn - 1 :: window.per_turn]


def _order(metric: Metric, window: Window, options: Options) -> float:
    """Return twice the modulus of the mean of x exp(-i order phi), over whole turns."""
    values = _quantity(metric, window.turns)
    angle = math.tau * np.arange(1, len(values) + 1) / window.per_turn
    return float(2 * abs(np.mean(values * np.exp(-1j * options["order"] * angle))))


def _passing(metric: Metric, window: Window, options: Options) -> float:
    """Return the amplitude of an order by revolution-synchronous resampling, from the block of
    turns nearest to the first passage of the speed; nan where it is not, or in steps too long for
    the order."""
    from ...vibration import TooFewTurns, order_track

    phi, order = window.steps.columns["phi"], options["order"]
    try:
        track = order_track(window.steps.t, phi, _quantity(metric, window.steps), [order])
    except TooFewTurns:
        return math.nan
    apart = track.speed - options["speed"]
    ways = track.speed[1:] * track.speed[:-1] > 0
    passed = np.flatnonzero((apart[1:] * apart[:-1] <= 0) & ways)
    if not len(passed):
        return math.nan
    at = passed[0] + int(abs(apart[passed[0] + 1]) < abs(apart[passed[0]]))
    return float(abs(track.x(order)[at]))


def spectrum_orders(highest: float, turns: int) -> np.ndarray:
    """Return the orders of a full spectrum over so many turns, from -highest to highest."""
    most = round(highest * turns)
    return np.arange(-most, most + 1) / turns


def _spectrum(metric: Metric, window: Window, options: Options) -> np.ndarray:
    """Return the amplitudes of the orders of x + i y; the mean is taken away."""
    columns = window.turns.columns
    z = columns[f"{metric.of}.x"] + 1j * columns[f"{metric.of}.y"]
    if window.speed < 0:  # seen from behind, forward stays forward
        z = z.conj()
    turns = len(z) // window.per_turn
    result = np.abs(np.fft.fft(z - z.mean())) / len(z)
    lines = np.rint(spectrum_orders(options["orders"], turns) * turns).astype(int)
    return result[lines]


def _contact(metric: Metric, window: Window, options: Options) -> float:
    t = window.steps.t
    first = int(np.searchsorted(t, t[0] + options["after"]))
    closed = window.steps.columns[f"{metric.of}.contact"][first:]
    return float(np.trapezoid(closed, t[first:]))


def _dissipated(metric: Metric, window: Window, options: Options) -> float:
    """Return friction times the sliding distance: that of the journal's surface, R dphi, and of its
    centre along the wall, (x dy - y dx) / r."""
    force, x, y = (window.steps.columns[f"{metric.of}.{name}"] for name in ("ft", "x", "y"))
    mid_x, mid_y = 0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1])
    r = np.hypot(mid_x, mid_y)
    along = (mid_x * np.diff(y) - mid_y * np.diff(x)) / np.where(r > 0, r, 1.0)
    slid = metric.scale * np.diff(window.steps.columns["phi"]) + along
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * slid))


def _whirl(metric: Metric, window: Window, options: Options) -> float:
    x, y = (window.steps.columns[f"{metric.of}.{axis}"] for axis in "xy")
    angle = np.unwrap(np.arctan2(y, x))
    span = window.steps.t[-1] - window.steps.t[0]
    return float((angle[-1] - angle[0]) / span) if span > 0 else math.nan


def _jump(metric: Metric, windows: list[Window], options: Options) -> float:
    """Return the two neighbouring speeds between which the mean changes most, by at least the share
    `least` of the larger of both; nan where it does not."""
    means = np.array([_mean(metric, window, {"after": 0.0}) for window in windows])
    speeds = np.array([window.speed for window in windows])
    rises = np.diff(speeds) > 0
    chosen = rises if options["way"] == "up" else ~rises
    change = np.where(chosen, np.abs(np.diff(means)), 0.0)
    at = int(np.argmax(change))
    if not change[at] > options["least"] * np.abs(means[at : at + 2]).max():
        return math.nan
    return float(0.5 * (speeds[at] + speeds[at + 1]))


_NUMBERS: Mapping[str, Callable[[Metric, Window, Options], float]] = {
    "peak": _peak,
    "rms": _rms,
    "mean": _mean,
    "last": _last,
    "value": _value,
    "order": _order,
    "passing": _passing,
    "contact": _contact,
    "dissipated": _dissipated,
    "whirl": _whirl,
}
_LISTS: Mapping[str, Callable[[Metric, Window, Options], np.ndarray]] = {
    "poincare": _poincare,
    "spectrum": _spectrum,
}
