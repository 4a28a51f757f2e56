"""Orbits, Poincare sections, the sense of whirl, and how long a place points in each direction."""

from dataclasses import dataclass

import numpy as np

from ..errors import check_integer
from ..short_repr import ShortRepr
from .recorded import enough, finite
from .turns import TURN, Synchronous, hann, summed, synchronous

_FEWEST = 3  # turns by which a whirl is recognized
_SAMPLES = 16  # least samples a turn, from which an order of 1 is within 0.1 %, a range within 2 %
_NOTHING = 1e-12  # share of a mean square that rounding may leave of nothing


@dataclass(frozen=True, repr=False)
class Orbit(ShortRepr):
    """The path of a place over whole turns at a speed [rad/s]: times [s] and displacements x + i y
    [m] from a keyphasor mark on, shape (n,); displacements at the marks [m], shape (turns,)."""

    speed: float
    t: np.ndarray
    z: np.ndarray
    marks: np.ndarray


@dataclass(frozen=True, repr=False)
class Poincare(ShortRepr):
    """Where a place was once a turn, at the keyphasor mark.

    t [s], speed [rad/s], points: x + i y [m], NaN where less than 3 rows of a turn were recorded;
    shape (turns,). One point that stays: the motion repeats every turn; two in turn: every second
    turn; a closed curve: a whirl of its own frequency; a cloud: chaos.
    """

    t: np.ndarray
    speed: np.ndarray
    points: np.ndarray


@dataclass(frozen=True, repr=False)
class Whirl(ShortRepr):
    """How a place went round its mean position, one row a block of turns.

    t: middles of the blocks [s]; speed [rad/s]; sense: from -1, a backward circle, over 0, a
    straight line, to 1, a forward circle; order: mean angular velocity of the whirl over the
    shaft's, negative backward; both NaN where less than 3 rows a turn were recorded; shape
    (blocks,).
    """

    t: np.ndarray
    speed: np.ndarray
    sense: np.ndarray
    order: np.ndarray


@dataclass(frozen=True, repr=False)
class Displacement(ShortRepr):
    """Unfiltered ("direct") displacements of blocks of turns, as ISO 20816-1 has them, without
    the steady drift of the mean position over three blocks, which is no vibration.

    begin, t: begins and middles of the blocks [s]; speed [rad/s]; x_pp, y_pp: peak-to-peak [m];
    s_max: largest distance from the mean position of the block, 0-p [m]; mean: that position, x + i
    y [m]; shape (blocks,).
    """

    begin: np.ndarray
    t: np.ndarray
    speed: np.ndarray
    x_pp: np.ndarray
    y_pp: np.ndarray
    s_max: np.ndarray
    mean: np.ndarray


def orbit(
    t: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    speed: float,
    *,
    turns: int = 4,
    per_turn: int | None = None,
) -> Orbit:
    """Return the orbit of the `turns` consecutive turns that are nearest to a speed [rad/s]. Raises
    `TooFewTurns`, and `TooFewRows` for less than 3 rows a turn."""
    signal = synchronous(t, phi, z, turns=turns, per_turn=per_turn)
    first = signal.nearest(speed, turns)
    signal.enough_rows(np.array([first]), turns)
    speed = float(signal.speed_of(np.array([first]), turns)[0])
    path = slice(first, first + turns)
    z = signal.values[path]
    return Orbit(speed, signal.t[path].ravel(), z.ravel(), z[:, 0])


def poincare(
    t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, per_turn: int | None = None
) -> Poincare:
    """Return the Poincare section of a run, a point a turn, NaN where less than 3 rows were
    recorded in it. Raises `TooFewTurns`, and `TooFewRows` where there are no more in any turn."""
    signal = synchronous(t, phi, z, per_turn=per_turn)
    is_told = signal.enough_rows(np.arange(len(signal.mark)), 1)
    return Poincare(signal.begin, signal.speed, np.where(is_told, signal.values[:, 0], np.nan))


def whirl(
    t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, turns: int = 16, per_turn: int | None = None
) -> Whirl:
    """Return the sense of whirl in blocks of `turns` turns, one a turn, or of as many as there are.

    A block must hold whole cycles of what is slower than the shaft, or its mean is not what the
    place goes round: with 16 turns under Hann's window the mean is right within 0.6 % of a
    component of 0.2x and within 0.04 % of one of 0.43x. With w = z less that mean and w' = dw by
    the angle turned: sense = Im <conj(w) w'> / sqrt(<|w|^2> <|w'|^2>), order = Im <conj(w) w'> /
    <|w|^2>. Raises `TooFewTurns` for less than 3, `InputError` for less than 16 samples a turn.
    """
    return whirl_of(synchronous(t, phi, z, turns=_FEWEST, per_turn=per_turn), turns=turns)


