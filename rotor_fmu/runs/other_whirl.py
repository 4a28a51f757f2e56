"""The whirl of a place that is not synchronous, such as oil whip, if it is part of the motion."""

import math
from typing import NamedTuple

import numpy as np

from ..vibration import TooFewRows, TooFewTurns, full_spectrum_of
from .measuring_points import MeasuringPoint
from .recording import Recording

# Turns of a spectrum, the distance from 1x and from rest [orders] at which its largest line is that
# of another motion than one by unbalance or a drift, and the share of the motion that it then has.
_TURNS, _AWAY, _MOVES = 64, 3.0 / 64.0, 0.2


class OtherWhirl(NamedTuple):
    """The largest whirl of a full spectrum: its order, negative backward [1], its frequency, of the
    same sign [rad/s], and the major semi-axis of its ellipse [m]."""

    order: float
    frequency: float
    major: float


def other_whirl(run: Recording, place: MeasuringPoint, t: float, size: float) -> OtherWhirl | None:
    """Return the largest whirl of a place about a time [s]; None if it is synchronous, or a small
    part of the motion, or the run has too few turns or rows; size: of the motion [m]."""
    try:
        seen = full_spectrum_of(run.resampled(place), t, turns=_TURNS)
    except (TooFewRows, TooFewTurns):
        return None
    lines = np.where(np.abs(seen.order) >= _AWAY, np.nan_to_num(seen.amplitude), 0.0)
    majors = lines + np.interp(-seen.order, seen.order, lines)
    top = int(np.argmax(majors + lines * 1e-6))  # of two alike the one in whose sense it whirls
    order, major = float(seen.order[top]), 1e-6 * float(majors[top])  # resampled in um
    below, there, above = np.pad(lines, 1)[top : top + 3]
    if there > 0.0:  # between lines, by those of Hann's window
        ratio = min(max(below, above) / there, 1.0)
        between = math.copysign(max(2.0 * ratio - 1.0, 0.0) / (ratio + 1.0), above - below)
        order += between * seen.resolution
    if abs(abs(order) - 1.0) < _AWAY or major <= _MOVES * size:
        return None
    return OtherWhirl(order, order * abs(seen.speed), major)
