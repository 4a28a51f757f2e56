"""The synchronous (1x) response of each place of a run: its largest, and its resonance."""

from typing import NamedTuple

from .. import vibration
from .measuring_points import MeasuringPoint, last_of_the_largest
from .peaks import largest_row, start_up
from .recording import Recording

_WIDE = 1.3  # ratio of the speeds between which a run may pass a resonance


class SynchronousResponse(NamedTuple):
    """The largest 1x vector of a place after the start-up.

    major: semi-axis of its ellipse, 0-p [m]; speed: at which it is largest [rad/s];
    resonance: the highest one of the place over the speed, None where the run passes none.
    """

    place: MeasuringPoint
    major: float
    speed: float
    resonance: vibration.Resonance | None


def synchronous_response(run: Recording, place: MeasuringPoint) -> SynchronousResponse:
    """Return the synchronous response of a place; raises `TooFewTurns` as `Recording.resampled`."""
    track = vibration.order_track_of(run.resampled(place), (1.0,))
    major = track.major() * 1e-6  # recorded motions are resampled in um
    at = largest_row(track.t, major, start_up(run.t, run.w))
    span, found = abs(track.speed), []
    if vibration.goes_one_way(track.speed) and span.max() > _WIDE * span.min():
        found = vibration.resonances(track.speed, major, t=track.t)
    largest = float(major[at]), float(track.speed[at])
    return SynchronousResponse(place, *largest, next(iter(found), None))


def largest_synchronous_response(run: Recording) -> SynchronousResponse | None:
    """Return the largest synchronous response of a run's shaft, the last of several places that
    move as much; None of a run of too few turns, or without a place."""
    try:
        responses = [synchronous_response(run, place) for place in run.shaft_places]
    except vibration.TooFewTurns:
        return None
    majors = [response.major for response in responses]
    return responses[last_of_the_largest(majors)] if responses else None
