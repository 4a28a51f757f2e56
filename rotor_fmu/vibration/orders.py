"""Orders over speed, for Bode and polar plots: what of a motion goes with 1x, 2x, 0.5x the shaft.

Terms are those of API RP 684 (synchronous response, amplification factor) and ISO 21940-1
(phase from a mark on the rotor).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .turns import TURN, Synchronous, hann, synchronous

_HALF_POWER = 0.5**0.5


@dataclass(frozen=True)
class OrderTrack:
    """Vectors of orders over a run, one row a turn: z = f exp(i k phi) + b exp(-i k phi).

    t: middles of the blocks of turns that were read, shape (m,) [s]; speed: their mean speed,
    shape (m,) [rad/s]; orders: the k; forward f, backward b: complex, shape (m, orders) [m].
    """

    t: np.ndarray
    speed: np.ndarray
    orders: tuple[float, ...]
    forward: np.ndarray
    backward: np.ndarray

    def _of(self, part: np.ndarray, order: float) -> np.ndarray:
        if order not in self.orders:
            known = ", ".join(f"{k:g}" for k in self.orders)
            raise ValueError(f"order {order:g}: must be one of {known}, which were tracked")
        return part[:, self.orders.index(order)]

    def x(self, order: float = 1.0) -> np.ndarray:
        """Complex amplitude X of Re(X exp(i k phi)), 0-p, shape (m,) [m]."""
        return self._of(self.forward, order) + np.conj(self._of(self.backward, order))

    def y(self, order: float = 1.0) -> np.ndarray:
        """Complex amplitude of y, a quarter turn behind x on a forward circle, 0-p [m]."""
        return -1j * (self._of(self.forward, order) - np.conj(self._of(self.backward, order)))

    def phase_x(self, order: float = 1.0) -> np.ndarray:
        """Angle by which x leads the mark, unwrapped over the run [rad]."""
        return _unwrapped(self.x(order))

    def phase_y(self, order: float = 1.0) -> np.ndarray:
        """Angle by which y leads the mark, unwrapped over the run [rad]."""
        return _unwrapped(self.y(order))

    def major(self, order: float = 1.0) -> np.ndarray:
        """Major semi-axis of the order's ellipse [m]."""
        return np.abs(self._of(self.forward, order)) + np.abs(self._of(self.backward, order))

    def minor(self, order: float = 1.0) -> np.ndarray:
        """Minor semi-axis, negative where the order whirls backward [m]."""
        return np.abs(self._of(self.forward, order)) - np.abs(self._of(self.backward, order))


@dataclass(frozen=True)
class Resonance:
    """A peak of a response over speed.

    speed [rad/s]; amplitude, 0-p [m]; amplification: the factor speed / (N2 - N1) between the
    half-power points (API RP 684), NaN where the run does not reach one of them.
    """

    speed: float
    amplitude: float
    amplification: float


def order_track(
    t: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    orders: Sequence[float] = (0.5, 1.0, 2.0),
    *,
    turns: int = 4,
    per_turn: int | None = None,
) -> OrderTrack:
    """Follow orders through a run, in blocks of `turns` turns under Hann's window, one a turn.

    z: x + i y [m], or any real signal, whose forward and backward halves are alike. With 4 turns
    the orders that are multiples of 0.5 do not leak into one another, nor does the mean. Raises
    `TooFewTurns`, and `ValueError` for an order that the block cannot hold.
    """
    signal = synchronous(t, phi, z, turns=turns, per_turn=per_turn)
    return order_track_of(signal, orders, turns=turns)


def order_track_of(
    signal: Synchronous, orders: Sequence[float] = (0.5, 1.0, 2.0), *, turns: int = 4
) -> OrderTrack:
    """`order_track` of a signal that is resampled already."""
    signal.needs(turns)
    for order in orders:
        if not 0 < order < signal.per_turn / 2:
            raise ValueError(f"order {order:g}: must be > 0 and < {signal.per_turn / 2:g}")
        if abs(order * turns - round(order * turns)) > 1e-9 or order * turns < 2:
            raise ValueError(f"order {order:g}: a block of {turns} turns holds no whole cycles")
    blocks = np.lib.stride_tricks.sliding_window_view(signal.values, turns, axis=0)
    window = hann(turns, signal.per_turn)
    angle = TURN * np.arange(turns)[:, None] + signal.angle
    forward = np.empty((len(blocks), len(orders)), complex)
    backward = np.empty_like(forward)
    for i, order in enumerate(orders):
        kernel = (window * np.exp(-1j * order * angle)).T
        # from the angle's own zero: an order of a half changes its sign from turn to turn
        count = np.exp(-1j * order * TURN * (signal.begin + np.arange(len(blocks))))
        forward[:, i] = np.einsum("bpn,pn->b", blocks, kernel) * count
        backward[:, i] = np.einsum("bpn,pn->b", blocks, kernel.conj()) * count.conj()
    first = np.arange(len(blocks))
    middle = (signal.marks[first] + signal.marks[first + turns]) / 2
    return OrderTrack(middle, signal.speed_over(first, turns), tuple(orders), forward, backward)


def resonances(speed: np.ndarray, amplitude: np.ndarray, least: float = 0.1) -> list[Resonance]:
    """Peaks of an amplitude over speed, the highest first.

    speed [rad/s], amplitude 0-p [m], shape (m,); least: share of the highest amplitude below which
    a peak, and how far it stands out, is not told.
    """
    order = np.argsort(speed, kind="stable")
    n, a = np.asarray(speed)[order], np.asarray(amplitude)[order]
    floor = least * a.max(initial=0.0)
    tops = 1 + np.flatnonzero((a[1:-1] > a[:-2]) & (a[1:-1] >= a[2:]))
    at = [i for i in tops.tolist() if a[i] >= floor and _prominence(a, i) >= floor]
    found = [Resonance(float(n[i]), float(a[i]), _amplification(n, a, i)) for i in at]
    return sorted(found, key=lambda peak: -peak.amplitude)


def _prominence(a: np.ndarray, peak: int) -> float:
    """How far one has to go down from a peak before a higher place is reached."""
    lowest = []
    for side in (a[:peak][::-1], a[peak + 1 :]):
        higher = np.flatnonzero(side > a[peak])
        lowest.append(side[: higher[0] if len(higher) else None].min())
    return float(a[peak] - max(lowest))


def _amplification(n: np.ndarray, a: np.ndarray, peak: int) -> float:
    edge = _HALF_POWER * a[peak]
    below = np.flatnonzero(a[:peak] < edge)
    above = np.flatnonzero(a[peak:] < edge)
    if not len(below) or not len(above):
        return float("nan")
    i, j = below[-1], peak + above[0]
    low = np.interp(edge, [a[i], a[i + 1]], [n[i], n[i + 1]])
    high = np.interp(edge, [a[j], a[j - 1]], [n[j], n[j - 1]])
    return float(n[peak] / (high - low))


def _unwrapped(vector: np.ndarray) -> np.ndarray:
    return np.unwrap(np.angle(vector))
