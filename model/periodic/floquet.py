"""Stability of a periodic motion: Floquet multipliers of the machine linearized along it.

Radau IIA with three points a step (order 5; what is faster than the steps is damped) in the modes
of the machine with its interfaces' mean tangents, where only what the tangents deviate from their
means couples them. Steps end where a contact opens or closes:

    u' = Lambda u + W f,    y = V u + R f,    f = dT(t) y

y: displacements and velocities of the interfaces, and own states; R: the modes left out, at rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg

from .balance import Orbit
from .entry_points import Lengths
from .force_corners import crossings
from .fourier import basis
from .laws import Along
from .linear_structure import Condensed

_C = np.array([(4 - math.sqrt(6)) / 10, (4 + math.sqrt(6)) / 10, 1.0])  # Radau IIA
_SEEN = np.array([*_C[:2], 1.0 - 1e-7])  # where in a step the tangents are looked at
_LEAST, _MOST = 96, 1024  # steps a turn
_SLOW = 200.0  # modes up to so many times the highest frequency of the orbit are kept


class Multipliers(NamedTuple):
    """Floquet multipliers, the largest first, and the motions that they multiply, as displacements
    and velocities of all coordinates, one a column."""

    values: np.ndarray
    shapes: np.ndarray


class Modes(NamedTuple):
    """Modes: roots [1/s], what forces do to them, y of them, y of a force by the modes left out,
    and displacements and velocities of all coordinates of them."""

    roots: np.ndarray
    W: np.ndarray
    V: np.ndarray
    R: np.ndarray
    shapes: np.ndarray


class Paces(NamedTuple):
    """Of a motion: speed of the rotor, frequency, and the highest frequency that it holds
    [rad/s]."""

    speed: float
    pace: float
    fastest: float


class Path(NamedTuple):
    """A motion that the machine is linearized along.

    at: of times [s], shape (n,), the displacements [m] and velocities [m/s] of the m nonlinear
    interfaces, x and y in turn, shape (n, 2 m) each, and the own states, shape (n, s), which are of
    the size `own_scale`.
    """

    at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    paces: Paces
    own_scale: np.ndarray


def path_of(machine: Condensed, orbit: Orbit) -> Path:
    """The path of an orbit."""
    d, pace = orbit.b @ machine.B.T, abs(orbit.omega)

    def at(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the motion at times."""
        value, slope = basis(orbit.H, pace * times)
        return value @ d, orbit.omega * slope @ d, value @ orbit.own

    own_scale = np.maximum(np.abs(orbit.own).max(axis=0, initial=0.0), 1e-9)
    return Path(at, Paces(orbit.speed, pace, pace * max(orbit.H, orbit.turns)), own_scale)


def multipliers(machine: Condensed, orbit: Orbit, steps: int = 0) -> Multipliers:
    """Of an orbit; steps: a period, 0: as many as its harmonics need."""
    path = path_of(machine, orbit)
    period = 2 * math.pi / path.paces.pace
    steps = steps or min(_MOST, max(_LEAST * orbit.turns, 4 * orbit.H))
    if machine.b == 0:
        modes = modes_of(machine, path.paces, np.zeros((0, 0)))
        return Multipliers(*_sorted(np.exp(modes.roots * period), modes.shapes))
    part = tangents_along(machine, path, np.linspace(0.0, period, steps + 1))
    modes, mean = modes_along(machine, path, [part])
    values, vectors = np.linalg.eig(passed(modes, mean, part))
    return Multipliers(*_sorted(values, modes.shapes @ vectors))


class Part(NamedTuple):
    """A part of a path in steps of lengths h [s], shape (n,), with the tangents at the points of
    each, shape (n, 3, inputs, outputs)."""

    h: np.ndarray
    tangent: np.ndarray


def tangents_along(machine: Condensed, path: Path, times: np.ndarray) -> Part:
    """The tangents along a path between times [s], at which steps end, as they do where a contact
    opens or closes."""
    ends = _grid(machine, path, times)
    h = np.diff(ends)
    # at its last point a step sees its own side of a contact that opens or closes there
    tangent = _tangents(machine, path, (ends[:-1, None] + h[:, None] * _SEEN).ravel())
    return Part(h, tangent.reshape(len(h), 3, *tangent.shape[1:]))


def modes_along(machine: Condensed, path: Path, parts: Sequence[Part]) -> tuple[Modes, np.ndarray]:
    """The modes of the machine with the mean tangents of parts of a path, and these."""
    of_points, length = weights(), sum(float(part.h.sum()) for part in parts)
    each = [np.einsum("t,i,tiao->ao", part.h, of_points, part.tangent) for part in parts]
    mean = held(machine, path.paces, sum(each) / length)
    return modes_of(machine, path.paces, mean), mean


