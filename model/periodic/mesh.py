"""Time steps of a period: short where the forces change fast, and ending where a force has a
corner.

The period is bisected repeatedly and cut at corners. The error of a step is estimated from the
parabola through the forces at its three points: extrapolated to the begin of the step it misses the
force there by an impulse, which is to be a small share of the period's.
"""

import functools
import math

import numpy as np

from .force_corners import crossings
from .linear_structure import CondensedMachine

POINTS = np.array([(4 - math.sqrt(6)) / 10, (4 + math.sqrt(6)) / 10, 1.0])  # Radau IIA
_COARSEST, _UNIFORM, _FINEST = 6, 9, 13  # halvings of the period
UNIFORM_MESH = np.linspace(0.0, 1.0, 2**_UNIFORM + 1)  # of the period, as fractions of it
_MISSED_IMPULSE = 3e-6  # that a parabola may miss in a step, as a share of the period's
_FINER, _COARSER = 3, 1  # halvings at once
_CORNER_SAMPLES = 2048  # instants at which corners are looked for
_APART = 1e-6  # of the period: how near its begin a corner is none
_BESIDE = 0.2  # of a step: how near a corner no other step ends, since the corner moves a little
# weights of the values at the points in the value of their parabola at the beginning
_BACK = np.array(
    [np.prod(np.delete(POINTS, i) / (np.delete(POINTS, i) - POINTS[i])) for i in range(3)]
)


@functools.cache  # not a constant: an import may not solve with threads of its own
def mean_weights() -> np.ndarray:
    """Return the weights of the values at the points in the mean over a step."""
    return np.linalg.solve([POINTS**p for p in range(3)], 1.0 / np.arange(1, 4))


def refined_mesh(ends: np.ndarray, which: np.ndarray) -> np.ndarray:
    """Return the mesh with some of the steps divided by four, and those after them by two."""
    h, after = np.diff(ends), which | np.roll(which, 1)
    quarters = [ends[:-1][which] + share * h[which] for share in (0.25, 0.75)]
    return np.unique(np.concatenate([ends, ends[:-1][after] + 0.5 * h[after], *quarters]))


def mesh_points(ends: np.ndarray) -> np.ndarray:
    """Return the three points of each step, as fractions of the period, shape (steps, 3)."""
    return ends[:-1, None] + np.diff(ends)[:, None] * POINTS


def interpolated(values: np.ndarray, ends: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return values at fractions of the period, shape (n, m), from those at the points of the
    steps, shape (steps, 3, m), by the cubic of each step that also meets the end of the step
    before."""
    step = np.clip(np.searchsorted(ends, at, "left") - 1, 0, len(ends) - 2)
    x = (at - ends[step]) / (ends[step + 1] - ends[step])
    nodes = np.append(0.0, POINTS)
    known = np.concatenate([np.roll(values[:, 2:], 1, axis=0), values], axis=1)[step]
    share = np.ones((len(at), 4))
    for i in range(4):
        for j in np.delete(np.arange(4), i):
            share[:, i] *= (x - nodes[j]) / (nodes[i] - nodes[j])
    return np.einsum("ni,nim->nm", share, known)


def at_mesh_points(values: np.ndarray, ends: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return values at the points of another mesh, from those at the points of one."""
    at = mesh_points(others)
    return interpolated(values, ends, at.ravel()).reshape(*at.shape, -1)


def with_corners(
    machine: CondensedMachine, y: np.ndarray, ends: np.ndarray, cells: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mesh of cells, the ends of steps, that also ends in the corners along a motion y,
    at the points of the present mesh, shape (steps, 3, m); and the cells without the ends close to
    a corner, which stay away where it moves on."""
    corners = _corners(machine, y, ends)
    corners = np.unique(corners[np.minimum(corners, 1.0 - corners) > _APART])
    inner, h = cells[1:-1], np.diff(cells)
    around = np.concatenate([[-1.0], corners, [2.0]])
    behind = np.searchsorted(around, inner)
    apart = np.minimum(inner - around[behind - 1], around[behind] - inner)
    is_far = apart > _BESIDE * np.minimum(h[:-1], h[1:])
    cells = np.concatenate([[0.0], inner[is_far], [1.0]])
    return np.union1d(cells, corners), cells


def adapted_cells(force: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the mesh by bisection that the forces at the points of the present one demand, shape
    (steps, 3, m), without corners."""
    h, n = np.diff(ends), 2**_FINEST
    missed = np.abs(np.einsum("i,tim->tm", _BACK, force) - np.roll(force[:, 2], 1, axis=0))
    missed = h * np.linalg.norm(missed, axis=1)
    whole = max(float(h @ np.linalg.norm(force, axis=2).mean(axis=1)), 1e-300)
    now = -np.log2(h)
    wanted = now + np.log2(np.maximum(missed / (_MISSED_IMPULSE * whole), 1e-12)) / 4
    wanted = np.clip(np.ceil(wanted), np.floor(now + 1e-9) - _COARSER, now + _FINER)
    halvings = np.clip(wanted, _COARSEST, _FINEST).astype(int)
    of_least = halvings[np.searchsorted(ends, (np.arange(n) + 0.5) / n) - 1]
    np.maximum.at(of_least, np.minimum((ends[:-1] * n).astype(int), n - 1), halvings)
    is_end, is_free = np.append(np.zeros(n, bool), True), np.ones(n, bool)
    for halved in range(_COARSEST, _FINEST + 1):
        size = n // 2**halved
        is_one = of_least.reshape(-1, size).max(axis=1) <= halved
        is_one &= is_free.reshape(-1, size).all(axis=1)
        is_end[:-1:size] |= is_one
        is_free &= ~np.repeat(is_one, size)
    return np.flatnonzero(is_end) / n


def _corners(machine: CondensedMachine, y: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return where forces have corners, as fractions of the period."""
    if not len(machine.laws.corner_owner):
        return np.zeros(0)

    def gap(at: np.ndarray) -> np.ndarray:
        b, B = machine.b, machine.B
        motion = interpolated(y[..., : 2 * b], ends, at % 1.0)
        return machine.laws.corner_gaps(motion[:, :b] @ B.T, motion[:, b:] @ B.T)

    n = _CORNER_SAMPLES
    found = crossings(
        machine.laws, gap(np.arange(-1, n + 2) / n), lambda cell, share: gap((cell + share) / n)
    )
    return (found.cell + found.share) / n
