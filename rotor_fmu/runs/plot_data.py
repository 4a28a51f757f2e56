"""The data of a run's pictures, as arrays that do not depend on where the run was sampled."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from ..vibration import turns_of
from .recording import Recording

TURN = 2 * math.pi
_CONSTANT = 0.01  # share of the highest speed by which a constant one may vary
_EDGE = 0.01  # share of a run's length at its ends where an amplitude may still be growing
_AS_MUCH = 0.02  # share by which the motion of two places may differ that move as much


def place_of(columns: Mapping[str, np.ndarray]) -> str | None:
    """Return the part whose motion is drawn: of all that are probed the one that moves most, the
    last of several that move as much."""
    moved = {
        name.removesuffix(".x"): _moved(columns, name.removesuffix(".x"))
        for name in columns
        if name.endswith(".x") and {f"{name}_amp", f"{name[:-1]}vx"} & columns.keys()
    }
    most = max(moved.values(), default=0.0)
    alike = [name for name, motion in moved.items() if motion >= (1 - _AS_MUCH) * most]
    return alike[-1] if alike else None


def _moved(columns: Mapping[str, np.ndarray], place: str) -> float:
    """Root of the mean square distance of a place from its mean [m], of what is finite."""
    z = columns[f"{place}.x"] + 1j * columns[f"{place}.y"]
    known = z[np.isfinite(z)]
    return float(np.std(known)) if len(known) else 0.0


def contact_of(names: Collection[str]) -> str | None:
    """Return the last part that has a contact angle."""
    return next((n.removesuffix(".psi") for n in reversed([*names]) if n.endswith(".psi")), None)


def is_constant(w: np.ndarray) -> bool:
    """Return whether a speed is one speed, so that nothing can be drawn against it."""
    return len(w) == 0 or float(np.ptp(w)) <= _CONSTANT * float(np.abs(w).max())


def peak_index(t: np.ndarray, w: np.ndarray, amplitude: np.ndarray, after: float) -> int | None:
    """Return the row at which an amplitude over the last turn, shape (n,), has a peak after a time
    [s]; None where it is largest at an edge of the run or of its speeds: that is no peak."""
    late = np.flatnonzero(t > after)
    if not len(late) or is_constant(w):
        return None
    at = int(late[np.argmax(amplitude[late])])
    turn = TURN / max(abs(float(w[at])), 1e-9)
    margin = max(_EDGE * float(t[-1] - t[late[0]]), min(turn, 0.1 * float(t[-1])))
    is_inside = t[late[0]] + margin < t[at] < t[-1] - margin
    passed = w[late]
    of_speeds = _EDGE * float(np.ptp(passed))
    is_passed = passed.min() + of_speeds < w[at] < passed.max() - of_speeds
    return at if is_inside and is_passed else None


def why_no_peak(t: np.ndarray, w: np.ndarray, after: float) -> str:
    """Return why a run, in which `peak_index` finds none, has no peak."""
    if not len(t) or t[-1] <= after:
        return f"the run ends within the start-up, {after:g} s"
    if is_constant(w):
        return "the speed is constant"
    return "the amplitude is largest at an edge of the run"


def rows_a_turn(recording: Recording, near: slice | np.ndarray = slice(None)) -> float:
    """Return the median number of rows in a turn of the shaft; infinite where it does not turn."""
    steps = np.abs(np.diff(recording.columns["phi"][near]))
    angle = float(np.median(steps)) if len(steps) else 0.0
    return TURN / angle if angle else math.inf


def late_turns(recording: Recording) -> slice:
    """Return the second half of a run, cut to whole turns where it holds any: orders then lie on
    lines of a spectrum."""
    t, turned = recording.t, np.abs(recording.columns["phi"] - recording.columns["phi"][-1])
    half = int(np.searchsorted(t, (t[0] + t[-1]) / 2))
    whole = TURN * math.floor(turned[half] / TURN)
    return slice(half + int(np.argmax(turned[half:] <= whole)) if whole else half, None)


@dataclass(frozen=True)
class TimeShare:
    """Share of the time [1] spent in each bin of an angle, shape (speeds, angles), rows of sum 1,
    or 0 where a speed was not passed; edges of the bins: hz [Hz], angle [rad]."""

    hz: np.ndarray
    angle: np.ndarray
    share: np.ndarray


def time_share(
    recording: Recording, part: str, speeds: int = 240, angles: int = 120, between: int = 8
) -> TimeShare:
    """Return how long a part's displacement pointed in each direction, over the speed.

    The path between two rows is a straight line, each of its `between` pieces counting for the time
    it took: a quick passage is a faint trace, not the few points that happened to be recorded.
    """
    weights = np.repeat(np.diff(recording.t) / between, between)
    share = np.tile((np.arange(between) + 0.5) / between, len(recording.t) - 1)

    def path(values: np.ndarray) -> np.ndarray:
        before, after = (np.repeat(v, between) for v in (values[:-1], values[1:]))
        return before + share * (after - before)

    c = recording.columns
    hz = path(c["w"]) / TURN
    angle = np.arctan2(path(c[f"{part}.y"]), path(c[f"{part}.x"])) % TURN
    edges = np.linspace(hz.min(), hz.max() + 1e-9, speeds + 1), np.linspace(0, TURN, angles + 1)
    table, *_ = np.histogram2d(hz, angle, edges, weights=weights)
    total = table.sum(axis=1, keepdims=True)
    return TimeShare(*edges, np.divide(table, total, out=np.zeros_like(table), where=total > 0))


def envelope(
    at: np.ndarray, values: np.ndarray, most: int = 1200
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the middle, least and largest of values, shape (n,), in at most `most` bins over
    `at`."""
    edges = np.linspace(at.min(), at.max(), most + 1)
    place = np.clip(np.searchsorted(edges, at, "right") - 1, 0, most - 1)
    low, high = np.full(most, np.inf), np.full(most, -np.inf)
    np.minimum.at(low, place, values)
    np.maximum.at(high, place, values)
    is_met = np.isfinite(low)
    return ((edges[:-1] + edges[1:]) / 2)[is_met], low[is_met], high[is_met]


def once_a_turn(recording: Recording, part: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the times [s] at which the shaft's mark points to the right, and where a part was
    then, x + i y [m]: between two rows by a straight line."""
    turns = turns_of(recording.t, recording.columns["phi"])
    t = np.union1d(turns.begin, turns.end)
    x, y = (np.interp(t, recording.t, recording.columns[f"{part}.{axis}"]) for axis in "xy")
    return t, x + 1j * y


def spectrum(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the amplitudes 0-p of a signal, without its mean, and their frequencies [Hz], by
    Hann's window: resampled at equal times, the median step apart."""
    count = 1 + round(float(t[-1] - t[0]) / float(np.median(np.diff(t))))
    even = np.linspace(t[0], t[-1], count)
    signal = np.interp(even, t, values)
    window = np.hanning(count)
    lines = np.fft.rfft(window * (signal - np.average(signal, weights=window)))
    return np.fft.rfftfreq(count, float(even[1] - even[0])), 2 * np.abs(lines) / window.sum()
