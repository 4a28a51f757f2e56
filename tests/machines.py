"""Rotors and plain dense forms of their equations, shared by the physics tests."""

import itertools
import math
from dataclasses import replace

import numpy as np
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.shaft import Material, Section
from rotor_fmu.model.parts.support import Support

STEEL = Material(young=2.1e11, density=7800.0)

# Every integrator that a user can choose, with the settings that name it.
METHODS = {
    "newmark": {"method": "newmark"},
    "hht": {"method": "hht", "alpha_f": 0.2},
    "wbz": {"method": "wbz", "alpha_m": -0.2},
    "generalized-alpha": {"method": "generalized-alpha", "alpha_f": 0.1, "alpha_m": 0.08},
    "chung-hulbert": {"method": "chung-hulbert", "rho": 0.2},
}


def cylinders(nodes, diameters):
    """Solid sections of steel between nodes [m], of these diameters [m]."""
    lengths = [b - a for a, b in itertools.pairwise(nodes)]
    return tuple(
        Section.cylinder(length, d, STEEL) for length, d in zip(lengths, diameters, strict=True)
    )


DISCS = (Disc(2, 0.2, 0.03, e=1e-4, phase=0.3), Disc(3, 0.1, 0.02))
SUPPORTS = (Support(1, 2e5, 40.0), Support(3, 3e5, 60.0))


def overhung(discs=DISCS, supports=SUPPORTS, others=(), **changes):
    """A linear rotor on two springs whose six modes, 22 to 950 Hz, an ordinary step resolves;
    others: further parts."""
    shaft = cylinders((0.0, 0.4, 0.7), (0.02, 0.02))
    return Rotor(STEEL, shaft, (*others, *discs, *supports), **({"eta_v": 2e-5} | changes))


def balanced(rotor):
    """The rotor, its discs without eccentricity."""
    return rotor.with_parts(Disc, *(replace(disc, e=0.0) for disc in rotor.discs))


SPAN, THICKNESS = 0.4, 0.02  # of the Jeffcott rotor's shaft [m]


def jeffcott(e=0.0, damping=0.0, **changes):
    """Jeffcott's rotor: a heavy disc amid a light shaft on all but rigid supports, with an external
    damper [N.s/m] at the disc."""
    shaft = cylinders((0.0, SPAN / 2, SPAN), (THICKNESS, THICKNESS))
    supports = (Support(1, 1e11), Support(2, 0.0, damping), Support(3, 1e11))
    parts = (Disc(2, 0.3, 0.05, e=e), *supports)
    return Rotor(STEEL, shaft, parts, **({"gravity": 0.0} | changes))


def jeffcott_stiffness():
    """Stiffness of the Jeffcott rotor's shaft at the disc [N/m], shear neglected."""
    return 48 * STEEL.young * math.pi / 64 * THICKNESS**4 / SPAN**3


def jeffcott_shaft_mass():
    """Mass of the Jeffcott rotor's shaft [kg]."""
    return STEEL.density * math.pi / 4 * THICKNESS**2 * SPAN


def first_order(structure, omega):
    """A of x' = A x, x = (q, q'), complex, of a rotor without bearings at constant speed."""
    M, C, K, G, K_shaft = (
        to_dense(band)
        for band in (structure.M, structure.C, structure.K, structure.G, structure.K_shaft)
    )
    numbers = structure.numbers[0]
    kappa = numbers.kappa_v * omega + numbers.kappa_h * np.sign(omega)
    n = len(M)
    return np.block(
        [
            [np.zeros((n, n)), np.eye(n)],
            [
                -np.linalg.solve(M, K - 1j * kappa * K_shaft),
                -np.linalg.solve(M, C - 1j * omega * G),
            ],
        ]
    )


def unbalance_vector(structure):
    """m e exp(i phase) at its degrees of freedom, shape (n,) [kg.m]."""
    vector = np.zeros(structure.M.shape[0], dtype=complex)
    np.add.at(vector, structure.unbalances.dof, structure.unbalance)
    return vector


def disc_dofs(rotor):
    """Degrees of freedom of the discs' deflections."""
    return np.array([2 * (disc.node - 1) for disc in rotor.discs])


def losses(sim):
    """All that a simulation has dissipated [J]."""
    return sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
