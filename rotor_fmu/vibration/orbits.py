"""Orbits, Poincare sections and the sense of whirl."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .turns import TURN, Synchronous, synchronous


@dataclass(frozen=True)
class Orbit:
    """The path of a place over whole turns at one speed.

    speed [rad/s]; t: shape (n,) [s]; z: x + i y, shape (n,) [m], from a keyphasor mark on;
    marks: where the place was at the marks, shape (turns,) [m].
    """

    speed: float
    t: np.ndarray
    z: np.ndarray
    marks: np.ndarray


@dataclass(frozen=True)
class Poincare:
    """Where a place was once a turn, at the keyphasor mark.

    t [s], speed [rad/s], points: x + i y [m]; shape (turns,). One point that stays: the motion
    repeats every turn; two in turn: every second turn; a closed curve: a whirl of its own
    frequency; a cloud: chaos.
    """

    t: np.ndarray
    speed: np.ndarray
    points: np.ndarray


@dataclass(frozen=True)
class Whirl:
    """How a place went round its mean position, one row a turn.

    t [s], speed [rad/s]; sense: from -1, a backward circle, over 0, a straight line, to 1, a
    forward circle; order: mean angular velocity of the whirl over the shaft's, negative backward;
    shape (turns,).
    """

    t: np.ndarray
    speed: np.ndarray
    sense: np.ndarray
    order: np.ndarray


@dataclass(frozen=True)
class Displacement:
    """Unfiltered ("direct") displacements of each turn, as ISO 20816-1 has them.

    t [s], speed [rad/s]; x_pp, y_pp: peak-to-peak [m]; s_max: largest distance from the mean
    position of the turn, 0-p [m]; shape (turns,).
    """

    t: np.ndarray
    speed: np.ndarray
    x_pp: np.ndarray
    y_pp: np.ndarray
    s_max: np.ndarray


def orbit(
    t: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    speed: float,
    *,
    turns: int = 4,
    per_turn: int | None = None,
) -> Orbit:
    """The orbit of the `turns` turns nearest to a speed [rad/s]. Raises `TooFewTurns`."""
    signal = synchronous(t, phi, z, turns=turns, per_turn=per_turn)
    first = signal.nearest(speed, turns)
    path = slice(first, first + turns)
    return Orbit(
        float(signal.speed_over(np.array([first]), turns)[0]),
        signal.t[path].ravel(),
        signal.values[path].ravel(),
        signal.values[path, 0],
    )


def poincare(
    t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, per_turn: int | None = None
) -> Poincare:
    """The Poincare section of a run, a point a turn. Raises `TooFewTurns`."""
    signal = synchronous(t, phi, z, per_turn=per_turn)
    return Poincare(signal.marks[:-1], signal.speed, signal.values[:, 0])


def whirl(t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, per_turn: int | None = None) -> Whirl:
    """The sense of whirl of every turn but the first and the last. Raises `TooFewTurns`.

    With w = z less its mean over the turn and w' = dw / dphi:
    sense = Im <conj(w) w'> / sqrt(<|w|^2> <|w'|^2>), order = Im <conj(w) w'> / <|w|^2>; the area
    that is swept a turn is pi times Im <conj(w) w'>.
    """
    return whirl_of(synchronous(t, phi, z, turns=3, per_turn=per_turn))


def whirl_of(signal: Synchronous) -> Whirl:
    """`whirl` of a signal that is resampled already."""
    signal.needs(3)
    slope = np.gradient(signal.values.ravel(), TURN / signal.per_turn).reshape(signal.values.shape)
    slope = slope[1:-1]
    around = signal.values[1:-1]
    around = around - around.mean(axis=1, keepdims=True)
    swept = (around.conj() * slope).imag.mean(axis=1)
    square = (np.abs(around) ** 2).mean(axis=1)
    both = np.sqrt(square * (np.abs(slope) ** 2).mean(axis=1))
    middle = (signal.marks[1:-2] + signal.marks[2:-1]) / 2
    return Whirl(middle, signal.speed[1:-1], _over(swept, both), _over(swept, square))


def displacement(
    t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, per_turn: int | None = None
) -> Displacement:
    """Peak-to-peak displacements and S_max of every turn (ISO 20816-1). Raises `TooFewTurns`."""
    return displacement_of(synchronous(t, phi, z, per_turn=per_turn))


def displacement_of(signal: Synchronous) -> Displacement:
    """`displacement` of a signal that is resampled already."""
    values = signal.values
    return Displacement(
        (signal.marks[:-1] + signal.marks[1:]) / 2,
        signal.speed,
        np.ptp(values.real, axis=1),
        np.ptp(values.imag, axis=1),
        np.abs(values - values.mean(axis=1, keepdims=True)).max(axis=1),
    )


def _over(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    return np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)
