"""What is kept of a run: numbers and lists made of its windows.

A quantity is an output by its name, or PART.r, the distance of PART.x and PART.y from zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..study import Cell, Column
from .driving import Drive, Samples, Window

Options = Mapping[str, Any]


class Kind(NamedTuple):
    """A way to make a cell of a window: what it needs beside the quantity, what it may have with
    its default, whether only at constant speed in whole turns, and what it is, to be filled in
    with the options."""

    needed: tuple[str, ...]
    optional: Mapping[str, float]
    in_turns: bool
    text: str


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
        "amplitude of order {order:g} where {speed:g} rad/s is passed,",
    ),
    "spectrum": Kind(("orders",), {}, True, "full spectrum, negative orders backward,"),
    "contact": Kind((), {"after": 0.0}, False, "time in contact"),
    "dissipated": Kind((), {}, False, "work of friction at a contact"),
    "whirl": Kind((), {}, False, "mean rate at which PART.x, PART.y turn about zero"),
    "jump": Kind(("way",), {"least": 0.2}, False, "speed of the largest jump {way} of the mean"),
}
# Kinds that look at the solver's own steps.
TAPED = ("contact", "dissipated", "passing")
# Kinds whose quantity is a part, with the outputs that they look at.
_OF_PARTS = {
    "contact": ("contact",),
    "dissipated": ("ft", "x", "y"),
    "whirl": ("x", "y"),
    "spectrum": ("x", "y"),
}
WAYS = ("up", "down")


@dataclass(frozen=True)
class Keep:
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


def column(keep: Keep, unit: str, drive: Drive, is_varied: bool) -> Column:
    """The column of a keep; unit: the quantity's; is_varied: whether the held speeds differ from
    run to run."""
    options = dict(keep.options)
    text = f"{KINDS[keep.kind].text.format(**options)} of {keep.of}"
    own = {"contact": "s", "dissipated": "J", "whirl": "rad/s", "jump": "rad/s", "spectrum": "m"}
    unit = own.get(keep.kind, unit)
    if keep.kind == "jump":
        return Column(keep.name, unit, text)
    if keep.kind == "amplitude":
        bins = options["bins"]
        edges = np.linspace(bins["from"], bins["to"], int(bins["count"]) + 1)
        middles = tuple((0.5 * (edges[1:] + edges[:-1])).tolist())
        return Column(keep.name, unit, text, f"{keep.name} speed", middles, "rad/s")
    if keep.kind == "poincare":
        return Column(keep.name, unit, text, "turn")
    if keep.kind == "spectrum":
        orders = tuple(spectrum_orders(options["orders"], int(drive.numbers["turns"])).tolist())
        return Column(keep.name, unit, text, f"{keep.name} order", orders)
    if drive.kind == "steps":
        held = () if is_varied else tuple(drive.speeds.tolist())
        return Column(keep.name, unit, text, "held speed", held, "rad/s")
    return Column(keep.name, unit, text)


def cells(keep: Keep, windows: list[Window], drive: Drive) -> Cell:
    """The cell of a finished run."""
    options = {**KINDS[keep.kind].optional, **dict(keep.options)}
    if keep.kind == "jump":
        return _jump(keep, windows, options)
    if keep.kind in ("poincare", "spectrum"):
        found = [_LISTS[keep.kind](keep, window, options) for window in windows]
        return np.concatenate(found).tolist()
    if keep.kind == "amplitude":
        return _amplitude(keep, windows[0], options)
    numbers = [_NUMBERS[keep.kind](keep, window, options) for window in windows]
    return numbers if drive.kind == "steps" else numbers[0]


def _seen(keep: Keep, window: Window) -> Samples:
    return window.steps if keep.kind in TAPED else window.sampled


def _quantity(keep: Keep, window: Window) -> np.ndarray:
    columns = _seen(keep, window).columns
    if keep.of.endswith(".r") and keep.of not in columns:
        part = keep.of.removesuffix(".r")
        return np.hypot(columns[f"{part}.x"], columns[f"{part}.y"])
    return columns[keep.of]


def _late(keep: Keep, window: Window, options: Options) -> tuple[np.ndarray, np.ndarray]:
    """Times and values from `after` on, counted from the window's beginning."""
    t = _seen(keep, window).t
    first = min(int(np.searchsorted(t, t[0] + options["after"])), len(t) - 1)
    return t[first:], _quantity(keep, window)[first:]


def _peak(keep: Keep, window: Window, options: Options) -> float:
    return float(np.abs(_late(keep, window, options)[1]).max())


def _averaged(t: np.ndarray, values: np.ndarray) -> float:
    if len(t) < 2:
        return float(values[-1])
    return float(np.trapezoid(values, t) / (t[-1] - t[0]))


def _rms(keep: Keep, window: Window, options: Options) -> float:
    t, values = _late(keep, window, options)
    return math.sqrt(_averaged(t, values**2))


def _mean(keep: Keep, window: Window, options: Options) -> float:
    return _averaged(*_late(keep, window, options))


def _last(keep: Keep, window: Window, options: Options) -> float:
    return float(_quantity(keep, window)[-1])


