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
from .condensed import Condensed
from .corners import crossings
from .fourier import basis

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


class Path(NamedTuple):
    """A motion that the machine is linearized along, at a speed [rad/s].

    at: of times [s], shape (n,), the displacements [m] and velocities [m/s] of the m nonlinear
    interfaces, x and y in turn, shape (n, 2 m) each, and the own states, shape (n, s), which are of
    the size `own_scale`; pace: the motion's frequency, fastest: the highest that it holds [rad/s].
    """

    at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    speed: float
    pace: float
    fastest: float
    own_scale: np.ndarray


def path_of(machine: Condensed, orbit: Orbit) -> Path:
    """The path of an orbit."""
    d, pace = orbit.b @ machine.B.T, abs(orbit.omega)

    def at(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the motion at times."""
        value, slope = basis(orbit.H, pace * times)
        return value @ d, orbit.omega * slope @ d, value @ orbit.own

    own_scale = np.maximum(np.abs(orbit.own).max(axis=0, initial=0.0), 1e-9)
    return Path(at, orbit.speed, pace, pace * max(orbit.H, orbit.turns), own_scale)


def multipliers(machine: Condensed, orbit: Orbit, steps: int = 0) -> Multipliers:
    """Of an orbit; steps: a period, 0: as many as its harmonics need."""
    path = path_of(machine, orbit)
    period = 2 * math.pi / path.pace
    steps = steps or min(_MOST, max(_LEAST * orbit.turns, 4 * orbit.H))
    if machine.b == 0:
        modes = _modes(machine, path, np.zeros((0, 0)))
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
    weights, length = _weights(), sum(float(part.h.sum()) for part in parts)
    mean = sum(np.einsum("t,i,tiao->ao", part.h, weights, part.tangent) for part in parts) / length
    mean = _held(machine, path, mean)
    return _modes(machine, path, mean), mean


def _sorted(values: np.ndarray, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(-np.abs(values), kind="stable")
    return values[order], shapes[:, order]


def _weights() -> np.ndarray:
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
    along = machine.laws.tangents(d, v, own, path.own_scale, path.speed)
    n, s, b, B = len(times), machine.laws.states, machine.b, machine.B
    out = np.zeros((n, b + s, 2 * b + s))
    out[:, :b, :b], out[:, :b, b : 2 * b] = machine.of_b(along.by_d), machine.of_b(along.by_v)
    out[:, :b, 2 * b :] = B.T @ along.by_rate
    out[:, b:, :b] = along.rates_by_d @ B
    out[:, b:, b : 2 * b] = along.rates_by_v @ B
    out[:, b:, 2 * b :] = along.rates_by_own
    return out


def _held(machine: Condensed, path: Path, mean: np.ndarray) -> np.ndarray:
    """With springs where a contact is hardly ever closed: a machine that nothing holds has motions
    as one body, which are no modes."""
    own = np.diag(machine.matrices(path.speed).M)[: machine.b] * path.pace**2
    diagonal = np.arange(machine.b)
    lacks = np.abs(mean[diagonal, diagonal]) < 0.1 * own
    held = mean.copy()
    held[diagonal[lacks], diagonal[lacks]] -= own[lacks]
    return held


def _modes(machine: Condensed, path: Path, mean: np.ndarray) -> Modes:
    """Of the machine with mean tangents: roots, what forces do to them, y of them, the rest's
    flexibility, displacements and velocities of all coordinates of them."""
    M, D, K = machine.matrices(path.speed)
    N, b, s = machine.size, machine.b, machine.laws.states
    K, D = K.copy(), D.copy()
    if len(mean):
        K[:b, :b] -= mean[:b, :b]
        D[:b, :b] -= mean[:b, b : 2 * b]
    squares, shapes = _real_modes(M, K)
    slow = squares < (_SLOW * path.fastest) ** 2
    P, rest = shapes[:, slow], shapes[:, ~slow]
    n = P.shape[1]
    pace = path.pace
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


def _collocation(roots: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Of one step of Radau IIA: what it makes of each mode at its points, shape (3, modes); weights
    of the forces at the points, shape (3, 3, modes) [s]."""
    powers = np.array([_C**p for p in range(3)])
    integrals = np.array([_C ** (p + 1) / (p + 1) for p in range(3)])
    a = integrals.T @ np.linalg.inv(powers).T
    inverse = np.linalg.inv(np.eye(3) - h * roots[:, None, None] * a)
    return inverse.sum(axis=2).T, (inverse @ (h * a)).transpose(1, 2, 0)


def passed(modes: Modes, mean: np.ndarray, part: Part) -> np.ndarray:
    """The modes' amplitudes at the end of a part of a path by those at its begin; mean: the
    tangents that are in the modes. A pair of modes is taken by the real and the imaginary part of
    its amplitude, since what is complex takes four times as long."""
    h, change = part.h, part.tangent - mean
    count, n = modes.W.shape[1], len(modes.roots)
    T, inverse, other = _real_amplitudes(modes.roots)
    groups: dict[float, list[int]] = {}
    for i, length in enumerate(h):
        groups.setdefault(float(f"{length:.9e}"), []).append(i)
    made: dict[float, tuple[np.ndarray, ...]] = {}
    gains = np.empty((len(h), 3 * count, n))
    keys = np.empty(len(h))
    for length, members in groups.items():
        grown, weight = _collocation(modes.roots, length)
        forced = np.concatenate([weight[2, j][:, None] * modes.W for j in range(3)], axis=1)
        # g (a + i b): -Im g b in the row of a, Im g a in that of b, whose own g is conj g
        made[length] = grown[2].real, -grown[2].imag, (inverse @ forced).real
        among = np.einsum("om,ijm,mq->iojq", modes.V, weight, modes.W, optimize=True).real
        for i in range(3):
            among[i, :, i] += modes.R
        at = np.array(members)
        keys[at] = length
        of = change[at]
        left = np.einsum("tiao,iojq->tiajq", of, among, optimize=True)
        left = np.eye(3 * count) - left.reshape(len(at), 3 * count, 3 * count)
        seen = (np.einsum("om,im->iom", modes.V, grown) @ T).real
        right = np.einsum("tiao,iom->tiam", of, seen, optimize=True)
        gains[at] = np.linalg.solve(left, right.reshape(len(at), 3 * count, n))
    state = np.eye(n)
    for i in range(len(h)):
        along, across, forced = made[keys[i]]
        pushed = forced @ (gains[i] @ state)
        state = along[:, None] * state + across[:, None] * state[other] + pushed
    return T @ state @ inverse


def _real_amplitudes(roots: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What makes complex amplitudes of real ones, its inverse, and the place of the other of each
    pair; pairs of roots follow one another, that with the positive imaginary part first."""
    n = len(roots)
    T, inverse, other = np.eye(n, dtype=complex), np.eye(n, dtype=complex), np.arange(n)
    for m in np.flatnonzero(roots.imag > 0):
        pair = slice(m, m + 2)
        T[pair, pair] = [[1, 1j], [1, -1j]]
        inverse[pair, pair] = [[0.5, 0.5], [-0.5j, 0.5j]]
        other[pair] = m + 1, m
    return T, inverse, other
