"""What unbalance is left in a rotor, against the balance quality grades of ISO 21940-11.

The unbalances U of a rigid rotor at z are those of two planes, here of its outermost bearings A and
B, between which its mass is divided by the same levers, as its weight is between two bearings:

    U_A = sum U (z_B - z) / (z_B - z_A),    U_B = sum U (z - z_A) / (z_B - z_A)

A residual bow b(z), from the line through the bearings, moves the masses off it and tilts them: it
is an unbalance M b, less what the gyroscopic moments of the tilt take of it.

A grade G is the largest eccentricity e = U / m times the service speed in mm/s, so that G 2.5 at
3000 rev/min permits 7.96 um. Each plane is permitted its share of that by the same levers; where
the centre of mass lies near a bearing or beyond both, the standard keeps the shares within limits.
"""

import math
from typing import NamedTuple

import numpy as np

from ..kernels.band import product
from ..machine.rotor import Rotor
from ..parts.base import BowElement
from ..structure.assembly import assemble
from ..structure.bow import bow_shape
from ..structure.structure import total_mass
from .linear_machine import shared_machine
from .undamped import bearings_of, without_seals

# Of what the whole rotor is permitted, the least and the most that a plane is: of a rotor with its
# centre of mass between its bearings, and of one beyond them (ISO 21940-11, clause 7)
_INBOARD, _OUTBOARD = (0.3, 0.7), (0.3, 1.3)
_ROUNDING = 1e-12  # of an unbalance that is all that a grade permits
GRADES = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)  # [mm/s]


class TolerancePlane(NamedTuple):
    """The plane of a bearing: its node (from 1), the mass that it bears [kg], that by which a grade
    permits unbalance there [kg], and the unbalance of the rotor there, complex [kg.m]."""

    node: int
    mass: float
    graded_mass: float
    unbalance: complex


def balance_quality_grade(unbalance: float, mass: float, speed: float) -> float:
    """Return the finest grade G [mm/s] that an unbalance [kg.m] of a mass [kg] meets at a service
    speed [rad/s], infinite where it meets none."""
    size = (1.0 - _ROUNDING) * abs(unbalance) * speed
    return next((grade for grade in GRADES if size <= 1e-3 * grade * mass), math.inf)


def tolerance_planes(rotor: Rotor) -> tuple[TolerancePlane, ...]:
    """Return the planes of the two outermost bearings, with what a rotor, taken as rigid, has of
    mass and unbalance there; none where its bearings stand at fewer nodes."""
    bearings = bearings_of(without_seals(rotor), shared_machine(rotor).contacts)
    nodes = sorted({part.node for part in bearings.values()})  # type: ignore[attr-defined]
    if len(nodes) < 2:
        return ()
    structure, z = assemble(rotor), np.asarray(rotor.nodes)
    whole = float(total_mass(structure))
    at = z[structure.unbalances.dof // 2] + structure.unbalances.offset
    ends = (nodes[0], nodes[-1]), (nodes[-1], nodes[0])
    levers = [_lever(z, z[node - 1], z[other - 1]) for node, other in ends]
    bow = np.zeros(2 * len(z), complex)  # from the line through the bearings, about which it turns
    for _, of in rotor.elements_of_kind(BowElement):
        bow += of.amplitude * np.exp(1j * of.phase) * bow_shape(z, of.node)
    bow -= bow[[2 * node - 2 for node, _ in ends]] @ levers
    of_bow = product(structure.M, bow) - product(structure.G, bow)
    result = []
    for (node, other), lever in zip(ends, levers, strict=True):
        end, span = z[other - 1], z[other - 1] - z[node - 1]
        mass = float(structure.mass_sum @ lever)
        unbalance = structure.unbalance @ (end - at) / span + of_bow @ lever
        limits = _INBOARD if 0.0 <= mass <= whole else _OUTBOARD
        graded = whole * float(np.clip(abs(mass) / whole, *limits))
        result.append(TolerancePlane(node, abs(mass), graded, complex(unbalance)))
    return tuple(result)


def _lever(z: np.ndarray, of: float, other: float) -> np.ndarray:
    """Return the share of a bearing at `of` in a force at each of z, and in a moment there."""
    span = other - of
    return np.column_stack([(other - z) / span, np.full(len(z), -1.0 / span)]).ravel()
