"""What holds the shaft of a machine: names of its supports, its interfaces."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from ..parts.base import GROUND, InterfaceElement, MountElement, SpringElement
from ..parts.linear_bearing import LINEAR_BEARING


class Supports(NamedTuple):
    """The supports of the shaft, in the order of the parts: names of springs to ground, of
    interfaces; housings' names."""

    springs: tuple[str, ...]
    interfaces: tuple[str, ...]
    housings: tuple[str, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of springs, then of interfaces."""
        return self.springs + self.interfaces


def seat(rotor: Rotor) -> float:
    """Return how far the shaft falls before its bearings hold it [m]."""
    seats = (e.law.seat(e.source) for e in interfaces(rotor) if e.law.seat)
    return max(seats, default=0.0)


def interfaces(rotor: Rotor) -> Iterator[InterfaceElement]:
    """Return the interfaces of all parts, in their order."""
    return (element for _, element in rotor.elements_of_kind(InterfaceElement))


def walls(rotor: Rotor) -> dict[str, InterfaceElement]:
    """Return the interfaces with a wall, whose `length` is its radius, by the parts' names."""
    return {where: e for where, e in rotor.elements_of_kind(InterfaceElement) if e.law.has_wall}


def touching(rotor: Rotor) -> dict[str, InterfaceElement]:
    """Return the interfaces that observe whether they touch, by the parts' names: those with a
    wall, and films, behind which there may be one."""
    elements = rotor.elements_of_kind(InterfaceElement)
    return {
        where: e
        for where, e in elements
        if any(output.name == "contact" for output in e.law.outputs_of(e.source))
    }


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


def rigid_motions(nodes: np.ndarray, size: int) -> np.ndarray:
    """Return the shaft's motions as a rigid body: to the right, upwards, tilted in each of both
    planes; shape (2 size, 4).

    nodes: their positions [m]; size: number of deflections, slopes and housings.
    """
    n = 2 * len(nodes)
    motions = np.zeros((2 * size, 4))
    for plane in range(2):
        motions[plane : 2 * n : 4, plane] = 1.0
        motions[plane : 2 * n : 4, 2 + plane] = nodes - nodes.mean()
        motions[2 + plane : 2 * n : 4, 2 + plane] = 1.0
    return motions


def unsprung(rotor: Rotor) -> list[str]:
    """Return the names of the parts that hold their node at rest by a spring, and have none."""
    return [
        name
        for name, e in rotor.elements_of_kind(InterfaceElement)
        if e.law.stiffness and e.law.stiffness(e.source) == 0.0 and e.ring == GROUND
    ]


def not_held(contacts: str, held: int, gravity: float | None, springless: Sequence[str]) -> str:
    """Return one line about supports that do not hold a machine; contacts: `open` or `pinned`;
    held: how many there are; gravity: where none of it presses the shaft into its bearings
    [m/s2]; springless: of `unsprung`."""
    if held < 2:
        return (
            f"the machine is not held: with its contacts {contacts} it has {held} bearings or "
            "supports, and moves as a rigid body; at least 2 nodes must be held"
        )
    result = (
        f"the machine is not held: where it is at rest, its contacts {contacts}, its {held} "
        "bearings and supports have no stiffness against a motion as a rigid body"
    )
    if gravity is not None:
        why = "gravity is 0" if gravity == 0.0 else "the machine stands upright"
        result += (
            f"; {why}, and in the middle of its clearance a bearing without preload has none: give "
            "the machine gravity or a [[load]] across its shaft, or its bearings preload"
        )
    if springless:
        result += (
            "; without a centring spring a squeeze film holds nothing at rest: give "
            f"{' and '.join(springless)} a stiffness"
        )
    return result
