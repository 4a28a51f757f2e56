"""Corners of the forces along an orbit, and the corrections that they need in the Fourier sums.

A contact force has a corner where the contact begins, where its damping acts in full, and where the
damping of a journal that leaves has used up the elastic force; its tangents jump there. With g
sampled at intervals h, and its jumps [g], [g'] at t_c, theta h after a sample, the Euler-Maclaurin
formula is

    integral of g e = sum of g e h - h B1 [g e] + h^2/2 B2 [(g e)'] - h^3/6 B3 [(g e)'']

with the Bernoulli polynomials of theta, and e = exp(-i k t). Sixteen samples a harmonic are then
accurate enough, and the sum is smooth where a corner passes a sample.
"""

from collections.abc import Callable
from copy import copy
from typing import NamedTuple, TypeVar

import numpy as np

from .fourier import basis, derivative, sampled
from .laws import Forces, ForcesAndTangents, LawsAlongMotion

_F = TypeVar("_F", Forces, ForcesAndTangents)

_SIDE = np.array([1.0, 2.0, 3.0])  # behind a corner, where limits are taken from by a parabola
_SIDES = np.append(-_SIDE[::-1], _SIDE)  # on both sides
_LIMITS = np.linalg.inv(np.vander(_SIDE, increasing=True)) * [[1.0], [1.0], [2.0]]
_NEAR = 0.02  # in samples, or in distances to the next corner
_NEAR_ROOT = 0.2  # where a tangent like a root begins: its derivatives grow without bound there
_LEAST = 1e-5  # of that distance, in samples
_NEWTON, _EXACT = 6, 5  # iterations on the interpolated gap; secants on the gap itself
_FOUND = 1e-13  # in samples: the last secant moved no corner further


class Crossings(NamedTuple):
    """Where forces have corners: the sample before, the fraction of the interval, the interface,
    shape (n,) each."""

    cell: np.ndarray
    share: np.ndarray
    owner: np.ndarray


