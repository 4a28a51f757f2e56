"""A shaft under its weight on two pins, by statics and Mohr's integral: no stiffness matrix."""

import itertools
import math

import numpy as np
from rotor_fmu.model.parts.disc import Coupling
from rotor_fmu.model.structure.beam import shear_coefficient


def pieces(rotor):
    """Diameter, beginning and end [m] and weight per length [N/m] of the shaft's elements."""
    for section, (a, b) in zip(rotor.sections, itertools.pairwise(rotor.nodes), strict=True):
        d = section.outer_left
        yield d, a, b, rotor.material.density * math.pi / 4 * d**2 * rotor.gravity


def point_loads(rotor):
    """Positions [m] and weights [N] of the discs and the coupling."""
    bodies = (*rotor.discs, *rotor.of_kind(Coupling))
    return [
        (rotor.nodes[b.node - 1], b.mass(rotor.material.density) * rotor.gravity) for b in bodies
    ]


def total_weight(rotor):
    """Weight of shaft, discs and coupling [N]."""
    shaft = sum(load * (b - a) for _, a, b, load in pieces(rotor))
    return shaft + sum(weight for _, weight in point_loads(rotor))


def reactions_of_two_pins(rotor, left, right):
    """Upward forces [N] of pins at the positions left and right [m]."""
    loads = point_loads(rotor)
    loads += [((a + b) / 2, load * (b - a)) for _, a, b, load in pieces(rotor)]
    at_right = sum(weight * (z - left) for z, weight in loads) / (right - left)
    return total_weight(rotor) - at_right, at_right


def _moment_and_shear(z, forces):
    """Of upward point forces (position, force) to the left of the sections z."""
    arm = z[:, None] - np.array([at for at, _ in forces])
    up = np.array([force for _, force in forces]) * (arm > 0)
    return (up * arm).sum(axis=1), up.sum(axis=1)


def _own_weight(rotor, z):
    """Moment and shear of the shaft's weight to the left of the sections z."""
    moment, shear = np.zeros_like(z), np.zeros_like(z)
    for _, a, b, load in pieces(rotor):
        covered = np.clip(z - a, 0, b - a)
        shear -= load * covered
        moment -= load * covered * (z - a - covered / 2)
    return moment, shear


def sag_of_discs(rotor, left, right):
    """Downward deflection [m] of the discs below the line of two pins: the work of the real
    moments and shears along those of a unit load at the disc."""
    reactions = reactions_of_two_pins(rotor, left, right)
    real = list(zip((left, right), reactions, strict=True))
    real += [(at, -weight) for at, weight in point_loads(rotor)]
    kappa = shear_coefficient(rotor.material.poisson)
    points, weights = np.polynomial.legendre.leggauss(6)  # exact: polynomials of degree 3
    sags = []
    for disc in rotor.discs:
        at = rotor.nodes[disc.node - 1]
        share = (at - left) / (right - left)
        virtual = [(left, 1 - share), (right, share), (at, -1.0)]
        sag = 0.0
        for d, a, b, _ in pieces(rotor):
            z, dz = (a + b) / 2 + (b - a) / 2 * points, (b - a) / 2 * weights
            bending = rotor.material.young * math.pi / 64 * d**4
            sliding = kappa * rotor.material.shear * math.pi / 4 * d**2
            moment, shear = np.add(_moment_and_shear(z, real), _own_weight(rotor, z))
            unit_moment, unit_shear = _moment_and_shear(z, virtual)
            sag += dz @ (moment * unit_moment / bending + shear * unit_shear / sliding)
        sags.append(sag)
    return np.array(sags)
