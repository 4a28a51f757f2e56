"""Static equilibrium under gravity, the journals resting in their clearances: how a run starts."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from .assembly import Structure, dense_matrices
from .contact import contact_force, contact_tangent

_ITERATIONS = 200
_SINK = 1e-6  # first guess of the penetration [m]


class EquilibriumError(RuntimeError):
    """No static equilibrium was found."""


def static_equilibrium(structure: Structure) -> np.ndarray:
    """Displacements at rest, complex, shape (n + bearings,) [m], without spin and friction.

    Newton's method on the whole machine, from a rotor that touches all its bearings at the bottom.
    Without gravity the machine rests at zero. Raises `EquilibriumError` if it finds no rest.
    """
    contacts = structure.contacts
    n, nb = structure.M.shape[1], len(contacts)
    size = n + nb
    if structure.gravity == 0:
        return np.zeros(size, dtype=complex)
    frictionless = contacts.copy()
    frictionless.mu = 0.0
    weight = np.concatenate([structure.weight, -1j * structure.gravity * contacts.mass])
    stiffness = dense_matrices(structure)[2]
    q = np.zeros(size, dtype=complex)
    if nb:
        q[:n:2] = -1j * (contacts.clearance.max() + _SINK)
    for _ in range(_ITERATIONS):
        packed = np.concatenate([q.real, q.imag])
        out_of_balance = stiffness @ packed - np.concatenate([weight.real, weight.imag])
        tangent = stiffness.copy()
        for j, bearing in enumerate(frictionless):
            at = bearing.dof
            relative = q[at] - q[n + j]
            force = contact_force(bearing, relative, 0j, 0.0)[0]
            p, c = contact_tangent(bearing, relative, 0j, 0.0, 1.0, 0.0)
            images = np.array([p + c, 1j * (p - c)])  # of a unit in x and in y
            block = np.array([images.real, images.imag])
            for dof, sign in ((at, 1), (n + j, -1)):
                rows = [dof, dof + size]
                out_of_balance[rows] -= sign * np.array([force.real, force.imag])
                for other, side in ((at, 1), (n + j, -1)):
                    tangent[np.ix_(rows, [other, other + size])] -= sign * side * block
        correction = scipy.linalg.lstsq(tangent, -out_of_balance)[0]
        step = correction[:size] + 1j * correction[size:]
        # A journal must not be thrown through its housing by the first, far too soft tangents.
        largest = np.abs(step[:n:2]).max()
        if nb and largest > contacts.clearance.min():
            step *= contacts.clearance.min() / largest
        q += step
        if np.abs(step).max() < 1e-15:
            return q
    raise EquilibriumError(
        "no static equilibrium under gravity: does every part of the rotor rest in a bearing?"
    )