def _value(keep: Keep, window: Window, options: Options) -> float:
    """Linear between the two samples about the speed; nan where it is never passed."""
    w, values = window.sampled.columns["w"] - options["speed"], _quantity(keep, window)
    passed = np.flatnonzero(w[1:] * w[:-1] <= 0)
    if not len(passed):
        return math.nan
    at = passed[0]
    share = w[at] / (w[at] - w[at + 1]) if w[at] != w[at + 1] else 0.0
    return float(values[at] + share * (values[at + 1] - values[at]))


def _amplitude(keep: Keep, window: Window, options: Options) -> list[float]:
    bins = options["bins"]
    edges = np.linspace(bins["from"], bins["to"], int(bins["count"]) + 1)
    values = np.abs(_quantity(keep, window))
    at = np.digitize(window.sampled.columns["w"], edges) - 1
    largest = np.full(len(edges) - 1, math.nan)
    for i in range(len(largest)):
        inside = values[at == i]
        if len(inside):
            largest[i] = inside.max()
    return largest.tolist()


def _poincare(keep: Keep, window: Window, options: Options) -> np.ndarray:
    return _quantity(keep, window)[window.per_turn - 1 :: window.per_turn]


def _order(keep: Keep, window: Window, options: Options) -> float:
    """Twice the modulus of the mean of x exp(-i order phi), over whole turns."""
    values = _quantity(keep, window)
    angle = math.tau * np.arange(1, len(values) + 1) / window.per_turn
    return float(2 * abs(np.mean(values * np.exp(-1j * options["order"] * angle))))


def _passing(keep: Keep, window: Window, options: Options) -> float:
    """By revolution-synchronous resampling, of the block of turns nearest to the speed; nan where
    the speed is not reached."""
    from ...vibration import TooFewTurns, order_track

    phi = window.steps.columns["phi"]
    try:
        track = order_track(window.steps.t, phi, _quantity(keep, window), [options["order"]])
    except TooFewTurns:
        return math.nan
    if not track.speed.min() <= options["speed"] <= track.speed.max():
        return math.nan
    nearest = int(np.argmin(np.abs(track.speed - options["speed"])))
    return float(abs(track.x(options["order"])[nearest]))


def spectrum_orders(highest: float, turns: int) -> np.ndarray:
    """Orders of a full spectrum over so many turns, from -highest to highest."""
    most = round(highest * turns)
    return np.arange(-most, most + 1) / turns


def _spectrum(keep: Keep, window: Window, options: Options) -> np.ndarray:
    """Amplitudes of the orders of x + i y; the mean is taken away."""
    columns = window.sampled.columns
    z = columns[f"{keep.of}.x"] + 1j * columns[f"{keep.of}.y"]
    turns = len(z) // window.per_turn
    found = np.abs(np.fft.fft(z - z.mean())) / len(z)
    lines = np.rint(spectrum_orders(options["orders"], turns) * turns).astype(int)
    return found[lines]


def _contact(keep: Keep, window: Window, options: Options) -> float:
    t = window.steps.t
    first = int(np.searchsorted(t, t[0] + options["after"]))
    closed = window.steps.columns[f"{keep.of}.contact"][first:]
    return float(np.trapezoid(closed, t[first:]))


def _dissipated(keep: Keep, window: Window, options: Options) -> float:
    """Friction times the way slid: that of the journal's surface, R dphi, and of its centre along
    the wall, (x dy - y dx) / r."""
    force, x, y = (window.steps.columns[f"{keep.of}.{name}"] for name in ("ft", "x", "y"))
    mid_x, mid_y = 0.5 * (x[1:] + x[:-1]), 0.5 * (y[1:] + y[:-1])
    r = np.hypot(mid_x, mid_y)
    along = (mid_x * np.diff(y) - mid_y * np.diff(x)) / np.where(r > 0, r, 1.0)
    slid = keep.scale * np.diff(window.steps.columns["phi"]) + along
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * slid))


def _whirl(keep: Keep, window: Window, options: Options) -> float:
    x, y = (window.sampled.columns[f"{keep.of}.{axis}"] for axis in "xy")
    angle = np.unwrap(np.arctan2(y, x))
    span = window.sampled.t[-1] - window.sampled.t[0]
    return float((angle[-1] - angle[0]) / span) if span > 0 else math.nan


def _jump(keep: Keep, windows: list[Window], options: Options) -> float:
    """Between which of two neighbouring speeds the mean changes most, by at least the share `least`
    of the larger of both; nan where it does not."""
    means = np.array([_mean(keep, window, {"after": 0.0}) for window in windows])
    speeds = np.array([window.speed for window in windows])
    rises = np.diff(speeds) > 0
    chosen = rises if options["way"] == "up" else ~rises
    change = np.where(chosen, np.abs(np.diff(means)), 0.0)
    at = int(np.argmax(change))
    if not change[at] > options["least"] * np.abs(means[at : at + 2]).max():
        return math.nan
    return float(0.5 * (speeds[at] + speeds[at + 1]))


_NUMBERS: Mapping[str, Callable[[Keep, Window, Options], float]] = {
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
_LISTS: Mapping[str, Callable[[Keep, Window, Options], np.ndarray]] = {
    "poincare": _poincare,
    "spectrum": _spectrum,
}
