"""Full spectra and cascades: forward and backward amplitude at each order; and the spectrum of a
signal over time, for shafts that may stand.

The full spectrum of z = x + i y (Southwick, Orbit 14 (1993); Muszynska, Rotordynamics, 2005) has
forward whirl at positive and backward whirl at negative orders; a straight line is equal halves.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..errors import check_integer, check_positive
from ..short_repr import ShortRepr
from .recorded import enough, finite, recorded
from .turns import LEAST_ROWS, TURN, Synchronous, hann, synchronous

MOST_ORDER = 8.0


@dataclass(frozen=True, repr=False)
class FullSpectrum(ShortRepr):
    """Amplitudes over signed orders of a block of turns at one speed [rad/s].

    order: ascending, negative ones whirl backward [1]; amplitude: radius of the circle that each
    draws, 0-p, without the mean position and its steady drift [m]; shape (k,).
    """

    speed: float
    order: np.ndarray
    amplitude: np.ndarray

    @property
    def frequency(self) -> np.ndarray:
        """Whirl frequencies, negative backward [rad/s], shape (k,)."""
        return self.order * abs(self.speed)

    @property
    def resolution(self) -> float:
        """Distance of two lines [orders]."""
        return float(self.order[1] - self.order[0])


@dataclass(frozen=True, repr=False)
class Cascade(ShortRepr):
    """Full spectra through a run (a waterfall).

    first: the first turn of each block, shape (m,); passage: the number of the stretch without a
    rest or a reversal that it lies in, shape (m,); t, speed: of the blocks, shape (m,) [s],
    [rad/s]; order: shape (k,); amplitude: 0-p, shape (m, k) [m].
    """

    first: np.ndarray
    passage: np.ndarray
    t: np.ndarray
    speed: np.ndarray
    order: np.ndarray
    amplitude: np.ndarray

    @property
    def frequency(self) -> np.ndarray:
        """Whirl frequencies, negative backward, shape (m, k) [rad/s]."""
        return np.abs(self.speed)[:, None] * self.order

    @property
    def is_one_way(self) -> bool:
        """Whether the speed only falls or only rises from block to block."""
        ways = np.diff(self.speed)
        return bool(np.all(ways < 0) or np.all(ways > 0))


def full_spectrum(
    t: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    speed: float,
    *,
    turns: int = 16,
    most_order: float = MOST_ORDER,
    per_turn: int | None = None,
) -> FullSpectrum:
    """Return the full spectrum, by Hann's window, of the turns nearest to a speed [rad/s].

    Orders that are multiples of 1 / turns have their full amplitude; one between two lines has up
    to 15 % less. Raises `TooFewTurns`.
    """
    signal = synchronous(t, phi, z, turns=turns, per_turn=per_turn)
    return _full_spectrum(signal, signal.nearest(speed, turns), turns, most_order)


def full_spectrum_of(
    signal: Synchronous, t: float, *, turns: int = 16, most_order: float = MOST_ORDER
) -> FullSpectrum:
    """Return the full spectrum of the turns nearest to a time [s] of a signal that is already
    resampled."""
    return _full_spectrum(signal, signal.nearest_in_time(t, turns), turns, most_order)


def _full_spectrum(signal: Synchronous, turn: int, turns: int, most_order: float) -> FullSpectrum:
    first = np.array([turn])
    order, amplitude = _spectra(signal, first, turns, most_order)
    return FullSpectrum(float(signal.speed_of(first, turns)[0]), order, amplitude[0])


def cascade(
    t: np.ndarray,
    phi: np.ndarray,
    z: np.ndarray,
    *,
    turns: int = 16,
    lines: int = 120,
    most_order: float = MOST_ORDER,
    per_turn: int | None = None,
) -> Cascade:
    """Return the full spectra of up to `lines` blocks of turns, evenly through the turns of a run.

    Raises `TooFewTurns` for less turns than a block.
    """
    signal = synchronous(t, phi, z, turns=turns, per_turn=per_turn)
    return cascade_of(signal, turns=turns, lines=lines, most_order=most_order)


def cascade_of(
    signal: Synchronous, *, turns: int = 16, lines: int = 120, most_order: float = MOST_ORDER
) -> Cascade:
    """Return `cascade` of a signal that is already resampled."""
    signal.needs(turns)
    check_integer("lines", lines, 1)
    first = signal.blocks(turns)
    first = first[np.unique(np.linspace(0, len(first) - 1, lines).round().astype(int))]
    order, amplitude = _spectra(signal, first, turns, most_order)
    middle, speed = signal.middle_of(first, turns), signal.speed_of(first, turns)
    return Cascade(first, signal.passage[first], middle, speed, order, amplitude)


def _spectra(
    signal: Synchronous, first: np.ndarray, turns: int, most_order: float
) -> tuple[np.ndarray, np.ndarray]:
    check_positive("most_order", most_order)
    per_turn = signal.per_turn
    window = hann(turns, per_turn)
    order = np.fft.fftshift(np.fft.fftfreq(turns * per_turn, 1 / per_turn))
    retained = np.abs(order) <= most_order
    amplitude = np.empty((len(first), np.count_nonzero(retained)))
    drift, ramp = signal.drift_of(first, turns), signal.ramp(turns)
    for row, begin in enumerate(first):
        block = signal.values[begin : begin + turns] - drift[row] * ramp
        if signal.sense[begin] < 0:  # seen from behind, forward stays forward
            block = block.conj()
        around = window * (block - (window * block).sum())
        amplitude[row] = np.abs(np.fft.fftshift(np.fft.fft(around.ravel())))[retained]
    # what the rows that were recorded cannot show is not known
    known = signal.rows_of(first, turns)[:, None] / 2
    return order[retained], np.where(np.abs(order[retained]) < known, amplitude, np.nan)


def spectrum(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the frequencies [Hz] and the amplitudes 0-p of a real signal, without its mean, under
    Hann's window: resampled at equal times, the median step apart, its end being the beginning of
    the next period; what is not finite is left out. Raises `TooFewRows` for less than 3 times,
    `InputError` for what is no signal."""
    t, values = finite(t=t, values=values)
    t, row = np.unique(t, return_index=True)  # a row may stand twice
    enough(t, LEAST_ROWS)
    values = values[row]
    count = round(float(t[-1] - t[0]) / float(np.median(np.diff(t))))
    even, step = np.linspace(t[0], t[-1], count, endpoint=False, retstep=True)
    signal, (window,) = np.interp(even, t, values), hann(1, count)
    lines = np.fft.rfft(window * (signal - window @ signal))
    return np.fft.rfftfreq(count, float(step)), 2 * np.abs(lines)


def second_half(t: np.ndarray, phi: np.ndarray, *, turns: int = 1) -> slice:
    """Return the rows of the second half of a run, cut to whole turns where it holds any: orders
    then lie on lines of a spectrum; turns: to a multiple of so many, where it holds these, so that
    orders of a motion that repeats after them do, as halves after 2. Of a run of few rows it is
    more than half, the last three or all. What is not finite counts for none. Raises `TooFewRows`
    for no row, `InputError` for what is no signal."""
    t, phi = recorded(t=t, phi=phi)
    rows = np.flatnonzero(np.isfinite(t) & np.isfinite(phi))
    enough(rows, 1)
    t, phi = t[rows], phi[rows]
    turned = np.abs(phi - phi[-1])
    half = int(np.searchsorted(t, (t[0] + t[-1]) / 2))
    check_integer("turns", turns, 1)
    count = math.floor(turned[half] / TURN)
    whole = TURN * (count - count % turns if count >= turns else count)
    begin = half + int(np.argmax(turned[half:] <= whole)) if whole else half
    return slice(int(rows[max(0, min(begin, len(t) - LEAST_ROWS))]), None)
