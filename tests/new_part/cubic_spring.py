"""A part that exists in the tests alone: a cubic spring to ground with a viscous damper."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..kernels.jit import jit
from ..quantities import NOT_NEGATIVE, Output, places, quantity
from .base import Element, InterfaceElement, Part
from .law import Law


@dataclass(frozen=True)
class CubicQuantities:
    """Cubic stiffness [N/m3] and damping [N.s/m]."""

    cubic: float = quantity("N/m3", "cubic stiffness", is_parameter=True)
    drag: float = quantity("N.s/m", "damping", NOT_NEGATIVE, 0.0, is_parameter=True)


OUTPUTS = (Output("pull", "N", "size of the spring's and damper's force", True, 1.0),)
LOSSES = (Output("cubic", "J", "dissipated by the cubic springs' dampers", nominal=1e-3),)
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)


@jit
def _force(part, tables, kinematics, internal_state):
    d = kinematics.displacement
    return -part.cubic * abs(d) ** 2 * d - part.drag * kinematics.velocity


@jit
def _tangent(part, tables, kinematics, weights, free, internal_state):
    d = kinematics.displacement
    p = -2.0 * part.cubic * abs(d) ** 2 * weights.displacement - part.drag * weights.velocity
    q = -part.cubic * d * d * weights.displacement
    return _force(part, tables, kinematics, internal_state), complex(p, 0.0), q


@jit
def _energy(part, tables, displacement, internal_state):
    return (0.25 * part.cubic * abs(displacement) ** 4,)


@jit
def _dissipate(part, tables, kinematics, internal_state, out):
    out[_LOSS.cubic] = part.drag * abs(kinematics.velocity) ** 2
    return 0.0


@jit
def _observe(part, tables, kinematics, internal_state, out):
    out[_OUT.pull] = abs(_force(part, tables, kinematics, internal_state))


CUBIC = Law(
    name="cubic_spring",
    kind=CubicQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    outputs=OUTPUTS,
    stores=(Output("cubic", "J", "elastic energy of the cubic springs", nominal=1e-3),),
    losses=LOSSES,
)


@dataclass(frozen=True)
class _OnNode:
    node: int


@dataclass(frozen=True)
class CubicSpring(CubicQuantities, _OnNode, Part):
    """A cubic spring from a node to ground."""

    KIND: ClassVar[str] = "cubic_spring"
    TEXT: ClassVar[str] = "a cubic spring from a node to ground"
    LAWS: ClassVar[tuple[Law, ...]] = (CUBIC,)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """One interface."""
        yield InterfaceElement(self.node, CUBIC, self)
