"""What holds the shaft of a machine: names of its supports, its interfaces."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from ..parts.base import InterfaceElement, MountElement, SpringElement
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


def interfaces(rotor: Rotor) -> Iterator[InterfaceElement]:
    """Return the interfaces of all parts, in their order."""
    return (element for _, element in rotor.elements_of_kind(InterfaceElement))


def walls(rotor: Rotor) -> dict[str, InterfaceElement]:
    """Return the interfaces with a wall, whose sources have a `clearance`, by the parts' names."""
    return {where: e for where, e in rotor.elements_of_kind(InterfaceElement) if e.law.has_wall}


def are_linear(rotor: Rotor) -> np.ndarray:
    """Return which interfaces have a force that is linear in displacement and velocity."""
    return np.array([e.law is LINEAR_BEARING for e in interfaces(rotor)], bool)


def supports(rotor: Rotor) -> Supports:
    """Return the `Supports` of a machine."""
    springs, interfaces = (
        tuple(where for where, _ in rotor.elements_of_kind(kind))
        for kind in (SpringElement, InterfaceElement)
    )
    housings = tuple(mount.name for _, mount in rotor.elements_of_kind(MountElement))
    return Supports(springs, interfaces, housings)
