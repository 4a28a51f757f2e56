"""What the supports of a machine bear, at rest or in a motion."""

import numpy as np

from .linear_machine import LinearMachine
from .linearization import PINNED
from .real_matrices import in_plane, x_and_y
from .supports import interfaces
from .system_at_speed import Linear


def support_loads(
    machine: LinearMachine,
    at: Linear,
    force: np.ndarray,
    whirl: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """Return loads on springs, then interfaces, in x, y, shape (springs + interfaces, 2) [N], under
    `force`, x, y of every dof, where the machine rests; whirl: u and the elements' pull where it
    moves as Re(u exp(i Omega t)) instead."""
    (u, pull), omega = (whirl, at.speed) if whirl else ((at.rest, at.pull), 0.0)
    s, laws = machine.structure, at.laws
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
        left = left - machine.full.resistance(at.speed, 1j * omega, whole)
        # the forces on the pins balance all others; the last rows are ground's
        left = left - machine.across.T @ acting.ravel()
        rows = machine.across[x_and_y(machine.pinned)].toarray().T[:-2]
        pins = np.linalg.lstsq(rows, left[:-2], rcond=None)[0]
        acting[machine.pinned] = pins.reshape(-1, 2)
    # a seal bears what moves its fluid too
    fluid = np.array([getattr(e.source, "added_mass", 0.0) for e in interfaces(machine.rotor)])
    acting -= omega**2 * fluid[:, None] * (machine.across @ whole).reshape(-1, 2)
    return np.concatenate([springs, acting])
