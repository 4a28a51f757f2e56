"""Conditions on the machine as a whole: a moving foundation, a start out of equilibrium."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..quantities import ANY, Rule, quantity
from .base import BASE, Element, Part, PortElement, ReleaseElement

# sound in steel is no faster, and a shaft whose ends leave each other faster breaks
_VELOCITY = Rule(-5e3, False, "must be from -5000 to 5000", most=5e3)
_RATE = Rule(-1e5, False, "must be from -100000 to 100000", most=1e5)


@dataclass(frozen=True)
class Base(Part):
    """A moving foundation: its acceleration [m/s2] is an input, and all motion is relative to
    it."""

    KIND: ClassVar[str] = "base"
    TEXT: ClassVar[str] = (
        "a foundation that moves with a given acceleration; all displacements are relative to it"
    )
    IS_SINGLE: ClassVar[bool] = True

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield the port of the base."""
        yield PortElement(BASE, "the foundation")


@dataclass(frozen=True, kw_only=True)
class Start(Part):
    """A start out of equilibrium: displacement and velocity of the rotor's centre of mass, and its
    slope dx/dz, dy/dz with its rate. Housings are in equilibrium on their springs."""

    KIND: ClassVar[str] = "start"
    TEXT: ClassVar[str] = (
        "a start of the rotor in the air, as one rigid body, instead of in equilibrium"
    )
    IS_SINGLE: ClassVar[bool] = True

    x: float = quantity("m", "displacement to the right at the start", ANY, 0.0, is_parameter=True)
    y: float = quantity("m", "displacement upwards at the start", ANY, 0.0, is_parameter=True)
    vx: float = quantity(
        "m/s", "velocity to the right at the start", _VELOCITY, 0.0, is_parameter=True
    )
    vy: float = quantity("m/s", "velocity upwards at the start", _VELOCITY, 0.0, is_parameter=True)
    tilt_x: float = quantity("1", "slope dx/dz at the start", ANY, 0.0, is_parameter=True)
    tilt_y: float = quantity("1", "slope dy/dz at the start", ANY, 0.0, is_parameter=True)
    rate_x: float = quantity("rad/s", "rate of tilt_x at the start", _RATE, 0.0, is_parameter=True)
    rate_y: float = quantity("rad/s", "rate of tilt_y at the start", _RATE, 0.0, is_parameter=True)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield the release."""
        yield ReleaseElement(
            self.x, self.y, self.vx, self.vy, self.tilt_x, self.tilt_y, self.rate_x, self.rate_y
        )
