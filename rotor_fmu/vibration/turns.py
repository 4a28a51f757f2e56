"""Revolution-synchronous resampling: a signal over time becomes a signal over the shaft's angle.

Computed order tracking (Fyfe and Munck, Mechanical Systems and Signal Processing 11 (1997) 187):
a signal is interpolated by a cubic spline over the angle and read at equal angles, so that an order
is a line of the spectrum whatever the speed does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

_LEAST, _MOST = 64, 1024  # samples a turn
_SHORT = 0.1  # share of the steps that may be shorter than those that decide how fine to resample
_TOO_FEW = "the signal holds {} whole turns of the shaft; {} are needed"
TURN = 2 * math.pi


class TooFewTurns(ValueError):
    """A signal shorter than what is asked of it; says how many turns there are and are needed."""


@dataclass(frozen=True)
class Synchronous:
    """A signal at equal angles in whole turns from the first keyphasor mark on.

    begin: turns that the angle counts at the first mark; marks: times of the marks,
    shape (turns + 1,) [s]; t, values: shape (turns, per_turn).
    """

    begin: int
    marks: np.ndarray
    t: np.ndarray
    values: np.ndarray

    @property
    def per_turn(self) -> int:
        """Samples a turn."""
        return self.values.shape[1]

    @property
    def angle(self) -> np.ndarray:
        """The shaft's angle within a turn, shape (per_turn,) [rad]."""
        return np.arange(self.per_turn) * (TURN / self.per_turn)

    @property
    def speed(self) -> np.ndarray:
        """Mean speed of each turn, shape (turns,) [rad/s]."""
        return TURN / np.diff(self.marks)

    def needs(self, turns: int) -> None:
        """Raise `TooFewTurns` for a signal of less than `turns` turns."""
        if len(self.values) < turns:
            raise TooFewTurns(_TOO_FEW.format(len(self.values), turns))

    def speed_over(self, first: np.ndarray, turns: int) -> np.ndarray:
        """Mean speed of blocks of turns that begin with the turns `first` [rad/s]."""
        return turns * TURN / (self.marks[first + turns] - self.marks[first])

    def nearest(self, speed: float, turns: int) -> int:
        """The first turn of the block whose mean speed is nearest to `speed` [rad/s]."""
        first = np.arange(len(self.values) - turns + 1)
        return int(np.argmin(np.abs(self.speed_over(first, turns) - speed)))


def synchronous(
    t: np.ndarray,
    phi: np.ndarray,
    values: np.ndarray,
    *,
    turns: int = 1,
    per_turn: int | None = None,
) -> Synchronous:
    """Resample a real or complex signal, shape (n,), at equal angles.

    per_turn: samples a turn; what the signal holds above order per_turn / 2 folds back. None: a
    power of two fine enough for nine tenths of the steps, at least 64, so that nothing folds. Where
    the shaft rests or turns back, the signal is left out until it reaches a new angle. Raises
    `TooFewTurns` for a signal of less than `turns` whole turns.
    """
    t, phi, values = np.asarray(t, float), np.asarray(phi, float), np.asarray(values)
    if not t.shape == phi.shape == values.shape or t.ndim != 1:
        raise ValueError(
            f"t {t.shape}, phi {phi.shape}, values {values.shape}: must be alike, (n,)"
        )
    grows = np.ones(len(phi), bool)
    grows[1:] = phi[1:] > np.maximum.accumulate(phi)[:-1]
    grows &= np.isfinite(phi) & np.isfinite(values)
    t, phi, values = t[grows], phi[grows], values[grows]
    first, last = (math.ceil(phi[0] / TURN), math.floor(phi[-1] / TURN)) if len(phi) > 3 else (0, 0)
    whole = max(last - first, 0)
    if whole < turns:
        raise TooFewTurns(_TOO_FEW.format(whole, turns))
    if per_turn is None:
        per_turn = _fine(phi)
    angles = TURN * (first + np.arange(whole * per_turn + 1) / per_turn)
    # a rounding past the last sample would extrapolate
    angles = np.clip(angles, phi[0], phi[-1])
    times = PchipInterpolator(phi, t)(angles)
    resampled = CubicSpline(phi, values)(angles[:-1])
    instants, resampled = (v.reshape(whole, per_turn) for v in (times[:-1], resampled))
    return Synchronous(first, times[::per_turn], instants, resampled)


def _fine(phi: np.ndarray) -> int:
    step = float(np.quantile(np.diff(phi), _SHORT))
    return int(min(max(2 ** math.ceil(math.log2(TURN / step)), _LEAST), _MOST))


def hann(turns: int, per_turn: int) -> np.ndarray:
    """Hann's window over a block of whole turns, of sum 1, shape (turns, per_turn).

    Its spectrum is zero at every multiple of 1 / turns orders but the first, so that of a block of
    n turns all orders that are multiples of 2 / n are told apart without leakage.
    """
    window = 1 - np.cos(TURN * np.arange(turns * per_turn) / (turns * per_turn))
    return (window / window.sum()).reshape(turns, per_turn)
