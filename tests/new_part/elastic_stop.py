"""A part that exists in the tests alone: a stop that the shaft meets when it has crossed a room."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..kernels.functions import modulus
from ..kernels.jit import jit
from ..quantities import Output, quantity
from .base import Element, InterfaceElement, Part
from .law import Law


@dataclass(frozen=True, kw_only=True)
class StopQuantities:
    """Room [m] and stiffness [N/m]."""

    room: float = quantity("m", "radial distance at which the stop begins", is_parameter=True)
    stiffness: float = quantity("N/m", "stiffness of the stop", is_parameter=True)


@jit
def _gap(part, d):
    return part.room - modulus(d)


@jit
def _length(part):
    return part.room


@jit
def _tangent(part, tables, kinematics, weights, free, internal_state):
    d, gap = kinematics.displacement, _gap(part, kinematics.displacement)
    if gap >= 0.0:
        return 0.0j, 0.0j, 0.0j
    e, share = d / modulus(d), part.room / modulus(d)
    p = -part.stiffness * (1.0 - 0.5 * share) * weights.displacement
    q = -part.stiffness * 0.5 * share * weights.displacement
    return part.stiffness * gap * e, complex(p, 0.0), q * e * e


@jit
def _force(part, tables, kinematics, internal_state):
    d, gap = kinematics.displacement, _gap(part, kinematics.displacement)
    return part.stiffness * gap / modulus(d) * d if gap < 0.0 else 0.0j


@jit
def _energy(part, tables, displacement, internal_state):
    return (0.5 * part.stiffness * min(0.0, _gap(part, displacement)) ** 2,)


@jit
def _dissipate(part, tables, kinematics, internal_state, out):
    return 0.0


@jit
def _observe(part, tables, kinematics, internal_state, out):
    out[0] = modulus(_force(part, tables, kinematics, internal_state))


STOP = Law(
    name="elastic_stop",
    kind=StopQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    outputs=(Output("fn", "N", "normal force", True, 10.0),),
    stores=(Output("stops", "J", "elastic energy of the stops", nominal=1e-3),),
    losses=(),
    gap=_gap,
    length=_length,
    has_wall=True,
)


@dataclass(frozen=True, kw_only=True)
class ElasticStop(StopQuantities, Part):
    """A stop around a node (from 1), fixed to ground."""

    KIND: ClassVar[str] = "elastic_stop"
    TEXT: ClassVar[str] = "an elastic stop around a node"
    LAWS: ClassVar[tuple[Law, ...]] = (STOP,)

    node: int

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface."""
        yield InterfaceElement(self.node, STOP, self)
