"""A Jacobi master: at each communication point each of two FMUs gets the other's last outputs, then
both step."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import check_positive
from .member import Member

# (output of one FMU, connected input of the other)
Connection = tuple[str, str]
_WHOLE = 1e-6  # of a step, by which a run of whole steps may miss its end


@dataclass(frozen=True)
class Side:
    """One of the two FMUs: its connections to the other, and its further recorded variables."""

    member: Member
    connections: Sequence[Connection]
    recorded: Sequence[str]

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all variables read from it at a communication point."""
        return (*(output for output, _ in self.connections), *self.recorded)


class Point(NamedTuple):
    """A communication point t [s], and the values of both FMUs in the order of `outputs`."""

    t: float
    one: list[float]
    other: list[float]


def points(one: Side, other: Side, stop: float, step: float) -> Iterator[Point]:
    """Yield the communication points of two initialized FMUs to `stop` [s], `step` [s] apart, the
    last after what is left of a step; both leave the initialization mode at the first. Raises
    `RunFailed`, and `InputError` for a stop or step that is not positive and finite."""
    for name, value in (("stop", stop), ("step", step)):
        check_positive(name, value, "s")
    sides = (one, other)
    read = [side.member.references(*side.outputs) for side in sides]
    inputs = [
        receiver.member.references(*(name for _, name in sender.connections))
        for sender, receiver in ((one, other), (other, one))
    ]

    def outputs(t: float) -> Point:
        return Point(t, one.member.get(read[0]), other.member.get(read[1]))

    for side in sides:
        side.member.begin()
    point = outputs(0.0)
    yield point
    steps = math.ceil(stop / step - _WHOLE)
    for n in range(steps):
        other.member.set(inputs[0], point.one[: len(one.connections)])
        one.member.set(inputs[1], point.other[: len(other.connections)])
        end = (n + 1) * step
        is_cut = end > stop + _WHOLE * step
        for side in sides:
            side.member.step(n * step, stop - n * step if is_cut else step)
        point = outputs(stop if is_cut else end)
        yield point


def run_jacobi(
    one: Side, other: Side, stop: float, step: float, progress: Callable[[float], None]
) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Run two initialized FMUs to `stop` [s] with the communication step `step` [s].

    Returns the communication points, shape (n,) [s], and the values read from each by name, shape
    (n,). Both leave the initialization mode. `progress` gets the time at each communication point,
    and ends the run by raising. Errors are those of `points`.
    """
    seen = []
    for point in points(one, other, stop, step):
        seen.append(point)
        progress(point.t)
    recorded = [
        dict(zip(side.outputs, np.array(rows).reshape(len(seen), -1).T, strict=True))
        for side, rows in ((one, [p.one for p in seen]), (other, [p.other for p in seen]))
    ]
    return np.array([point.t for point in seen]), recorded[0], recorded[1]