def crossings(
    laws: LawsAlongMotion, gap: np.ndarray, gap_at: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> Crossings:
    """Return where forces have corners between the samples 1 and n + 1 of n + 3 evenly spaced ones;
    gap: their distances from corners (`LawsAlongMotion.corner_gaps`), shape (n + 3, corners);
    gap_at: those at intervals and fractions of them."""
    slope = 0.5 * (gap[2:] - gap[:-2])
    g = gap[1:-1]

    def cubic_in(cell, which):
        """Return `hermite` of gaps between samples."""
        return hermite(*(of[at, which] for of in (g, slope) for at in (cell, cell + 1)))

    changes = (g[:-1] > 0) != (g[1:] > 0)
    cell, which = np.nonzero(changes)
    low, high = np.zeros(len(cell)), np.ones(len(cell))
    # in and out, or out and in, between two samples
    turns = ~changes & (slope[:-1] * g[:-1] < 0) & (slope[1:] * g[1:] > 0)
    if turns.any():
        at = np.nonzero(turns)
        vertex = slope[:-1][at] / (slope[:-1][at] - slope[1:][at])
        passes = cubic_in(*at)(vertex)[0] * g[at] < 0
        two, vertex = tuple(np.repeat(a[passes], 2) for a in at), vertex[passes]
        cell, which = np.append(cell, two[0]), np.append(which, two[1])
        zero, one = np.zeros(len(vertex)), np.ones(len(vertex))
        low = np.append(low, np.column_stack([zero, vertex]).ravel())
        high = np.append(high, np.column_stack([vertex, one]).ravel())
    if not len(cell):
        return Crossings(cell, low, laws.corner_owner[which])
    cubic = cubic_in(cell, which)
    share, begins = 0.5 * (low + high), cubic(low)[0] > 0
    for _ in range(_NEWTON):
        value, rate = cubic(share)
        is_before = (value > 0) == begins
        low, high = np.where(is_before, share, low), np.where(is_before, high, share)
        with np.errstate(divide="ignore", invalid="ignore"):
            near = share - value / rate
        share = np.where((near > low) & (near < high), near, 0.5 * (low + high))
    rate, before, last = cubic(share)[1], share, np.full(len(cell), np.nan)
    for _ in range(_EXACT):
        value = gap_at(cell, share)[np.arange(len(cell)), which]
        with np.errstate(divide="ignore", invalid="ignore"):
            secant = (value - last) / (share - before)
            rate = np.where(np.isfinite(secant) & (secant * rate > 0), secant, rate)
            near = share - value / rate
        before, last = share, value
        share = np.where(np.isfinite(near), np.clip(near, 0.0, 1.0), share)
        if np.abs(share - before).max() < _FOUND:
            break
    return Crossings(cell, share, laws.corner_owner[which])


def hermite(
    a: np.ndarray, b: np.ndarray, s: np.ndarray, t: np.ndarray
) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Return a function that gives a cubic, and its derivative, at fractions of an interval at
    whose ends it has the values a, b and the slopes s, t per interval (Hermite interpolation)."""
    c, e = 3 * (b - a) - 2 * s - t, 2 * (a - b) + s + t
    return lambda x: (a + x * (s + x * (c + x * e)), s + x * (2 * c + 3 * x * e))


class SampledOrbit:
    """An orbit sampled over its period, and on both sides of each corner.

    d, v, states: displacements and velocities of the interfaces and internal states at all
    instants, the n evenly spaced ones first; omega [rad/s].
    """

    def __init__(
        self, laws: LawsAlongMotion, d: np.ndarray, states: np.ndarray, omega: float, n: int
    ) -> None:
        self.n, self.owner, self._laws = n, np.zeros(0, int), laws
        self._of, self._omega = (d, states), omega
        self.d, self._rate, self.states = (sampled(x, n) for x in (d, derivative(d), states))
        self.v = omega * self._rate
        if not len(laws.corner_owner):
            return
        H, h = len(d) // 2, 2 * np.pi / n
        gap = laws.corner_gaps(self.d, self.v)

        def gap_at(cell, share):
            value, slope = basis(H, h * (cell + share))
            return laws.corner_gaps(value @ d, omega * (slope @ d))

        cyclic = np.concatenate([gap[-1:], gap, gap[:2]])
        cell, self._share, self.owner = crossings(laws, cyclic, gap_at)
        if not len(cell):
            return
        self._at = h * (cell + self._share)
        near = np.where(laws.is_root_like[self.owner], _NEAR_ROOT, _NEAR)
        self._near = h * near * self._apart(cell)
        value, slope = basis(H, (self._at[:, None] + self._near[:, None] * _SIDES).ravel())
        self.d = np.concatenate([self.d, value @ d])
        self._rate = np.concatenate([self._rate, slope @ d])
        self.v = omega * self._rate
        self.states = np.concatenate([self.states, value @ states])

    def at(
        self, laws: LawsAlongMotion, d: np.ndarray, states: np.ndarray, omega: float
    ) -> "SampledOrbit":
        """Return an orbit sampled as this one is, at once where only omega differs, as in a
        difference by the speed."""
        is_same = laws is self._laws and (omega == self._omega or not laws.has_damping)
        if not (is_same and all(map(np.array_equal, self._of, (d, states)))):
            return SampledOrbit(laws, d, states, omega, self.n)
        result = copy(self)
        result._omega, result.v = omega, omega * self._rate
        return result

    def _apart(self, cell: np.ndarray) -> np.ndarray:
        """Return the distance to the next corner of the same force, in samples, 1 at most."""
        at = cell + self._share
        apart = np.abs(at[:, None] - at)
        apart = np.minimum(apart, self.n - apart)
        apart[(self.owner[:, None] != self.owner) | np.eye(len(at), dtype=bool)] = 1.0
        return np.clip(apart.min(axis=1), _LEAST, 1.0)

    def of_own_corners(self, along: _F) -> _F:
        """Return forces and tangents with those of the other interfaces set to 0 at the corners of
        one."""
        if not len(self.owner):
            return along
        owner, laws = np.repeat(self.owner, len(_SIDES))[:, None], self._laws
        of_force = np.repeat(np.arange(laws.count), 2) == owner
        for name, values in along._asdict().items():
            mask = laws.owner == owner if name.startswith("rates") else of_force
            mask = mask[:, ::2] if name in ("by_d", "by_v") else mask
            values[self.n :] *= mask.reshape(*mask.shape, *[1] * (values.ndim - 2))
        return along

    def spectrum(self, values: np.ndarray, H: int) -> np.ndarray:
        """Return the complex Fourier coefficients 0 to H of values at all instants, along the first
        axis."""
        n = self.n
        result = np.fft.rfft(values[:n], axis=0)[: H + 1] / n
        if not len(self.owner):
            return result
        sides = values[n:].reshape(len(self.owner), 2, len(_SIDE), -1)
        turns = (-1.0) ** np.arange(3)[:, None]  # of derivatives by the way back
        limits = _LIMITS @ sides[:, 1] - turns * (_LIMITS @ sides[:, 0, ::-1])
        jumps = limits / self._near[:, None, None] ** np.arange(3)[:, None]
        if values.ndim > 2:  # of a tangent like a root there is no second derivative
            jumps[self._laws.is_root_like[self.owner], 2] = 0.0
        result += np.einsum("cpk,cpv->kv", self._weights(H), jumps).reshape(result.shape)
        return result

    def _weights(self, H: int) -> np.ndarray:
        """Return the contributions of jumps of values, slopes and second derivatives at the corners
        to the coefficients 0 to H, shape (corners, 3, H + 1)."""
        x, ik, h = self._share[:, None], 1j * np.arange(H + 1), 2 * np.pi / self.n
        first = -h * (x - 0.5)
        second = h**2 / 2 * (x * x - x + 1 / 6)
        third = -(h**3) / 6 * x * (x - 0.5) * (x - 1.0)
        turn = np.exp(-ik * self._at[:, None]) / (2 * np.pi)
        of_value = first - ik * second + ik * ik * third
        of_slope = second - 2 * ik * third
        return np.stack([turn * of_value, turn * of_slope, turn * third], axis=1)