def _sorted(values: np.ndarray, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(-np.abs(values), kind="stable")
    return values[order], shapes[:, order]


def weights() -> np.ndarray:
    """By which the points of a step count in its mean."""
    powers = np.array([_C**p for p in range(3)])
    return np.linalg.solve(powers, 1.0 / np.arange(1, 4))


def _grid(machine: Condensed, path: Path, times: np.ndarray) -> np.ndarray:
    """Times at which steps end: those given, even ones, and where a force has a corner."""
    laws, h = machine.laws, times[1] - times[0]
    if not len(laws.levels[0]):
        return times
    gap = laws.openings(path.at(np.concatenate([[times[0] - h], times, [times[-1] + h]]))[0])

    def gap_at(cell: np.ndarray, share: np.ndarray) -> np.ndarray:
        """Return the gaps between the times."""
        return laws.openings(path.at(times[cell] + h * share)[0])

    cell, share, _ = crossings(laws, gap, gap_at)
    return np.unique(np.concatenate([times, times[cell] + h * share]))


def _tangents(machine: Condensed, path: Path, times: np.ndarray) -> np.ndarray:
    """By y, the displacements b, the velocities and the states: of the forces as b sees them, and
    of the rates of the states, shape (n, b + s, 2 b + s)."""
    d, v, own = path.at(times)
    return by_y(machine, machine.laws.tangents(d, v, own, path.own_scale, path.paces.speed))


def by_y(machine: Condensed, along: Along) -> np.ndarray:
    """Derivatives by y of the forces as b sees them and of the rates of the states at n samples,
    shape (n, b + s, 2 b + s)."""
    n, s, b, B = len(along.force), machine.laws.states, machine.b, machine.B
    out = np.zeros((n, b + s, 2 * b + s))
    out[:, :b, :b], out[:, :b, b : 2 * b] = machine.of_b(along.by_d), machine.of_b(along.by_v)
    out[:, :b, 2 * b :] = B.T @ along.by_rate
    out[:, b:, :b] = along.rates_by_d @ B
    out[:, b:, b : 2 * b] = along.rates_by_v @ B
    out[:, b:, 2 * b :] = along.rates_by_own
    return out


def held(machine: Condensed, paces: Paces, mean: np.ndarray) -> np.ndarray:
    """With springs where a contact is hardly ever closed: a machine that nothing holds has motions
    as one body, which are no modes."""
    own = np.diag(machine.matrices(paces.speed).M)[: machine.b] * paces.pace**2
    diagonal = np.arange(machine.b)
    lacks = np.abs(mean[diagonal, diagonal]) < 0.1 * own
    held = mean.copy()
    held[diagonal[lacks], diagonal[lacks]] -= own[lacks]
    return held


def modes_of(machine: Condensed, paces: Paces, mean: np.ndarray) -> Modes:
    """Of the machine with mean tangents: roots, what forces do to them, y of them, the rest's
    flexibility, displacements and velocities of all coordinates of them."""
    M, D, K = machine.matrices(paces.speed)
    N, b, s = machine.size, machine.b, machine.laws.states
    K, D = K.copy(), D.copy()
    if len(mean):
        K[:b, :b] -= mean[:b, :b]
        D[:b, :b] -= mean[:b, b : 2 * b]
    squares, shapes = _real_modes(M, K)
    slow = squares < (_SLOW * paces.fastest) ** 2
    P, rest = shapes[:, slow], shapes[:, ~slow]
    n = P.shape[1]
    pace = paces.pace
    A = np.zeros((2 * n + s, 2 * n + s))
    A[:n, n : 2 * n] = pace * np.eye(n)  # velocities over pace
    A[n : 2 * n, :n] = -(P.T @ K @ P) / pace
    A[n : 2 * n, n : 2 * n] = -(P.T @ D @ P)
    inputs = np.zeros((2 * n + s, b + s))
    inputs[n : 2 * n, :b] = P[:b].T / pace
    inputs[2 * n :, b:] = np.eye(s)
    outputs = np.zeros((2 * b + s, 2 * n + s))
    outputs[:b, :n], outputs[b : 2 * b, n : 2 * n] = P[:b], pace * P[:b]
    outputs[2 * b :, 2 * n :] = np.eye(s)
    if len(mean):
        A[n : 2 * n, 2 * n :] = P[:b].T @ mean[:b, 2 * b :] / pace
        A[2 * n :] += mean[b:] @ outputs
    roots, vectors = np.linalg.eig(A)
    W = np.linalg.solve(vectors, inputs.astype(complex))
    R = np.zeros((2 * b + s, b + s))
    if rest.shape[1]:
        R[:b, :b] = rest[:b] @ np.linalg.solve(rest.T @ K @ rest, rest[:b].T)
    whole = np.zeros((2 * N, 2 * n + s))
    whole[:N, :n], whole[N:, n : 2 * n] = P, pace * P
    return Modes(roots, W, outputs @ vectors, R, whole @ vectors)


def _real_modes(M: np.ndarray, K: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the symmetric part of K: squares of frequencies, shapes with unit modal masses."""
    return scipy.linalg.eigh(0.5 * (K + K.T), M)


def _collocation(roots: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of steps of Radau IIA of lengths h [s], shape (l,): what they make of each mode at their
    points, shape (l, 3, modes); weights of the forces at the points, shape (l, 3, 3, modes) [s].

    Both come of (1 - z a)^-1, z = h root, by its adjugate 1 - z (tr a - a) + z^2 adj a."""
    powers = np.array([_C**p for p in range(3)])
    integrals = np.array([_C ** (p + 1) / (p + 1) for p in range(3)])
    a = integrals.T @ np.linalg.inv(powers).T
    trace, det, one = np.trace(a), np.linalg.det(a), np.eye(3)
    adjugate = det * np.linalg.inv(a)
    z = h[:, None] * roots
    per = 1.0 / (1.0 - z * (trace - z * (np.trace(adjugate) - z * det)))
    powers = np.stack([per, z * per, z * z * per], axis=1)  # shape (l, 3, modes)
    grown = np.array([one, a - trace * one, adjugate]).sum(axis=2).T @ powers
    weight = np.array([a, a @ a - trace * a, det * one]).reshape(3, 9).T @ powers
    return grown, (h[:, None, None] * weight).reshape(len(h), 3, 3, len(roots))


def lengths(modes: Modes, h: np.ndarray) -> Lengths:
    """Of steps of lengths h [s]. A pair of modes is taken by the real and the imaginary part of its
    amplitude, since what is complex takes four times as long."""
    (outputs, n), c = modes.V.shape, modes.W.shape[1]
    each, which = np.unique(np.round(h / h.max(), 12), return_inverse=True)
    count, is_first = len(each), modes.roots.imag > 0
    is_second = np.roll(is_first, 1)
    of = np.flatnonzero(~is_second)  # one of each pair, whose other is its conjugate
    grown, weight = _collocation(modes.roots[of], each * h.max())
    V, W = modes.V[:, of], modes.W[of]
    twice = np.where(is_first[of], 2.0, 1.0)
    last = weight[:, 2].transpose(0, 2, 1)
    forced = (last[..., None] * W[:, None]).reshape(count, len(of), 3 * c)
    seen = (twice * V * grown[:, :, None, :]).reshape(count, 3 * outputs, len(of))
    of_force = (twice[:, None, None] * V.T[:, :, None] * W[:, None, :]).reshape(len(of), -1)
    weight = weight.reshape(-1, len(of))
    among = weight.real @ of_force.real - weight.imag @ of_force.imag
    among = among.reshape(count, 3, 3, outputs, c)
    among[:, np.arange(3), np.arange(3)] += modes.R
    place = np.cumsum(~is_second) - 1
    alone, forced = grown[:, 2].take(place, 1), forced.take(place, 1)
    seen = seen.take(place, 2)
    return Lengths(
        which,
        # g (a + i b): -Im g b in the row of a, Im g a in that of b
        alone.real.copy(),
        np.where(is_second, alone.imag, -alone.imag),
        np.where(is_second[:, None], forced.imag, forced.real),
        np.where(is_second, -seen.imag, seen.real),
        among.transpose(0, 1, 3, 2, 4).reshape(count, 3 * outputs, 3 * c),
        np.arange(n) + is_first - is_second,
    )


def passed(modes: Modes, mean: np.ndarray, part: Part) -> np.ndarray:
    """The modes' amplitudes at the end of a part of a path by those at its begin; mean: the
    tangents that are in the modes."""
    T, inverse = real_amplitudes(modes.roots)
    return T @ through(lengths(modes, part.h), part.tangent - mean) @ inverse


def through(steps: Lengths, change: np.ndarray) -> np.ndarray:
    """Real amplitudes at the end of steps by those at their begin, shape (n, n), with forces
    `change` y at the points, shape (steps, 3, c, outputs)."""
    count, _, c, outputs = change.shape
    n = steps.along.shape[1]
    among = steps.among.reshape(-1, 3, outputs, 3 * c)[steps.which]
    left = np.eye(3 * c) - (change @ among).reshape(count, 3 * c, 3 * c)
    seen = steps.seen.reshape(-1, 3, outputs, n)[steps.which]
    forces = np.linalg.inv(left) @ (change @ seen).reshape(count, 3 * c, n)
    state = np.eye(n)
    for i, k in enumerate(steps.which):
        after = steps.forced[k] @ (forces[i] @ state)
        after += steps.along[k][:, None] * state
        state = state.take(steps.other, 0)
        state *= steps.across[k][:, None]
        state += after
    return state


def real_amplitudes(roots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What makes complex amplitudes of real ones, and its inverse; pairs of roots follow one
    another, that with the positive imaginary part first."""
    n = len(roots)
    T, inverse = np.eye(n, dtype=complex), np.eye(n, dtype=complex)
    for m in np.flatnonzero(roots.imag > 0):
        pair = slice(m, m + 2)
        T[pair, pair] = [[1, 1j], [1, -1j]]
        inverse[pair, pair] = [[0.5, 0.5], [-0.5j, 0.5j]]
    return T, inverse
