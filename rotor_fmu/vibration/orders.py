"""Orders over speed, for Bode and polar plots: the components of a motion at 1x, 2x, 0.5x.

Terms are those of API RP 684 (synchronous response, amplification factor) and ISO 21940-1
(phase from a mark on the rotor).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import InputError, check_positive, numbers
from ..model.prominent_peaks import prominent_peaks
from ..short_repr import ShortRepr
from .recorded import finite
from .turns import LEAST_ROWS, TURN, Synchronous, hann, summed, synchronous

BLOCK = 4  # turns in which an order is read
_HALF_POWER = 0.5**0.5
_BACK = 0.1  # share of its range by which a speed that goes one way may go back
_RIPPLE = 0.05  # share of a peak by which its flank may rise again
# Square of the half-power width over the rate of the speed, below which a linear resonance shows a
# factor up to 10 % too low or more (by integration of one that is swept, Q from 10 to 100).
_SLOW = 25.0


@dataclass(frozen=True, repr=False)
class OrderTrack(ShortRepr):
    """Vectors of orders over a run, one row a turn: z = f exp(i k phi) + b exp(-i k phi).

    t: middles of the blocks of turns that were read [s], shape (m,); speed: their mean speed,
    negative where the angle falls [rad/s], shape (m,); orders: k [1]; forward, backward: f and b,
    complex, NaN where the recorded rows are too few for the order [m], shape (m, orders).

    Amplitudes and angles of x and y are those of Re(X exp(i k |phi|)): a lag is negative whichever
    way the shaft turns. Each method takes one of `orders` [1] and returns an array of shape (m,);
    `ValueError` for another order.
    """

    t: np.ndarray
    speed: np.ndarray
    orders: tuple[float, ...]
    forward: np.ndarray
    backward: np.ndarray

    def _of(self, part: np.ndarray, order: float) -> np.ndarray:
        if order not in self.orders:
            known = ", ".join(f"{k:g}" for k in self.orders)
            raise InputError(f"order {order:g}: must be one of {known}, which were tracked")
        return part[:, self.orders.index(order)]

    def x(self, order: float = 1.0) -> np.ndarray:
        """Complex amplitude X of Re(X exp(i k |phi|)), 0-p [m]."""
        return self._ahead(self._of(self.forward, order) + np.conj(self._of(self.backward, order)))

    def y(self, order: float = 1.0) -> np.ndarray:
        """Complex amplitude of y, 0-p [m]: on a forward circle a quarter turn behind x, ahead of it
        where the angle falls."""
        forward, backward = self._of(self.forward, order), self._of(self.backward, order)
        return self._ahead(-1j * (forward - np.conj(backward)))

    def _ahead(self, vector: np.ndarray) -> np.ndarray:
        return np.where(self.speed < 0, np.conj(vector), vector)

    def phase_x(self, order: float = 1.0) -> np.ndarray:
        """Return the angle by which x leads the mark, unwrapped over the run [rad]."""
        return np.unwrap(np.angle(self.x(order)))

    def phase_y(self, order: float = 1.0) -> np.ndarray:
        """Return the angle by which y leads the mark, unwrapped over the run [rad]."""
        return np.unwrap(np.angle(self.y(order)))

    def major(self, order: float = 1.0) -> np.ndarray:
        """Return the major semi-axis of the order's ellipse [m]."""
        return np.abs(self._of(self.forward, order)) + np.abs(self._of(self.backward, order))

    def minor(self, order: float = 1.0) -> np.ndarray:
        """Return the minor semi-axis of the order's ellipse [m], negative where it whirls back."""
        return np.abs(self._of(self.forward, order)) - np.abs(self._of(self.backward, order))


@dataclass(frozen=True, repr=False)
class Resonance(ShortRepr):
    """A peak of a response over speed.

    speed [rad/s]; amplitude, 0-p [m]; amplification: the factor speed / (N2 - N1) between the
    half-power points (API RP 684), NaN where the response does not fall to one of them before the
    run ends or another peak begins, or the run passes both at one speed, or within fewer turns than
    an order is read in: that is a beat; rate: of the speed between them, without sign [rad/s2], NaN
    where it is not known.
    """

    speed: float
    amplitude: float
    amplification: float
    rate: float

    @property
    def is_fast(self) -> bool:
        """Whether the run passed so quickly that the factor is too low: by up to 10 % at the limit,
        by a third to a half where the square of N2 - N1 is seven times the rate."""
        return bool((self.speed / self.amplification) ** 2 < _SLOW * self.rate)


def order_track(
    t: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    orders: Sequence[float] = (0.5, 1.0, 2.0),
    *,
    turns: int = BLOCK,
    per_turn: int | None = None,
) -> OrderTrack:
    """Follow orders through a run, in blocks of `turns` turns under Hann's window, one a turn.

    z: x + i y [m], or any real signal, whose forward and backward halves are alike. With 4 turns
    the orders that are multiples of 0.5 do not leak into one another, nor does the mean, or
    a steady drift of it, as that of a shaft that rises on its oil film with the speed. Raises
    `TooFewTurns`, `TooFewRows` where 1x, or every order asked for, cannot be resolved, and
    `ValueError` for an order that the block cannot hold.
    """
    signal = synchronous(t, phi, z, turns=turns, per_turn=per_turn)
    return order_track_of(signal, orders, turns=turns)


