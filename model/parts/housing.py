"""A bearing housing: a mass on springs and dampers to ground that interfaces push."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

from ..kernels.jit import jit
from ..quantities import NOT_NEGATIVE, QuantityError, quantity
from .base import Element, MountElement, Part


@dataclass(frozen=True, kw_only=True)
class HousingQuantities:
    """The quantities of a housing: mass [kg], in y times mass_ratio [1]; springs [N/m] and dampers
    [N.s/m] to ground in x and y."""

    kx: float = quantity("N/m", "horizontal stiffness of the housing's springs", is_parameter=True)
    ky: float = quantity("N/m", "vertical stiffness of the housing's springs", is_parameter=True)
    cx: float = quantity(
        "N.s/m", "horizontal damping of the housing", NOT_NEGATIVE, is_parameter=True
    )
    cy: float = quantity(
        "N.s/m", "vertical damping of the housing", NOT_NEGATIVE, is_parameter=True
    )
    mass: float = quantity("kg", "mass of the housing", is_parameter=True)
    mass_ratio: float = quantity("1", "mass of the housing in y over that in x", default=1.0)


@jit
def masses(housing):
    """Return the housing mass in x and in y [kg]."""
    return housing.mass, housing.mass * housing.mass_ratio


@dataclass(frozen=True, kw_only=True)
class Housing(HousingQuantities, Part):
    """A housing of its own, to which any number of interfaces may refer by its name.

    Raises `QuantityError` without a name.
    """

    KIND: ClassVar[str] = "housing"
    TEXT: ClassVar[str] = "a mass on springs and dampers to ground, on which bearings may sit"

    name: str = field()  # unlike that of other parts it must be given

    @property
    def label(self) -> str:
        """Empty: bearings refer to the housing by its name; its variables are `housing[1]`."""
        return ""

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name:
            raise QuantityError(f"housing.name = {self.name!r}: must be a word")

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one mount."""
        yield MountElement(self.name, self)
