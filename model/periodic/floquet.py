"""Stability of a periodic motion: Floquet multipliers of the machine linearized along it.

Radau IIA with three points a step (order 5; what is faster than the steps is damped) in the modes
of the machine with its interfaces' mean tangents, where only what the tangents deviate from their
means couples them. Steps end where a contact opens or closes:

    u' = Lambda u + W f,    y = V u + R f,    f = dT(t) y

y: displacements and velocities of the interfaces, and own states; R: the modes left out, at rest.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy.linalg

from .balance import Orbit
from .condensed import Condensed
from .fourier import basis

_C = np.array([(4 - math.sqrt(6)) / 10, (4 + math.sqrt(6)) / 10, 1.0])  # Radau IIA
_LEAST, _MOST = 96, 1024  # steps a turn
_SLOW = 200.0  # modes up to so many times the highest frequency of the orbit are kept


class Multipliers(NamedTuple):
    """Floquet multipliers, the largest first, and the motions that they multiply, as displacements
    and velocities of all coordinates, one a column."""

    values: np.ndarray
    shapes: np.ndarray


class _Modes(NamedTuple):
    roots: np.ndarray
    W: np.ndarray
    V: np.ndarray
    R: np.ndarray
    shapes: np.ndarray


def multipliers(machine: Condensed, orbit: Orbit, steps: int = 0) -> Multipliers:
    """Of an orbit; steps: a period, 0: as many as its harmonics need."""
    period = 2 * math.pi / abs(orbit.omega)
    steps = steps or min(_MOST, max(_LEAST * orbit.turns, 4 * orbit.H))
    if machine.b == 0:
        modes = _modes(machine, orbit, np.zeros((0, 0)))
        return Multipliers(*_sorted(np.exp(modes.roots * period), modes.shapes))
    ends = _grid(machine, orbit, steps)
    h = np.diff(ends) / abs(orbit.omega)
    at = (ends[:-1, None] + np.diff(ends)[:, None] * _C).ravel()
    tangent = _tangents(machine, orbit, at)
    weights = (np.repeat(h, 3) * np.tile(_weights(), len(h)))[:, None, None]
    mean = (weights * tangent).sum(axis=0) / weights.sum()
    mean = _held(machine, orbit, mean)
    modes = _modes(machine, orbit, mean)
    change = (tangent - mean).reshape(len(h), 3, *mean.shape)
    passed = _passed(modes, change, h)
    values, vectors = np.linalg.eig(passed)
    return Multipliers(*_sorted(values, modes.shapes @ vectors))


def _sorted(values: np.ndarray, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(-np.abs(values), kind="stable")
    return values[order], shapes[:, order]


def _weights() -> np.ndarray:
    powers = np.array([_C**p for p in range(3)])
    return np.linalg.solve(powers, 1.0 / np.arange(1, 4))


def _motion(machine: Condensed, orbit: Orbit, angles: np.ndarray):
    value, slope = basis(orbit.H, angles)
    d = orbit.b @ machine.B.T
    return value @ d, orbit.omega * slope @ d, value @ orbit.own


def _grid(machine: Condensed, orbit: Orbit, steps: int) -> np.ndarray:
    """Angles at which steps end, over a period: evenly, and where a contact opens or closes."""
    even = np.linspace(0.0, 2 * math.pi, steps + 1)
    d, _, _ = _motion(machine, orbit, even)
    opening = machine.laws.openings(d)
    changes = []
    for j in np.flatnonzero(machine.laws.has_wall):
        for i in np.flatnonzero(opening[:-1, j] * opening[1:, j] < 0):
            low, high = even[i], even[i + 1]
            for _ in range(30):
                middle = 0.5 * (low + high)
                now = machine.laws.openings(_motion(machine, orbit, np.array([middle]))[0])[0, j]
                low, high = (middle, high) if now * opening[i, j] > 0 else (low, middle)
            changes.append(0.5 * (low + high))
    return np.unique(np.concatenate([even, changes]))


def _tangents(machine: Condensed, orbit: Orbit, angles: np.ndarray) -> np.ndarray:
    """By y, the displacements b, the velocities and the states: of the forces as b sees them, and
    of the rates of the states, shape (n, b + s, 2 b + s)."""
    d, v, own = _motion(machine, orbit, angles)
    scale = np.maximum(np.abs(orbit.own).max(axis=0, initial=0.0), 1e-9)
    along = machine.laws.tangents(d, v, own, scale, orbit.speed)
    n, m, s, b, B = len(angles), machine.laws.count, machine.laws.states, machine.b, machine.B
    out = np.zeros((n, b + s, 2 * b + s))
    for place, blocks in ((0, along.by_d), (b, along.by_v)):
        whole = np.zeros((n, 2 * m, 2 * m))
        for j in range(m):
            whole[:, 2 * j : 2 * j + 2, 2 * j : 2 * j + 2] = blocks[:, j]
        out[:, :b, place : place + b] = B.T @ whole @ B
    out[:, :b, 2 * b :] = B.T @ along.by_rate
    out[:, b:, :b] = along.rates_by_d @ B
    out[:, b:, b : 2 * b] = along.rates_by_v @ B
    out[:, b:, 2 * b :] = along.rates_by_own
    return out


def _held(machine: Condensed, orbit: Orbit, mean: np.ndarray) -> np.ndarray:
    """With springs where a contact is hardly ever closed: a machine that nothing holds has motions
    as one body, which are no modes."""
    own = np.diag(machine.matrices(orbit.speed).M)[: machine.b] * orbit.omega**2
    diagonal = np.arange(machine.b)
    lacks = np.abs(mean[diagonal, diagonal]) < 0.1 * own
    held = mean.copy()
    held[diagonal[lacks], diagonal[lacks]] -= own[lacks]
    return held


def _modes(machine: Condensed, orbit: Orbit, mean: np.ndarray) -> _Modes:
    """Of the machine with mean tangents: roots, what forces do to them, y of them, the rest's
    flexibility, displacements and velocities of all coordinates of them."""
    M, D, K = machine.matrices(orbit.speed)
    N, b, s = machine.size, machine.b, machine.laws.states
    K, D = K.copy(), D.copy()
    if len(mean):
        K[:b, :b] -= mean[:b, :b]
        D[:b, :b] -= mean[:b, b : 2 * b]
    squares, shapes = _real_modes(M, K)
    fastest = _SLOW * abs(orbit.omega) * max(orbit.H, orbit.turns)
    slow = squares < fastest**2
    P, rest = shapes[:, slow], shapes[:, ~slow]
    n = P.shape[1]
    pace = abs(orbit.omega)
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
    return _Modes(roots, W, outputs @ vectors, R, whole @ vectors)


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


def _passed(modes: _Modes, change: np.ndarray, h: np.ndarray) -> np.ndarray:
    """The modes' amplitudes after a period by those at its begin; change: of the tangents, shape
    (steps, 3, inputs, outputs)."""
    count, n = modes.W.shape[1], len(modes.roots)
    state = np.eye(n, dtype=complex)
    made: dict[float, tuple] = {}
    groups: dict[float, list[int]] = {}
    for i, length in enumerate(h):
        groups.setdefault(round(float(length), 15), []).append(i)
    gains = np.empty((len(h), 3 * count, n), complex)
    keys = np.empty(len(h))
    for length, members in groups.items():
        grown, weight = _collocation(modes.roots, length)
        forced = np.concatenate([weight[2, j][:, None] * modes.W for j in range(3)], axis=1)
        made[length] = grown[2], forced
        among = np.einsum("om,ijm,mq->iojq", modes.V, weight, modes.W, optimize=True)
        for i in range(3):
            among[i, :, i] += modes.R
        at = np.array(members)
        keys[at] = length
        of = change[at]
        left = np.einsum("tiao,iojq->tiajq", of, among, optimize=True)
        left = np.eye(3 * count) - left.reshape(len(at), 3 * count, 3 * count)
        seen = np.einsum("om,im->iom", modes.V, grown)
        right = np.einsum("tiao,iom->tiam", of, seen, optimize=True)
        gains[at] = np.linalg.solve(left, right.reshape(len(at), 3 * count, n))
    for i in range(len(h)):
        grown, weight = made[keys[i]]
        state = grown[:, None] * state + weight @ (gains[i] @ state)
    return state