def whirl_of(signal: Synchronous, *, turns: int = 16) -> Whirl:
    """Return `whirl` of a signal that is already resampled."""
    first, turns = _blocks(signal, turns)
    values = signal.values - signal.values.mean()
    slope = _slope(signal, values)
    window = hann(turns, signal.per_turn)

    def mean(of: np.ndarray) -> np.ndarray:
        return summed(of, window, first)

    middle, drift, size = mean(values), mean(slope), mean(np.abs(values) ** 2)
    swept = mean((values.conj() * slope).imag) - (middle.conj() * drift).imag
    square = size - np.abs(middle) ** 2
    square[square <= _NOTHING * size] = 0.0
    both = np.sqrt(square * mean(np.abs(slope) ** 2))
    way = np.where(signal.enough_rows(first, turns), signal.sense[first], np.nan)
    at = signal.middle_of(first, turns), signal.speed_of(first, turns)
    return Whirl(*at, way * _over(swept, both), way * _over(swept, square))


def displacement(
    t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, turns: int = 16, per_turn: int | None = None
) -> Displacement:
    """Return the peak-to-peak displacements and S_max (ISO 20816-1) of blocks of `turns` turns, one
    a turn, or of as many as there are, so that they hold whole cycles of what is slower than the
    shaft. Raises `TooFewTurns` for less than a turn, `InputError` for less than 16 samples a turn.
    """
    return displacement_of(synchronous(t, phi, z, per_turn=per_turn), turns=turns)


def displacement_of(signal: Synchronous, *, turns: int = 16) -> Displacement:
    """Return `displacement` of a signal that is already resampled."""
    first, turns = _blocks(signal, turns, 1)
    signal.enough_rows(first, turns)
    one = np.full((1, signal.per_turn), 1 / signal.per_turn)
    window = hann(turns, signal.per_turn) if turns > 1 else one
    centre = summed(signal.values, window, first)[:, None]
    drift, ramp = signal.drift_of(first, turns)[:, None], signal.ramp(turns)
    farthest = np.zeros(len(first))
    ends = np.full((4, len(first)), -np.inf)
    for k in range(turns):
        z = signal.values[first + k] - drift * ramp[k]
        np.maximum(farthest, np.abs(z - centre).max(axis=1), out=farthest)
        for end, values in zip(ends, (z.real, -z.real, z.imag, -z.imag), strict=True):
            np.maximum(end, values.max(axis=1), out=end)
    at = signal.begin[first], signal.middle_of(first, turns), signal.speed_of(first, turns)
    return Displacement(*at, ends[0] + ends[1], ends[2] + ends[3], farthest, centre[:, 0])


def _blocks(signal: Synchronous, turns: int, least: int = _FEWEST) -> tuple[np.ndarray, int]:
    """Return the first turns of blocks and their length, `turns` or as many on end as there are."""
    check_integer("turns", turns, 1)
    check_integer("per_turn", signal.per_turn, _SAMPLES)
    signal.needs(least)
    turns = min(turns, signal.longest)
    return signal.blocks(turns), turns


def _slope(signal: Synchronous, values: np.ndarray) -> np.ndarray:
    """Return the derivatives by the angle turned [m/rad], of their shape, by central differences of
    fourth order; each passage for itself."""
    step = TURN / signal.per_turn
    result = np.empty_like(values)
    for number in np.unique(signal.passage):
        within = signal.passage == number
        path = values[within].ravel()
        slope = np.gradient(path, step, edge_order=2)
        near, far = path[3:-1] - path[1:-3], path[4:] - path[:-4]
        slope[2:-2] = (8 * near - far) / (12 * step)
        result[within] = slope.reshape(-1, signal.per_turn)
    return result


def _over(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    return np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)


@dataclass(frozen=True, repr=False)
class TimeShare(ShortRepr):
    """Share of the time [1] spent in each bin of an angle, shape (speeds, angles), rows of sum 1,
    or 0 where a speed was not passed; edges of the bins: speed and angle [rad/s, rad]."""

    speed: np.ndarray
    angle: np.ndarray
    share: np.ndarray


def time_share(
    t: np.ndarray,
    w: np.ndarray,
    z: np.ndarray,
    *,
    speeds: int = 240,
    angles: int = 120,
    pieces: int = 8,
) -> TimeShare:
    """Return how long z = x + i y pointed in each direction, over the speed w [rad/s].

    The path between two rows is a straight line, each of its `pieces` counting for the time it
    took: a quick passage is a faint trace, not the few points that happened to be recorded. What is
    not finite is left out. Raises `TooFewRows` for less than two rows, `InputError` for what is no
    signal.
    """
    for name, value in (("speeds", speeds), ("angles", angles), ("pieces", pieces)):
        check_integer(name, value, 1)
    t, w, z = finite(t=t, w=w, z=z)
    enough(t, 2)
    weights = np.repeat(np.diff(t) / pieces, pieces)
    share = np.tile((np.arange(pieces) + 0.5) / pieces, len(t) - 1)

    def path(values: np.ndarray) -> np.ndarray:
        before, after = (np.repeat(v, pieces) for v in (values[:-1], values[1:]))
        return before + share * (after - before)

    speed, angle = path(w), np.angle(path(z)) % TURN
    edges = (np.linspace(speed.min(), speed.max(), speeds + 1), np.linspace(0, TURN, angles + 1))
    table, *_ = np.histogram2d(speed, angle, edges, weights=weights)
    total = table.sum(axis=1, keepdims=True)
    return TimeShare(*edges, np.divide(table, total, out=np.zeros_like(table), where=total > 0))
