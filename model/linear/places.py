"""Places on rigid parts of the shaft."""

import math
from typing import NamedTuple

from ..arguments import number, shown_value
from .system_at_speed import LinearError


class Place(NamedTuple):
    """A place on a rigid part of the shaft, `offset` [m] beyond a node (from 1) along the shaft: it
    moves as the node's slope takes it, and a force there has a moment about the node."""

    node: int
    offset: float = 0.0


MOVED = "base"  # where the foundation's acceleration acts, in the place of a force
AnyPlace = int | tuple[int, float]  # a node (from 1), or a place
PlacedAmount = tuple[AnyPlace, float, float]  # an unbalance [kg.m] and its angle [rad]


def as_place(of: AnyPlace) -> Place:
    """Return a node, or a node and an offset, as a place."""
    if not isinstance(of, tuple):
        return Place(of)
    if len(of) != 2:
        raise LinearError(f"{shown_value('place', of)}: must be a node, or a node and an offset")
    place = Place(of[0], number("offset", of[1]))
    if not math.isfinite(place.offset):
        raise LinearError(f"offset = {place.offset}: must be finite")
    return place
