"""Rigid bodies on the shaft, given by their inertia, and point masses."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import ANGLE, ANY, NOT_NEGATIVE, quantity
from . import base as of


@dataclass(frozen=True, kw_only=True)
class Body(of.Part):
    """A rigid body on the shaft at a node (from 1): mass [kg], diametral and polar moment of
    inertia about its centre of mass [kg.m2], which lies `offset` [m] beyond the node along z and
    off the axis by e [m] at the angle `phase` [rad] from the shaft's mark.

    The external force acts there on the axis, and what is observed is the axis there.
    """

    KIND: ClassVar[str] = "body"
    TEXT: ClassVar[str] = "a rigid body on the shaft, given by its mass and moments of inertia"

    node: int
    mass: float = quantity("kg", "mass")
    I_d: float = quantity("kg.m2", "moment of inertia about a diameter", NOT_NEGATIVE)
    I_p: float = quantity("kg.m2", "moment of inertia about the axis", NOT_NEGATIVE)
    offset: float = quantity(
        "m",
        "axial distance of the centre of mass from the node; loads act and x, y are observed there",
        ANY,
        0.0,
    )
    e: float = quantity(
        "m", "eccentricity of the centre of mass", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    phase: float = quantity("rad", "angle of the eccentricity", ANGLE, 0.0, is_tunable=True)

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield a body with its unbalance, a port and a probe."""
        yield of.BodyElement(self.node, self.mass, self.I_d, self.I_p, self.offset)
        yield of.UnbalanceElement(self.node, self.mass, self.mass, self.e, self.phase, self.offset)
        yield of.PortElement(self.node, where.replace("[", " ").rstrip("]"), self.offset)
        yield of.ProbeElement(self.node, self.offset)

    def outline(self) -> Iterator[of.Shape]:
        """Yield the solid cylinder of the same mass and inertia, if there is one."""
        radius = (2 * self.I_p / self.mass) ** 0.5
        width = (max(0.0, 12 * self.I_d / self.mass - 3 * radius**2)) ** 0.5
        yield of.Shape(self.offset - width / 2, width, 0.0, radius, "body")


@dataclass(frozen=True, kw_only=True)
class PointMass(of.Part):
    """A mass [kg] without moments of inertia at a node (from 1)."""

    KIND: ClassVar[str] = "point_mass"
    TEXT: ClassVar[str] = "a mass without moments of inertia at a node"

    node: int
    mass: float = quantity("kg", "mass")

    def elements(self, where: str, density: float) -> Iterator[of.Element]:
        """Yield a body."""
        yield of.BodyElement(self.node, self.mass, 0.0, 0.0)
