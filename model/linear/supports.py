"""What holds the shaft of a machine: names of its supports, its interfaces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from ..parts.base import Interface, Mount, Spring
from ..parts.linear_bearing import LINEAR_BEARING


class Supports(NamedTuple):
    """The supports of the shaft, in the order of the parts: names of springs to ground, of
    interfaces; housings' names."""

    springs: tuple[str, ...]
    interfaces: tuple[str, ...]
    housings: tuple[str, ...]


def seat(rotor: Rotor) -> float:
    """Return how far the shaft falls before its bearings hold it [m]."""
    seats = (e.law.seat(e.source) for e in interfaces(rotor) if e.law.seat)
    return max(seats, default=0.0)


def interfaces(rotor: Rotor) -> Iterator[Interface]:
    """Yield the interfaces of all parts, in their order."""
    for where, part in rotor.named_parts():
        yield from (e for e in part.elements(where, 1.0) if isinstance(e, Interface))


def are_linear(rotor: Rotor) -> np.ndarray:
    """Return which interfaces have a force that is linear in displacement and velocity."""
    return np.array([e.law is LINEAR_BEARING for e in interfaces(rotor)], bool)


def supports(rotor: Rotor) -> Supports:
    """Return the `Supports` of a machine."""
    names: dict[type, list[str]] = {Spring: [], Interface: [], Mount: []}
    for where, part in rotor.named_parts():
        for element in part.elements(where, rotor.material.density):
            if type(element) in names:
                names[type(element)].append(element.name if type(element) is Mount else where)
    return Supports(*(tuple(names[kind]) for kind in (Spring, Interface, Mount)))
