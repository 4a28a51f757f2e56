"""`Rotor` -> `Structure`: the band matrices and the local data of bearings, unbalances and loads.

The rotor's equation in complex coordinates q (deflection and slope at each node, x + i y):

    M q'' + (C - i Omega G) q' + (K - i kappa K_s - i/2 Omega' G) q = f(t) + B F

with F the bearings' forces on the journals. The housings are oscillators of their own,
m z'' + c z' + k z = f - F, with different springs and dampers in x and y. -i/2 Omega' G is the
transient stiffness of the gyroscopic terms, without which the energy of a rotor whose speed
changes does not close.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..kernels.band import factorize, to_band
from ..machine.rotor import Rotor
from . import beam

HALF_BANDWIDTH = 3


# One record a bearing: the journal's dof, and the quantities of `rotor.Bearing` by their names.
CONTACT = np.dtype(
    [("dof", "i8")]
    + [
        (name, "f8")
        for name in (
            "journal_radius",
            "clearance",
            "k",
            "c",
            "delta_c",
            "mu",
            "v_s",
            "mass",
            "kx",
            "ky",
            "cx",
            "cy",
        )
    ]
)


class Structure(NamedTuple):
    """A rotor in matrices, all in SI units; n dofs, two a node (deflection, slope).

    M, C, K: mass, damping, stiffness; G: gyroscopic (real, symmetric); K_shaft: the shaft alone;
    each in band storage, shape (n, 4); M_factors: M's, from `band.factorize`.
    eta_v: rotating viscous damping [s] and eta_h: rotating hysteretic coefficient [1], 0 where the
    internal damping does not rotate: kappa = Omega eta_v + sign(Omega) eta_h.
    mass_share: of the deflections' lumped masses in the rotor's, shape (n,) [1]; lowest_omega: of
    the elastic modes, journals pinned [rad/s]; clearance: the smallest, or, without bearings, 1e-4
    of the length [m].
    weight: gravity's force on the rotor, shape (n,) [N, N.m]; gravity [m/s2].
    deflections: dof and node number, from 1, of every deflection, shape (k, 2).
    disc_dof: deflections of the discs; load_dof: of the discs and, last, of the coupling, where
    external forces act.
    unbalance_dof, unbalance: deflections and m e exp(i phase) [kg.m] of the unbalances.
    support_dof: deflections on springs to ground.
    inertia: polar moment of inertia about the axis of rotation [kg.m2].
    bound: displacement that no rotor reaches [m].
    contacts: the bearings, shape (bearings,) of dtype `CONTACT`.
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    G: np.ndarray
    K_shaft: np.ndarray
    M_factors: np.ndarray
    eta_v: float
    eta_h: float
    mass_share: np.ndarray
    lowest_omega: float
    clearance: float
    weight: np.ndarray
    gravity: float
    deflections: np.ndarray
    disc_dof: np.ndarray
    load_dof: np.ndarray
    unbalance_dof: np.ndarray
    unbalance: np.ndarray
    support_dof: np.ndarray
    inertia: float
    bound: float
    contacts: np.ndarray


def assemble(rotor: Rotor) -> Structure:
    """The matrices of a rotor (Nelson 1980; Zorzi and Nelson 1977)."""
    material = rotor.material
    n = 2 * len(rotor.nodes)
    M, G, K_shaft, K_support, C_support = (np.zeros((n, n)) for _ in range(5))
    inertia = 0.0
    for i, diameter in enumerate(rotor.diameters):
        length = rotor.nodes[i + 1] - rotor.nodes[i]
        at = np.ix_(range(2 * i, 2 * i + 4), range(2 * i, 2 * i + 4))
        tilting = beam.rotary_mass(material, length, diameter)
        M[at] += beam.translational_mass(material, length, diameter) + tilting
        G[at] += 2 * tilting
        K_shaft[at] += beam.stiffness(material, length, diameter)
        inertia += material.density * math.pi / 32 * diameter**4 * length
    bodies = list(rotor.discs) + ([rotor.coupling] if rotor.coupling else [])
    for disc in bodies:
        dof = 2 * (disc.node - 1)
        mass = disc.mass(material)
        M[dof, dof] += mass
        M[dof + 1, dof + 1] += disc.diametral_inertia(material)
        G[dof + 1, dof + 1] += disc.polar_inertia(material)
        inertia += disc.polar_inertia(material) + mass * disc.e**2
    for support in rotor.supports:
        dof = 2 * (support.node - 1)
        K_support[dof, dof] += support.stiffness
        C_support[dof, dof] += support.damping
    M_factors = to_band(M, HALF_BANDWIDTH)
    factorize(M_factors)
    hysteresis = math.sqrt(1 + rotor.eta_h**2)
    body_dof = np.array([2 * (d.node - 1) for d in bodies], dtype=np.int64)
    return Structure(
        M=to_band(M, HALF_BANDWIDTH),
        C=to_band(rotor.eta_v * K_shaft + C_support, HALF_BANDWIDTH),
        K=to_band((1 + rotor.eta_h) / hysteresis * K_shaft + K_support, HALF_BANDWIDTH),
        G=to_band(G, HALF_BANDWIDTH),
        K_shaft=to_band(K_shaft, HALF_BANDWIDTH),
        M_factors=M_factors,
        eta_v=rotor.eta_v if rotor.rotating_damping else 0.0,
        eta_h=rotor.eta_h / hysteresis if rotor.rotating_damping else 0.0,
        mass_share=_mass_share(M),
        lowest_omega=_lowest_omega(
            M, K_shaft + K_support, [2 * (b.node - 1) for b in rotor.bearings]
        ),
        clearance=min((b.clearance for b in rotor.bearings), default=1e-4 * rotor.length),
        weight=-1j * rotor.gravity * M[:, ::2].sum(axis=1),
        gravity=rotor.gravity,
        deflections=np.array([(2 * i, i + 1) for i in range(n // 2)], dtype=np.int64),
        disc_dof=body_dof[: len(rotor.discs)].copy(),
        load_dof=body_dof,
        unbalance_dof=body_dof,
        unbalance=np.array(
            [d.mass(material) * d.e * complex(math.cos(d.phase), math.sin(d.phase)) for d in bodies]
        ),
        support_dof=np.array([2 * (s.node - 1) for s in rotor.supports], dtype=np.int64),
        inertia=inertia,
        bound=0.1 * rotor.length,
        contacts=_contacts(rotor),
    )


def _mass_share(M: np.ndarray) -> np.ndarray:
    lumped = np.zeros(len(M))
    lumped[::2] = M[::2, ::2].sum(axis=1)
    return lumped / lumped.sum()


def _lowest_omega(M: np.ndarray, K: np.ndarray, pinned: list[int]) -> float:
    free = np.setdiff1d(np.arange(len(M)), pinned)
    inverse = np.linalg.inv(np.linalg.cholesky(M[np.ix_(free, free)]))
    squares = np.linalg.eigvalsh(inverse @ K[np.ix_(free, free)] @ inverse.T)
    # what is smaller is a motion as a rigid body, and rounding
    return math.sqrt(squares[squares > 1e-13 * squares[-1]][0])


def _contacts(rotor: Rotor) -> np.recarray:
    contacts = np.zeros(len(rotor.bearings), dtype=CONTACT).view(np.recarray)
    for contact, bearing in zip(contacts, rotor.bearings, strict=True):
        contact.dof = 2 * (bearing.node - 1)
        for name in CONTACT.names[1:]:
            contact[name] = getattr(bearing, name)
    return contacts
