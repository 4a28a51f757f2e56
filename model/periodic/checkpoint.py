"""Checkpoint of a response computation: its events in order, from which an interrupted call is
resumed.

A response asks the log for the next event before it computes one; the events of an earlier call are
taken over unchanged.
"""

from collections import deque
from collections.abc import Callable, Generator, Iterable
from typing import NamedTuple, TypeVar, cast

import numpy as np

from ..message_templates import Message
from .balance import Orbit
from .tracer import TracedPoint


class BranchStart(NamedTuple):
    """The start of a branch: number of harmonics (0 for shooting, which also needs the orbit),
    reference value and scales of the equations (frequency [rad/s] if unknown, displacements [m]),
    revolutions in a period, the unknowns, the value of the parameter, and the tangents to follow,
    each with its component in the parameter over its scale last."""

    H: int
    reference: float
    turns: int
    omega_scale: float
    length_scale: float
    x: np.ndarray
    value: float
    directions: list[np.ndarray]
    orbit: Orbit | None = None


Starts = Generator[BranchStart, None, list[Message]]  # notes for the user in the end


class StartEvent(NamedTuple):
    """The result of a search for a branch: its start, or None, and notes for the user."""

    start: BranchStart | None
    notes: list[Message]


class EndEvent(NamedTuple):
    """Why a branch ends."""

    why: str


Event = StartEvent | TracedPoint | EndEvent
_E = TypeVar("_E", StartEvent, TracedPoint, EndEvent)


class EventLog:
    """Events of an earlier call, which are replayed, then new ones, which are passed to `write`."""

    def __init__(
        self, events: Iterable[Event] = (), write: Callable[[Event], object] = lambda _: None
    ) -> None:
        self._events, self._write = deque(events), write

    def replay(self, kind: type[_E]) -> _E | None:
        """Return the next event of an earlier call if it is of this kind, otherwise None."""
        if self.next_is(kind):
            return cast(_E, self._events.popleft())
        return None

    def next_is(self, kind: type[_E]) -> bool:
        """Return whether the next event of an earlier call is of this kind."""
        return bool(self._events) and isinstance(self._events[0], kind)

    def add(self, event: _E) -> _E:
        """Write and return a new event."""
        self._write(event)
        return event
