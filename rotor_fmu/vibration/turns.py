"""Revolution-synchronous resampling: a signal over time becomes a signal over the shaft's angle.

Computed order tracking (Fyfe and Munck, Mechanical Systems and Signal Processing 11 (1997) 187):
a signal is interpolated by a cubic spline over the angle and read at equal angles, so that an order
is a line of the spectrum whatever the speed does.

A shaft may turn either way, stand, and turn back. Whole turns are those between two keyphasor marks
within one passage, a stretch in which it neither stands nor turns back; a block of turns on end
lies within one passage too.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError, check_integer, number
from ..short_repr import ShortRepr
from .recorded import TooFewRows, TooFewTurns, finite, recorded

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

_LEAST, _MOST = 64, 1024  # samples a turn
_SHORT = 0.1  # share of the steps that may be shorter than those that decide how fine to resample
_ROUNDING = 1e-9  # of a turn, that may be missing at a mark
_CONSTANT = 1e-6  # of a speed, by which a constant one differs from turn to turn as it is recorded
TURN = 2 * math.pi
_BACK = TURN / _LEAST  # by which the angle must go back for the shaft to turn back
# Rows recorded in a cycle below which the spline through them is another motion: an order takes so
# many, a path so many a turn.
LEAST_ROWS = 3


@dataclass(frozen=True, repr=False)
class Turns(ShortRepr):
    """Whole turns of a shaft in the order in which they were made, all of shape (turns,).

    passage: the number of the stretch without a rest or a reversal that each lies in; sense: 1, or
    -1 where the angle falls; mark: turns that the angle counts where each begins; begin, end: times
    of its two marks [s]; row, rows: the first recorded row in it, and how many there are.
    """

    passage: np.ndarray
    sense: np.ndarray
    mark: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    row: np.ndarray
    rows: np.ndarray

    @property
    def middle(self) -> np.ndarray:
        """Middles of the turns [s]."""
        return (self.begin + self.end) / 2

    @property
    def speed(self) -> np.ndarray:
        """Mean speed of each turn, negative where the angle falls [rad/s]."""
        return self.sense * TURN / (self.end - self.begin)

    @property
    def longest(self) -> int:
        """The most turns in one passage."""
        return int(np.unique(self.passage, return_counts=True)[1].max(initial=0))

    def needs(self, turns: int) -> None:
        """Raise `TooFewTurns` where no passage holds so many turns, and `InputError` for a number
        of turns that is not whole and above 0."""
        check_integer("turns", turns, 1)
        if self.longest < turns:
            on_end = " on end" if len(self.passage) > self.longest else ""
            raise TooFewTurns(
                f"the signal holds {self.longest} whole turns of the shaft{on_end}; needed: {turns}"
            )

    def blocks(self, turns: int) -> np.ndarray:
        """Return the first turns of all blocks of `turns` turns within a passage."""
        last = len(self.passage) - turns + 1
        return np.flatnonzero(self.passage[: max(last, 0)] == self.passage[turns - 1 :])

    def middle_of(self, first: np.ndarray, turns: int) -> np.ndarray:
        """Return the middles of blocks that begin with the turns `first` [s]."""
        return (self.begin[first] + self.end[first + turns - 1]) / 2

    def speed_of(self, first: np.ndarray, turns: int) -> np.ndarray:
        """Return the mean speeds of blocks that begin with the turns `first` [rad/s]."""
        took = self.end[first + turns - 1] - self.begin[first]
        return self.sense[first] * turns * TURN / took

    def rows_of(self, first: np.ndarray, turns: int) -> np.ndarray:
        """Return the recorded rows a turn in blocks that begin with the turns `first` [1]."""
        counted = np.concatenate([[0], np.cumsum(self.rows)])
        return (counted[first + turns] - counted[first]) / turns

    def enough_rows(self, first: np.ndarray, turns: int, order: float = 1.0) -> np.ndarray:
        """Return whether blocks that begin with the turns `first` have rows enough for an order;
        raises `TooFewRows` where none has."""
        rows, least = self.rows_of(first, turns), LEAST_ROWS * order
        if rows.max() < least:
            raise TooFewRows(
                f"the signal has {rows.max():.3g} recorded rows a turn; order {order:g} needs at "
                f"least {least:g}"
            )
        return rows >= least

    def nearest(self, speed: float, turns: int) -> int:
        """Return the first turn of the block whose mean speed is nearest to `speed` [rad/s], the
        last of those that are equally near: at constant speed the motion has settled there."""
        self.needs(turns)
        if not math.isfinite(number("speed", speed)):
            raise InputError(f"speed = {speed} rad/s: must be finite")
        first = self.blocks(turns)
        away = np.abs(self.speed_of(first, turns) - speed)
        return int(first[away <= away.min() + _CONSTANT * abs(speed)][-1])

    def nearest_in_time(self, t: float, turns: int) -> int:
        """Return the first turn of the block whose middle is nearest to a time [s]."""
        self.needs(turns)
        first = self.blocks(turns)
        return int(first[np.argmin(np.abs(self.middle_of(first, turns) - t))])


@dataclass(frozen=True, repr=False)
class Synchronous(Turns):
    """A signal at equal angles in whole turns; t, values: shape (turns, per_turn), each turn from
    its mark on in the sense in which the shaft turns."""

    t: np.ndarray
    values: np.ndarray

    @property
    def per_turn(self) -> int:
        """Samples a turn."""
        return self.values.shape[1]

    @property
    def angle(self) -> np.ndarray:
        """The angle turned since the mark, shape (per_turn,) [rad]."""
        return np.arange(self.per_turn) * (TURN / self.per_turn)

    def drift_of(self, first: np.ndarray, turns: int) -> np.ndarray:
        """Return by how much the mean position moves a turn in blocks that begin with the turns
        `first`, from the blocks before each to those behind it, since within one a slow whirl is no
        other; 0 in a passage without so many."""
        blocks = self.blocks(turns)
        mean = summed(self.values, hann(turns, self.per_turn), blocks)
        apart = np.arange(-turns, turns + 1)
        weights = np.sin(np.pi * apart / (turns + 1))
        weights /= weights @ apart
        result = np.zeros_like(mean)
        for passage in np.unique(self.passage[blocks]):
            rows = np.flatnonzero(self.passage[blocks] == passage)
            last = len(rows) - len(apart)
            if last >= 0:
                slope = np.convolve(mean[rows], weights[::-1], "valid")
                result[rows] = slope[np.clip(np.arange(len(rows)) - turns, 0, last)]
        return result[np.searchsorted(blocks, first)]

    def ramp(self, turns: int) -> np.ndarray:
        """Return the turns made since the middle of a block, shape (turns, per_turn)."""
        return np.arange(turns)[:, None] + self.angle / TURN - turns / 2


def turns_of(t: np.ndarray, phi: np.ndarray) -> Turns:
    """Return the whole turns of a shaft whose angle is phi [rad], recorded at t [s], both finite
    and of shape (n,); none is fine. Raises `InputError` for others, and for times that fall."""
    t, phi = recorded(t=t, phi=phi)
    for name, values in (("t", t), ("phi", phi)):
        for row in np.flatnonzero(~np.isfinite(values)).tolist():
            raise InputError(f"{name}[{row}] = {values[row]:g}: must be finite")
    return _joined([passage.turns for passage in _passages(t, phi)])


def rows_per_turn(phi: np.ndarray) -> float:
    """Return the median number of rows in a turn of a shaft whose angle is phi [rad]; infinite
    where it does not turn."""
    (phi,) = finite(phi=phi)
    steps = np.abs(np.diff(phi))
    angle = float(np.median(steps)) if len(steps) else 0.0
    return TURN / angle if angle else math.inf


def synchronous(
    t: np.ndarray, phi: np.ndarray, z: np.ndarray, *, turns: int = 1, per_turn: int | None = None
) -> Synchronous:
    """Resample a real or complex signal, shape (n,), at equal angles.

    per_turn: samples a turn; what the signal holds above order per_turn / 2 folds back. None: a
    power of two fine enough for nine tenths of the steps, at least 64, so that nothing folds. What
    is not finite, and what was recorded within a turn that the shaft did not finish, is left out.
    Raises `TooFewTurns` for a signal without `turns` whole turns on end, `InputError` for what is
    no signal.
    """
    t, phi, z = finite(t=t, phi=phi, z=z)
    passages = list(_passages(t, phi))
    from scipy.interpolate import CubicSpline

    result = _joined([passage.turns for passage in passages])
    result.needs(turns)
    if per_turn is not None:
        check_integer("per_turn", per_turn, 1)
    else:
        steps = np.concatenate([np.diff(passage.reached) for passage in passages])
        fine = 2 ** math.ceil(math.log2(TURN / float(np.quantile(steps, _SHORT))))
        per_turn = int(min(max(fine, _LEAST), _MOST))
    instants, resampled = [], []
    for passage in passages:
        count = len(passage.turns.mark) * per_turn
        angle = passage.first + TURN * np.arange(count) / per_turn
        # a rounding past the ends would extrapolate
        angle = np.clip(angle, passage.reached[0], passage.reached[-1])
        instants.append(passage.time(angle))
        resampled.append(CubicSpline(passage.reached, z[passage.rows])(angle))
    shape = len(result.mark), per_turn
    return Synchronous(
        **vars(result),
        t=np.concatenate(instants).reshape(shape),
        values=np.concatenate(resampled).reshape(shape),
    )


@dataclass(frozen=True, repr=False)
class _Passage(ShortRepr):
    """A passage that holds whole turns: rows in which a new angle was reached, the angle turned
    there, in the sense of the passage [rad], its time [s], the first mark [rad], the turns."""

    rows: np.ndarray
    reached: np.ndarray
    time: "PchipInterpolator"
    first: float
    turns: Turns


def _passages(t: np.ndarray, phi: np.ndarray) -> Iterator[_Passage]:
    from scipy.interpolate import PchipInterpolator

    for passage, (begin, end, sense) in enumerate(_one_way(t, phi)):
        turned = np.maximum.accumulate(sense * phi[begin : end + 1])
        grows = np.concatenate([[True], np.diff(turned) > 0])
        rows, reached = begin + np.flatnonzero(grows), turned[grows]
        first = math.ceil(reached[0] / TURN - _ROUNDING)
        count = math.floor(reached[-1] / TURN + _ROUNDING) - first
        if count < 1 or len(rows) < 4:
            continue
        time = PchipInterpolator(reached, t[rows])
        angles = TURN * (first + np.arange(count + 1))
        marks = time(np.clip(angles, reached[0], reached[-1]))
        if (still := np.flatnonzero(np.diff(marks) <= 0)).size:
            at = float(marks[still[0]])
            raise InputError(f"t = {at:g} s: a whole turn takes no time; times must rise")
        edges = begin + np.searchsorted(turned, angles)
        turns = Turns(
            passage=np.full(count, passage),
            sense=np.full(count, sense),
            mark=sense * (first + np.arange(count)),
            begin=marks[:-1],
            end=marks[1:],
            row=edges[:-1],
            rows=np.diff(edges),
        )
        yield _Passage(rows, reached, time, TURN * first, turns)


def _one_way(t: np.ndarray, phi: np.ndarray) -> Iterator[tuple[int, int, int]]:
    """First and last rows between which the shaft turns one way, and which: 1, or -1 where the
    angle falls. Steps back that are small together are no reversal."""
    changed = np.sign(np.diff(phi)).astype(int)
    # a row that stands twice in a recording is no rest
    known = np.flatnonzero((changed != 0) | (np.diff(t) > 0))
    if not len(known):
        return
    steps = changed[known]
    edges = np.flatnonzero(np.diff(steps)) + 1
    starts = known[np.concatenate([[0], edges])].tolist()
    ends = (known[np.concatenate([edges - 1, [len(known) - 1]])] + 1).tolist()
    senses = steps[np.concatenate([[0], edges])].tolist()
    begin, farthest, sense = starts[0], starts[0], 0
    for start, end, way in zip(starts, ends, senses, strict=True):
        if way == sense:
            if sense * (phi[end] - phi[farthest]) > 0:
                farthest = end
        elif way == 0 or sense == 0 or sense * (phi[farthest] - phi[end]) >= _BACK:
            if sense:
                yield begin, farthest, sense
            begin, farthest, sense = (farthest if way and sense else start), end, way
    if sense:
        yield begin, farthest, sense


def _joined(parts: list[Turns]) -> Turns:
    if not parts:
        none, whole = np.zeros(0), np.zeros(0, int)
        return Turns(whole, whole, whole, none, none, whole, whole)
    names = vars(parts[0])
    return Turns(**{name: np.concatenate([vars(p)[name] for p in parts]) for name in names})


def hann(turns: int, per_turn: int) -> np.ndarray:
    """Return Hann's window over a block of whole turns, of sum 1, shape (turns, per_turn).

    Its spectrum is zero at every multiple of 1 / turns orders but the first, so that of a block of
    n turns all orders that are multiples of 2 / n are told apart without leakage. Of an order d
    lines (of 1 / n) away from such a one sin(pi d) / (pi d (1 - d^2)) of its amplitude leaks in.
    """
    window = 1 - np.cos(TURN * np.arange(turns * per_turn) / (turns * per_turn))
    return (window / window.sum()).reshape(turns, per_turn)


def summed(values: np.ndarray, weights: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Return the weighted sums over blocks of turns that begin with the turns `first`.

    values: shape (turns, per_turn); weights: shape (turns of a block, per_turn); result: as first.
    """
    products = values @ weights.T
    return np.sum([products[first + k, k] for k in range(len(weights))], axis=0)
