"""The shaft: its materials and its sections."""

import math
from dataclasses import dataclass, replace

from ..quantities import ANY, NOT_NEGATIVE, QuantityError, between, check_all, quantity

STEEL_POISSON = 0.3
POISSON = between(-0.7, 0.5, is_below=True)  # Hutchinson's coefficient has a pole at -0.79
SHEARS = ("cowper", "hutchinson", "ross-hutchinson", "rigid")
TAPERS = ("exact", "mean", "middle")
_OVERLAP = 1e-6  # of diameters, that is rounding


@dataclass(frozen=True)
class Material:
    """An elastic material: Young's modulus [Pa], density [kg/m3], Poisson's ratio [1].

    Raises `QuantityError` for an impossible value.
    """

    young: float = quantity("Pa", "Young's modulus")
    density: float = quantity("kg/m3", "density")
    poisson: float = quantity("1", "Poisson's ratio", POISSON, STEEL_POISSON)

    def __post_init__(self) -> None:
        check_all("material", self)

    @property
    def shear(self) -> float:
        """The shear modulus [Pa]."""
        return self.young / (2 * (1 + self.poisson))


@dataclass(frozen=True)
class Section:
    """The shaft between two nodes, of circular sections that may taper and be hollow: length, outer
    diameters and bores at its left and right end [m], its material; axial_force: tension [N];
    layers: further sections at the same place, of the same length; shear: the coefficient of the
    shear stiffness, one of `SHEARS`; taper: whether a section that tapers or has layers has its
    `exact` shape functions, or each layer those of a cylinder with the shear ratio of its `mean`
    area and moment or of its `middle`."""

    length: float = quantity("m", "length")
    outer_left: float = quantity("m", "outer diameter at the left end")
    outer_right: float = quantity("m", "outer diameter at the right end")
    material: Material  # type: ignore[misc]  # to mypy, any call stands for a default
    bore_left: float = quantity("m", "bore at the left end", NOT_NEGATIVE, 0.0)
    bore_right: float = quantity("m", "bore at the right end", NOT_NEGATIVE, 0.0)
    axial_force: float = quantity("N", "tension, negative where it is compressed", ANY, 0.0)
    layers: "tuple[Section, ...]" = ()
    shear: str = SHEARS[0]
    taper: str = TAPERS[0]

    @classmethod
    def cylinder(cls, length: float, diameter: float, material: Material) -> "Section":
        """Return a solid cylinder; length, diameter [m]."""
        return cls(length, diameter, diameter, material)

    def check(self, where: str) -> None:
        """Raise `QuantityError` for an impossible value of the section called `where`."""
        check_all(where, self)
        for side in ("left", "right"):
            outer, bore = getattr(self, f"outer_{side}"), getattr(self, f"bore_{side}")
            if bore >= outer:
                raise QuantityError(
                    f"{where}.bore_{side} = {bore:g} m: must be below the outer diameter, "
                    f"{outer:g} m"
                )
            inside = outer
            for i, layer in sorted(enumerate(self.layers, 1), key=lambda each: each[1].bore_left):
                if getattr(layer, f"bore_{side}") < inside * (1 - _OVERLAP):
                    raise QuantityError(
                        f"{where}.layer[{i}].bore_{side} = {getattr(layer, f'bore_{side}'):g} m: "
                        f"must not be below the outer diameter of what lies inside, {inside:g} m"
                    )
                inside = getattr(layer, f"outer_{side}")
        for i, layer in enumerate(self.layers, 1):
            if layer.length != self.length:
                raise QuantityError(
                    f"{where}.layer[{i}].length = {layer.length:g} m: must be the section's, "
                    f"{self.length:g} m"
                )
            layer.check(f"{where}.layer[{i}]")
        for name, allowed in (("shear", SHEARS), ("taper", TAPERS)):
            if getattr(self, name) not in allowed:
                raise QuantityError(
                    f"{where}.{name} = {getattr(self, name)!r}: must be one of {', '.join(allowed)}"
                )

    def with_layers(self, *layers: "Section") -> "Section":
        """Return the section with these further layers."""
        return replace(self, layers=layers)

    def part(self, begin: float, end: float) -> "Section":
        """Return the stretch between two fractions of the length, from 0 to 1."""

        def between(name: str, share: float) -> float:
            left: float = getattr(self, f"{name}_left")
            right: float = getattr(self, f"{name}_right")
            return left + share * (right - left)

        return replace(
            self,
            length=(end - begin) * self.length,
            outer_left=between("outer", begin),
            outer_right=between("outer", end),
            bore_left=between("bore", begin),
            bore_right=between("bore", end),
        )

    @property
    def all_layers(self) -> "tuple[Section, ...]":
        """The section itself and its further layers."""
        return (self, *self.layers)

    @property
    def is_cylinder(self) -> bool:
        """Whether its diameters are constant along it."""
        return self.outer_left == self.outer_right and self.bore_left == self.bore_right

    @property
    def polar_inertia(self) -> float:
        """The moment of inertia about the axis without that of further layers [kg.m2]."""

        def fourth(left: float, right: float) -> float:
            """Return the mean of the fourth power of a diameter that is linear along the
            section."""
            return sum(left ** (4 - k) * right**k for k in range(5)) / 5

        solid = fourth(self.outer_left, self.outer_right)
        hollow = fourth(self.bore_left, self.bore_right)
        return self.material.density * math.pi / 32 * (solid - hollow) * self.length
