"""Rigid cylinders on the shaft: discs, and the coupling at its end."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import ANGLE, NOT_NEGATIVE, QuantityError, quantity
from .base import BodyElement, Element, Part, PortElement, ProbeElement, Shape, UnbalanceElement
from .shaft import Material


@dataclass(frozen=True)
class Disc(Part):
    """A rigid cylinder on the shaft: node (from 1), diameter and width [m]; eccentricity of its
    mass centre e [m] at the angle `phase` [rad] from the shaft's mark; bore [m], 0 where it is
    solid; material: the machine's unless it has one of its own."""

    KIND: ClassVar[str] = "disc"
    TEXT: ClassVar[str] = "a rigid cylinder on the shaft, solid or with a bore"

    node: int
    diameter: float = quantity("m", "diameter")
    width: float = quantity("m", "width along the shaft")
    e: float = quantity(
        "m", "eccentricity of the centre of mass", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    phase: float = quantity("rad", "angle of the eccentricity", ANGLE, 0.0, is_tunable=True)

    bore: float = quantity("m", "diameter of the bore", NOT_NEGATIVE, 0.0)
    material: Material | None = None

    def check(self, where: str) -> None:
        """Raise `QuantityError` for impossible quantities or an impossible disc."""
        super().check(where)
        if self.bore >= self.diameter:
            raise QuantityError(
                f"{where}.bore = {self.bore:g} m: must be below the diameter, {self.diameter:g} m"
            )

    def mass(self, density: float) -> float:
        """Return the mass [kg]; density [kg/m3]."""
        if self.material is not None:
            density = self.material.density
        return density * math.pi / 4 * (self.diameter**2 - self.bore**2) * self.width

    def polar_inertia(self, density: float) -> float:
        """Return the moment of inertia about the shaft [kg.m2]; density [kg/m3]."""
        return self.mass(density) * (self.diameter**2 + self.bore**2) / 8

    def diametral_inertia(self, density: float) -> float:
        """Return the moment of inertia about a diameter [kg.m2]; density [kg/m3]."""
        return self.mass(density) * ((self.diameter**2 + self.bore**2) / 16 + self.width**2 / 12)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield a body with its unbalance, a port and a probe."""
        mass = self.mass(density)
        yield BodyElement(
            self.node, mass, self.diametral_inertia(density), self.polar_inertia(density)
        )
        yield UnbalanceElement(self.node, mass, mass, self.e, self.phase)
        yield PortElement(self.node, where.replace("[", " ").rstrip("]"))
        yield ProbeElement(self.node)

    def outline(self) -> Iterator[Shape]:
        """Yield a block about the shaft."""
        yield Shape(-self.width / 2, self.width, self.bore / 2, self.diameter / 2, "body")


@dataclass(frozen=True)
class Coupling(Disc):
    """A coupling as a rigid solid cylinder: a disc that an external force can load."""

    KIND: ClassVar[str] = "coupling"
    TEXT: ClassVar[str] = "a coupling as a rigid solid cylinder"
    IS_SINGLE: ClassVar[bool] = True

    e: float = quantity("m", "eccentricity of the centre of mass", NOT_NEGATIVE, 0.0)
    phase: float = quantity("rad", "angle of the eccentricity", ANGLE, 0.0)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield the elements of a disc, except for its probes."""
        for element in super().elements(where, density):
            if isinstance(element, PortElement):
                yield PortElement(self.node, "the coupling")
            elif not isinstance(element, ProbeElement):
                yield element
