"""A Jacobi master in its plainest form: at each communication point either of two FMUs gets the
other's last outputs, then both step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .member import Member

# (output of the one FMU, input of the other that gets its value)
Connection = tuple[str, str]


@dataclass(frozen=True)
class Side:
    """One of the two FMUs: what it tells the other, and what is recorded of it besides."""

    member: Member
    tells: Sequence[Connection]
    recorded: Sequence[str]

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all that is read of it at a communication point."""
        return (*(output for output, _ in self.tells), *self.recorded)


def march(
    one: Side, other: Side, stop: float, step: float, progress: Callable[[float], None]
) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Take two initialized FMUs to `stop` [s] with the communication step `step` [s].

    Returns the communication points, shape (n,) [s], and what was read of either, by name, shape
    (n,). Both leave the initialization mode here. `progress` gets the time at each communication
    point; what it raises ends the run. Raises `RunFailed`.
    """
    sides = (one, other)
    read = [side.member.references(*side.outputs) for side in sides]
    inputs = [
        hearer.member.references(*(name for _, name in teller.tells))
        for teller, hearer in ((one, other), (other, one))
    ]

    def look() -> list[list[float]]:
        return [side.member.get(references) for side, references in zip(sides, read, strict=True)]

    for side in sides:
        side.member.begin()
    rows = [look()]
    count = round(stop / step)
    for n in range(count):
        of_one, of_other = rows[-1]
        other.member.set(inputs[0], of_one[: len(one.tells)])
        one.member.set(inputs[1], of_other[: len(other.tells)])
        for side in sides:
            side.member.step(n * step, step)
        rows.append(look())
        progress((n + 1) * step)
    columns = [np.array(values).T for values in zip(*rows, strict=True)]
    told = [
        dict(zip(side.outputs, values, strict=True))
        for side, values in zip(sides, columns, strict=True)
    ]
    return np.arange(count + 1) * step, told[0], told[1]
