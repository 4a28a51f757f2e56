"""A part that exists in the tests alone: a cubic spring to ground with a viscous damper."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..kernels.compiled import compiled
from ..protocol.law import Law
from ..protocol.part import Element, Interface, Part
from ..quantities import NOT_NEGATIVE, Output, quantity


@dataclass(frozen=True)
class CubicQuantities:
    """Cubic stiffness [N/m3] and damping [N.s/m]."""

    cubic: float = quantity("N/m3", "cubic stiffness", is_parameter=True)
    drag: float = quantity("N.s/m", "damping", NOT_NEGATIVE, 0.0, is_parameter=True)


@compiled
def _force(part, tables, d, d_dot, speed, spin, own):
    return -part.cubic * abs(d) ** 2 * d - part.drag * d_dot


@compiled
def _tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own):
    force = -part.cubic * abs(d) ** 2 * d - part.drag * d_dot
    p = -2.0 * part.cubic * abs(d) ** 2 * by_d - part.drag * by_v
    return force, complex(p, 0.0), -part.cubic * d * d * by_d


@compiled
def _energy(part, tables, d, own):
    return (0.25 * part.cubic * abs(d) ** 4,)


@compiled
def _dissipate(part, tables, d, d_dot, speed, spin, own, out):
    out[0] = part.drag * abs(d_dot) ** 2
    return 0.0


@compiled
def _observe(part, tables, d, d_dot, speed, spin, own, out):
    out[0] = abs(part.cubic * abs(d) ** 2 * d + part.drag * d_dot)


CUBIC = Law(
    name="cubic_spring",
    kind=CubicQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    outputs=(Output("pull", "N", "size of the spring's and damper's force", True, 1.0),),
    stores=(Output("cubic", "J", "elastic energy of the cubic springs", nominal=1e-3),),
    losses=(Output("cubic", "J", "dissipated by the cubic springs' dampers", nominal=1e-3),),
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
        yield Interface(self.node, CUBIC, self)
