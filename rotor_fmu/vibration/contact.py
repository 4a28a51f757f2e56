"""What a contact does over a run: where it rubs, how hard, how long; where the energy goes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .turns import TURN, TooFewTurns


@dataclass(frozen=True)
class Contact:
    """A contact over a run, one row a turn.

    t [s], speed [rad/s]; share: of the turn that it touched [1]; peak, mean: largest normal force
    and its mean over the turn [N]; angle: mean direction of the touch, weighted by the force, in
    [0, 2 pi), NaN without a touch [rad]; spread: 0, always there, to 1, all round [1];
    shape (turns,).
    """

    t: np.ndarray
    speed: np.ndarray
    share: np.ndarray
    peak: np.ndarray
    mean: np.ndarray
    angle: np.ndarray
    spread: np.ndarray


def contact(t: np.ndarray, phi: np.ndarray, psi: np.ndarray, fn: np.ndarray) -> Contact:
    """A contact's angle psi [rad] and normal force fn [N] over a run, by turns.

    The samples are taken as they are, each for the interval about it: a force that comes and goes
    within a few steps is not interpolated. Raises `TooFewTurns` for less than a turn.
    """
    t, phi, psi, fn = (np.asarray(values, float) for values in (t, phi, psi, fn))
    marks, speed, edges = _turns(t, phi)
    weight = np.gradient(t) if len(t) > 1 else np.ones_like(t)
    total = _sums(weight, edges)
    force = _sums(weight * fn, edges)
    touching = _sums(weight * (fn > 0), edges)
    push = _sums(weight * fn * np.exp(1j * psi), edges)
    is_met = force > 0
    length = np.divide(np.abs(push), force, out=np.zeros_like(force), where=is_met)
    return Contact(
        (marks[:-1] + marks[1:]) / 2,
        speed,
        np.clip(touching / total, 0, 1),
        np.maximum.reduceat(fn, edges[:-1]),
        force / total,
        np.where(is_met, np.mod(np.angle(push), TURN), np.nan),
        np.where(is_met, 1 - length, np.nan),
    )


def power_by_sink(
    t: np.ndarray, phi: np.ndarray, losses: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Mean power of each turn that every sink took.

    losses: energy dissipated since the start by the sink's name, shape (n,) [J]. Returns the times
    of the turns' middles [s], their speeds [rad/s] and powers by name, shape (turns,) [W].
    """
    t = np.asarray(t, float)
    marks, speed, _ = _turns(t, np.asarray(phi, float))
    took = {name: np.diff(np.interp(marks, t, energy)) for name, energy in losses.items()}
    powers = {name: energy / np.diff(marks) for name, energy in took.items()}
    return (marks[:-1] + marks[1:]) / 2, speed, powers


def _turns(t: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times of the marks, the mean speed between them and the first sample after each."""
    reached = np.maximum.accumulate(phi)
    first, last = int(np.ceil(reached[0] / TURN)), int(np.floor(reached[-1] / TURN))
    if last <= first:
        raise TooFewTurns("the signal holds no whole turn of the shaft; 1 is needed")
    angles = TURN * np.arange(first, last + 1)
    edges = np.searchsorted(reached, angles)
    full = np.diff(edges) > 0
    if not full.all():  # steps longer than a turn
        kept = np.concatenate([[True], full])
        angles, edges = angles[kept], edges[kept]
    grows = np.concatenate([[True], np.diff(reached) > 0])
    marks = np.interp(angles, reached[grows], t[grows])
    return marks, np.diff(angles) / np.diff(marks), edges


def _sums(values: np.ndarray, edges: np.ndarray) -> np.ndarray:
    return np.add.reduceat(values[: edges[-1]], edges[:-1])
