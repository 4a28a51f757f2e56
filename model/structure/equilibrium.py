"""Static equilibrium under gravity, the journals resting in their clearances: how a run starts.

Without spin and friction everything lies in the vertical plane, where the journals touch at the
bottom or at the top of their clearances. The potential energy is then convex and piecewise
quadratic, and Newton's method with a line search finds its minimum in a few steps.
"""

from __future__ import annotations

import numpy as np

from ..kernels.band import to_dense
from .assembly import Structure

_ITERATIONS = 100
_SOFTNESS = 1e-9  # of the contact stiffness, on open journals while searching


class EquilibriumError(RuntimeError):
    """No static equilibrium was found."""


def static_equilibrium(structure: Structure) -> np.ndarray:
    """Displacements at rest, complex, shape (n + bearings,) [m], without spin and friction.

    Without gravity the machine rests at zero. Raises `EquilibriumError` if the rotor is not held at
    two nodes at least.
    """
    contacts = structure.contacts
    n, nb = structure.M.shape[0], len(contacts)
    size = n + nb
    if structure.gravity == 0:
        return np.zeros(size, dtype=complex)
    stiffness = np.zeros((size, size))
    stiffness[:n, :n] = to_dense(structure.K)
    stiffness[np.arange(n, size), np.arange(n, size)] = contacts.ky
    weight = np.concatenate([structure.weight.imag, -structure.gravity * contacts.mass])
    pick = np.zeros((nb, size))  # journal less housing
    pick[np.arange(nb), contacts.dof] = 1.0
    pick[np.arange(nb), np.arange(n, size)] = -1.0

    def energy(y: np.ndarray) -> float:
        gap = pick @ y
        delta = np.maximum(np.abs(gap) - contacts.clearance, 0.0)
        soft = _SOFTNESS * contacts.k * gap**2
        return 0.5 * y @ stiffness @ y - weight @ y + 0.5 * (contacts.k * delta**2 + soft).sum()

    y = np.zeros(size)
    side = -np.ones(nb)  # each journal at the bottom: -1, open: 0, at the top: 1
    for _ in range(_ITERATIONS):
        target = _solve(stiffness, weight, pick, contacts, side, _SOFTNESS)
        step = target - y
        share = 1.0
        while share > 1e-6 and energy(y + share * step) > energy(y):
            share /= 2
        y = y + share * step
        gap = pick @ y
        touching = np.where(np.abs(gap) > contacts.clearance, np.sign(gap), 0.0)
        if share == 1.0 and np.array_equal(touching, side):
            _check_held(structure, side)
            return 1j * _solve(stiffness, weight, pick, contacts, side, 0.0)
        side = touching
    raise EquilibriumError("no static equilibrium under gravity was found")


def _solve(
    stiffness: np.ndarray,
    weight: np.ndarray,
    pick: np.ndarray,
    contacts: np.ndarray,
    side: np.ndarray,
    softness: float,
) -> np.ndarray:
    """Rest with the journals held at the given sides as if they were fixed there by springs."""
    held = np.where(side != 0, contacts.k, 0.0) + softness * contacts.k
    matrix = stiffness + pick.T @ (held[:, None] * pick)
    load = weight + pick.T @ (np.where(side != 0, contacts.k, 0.0) * side * contacts.clearance)
    # scaled to a unit diagonal: deflections and slopes of short elements differ by many decades
    scale = 1 / np.sqrt(np.diagonal(matrix))
    return scale * np.linalg.solve(scale[:, None] * matrix * scale, scale * load)


def _check_held(structure: Structure, side: np.ndarray) -> None:
    held = {*structure.support_dof.tolist(), *structure.contacts.dof[side != 0].tolist()}
    if len(held) < 2:
        raise EquilibriumError(
            f"no static equilibrium: the rotor is held at {len(held)} of its nodes and would tilt "
            "under gravity; at least 2 bearings or supports are needed"
        )
