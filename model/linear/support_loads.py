"""What the supports of a machine bear, at rest or in a motion."""

import numpy as np
import scipy.sparse as sp

from ..laws_at_rest.tangents import Tangents
from .linear_machine import LinearMachine
from .linearization import PINNED
from .real_matrices import in_plane, x_and_y


def support_loads(
    machine: LinearMachine,
    laws: Tangents,
    speed: float,
    u: np.ndarray,
    pull: np.ndarray,
    force: np.ndarray,
    omega: float,
) -> np.ndarray:
    """Return loads on springs, then interfaces, in x, y, shape (springs + interfaces, 2) [N].

    The machine moves as Re(u exp(i omega t)), its elements pulling with `pull`, under `force`,
    x, y of every dof; at omega = 0 it rests. laws: of its interfaces, at a speed of rotation
    [rad/s].
    """
    s = machine.structure
    whole = machine.expand @ u
    motion = np.column_stack([whole[::2], whole[1::2]])
    factor = s.springs.stiffness + 1j * omega * s.springs.damping
    springs = factor[:, None] * motion[s.springs.dof]
    tangents = laws.by_d + 1j * omega * laws.by_v
    acting = -machine.tangent(tangents, u).reshape(-1, 2).astype(complex)
    if omega == 0.0:
        acting = -in_plane(laws.force).reshape(-1, 2).astype(complex)
    if machine.contacts == PINNED and machine.has_contacts:
        left = force - machine.full.strained.T @ pull
        left = left - machine.full.resistance(speed, 1j * omega, whole)
        acting[machine.pinned] = _pin_forces(machine.across, machine.pinned, left, acting)
    return np.concatenate([springs, acting])


def _pin_forces(
    across: sp.csr_array, pinned: np.ndarray, left: np.ndarray, acting: np.ndarray
) -> np.ndarray:
    """Return the forces on the pins, which balance all others, shape (pins, 2) [N].

    across: the interfaces' displacements by those of every dof, the last two ground's; pinned:
    which interfaces; left: force on every dof [N, N.m] but of the interfaces; acting: of these,
    those of pins 0.
    """
    rows = across[x_and_y(pinned)].toarray().T[:-2]
    left = left - across.T @ acting.ravel()
    return np.linalg.lstsq(rows, left[:-2], rcond=None)[0].reshape(-1, 2)