def order_track_of(
    signal: Synchronous, orders: Sequence[float] = (0.5, 1.0, 2.0), *, turns: int = BLOCK
) -> OrderTrack:
    """Return `order_track` of a signal that is already resampled."""
    signal.needs(turns)
    orders = numbers("orders", orders)
    if not orders:
        raise InputError("orders: at least one must be given")
    for order in orders:
        if not 0 < order < signal.per_turn / 2:
            raise InputError(f"order {order:g}: must be > 0 and < {signal.per_turn / 2:g}")
        if abs(order * turns - round(order * turns)) > 1e-9 or order * turns < 2:
            raise InputError(
                f"order {order:g}: a block of {turns} turns resolves multiples of {1 / turns:g}, "
                f"from {2 / turns:g} on"
            )
    first = signal.blocks(turns)
    # 1x, or whatever else is asked for, must be resolved
    signal.enough_rows(first, turns, max(min(orders), min(1.0, max(orders))))
    rows = signal.rows_of(first, turns)
    window = hann(turns, signal.per_turn)
    angle = TURN * np.arange(turns)[:, None] + signal.angle
    is_positive = signal.sense[first] > 0
    forward = np.empty((len(first), len(orders)), complex)
    backward = np.empty_like(forward)
    drift, ramp = signal.drift_of(first, turns), signal.ramp(turns)
    for i, order in enumerate(orders):
        kernel = window * np.exp(-1j * order * angle)
        ahead, behind = (
            summed(signal.values, k, first) - drift * (k * ramp).sum()
            for k in (kernel, kernel.conj())
        )
        # from the angle's own zero: an order of a half changes its sign from turn to turn
        count = np.exp(-1j * order * TURN * signal.mark[first])
        count[rows < LEAST_ROWS * order] = np.nan
        forward[:, i] = np.where(is_positive, ahead, behind) * count
        backward[:, i] = np.where(is_positive, behind, ahead) * count.conj()
    at = signal.middle_of(first, turns), signal.speed_of(first, turns)
    return OrderTrack(*at, tuple(orders), forward, backward)


def goes_one_way(speed: np.ndarray) -> bool:
    """Return whether a speed, shape (m,), goes back nowhere by more than a tenth of its range."""
    back = [(side * speed - np.minimum.accumulate(side * speed)).max(initial=0) for side in (1, -1)]
    return not len(speed) or bool(min(back) <= _BACK * np.ptp(speed))


def resonances(
    speed: np.ndarray, amplitude: np.ndarray, least: float = 0.1, t: np.ndarray | None = None
) -> list[Resonance]:
    """Return the peaks of an amplitude over speed, of a run that goes one way, the highest first.

    speed [rad/s], amplitude 0-p [m], t [s], all of shape (m,); least: share of the highest
    amplitude that the prominence of a peak must reach. What is not finite is left out. Raises
    `InputError` for what is no signal, and for a speed that both rises and falls.
    """
    check_positive("least", least)
    of_time = {} if t is None else {"t": t}
    n, a, *times = finite(speed=speed, amplitude=amplitude, **of_time)
    time = times[0] if times else np.full(len(n), np.nan)
    if not goes_one_way(n):
        raise InputError(f"speed: {n.min():g} to {n.max():g} rad/s, up and down; must go one way")
    order = np.argsort(n, kind="stable")
    n, a, time = n[order], a[order], time[order]
    floor = least * a.max(initial=0.0)
    at, _ = prominent_peaks(a, floor)
    result = [_resonance(n, a, time, i) for i in at.tolist()]
    return sorted(result, key=lambda peak: -peak.amplitude)


def _resonance(n: np.ndarray, a: np.ndarray, t: np.ndarray, peak: int) -> Resonance:
    sides = np.arange(peak, -1, -1), np.arange(peak, len(n))
    ends = [_half_power(n[side], a[side], t[side]) for side in sides]
    (low, t_low), (high, t_high) = ends
    width = high - low
    took = abs(t_high - t_low)
    rate = abs(width) / took if took else np.nan
    is_beat = abs(n[peak]) * took < BLOCK * TURN
    factor = np.nan if is_beat or not width else abs(n[peak]) / width
    return Resonance(float(n[peak]), float(a[peak]), float(factor), float(rate))


def _half_power(n: np.ndarray, a: np.ndarray, t: np.ndarray) -> tuple[float, float]:
    """Return the speed and time where an amplitude that begins at a peak has fallen to half of the
    power; NaN where it does not, or rises again to another peak before."""
    edge = _HALF_POWER * a[0]
    below = np.flatnonzero(a < edge)
    if not len(below):
        return np.nan, np.nan
    i = int(below[0])
    if (a[:i] - np.minimum.accumulate(a[:i])).max() > _RIPPLE * a[0]:
        return np.nan, np.nan
    share = (a[i - 1] - edge) / (a[i - 1] - a[i])
    return float(n[i - 1] + share * (n[i] - n[i - 1])), float(t[i - 1] + share * (t[i] - t[i - 1]))
