"""States of laws as unknowns beside those of the machine, such as where a floating ring is.

Their rates are s' = R_d d + R_v d' + R_s s, with the displacements d of the interfaces, and they
add the forces F_s s. In motions exp(root t) they follow, s = (root - R_s)^-1 (R_d + root R_v) d,
and so are a stiffness that depends on the root.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from ..laws_at_rest.tangents import StateTangents


class OwnStates(NamedTuple):
    """The states of a machine's interfaces that are unknowns.

    across: x and y of each interface's displacement by the machine's unknowns; between: returns the
    numbers of the system for tangents of interfaces; tangents: those of these states.
    """

    across: sp.csr_array
    between: Callable[[np.ndarray], np.ndarray]
    tangents: StateTangents

    def rates(self) -> np.ndarray:
        """Return R_d and R_v of the unknowns' displacements and velocities, shape (s, 2 N)."""
        return np.hstack([of @ self.across for of in (self.tangents.by_d, self.tangents.by_v)])

    def forces(self) -> np.ndarray:
        """Return the forces F_s on the unknowns, shape (N, s) [N]."""
        return np.asarray(self.across.T @ self.tangents.force)

    def following(self, root: float) -> "Following":
        """Return how they follow motions about exp(root t), root [1/s]."""
        by, m = self.tangents, np.arange(self.across.shape[0] // 2)
        inverse = np.linalg.inv(root * np.eye(len(by.by_states)) - by.by_states)
        moved = inverse @ (by.by_d + root * by.by_v)
        size = np.abs(moved).max(axis=1)
        size[size == 0.0] = 1.0
        inverse /= size[:, None]
        return Following(
            self.between((by.force @ moved).reshape(len(m), 2, len(m), 2)[m, :, m]),
            self.forces() * size,
            inverse @ by.by_d @ self.across,
            inverse @ by.by_v @ self.across,
            inverse * size,
        )


class Following(NamedTuple):
    """States about one root, each over the size that it has where its interface moves by 1 m:
    numbers of the system that they take from K; the forces on the unknowns by them, shape (N, s);
    and what they are by displacements, by velocities, and by what is lacking of their rates, shape
    (s, N) and (s, s)."""

    stiffness: np.ndarray
    push: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray
    by_rates: np.ndarray
