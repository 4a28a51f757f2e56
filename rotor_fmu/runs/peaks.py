"""Whether a run has one speed, and where an amplitude over its speed has a peak."""

import math
from typing import NamedTuple

import numpy as np

from ..run_status import has_failed
from ..vibration.turns import TURN


class StartUp(NamedTuple):
    """When the transient of the start is over: after so many turns at a run's highest speed, or
    after a share of a shorter run [1]. So a slow machine has as many turns to settle as a fast
    one, and a run-up does not wait until it has turned as often from rest."""

    turns: float
    share: float


START_UP = StartUp(125.0, 0.2)
# Relative to the highest speed, how far a constant one may vary: less than the half-power width of
# any resonance whose amplification factor is below 100, so that no peak lies within.
_CONSTANT = 0.01
_ROUNDING = 1e-6  # of a speed: by which a constant one varies as it is recorded
_STILL = 1e-12  # [m] a hundredth of an atom's size: what moves less is rounding
_EDGE = 0.01  # of a run's length at its ends, where an amplitude may still be growing


def is_constant(w: np.ndarray, share: float = _CONSTANT) -> bool:
    """Return whether a speed is constant but for a share of it: nothing is drawn against it."""
    return len(w) == 0 or float(np.ptp(w)) <= share * float(np.abs(w).max())


def start_up(t: np.ndarray, w: np.ndarray) -> float:
    """Return the time [s] until which a run at speeds w [rad/s] is in its start-up."""
    if not len(t):
        return 0.0
    highest = float(np.abs(w).max())
    settled = START_UP.turns * TURN / highest if highest > 0 else math.inf
    return float(t[0]) + min(settled, START_UP.share * float(t[-1] - t[0]))


def largest_row(t: np.ndarray, amplitude: np.ndarray, begin: float) -> int:
    """Return the row of the largest amplitude after a time [s], the end of the start-up, or of all
    where none is known later; t, amplitude: shape (n,), NaN where it is not known."""
    is_known = np.isfinite(amplitude)
    is_late = is_known & (t > begin)
    among = is_late if is_late.any() else is_known
    return int(np.argmax(np.where(among, amplitude, -math.inf)))


def peak_index(t: np.ndarray, w: np.ndarray, amplitude: np.ndarray) -> int | None:
    """Return the row at which an amplitude over the last turn, shape (n,), has a peak after
    the start-up; None where it is largest at an edge of the run or of its speeds: that is no
    peak."""
    late = np.flatnonzero(t > start_up(t, w))
    if not len(late) or is_constant(w) or amplitude[late].max() < _STILL:
        return None
    at = int(late[np.argmax(amplitude[late])])
    turn = TURN / max(abs(float(w[at])), 1e-9)
    margin = max(_EDGE * float(t[-1] - t[late[0]]), min(turn, 0.1 * float(t[-1] - t[0])))
    is_inside = t[late[0]] + margin < t[at] < t[-1] - margin
    passed = w[late]
    of_speeds = _EDGE * float(np.ptp(passed))
    is_passed = passed.min() + of_speeds < w[at] < passed.max() - of_speeds
    return at if is_inside and is_passed else None


def why_no_peak(t: np.ndarray, w: np.ndarray, status: str, largest: float = math.inf) -> str:
    """Return why a run of this status, in which `peak_index` finds none, has no peak; largest: its
    amplitude [m]."""
    if not len(t) or not t[-1] > t[0]:
        return "the run stopped in its first communication step"
    if is_constant(w, _ROUNDING):
        return "the speed is constant"
    if has_failed(status):
        return f"the run stopped at {t[-1]:.4g} s, before its end"
    if largest < _STILL:
        return "nothing moves"
    if is_constant(w):
        return f"the speed changes by at most {100 * _CONSTANT:g} %"
    return "the largest displacement is at an edge of the run"
