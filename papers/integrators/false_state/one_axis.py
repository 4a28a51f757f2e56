"""One direction of a journal's motion in its clearance: the machine along it, linear but the walls.

The scheme's step along such an axis: as the answer to a force z^n, and as matrices.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.structure import Structure

from papers.dense_machine import X, Y, clearance_contacts, contact_picks, in_plane, rest
from papers.integrators.members import Scheme

_SOFTNESS = 1e-13  # of the stiffness's diagonal, that a free rotor has a static shape


@dataclass(frozen=True)
class Axis:
    """One direction of bouncing: the machine along it as one journal sees it, without spin.

    M, C, K: shape (n + housings,) squared, the other journals held as they rest; pick: b, shape
    (n + housings,), journal less housing; clearance [m], k [N/m], c [N.s/m]: of the contact; rest:
    of the journal relative to its housing [m]; along, across: static load on the journal in the
    direction of bouncing and at right angles to it [N].
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    pick: np.ndarray
    clearance: float
    k: float
    c: float
    rest: float
    along: float
    across: float

    @cached_property
    def static(self) -> tuple[np.ndarray, float]:
        """Static shape for a journal that is 1 m off its rest, shape (n + housings,) [1], and the
        stiffness K_s [N/m]."""
        shape = _solve(self.K + _SOFTNESS * np.diag(np.diagonal(self.K)), self.pick)
        compliance = self.pick @ shape
        return shape / compliance, 1.0 / compliance


def axis_of(rotor: Rotor, contact: int, direction: int) -> Axis:
    """The machine along x (`X`) or y (`Y`) as the journal of a clearance contact, from 0, sees it.

    The other journals rest: held by the contact's stiffness in y, by their weight over their
    clearance in x. Raises `EquilibriumError`.
    """
    structure = assemble(rotor)
    contacts, picks = clearance_contacts(structure), contact_picks(structure)
    M, C, K = in_plane(structure, direction)
    at_rest = picks @ rest(rotor)[:-1].imag
    weights = contacts.k * np.maximum(np.abs(at_rest) - contacts.clearance, 0.0)
    holding = weights / contacts.clearance if direction == X else contacts.k
    holding = np.where(np.arange(len(contacts)) == contact, 0.0, holding)
    K += picks.T @ (holding[:, None] * picks)
    own = contacts[contact]
    load = math.copysign(weights[contact], at_rest[contact])
    own_rest, along, across = (0.0, 0.0, load) if direction == X else (at_rest[contact], load, 0.0)
    return Axis(M, C, K, picks[contact], own.clearance, own.k, own.c, own_rest, along, across)


def unbalance_loads(structure: Structure, omega: float) -> np.ndarray:
    """Amplitudes of the loads that the unbalance puts on the clearance contacts at a steady speed
    [N].

    Linear, the journals tied to their housings by the contact's stiffness; omega [rad/s]; shape
    (contacts, 2), in x and y.
    """
    contacts, picks = clearance_contacts(structure), contact_picks(structure)
    n, size = len(structure.static_load), picks.shape[1]
    tied = picks.T @ (contacts.k[:, None] * picks)
    dynamic = np.zeros((2 * size, 2 * size), dtype=complex)
    for axis, at in ((X, 0), (Y, size)):
        M, C, K = in_plane(structure, axis)
        dynamic[at : at + size, at : at + size] = K + tied + 1j * omega * C - omega**2 * M
    # (C - i Omega G) v in x and y
    turning = 1j * omega * omega * to_dense(structure.G)
    dynamic[:n, size : size + n] += turning
    dynamic[size : size + n, :n] -= turning
    force = np.zeros(2 * size, dtype=complex)
    pull = omega**2 * structure.unbalance
    np.add.at(force, structure.unbalances.dof, pull)
    np.add.at(force, structure.unbalances.dof + size, -1j * pull)
    q = _solve(dynamic, force).reshape(2, size)
    return np.abs(contacts.k * (q @ picks.T)).T


def response(axis: Axis, scheme: Scheme, h: float, z: complex) -> np.ndarray:
    """What a contact force z^n [N] at the ends of steps of length h [s] leaves there.

    Displacements, velocities and accelerations, shape (3, n + housings) [m/N, ...]. Raises
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
