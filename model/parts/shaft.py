"""The shaft: what it is made of, and its sections."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..quantities import NOT_NEGATIVE, QuantityError, check_all, quantity

STEEL_POISSON = 0.3


@dataclass(frozen=True)
class Material:
    """An elastic material: Young's modulus [Pa], density [kg/m3], Poisson's ratio [1].

    Raises `QuantityError` for what no material can be.
    """

    young: float = quantity("Pa", "Young's modulus")
    density: float = quantity("kg/m3", "density")
    poisson: float = quantity("1", "Poisson's ratio", NOT_NEGATIVE, STEEL_POISSON)

    def __post_init__(self) -> None:
        check_all("material", self)
        if self.poisson >= 0.5:
            raise QuantityError(f"material.poisson = {self.poisson:g}: must be below 0.5")

    @property
    def shear(self) -> float:
        """Shear modulus [Pa]."""
        return self.young / (2 * (1 + self.poisson))


@dataclass(frozen=True)
class Section:
    """The shaft between two nodes, of circular sections that may taper and be hollow: length,
    outer diameters and bores at its left and right end [m], and its material."""

    length: float = quantity("m", "length")
    outer_left: float = quantity("m", "outer diameter at the left end")
    outer_right: float = quantity("m", "outer diameter at the right end")
    material: Material
    bore_left: float = quantity("m", "bore at the left end", NOT_NEGATIVE, 0.0)
    bore_right: float = quantity("m", "bore at the right end", NOT_NEGATIVE, 0.0)

    @classmethod
    def cylinder(cls, length: float, diameter: float, material: Material) -> Section:
        """A solid cylinder; length, diameter [m]."""
        return cls(length, diameter, diameter, material)

    @property
    def is_cylinder(self) -> bool:
        """Whether its diameters do not change along it."""
        return self.outer_left == self.outer_right and self.bore_left == self.bore_right

    @property
    def polar_inertia(self) -> float:
        """Moment of inertia about the axis [kg.m2]."""

        def fourth(left: float, right: float) -> float:
            """Mean of the fourth power of a diameter that is linear along the section."""
            return sum(left ** (4 - k) * right**k for k in range(5)) / 5

        solid = fourth(self.outer_left, self.outer_right)
        hollow = fourth(self.bore_left, self.bore_right)
        return self.material.density * math.pi / 32 * (solid - hollow) * self.length
