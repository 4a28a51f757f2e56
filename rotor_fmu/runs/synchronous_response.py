"""The synchronous (1x) response of each place of a run: its largest, and its resonance."""

import math
from typing import NamedTuple

import numpy as np

from .. import vibration
from ..vibration.orders import BLOCK
from ..vibration.turns import TURN
from .measuring_points import MeasuringPoint, last_of_the_largest
from .peaks import largest_row, start_up
from .recording import Recording

# By how much the angle to the mark may change in a turn. A whirl of another frequency, which the
# few turns of a block do not keep apart from 1x, changes it by more; so does 1x in a block in which
# the speed changes by as large a share.
_KEPT = TURN / 16
_WIDE = 1.3  # ratio of the speeds between which a run may pass a resonance


class SynchronousResponse(NamedTuple):
    """The largest 1x vector of a place after the start-up, of those that keep their angle to the
    mark.

    major: semi-axis of its ellipse, 0-p [m]; speed: at which it is largest [rad/s]; both NaN where
    none keeps its angle, as in a free vibration that hides it; resonance: the highest one of the
    place over the speed, None where the run passes none.
    """

    place: MeasuringPoint
    major: float
    speed: float
    resonance: vibration.Resonance | None


def synchronous_response(run: Recording, place: MeasuringPoint) -> SynchronousResponse:
    """Return the synchronous response of a place; raises `TooFewTurns` as `Recording.resampled`."""
    track = vibration.order_track_of(run.resampled(place), (1.0,))
    major = track.major() * 1e-6  # recorded motions are resampled in um
    keeps = _keeps_its_angle(track)
    if not keeps.any():
        return SynchronousResponse(place, math.nan, math.nan, None)
    at = largest_row(track.t, np.where(keeps, major, np.nan), start_up(run.t, run.w))
    span, found = abs(track.speed), []
    if vibration.goes_one_way(track.speed) and span.max() > _WIDE * span.min():
        found = vibration.resonances(track.speed, major, t=track.t)
        found = [each for each in found if keeps[np.argmin(abs(span - abs(each.speed)))]]
    largest = float(major[at]), float(track.speed[at])
    return SynchronousResponse(place, *largest, next(iter(found), None))


def _keeps_its_angle(track: vibration.OrderTrack) -> np.ndarray:
    """Return where the 1x vector keeps its angle to the mark from turn to turn, shape (m,)."""
    if len(track.t) < 2:
        return np.ones(len(track.t), bool)
    both = np.concatenate([track.forward, track.backward], axis=1)
    turned = both[1:] * both[:-1].conj()
    size = np.sqrt(np.abs(turned))  # by which either half counts
    whole = np.maximum(size.sum(axis=1), np.finfo(float).tiny)
    changes = (size * np.abs(np.angle(turned))).sum(axis=1) / whole
    swept = BLOCK * TURN * abs(np.gradient(track.speed) / track.speed)
    around = np.pad(changes, BLOCK // 2)  # half a block before each and half a block after it
    largest = np.lib.stride_tricks.sliding_window_view(around, BLOCK).max(axis=1)
    return np.asarray(largest <= np.maximum(_KEPT, swept))


def largest_synchronous_response(run: Recording) -> SynchronousResponse | None:
    """Return the largest synchronous response of a run's shaft, of several places that
    move as much as `last_of_the_largest`; None of a run of too few turns, or without a place."""
    try:
        responses = [synchronous_response(run, place) for place in run.shaft_places]
    except vibration.TooFewTurns:
        return None
    responses = [each for each in responses if math.isfinite(each.major)]
    places = [(each.major, each.place.is_bearing) for each in responses]
    return responses[last_of_the_largest(places)] if responses else None
