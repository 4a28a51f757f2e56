"""The cells of a finished run: numbers and lists made from its windows, a function a metric."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from ..studies.study import Cell
from .metrics import KINDS, Metric, Options, edges_of, spectrum_orders
from .monitor import Samples, Window
from .run_excitation import Excitation


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
    edges = edges_of(options["bins"])
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
    from ..vibration import TooFewTurns, order_track

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


def _lyapunov(metric: Metric, window: Window, options: Options) -> float:
    return window.exponent


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
    "lyapunov": _lyapunov,
}
_LISTS: Mapping[str, Callable[[Metric, Window, Options], np.ndarray]] = {
    "poincare": _poincare,
    "spectrum": _spectrum,
}
