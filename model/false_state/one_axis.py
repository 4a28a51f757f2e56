"""One direction of a journal's motion in its clearance: the machine along it, linear but the walls.

The scheme's step along such an axis: as the answer to a force z^n, and as matrices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..kernels.band import to_dense
from ..schemes.family import Scheme
from ..structure.assembly import Structure
from ..structure.equilibrium import static_equilibrium

X, Y = 0, 1
_SOFTNESS = 1e-13  # of the stiffness's diagonal, that a free rotor has a static shape


@dataclass(frozen=True)
class Axis:
    """One direction of bouncing: the machine along it as one journal sees it, without spin.

    M, C, K: shape (n + bearings,) squared, the other journals held as they rest; at, wall: indices
    of journal and housing; clearance [m], k [N/m], c [N.s/m]: of the contact; rest: of the journal
    relative to its housing [m]; along, across: static load on the journal in the direction of
    bouncing and at right angles to it [N].
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    at: int
    wall: int
    clearance: float
    k: float
    c: float
    rest: float
    along: float
    across: float

    @cached_property
    def pick(self) -> np.ndarray:
        """b, shape (n + bearings,): journal less housing."""
        b = np.zeros(len(self.M))
        b[self.at], b[self.wall] = 1.0, -1.0
        return b

    @cached_property
    def static(self) -> tuple[np.ndarray, float]:
        """Static shape for a journal that is 1 m off its rest, shape (n + bearings,) [1], and the
        stiffness K_s [N/m]."""
        shape = _solve(self.K + _SOFTNESS * np.diag(np.diagonal(self.K)), self.pick)
        compliance = self.pick @ shape
        return shape / compliance, 1.0 / compliance


def axis_of(structure: Structure, bearing: int, direction: int) -> Axis:
    """The machine along x (`X`) or y (`Y`) as the journal of `bearing`, from 0, sees it.

    The other journals rest: held by the contact's stiffness in y, by their weight over their
    clearance in x. Raises `EquilibriumError`.
    """
    contacts = structure.contacts
    n, nb = structure.M.shape[0], len(contacts)
    M, C, K = (np.zeros((n + nb, n + nb)) for _ in range(3))
    for whole, band in ((M, structure.M), (C, structure.C), (K, structure.K)):
        whole[:n, :n] = to_dense(band)
    q = static_equilibrium(structure)
    rest = (q[contacts.dof] - q[n:]).imag
    weights = contacts.k * np.maximum(np.abs(rest) - contacts.clearance, 0.0)
    for j, contact in enumerate(contacts):
        wall = n + j
        M[wall, wall] = contact.mass
        C[wall, wall] = (contact.cx, contact.cy)[direction]
        K[wall, wall] = (contact.kx, contact.ky)[direction]
        if j != bearing:
            held = weights[j] / contact.clearance if direction == X else contact.k
            pair = np.ix_((contact.dof, wall), (contact.dof, wall))
            K[pair] += held * np.array([[1.0, -1.0], [-1.0, 1.0]])
    own = contacts[bearing]
    load = math.copysign(weights[bearing], rest[bearing])
    rest_along, along, across = (0.0, 0.0, load) if direction == X else (rest[bearing], load, 0.0)
    return Axis(
        M, C, K, own.dof, n + bearing, own.clearance, own.k, own.c, rest_along, along, across
    )


def unbalance_loads(structure: Structure, omega: float) -> np.ndarray:
    """Amplitudes of the loads that the unbalance puts on the bearings at a steady speed [N].

    Linear, the journals tied to their housings by the contact's stiffness; omega [rad/s]; shape
    (bearings, 2), in x and y.
    """
    contacts = structure.contacts
    n, nb = structure.M.shape[0], len(contacts)
    size = n + nb
    M, C, K, G = (to_dense(b) for b in (structure.M, structure.C, structure.K, structure.G))
    dynamic = np.zeros((2 * size, 2 * size), dtype=complex)
    for axis, at in ((X, 0), (Y, size)):
        block = dynamic[at : at + size, at : at + size]
        block[:n, :n] = K + 1j * omega * C - omega**2 * M
        for j, contact in enumerate(contacts):
            wall = n + j
            stiffness, damping = ((contact.kx, contact.cx), (contact.ky, contact.cy))[axis]
            block[wall, wall] = stiffness + 1j * omega * damping - omega**2 * contact.mass
            pair = np.ix_((contact.dof, wall), (contact.dof, wall))
            block[pair] += contact.k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    # (C - i Omega G) v in x and y
    dynamic[:n, size : size + n] += 1j * omega * omega * G
    dynamic[size : size + n, :n] -= 1j * omega * omega * G
    force = np.zeros(2 * size, dtype=complex)
    pull = omega**2 * structure.unbalance
    np.add.at(force, structure.unbalance_dof, pull)
    np.add.at(force, structure.unbalance_dof + size, -1j * pull)
    q = _solve(dynamic, force).reshape(2, size)
    return np.abs(contacts.k * (q[:, contacts.dof] - q[:, n:])).T


def response(axis: Axis, scheme: Scheme, h: float, z: complex) -> np.ndarray:
    """What a contact force z^n [N] at the ends of steps of length h [s] leaves there.

    Displacements, velocities and accelerations, shape (3, n + bearings) [m/N, ...]. Raises
    `numpy.linalg.LinAlgError` at a pole.
    """
    m, d, s = (np.polyval(c[::-1], z - 1.0) for c in scheme.characteristic())
    solved = _solve(m / h**2 * axis.M + d / h * axis.C + s * axis.K, axis.pick)
    by_acceleration = (z - 1.0) ** 2 * (1.0 + (1.0 - scheme.alpha_f) * (z - 1.0))
    return np.array([s * solved, d / h * solved, by_acceleration / h**2 * solved])


def step_matrices(
    axis: Axis, scheme: Scheme, h: float, before: bool = False, after: bool = False
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A step of length h [s] as x1 = A x0 + B1 F1 + B0 F0, for x = (q, h v, h^2 a).

    F: force on the journal [N] at both ends; A: shape (3 n, 3 n), B1, B0: (3 n,). `before`,
    `after`: whether at the step's ends the contact's stiffness and damping belong to the machine.
    """
    am, af, beta, gamma = scheme
    size = len(axis.M)
    wall = np.outer(axis.pick, axis.pick)
    zero, one = np.zeros((size, size)), np.eye(size)
    # rows of equal size: the step's equation by the root of the masses
    scale = 1.0 / np.sqrt(np.diagonal(axis.M))[:, None]
    K0, K1 = (scale * (h**2 * (axis.K + at * axis.k * wall)) for at in (before, after))
    C0, C1 = (scale * (h * (axis.C + at * axis.c * wall)) for at in (before, after))
    M = scale * axis.M
    left = np.block(
        [
            [one, zero, -beta * one],
            [zero, one, -gamma * one],
            [(1 - af) * K1, (1 - af) * C1, (1 - am) * M],
        ]
    )
    right = np.block(
        [
            [one, one, (0.5 - beta) * one],
            [zero, one, (1.0 - gamma) * one],
            [-af * K0, -af * C0, -am * M],
        ]
    )
    push = np.concatenate([np.zeros(2 * size), scale[:, 0] * h**2 * axis.pick])
    solved = np.linalg.solve(left, np.column_stack([right, push]))
    return solved[:, :-1], (1 - af) * solved[:, -1], af * solved[:, -1]


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    # deflections and slopes of short elements differ by many decades
    scale = 1.0 / np.sqrt(np.abs(np.diagonal(matrix)))
    return scale * np.linalg.solve(scale[:, None] * matrix * scale, scale * right)
