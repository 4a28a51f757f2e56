"""What a response has come to, event by event, so that a call that was stopped can be gone on with.

A response asks its journal for the next event before it computes one; what an earlier call wrote
is taken over as it is.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from typing import NamedTuple, TypeVar, cast

import numpy as np

from ..message_templates import Message
from .balance import Orbit
from .branch import Passed


class Start(NamedTuple):
    """A motion from which a branch is followed: harmonics, or 0 and the orbit of one that is
    followed by shooting, the value about which the equations are
    scaled, turns in a period, scale of an unknown frequency [rad/s], length of displacements [m],
    the unknowns, the value of the parameter; the ways to go, each a tangent by the unknowns and by
    the parameter over its scale."""

    H: int
    at: float
    turns: int
    omega: float
    length: float
    x: np.ndarray
    value: float
    ways: list[np.ndarray]
    orbit: Orbit | None = None


class Started(NamedTuple):
    """What was found where a branch was looked for: its start, or None, and what is said of it."""

    start: Start | None
    notes: list[Message]


class Ended(NamedTuple):
    """Why a branch ends."""

    why: str


Event = Started | Passed | Ended
_E = TypeVar("_E", Started, Passed, Ended)


class Journal:
    """Events of an earlier call, which are taken over, then new ones, which go to `write`."""

    def __init__(
        self, events: Iterable[Event] = (), write: Callable[[Event], object] = lambda _: None
    ) -> None:
        self._events, self._write = deque(events), write

    def recall(self, kind: type[_E]) -> _E | None:
        """The next event of an earlier call, if there is one of this kind."""
        if self.holds(kind):
            return cast(_E, self._events.popleft())
        return None

    def holds(self, kind: type[_E]) -> bool:
        """Whether the next event of an earlier call is of this kind."""
        return bool(self._events) and isinstance(self._events[0], kind)

    def add(self, event: _E) -> _E:
        """Write a new event; returns it."""
        self._write(event)
        return event
