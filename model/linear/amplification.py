"""Amplification factors of critical speeds and their separation margins, by API 617 and 684.

A critical speed is a peak of the response; with the speeds N1 below and N2 above it at which the
response has fallen to 0.707 of the peak, the amplification factor is

    AF = Nc / (N2 - N1)                                      (API 684, 2nd edition, chapter 2)

which tends to 1 / (2 zeta) as the damping ratio zeta of the mode becomes small. The separation that
is required, a share of the minimum operating speed for a critical speed below it, of the maximum
continuous speed for one above it (API 617, 7th edition, part 1, 2.6.2), is none for AF < 2.5 and

    below:  min(0.16, 0.17 (1 - 1 / (AF - 1.5)))
    above:  min(0.26, 0.10 + 0.17 (1 - 1 / (AF - 1.5)))
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from ..prominent_peaks import prominent_peaks

HALF_POWER = math.sqrt(0.5)
DAMPED = 2.5  # amplification factor below which a peak is critically damped
# The logarithmic decrement at an amplification factor 1 / (2 zeta) of that, above which API 684
# calls a mode critically damped. Larger ones, which have no limit, say nothing more.
CRITICALLY_DAMPED = 2 * math.pi / math.sqrt((2 * DAMPED) ** 2 - 1)
_PRECISE = 1e-10  # of a speed
_UNDAMPED = 1e-8  # of a speed: a peak that is not as wide has no damping but rounding
_FALLEN = 0.5  # of a peak: so far away on both sides one that is not as wide is lower
_UNBOUNDED = complex(math.inf, math.nan)  # the answer at a resonance without damping
_CLEAR = 1e-3  # of a resonance without damping: nearer to it a curve shows nothing but its pole
# About a mode's frequency, in its half-widths. Not there itself: an undamped mode that nothing
# drives has a peak of rounding there.
_ABOVE = np.array([0.1, 0.3, 0.6, 1, 1.5, 2, 3, 4, 6])
_AROUND = np.concatenate([-_ABOVE[::-1], _ABOVE])
_ROUNDING = 1e-10  # of the largest answer: what is smaller has no peaks
_FLAT = 1e-4  # of a peak: what rises less is rounding beside an undamped mode that nothing drives
# Of a speed: so near a peak, though far from how exactly it is found, the response is the same on
# both sides, in what it falls by; less than that, of the peak, is rounding. At the nearer distance
# a step shows though it is small; at the other one though its edge is not sharp: whether a pad
# bears there depends, within rounding, on the way of Newton's method to its equilibrium.
_BESIDE, _FALLS = (1e-6, 1e-5), 1e-8
# Damping ratio: a sharper peak is not looked at more closely. Ten times as close, the rounding of
# some machines rises by 1e-5.
_SHARPEST = 1e-5 / (2 * math.pi)


@dataclass(frozen=True)
class Peak:
    """A peak of a response over the speed: the critical speed [rad/s], the amplitude there,
    infinite without damping, and the speeds below and above at which it has fallen to 0.707 of that
    [rad/s]; NaN where it does not fall so far before the speeds end or another peak follows."""

    speed: float
    amplitude: float
    below: float
    above: float

    @property
    def amplification(self) -> float:
        """AF = Nc / (N2 - N1); where one of them is missing the other one's distance counts twice;
        NaN where both are; infinite without damping [1]."""
        width = self.above - self.below
        if math.isnan(self.below):
            width = 2 * (self.above - self.speed)
        elif math.isnan(self.above):
            width = 2 * (self.speed - self.below)
        return math.inf if math.isinf(self.amplitude) else abs(self.speed) / width

    @property
    def between(self) -> tuple[float, float]:
        """The speeds between which it has half its power [rad/s]: a missing one as far away as the
        other, NaN where both are."""
        half = abs(self.speed) / self.amplification / 2
        low = self.speed - half if math.isnan(self.below) else self.below
        return low, self.speed + half if math.isnan(self.above) else self.above

    @property
    def is_one_sided(self) -> bool:
        """Whether the response falls to 0.707 of the peak on one side only."""
        return math.isnan(self.below) != math.isnan(self.above)


@dataclass(frozen=True)
class Margin:
    """The separation of a peak from the operating range: required and actual, shares of the nearer
    end of the range [1]; the actual one is 0 within the range."""

    required: float
    actual: float

    @property
    def is_met(self) -> bool:
        """Whether the peak lies far enough from the range, or needs no distance."""
        return self.actual >= self.required


def required_margin(amplification: float, is_above: bool) -> float:
    """Return the separation that a critical speed needs from the operating range [1].

    amplification: AF [1]; is_above: whether it lies above the range.
    """
    if not amplification >= DAMPED:
        return 0.0
    share = 0.17 * (1 - 1 / (amplification - 1.5))
    return min(0.26, 0.10 + share) if is_above else min(0.16, share)


def margin(peak: Peak, low: float, high: float) -> Margin:
    """Return the separation of a peak from the operating range, from the minimum to the maximum
    continuous speed [rad/s]."""
    needed = required_margin(peak.amplification, is_above=peak.speed >= low)
    if peak.speed > high:
        return Margin(needed, (peak.speed - high) / high)
    if peak.speed < low:
        return Margin(needed, (low - peak.speed) / low)
    return Margin(needed, 0.0)  # no distance is enough, unless the peak is critically damped


def about(frequency: float, damping_ratio: float) -> np.ndarray:
    """Return frequencies about that of a mode [rad/s], in which its peak has one that is higher
    than its neighbours."""
    return frequency * (1 + max(abs(damping_ratio), _SHARPEST) * _AROUND)


def peaks(response: Callable[[float], float], speeds: Sequence[float] | np.ndarray) -> list[Peak]:
    """Return the peaks of a response over ascending speeds [rad/s], each exact to rounding.

    response: of a speed; speeds: so close together that each peak has one of them higher than its
    neighbours. A step of the response is none.
    """
    at = np.asarray(speeds, dtype=float)
    values = np.array([response(speed) for speed in at])
    found = tops(response, at, values)
    ends = [-1, *(i for i, _, _ in found), len(at)]
    beside = zip(ends, ends[2:], strict=False)
    return [
        _peak(response, at, values, *each, *others)
        for each, others in zip(found, beside, strict=True)
    ]


def tops(
    response: Callable[[float], float], at: np.ndarray, values: np.ndarray
) -> list[tuple[int, float, float]]:
    """Return the place, speed [rad/s] and value of the peaks of a response with values at ascending
    speeds; see `peaks`."""
    found = ((i, *top(response, at, i)) for i in inner_peaks(values))
    return [each for each in found if not _is_step(response, *each[1:])]


def _is_step(response: Callable[[float], float], speed: float, largest: float) -> bool:
    """Return whether a response does not fall alike on both sides of what was found as its top: it
    has a step there, as where a pad that tilts begins to bear. No mode is near then, and a factor
    of amplification means nothing."""
    for apart in _BESIDE:
        less, more = sorted(1.0 - response(speed * (1.0 + by)) / largest for by in (-apart, apart))
        if max(-less, more) > _FALLS and less < 0.5 * more:
            return True
    return False


def inner_peaks(values: np.ndarray) -> list[int]:
    """Return the places of values that are higher than their neighbours, and rise by more than
    rounding above the lowest on either side."""
    at, heights = prominent_peaks(values)
    return at[heights > _FLAT * values[at]].tolist()


def top(response: Callable[[float], float], at: np.ndarray, i: int) -> tuple[float, float]:
    """Return speed [rad/s] and response of a peak between the neighbours of the i-th of speeds; an
    infinite response where nothing damps it."""
    # the distance from there, since the search is only exact to 1e-8 of what it varies
    found = minimize_scalar(
        lambda apart: -response(at[i] + apart),
        bounds=(at[i - 1] - at[i], at[i + 1] - at[i]),
        method="bounded",
        options={"xatol": _PRECISE * abs(at[i])},
    )
    speed, highest = float(at[i] + found.x), -float(found.fun)
    beside = max(response(speed * (1.0 + by)) for by in (-_UNDAMPED, _UNDAMPED))
    return speed, math.inf if beside < _FALLEN * highest else highest


def largest(
    response: Callable[[float], float], speeds: Sequence[float] | np.ndarray
) -> tuple[float, float]:
    """Return the speed of the largest response over ascending speeds [rad/s], peaks between them
    included, and the response there."""
    at = np.asarray(speeds, dtype=float)
    values = np.array([response(speed) for speed in at])
    first = int(np.argmax(values))
    found = [(float(at[first]), float(values[first]))]
    found += [top(response, at, i) for i in inner_peaks(values)]
    return max(found, key=lambda of: of[1])


def _peak(
    response: Callable[[float], float],
    at: np.ndarray,
    values: np.ndarray,
    i: int,
    speed: float,
    largest: float,
    before: int,
    after: int,
) -> Peak:
    """Return the peak with its top between the neighbours of the i-th of speeds; before, after:
    places of the peaks beside it, or just outside of the speeds."""
    if math.isinf(largest):
        return Peak(speed, largest, speed, speed)

    def excess(s: float) -> float:
        return response(s) - HALF_POWER * largest

    def fallen(side: range) -> float:
        """Return the half-power speed on a side of the peak, NaN where there is none."""
        inside = speed
        for k in side:
            if values[k] <= HALF_POWER * largest:
                return float(brentq(excess, inside, at[k], xtol=_PRECISE * abs(speed)))
            inside = at[k]
        return math.nan

    return Peak(speed, largest, fallen(range(i - 1, before, -1)), fallen(range(i + 1, after)))


def with_modes(at: np.ndarray, modes: Iterable[tuple[float, float]]) -> np.ndarray:
    """Return ascending frequencies with those `about` modes, given by frequency [rad/s] and damping
    ratio, that lie between the first and the last."""
    result = np.unique(np.concatenate([at, *(about(*mode) for mode in modes)]))
    return result[(result >= at.min()) & (result <= at.max())]


def with_tops(sizes: Iterable[Callable[[float], float]], at: np.ndarray) -> np.ndarray:
    """Return ascending frequencies [rad/s] with those of the peaks of sizes between them."""
    return np.unique(np.append(at, [frequency for frequency, _ in _tops_of(sizes, at)]))


def _tops_of(
    sizes: Iterable[Callable[[float], float]], at: np.ndarray
) -> list[tuple[float, float]]:
    return [
        top(size, at, i)
        for size in sizes
        for i in inner_peaks(np.array([size(frequency) for frequency in at]))
    ]


def with_poles(
    at: Iterable[float], asked: Sequence[float] | np.ndarray, poles: Sequence[float]
) -> np.ndarray:
    """Return ascending frequencies [rad/s] with those of resonances without damping, and within
    `_CLEAR` of these only its ends and what was asked for."""
    each, of_poles = np.asarray(list(at)), np.asarray(poles)
    beside = np.concatenate([(1 - _CLEAR) * of_poles, (1 + _CLEAR) * of_poles])
    beside = beside[(beside >= each.min()) & (beside <= each.max())]
    apart = np.abs(each[:, None] - of_poles) > _CLEAR * np.abs(of_poles)
    kept = each[apart.all(axis=1) | np.isin(each, asked)]
    return np.unique(np.concatenate([kept, beside, of_poles]))


def at_pole(answer: Callable[[float], np.ndarray], pole: float) -> np.ndarray:
    """Return a complex answer at a resonance without damping [rad/s], infinite in what resonates
    and not what comes out by rounding."""
    here, *beside = (answer(pole * (1.0 + by)) for by in (0.0, -_UNDAMPED, _UNDAMPED))
    resonates = np.abs(beside).max(axis=0) < _FALLEN * np.abs(here)
    return np.where(resonates, _UNBOUNDED, here)


def with_peaks(
    answer: Callable[[float], np.ndarray], frequencies: np.ndarray, poles: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the frequencies that were asked for [rad/s], ascending, with those of all peaks
    between them, and the answers at these, infinite where nothing damps a peak.

    answer: complex array of a frequency; poles: of the answer [1/s].
    """

    @cache
    def answered(w: float) -> np.ndarray:
        return np.asarray(answer(float(w)))

    low, high = frequencies.min(), frequencies.max()
    inside = (pole for pole in poles if low < pole.imag < high)
    at = with_modes(frequencies, ((pole.imag, pole.real / pole.imag) for pole in inside))
    size = np.abs([answered(w).ravel() for w in at])
    seen = size.max(axis=0) > _ROUNDING * size.max()

    def size_of(column: int, w: float) -> float:
        return float(abs(answered(w).ravel()[column]))

    found = _tops_of((partial(size_of, column) for column in np.flatnonzero(seen).tolist()), at)
    infinite = {w for w, highest in found if math.isinf(highest)}
    at = with_poles([*at, *(w for w, _ in found)], frequencies, sorted(infinite))
    return at, np.array([at_pole(answered, w) if w in infinite else answered(w) for w in at])
