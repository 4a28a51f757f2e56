"""A machine at one speed as sparse real matrices, what the shaft's strain has of them kept apart.

Without it no digit is lost where a shaft is stiff by many decades (`structure.elastic`). An element
pulls with Z k e, where Z, complex or a matrix of x and y, is made of the share of hysteresis, of
-i kappa of the damping that rotates, and of eta_v d/dt.

Hysteresis depends on the sense in which the shaft is bent in its own frame: a circular whirl of the
frequency w is pulled back by i kappa_h sign(w - Omega) of its stiffness (Genta 2004). That drives a
whirl slower than the rotation, damps a faster one and any against it, and leaves what turns with
the shaft alone. In motions slower than the rotation it is -i kappa_h sign(Omega) in complex
coordinates, in faster ones i kappa_h sign(w), i being that of time.
"""

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from ..laws_at_rest.tangents import Tangents
from ..quantities import QuantityError
from ..structure.strain_solver import Solve, StrainedMatrices
from .own_states import OwnStates
from .real_matrices import TURN

_WITH_IT = 1e-9  # relative difference of a frequency and the speed that are one


class LinearError(QuantityError):
    """A linear analysis that this machine does not allow; the message says what to do."""


class Strain(NamedTuple):
    """Z of what the shaft's strain adds to K and D: by displacement, of motions slower than the
    rotation, and by velocity, shape (2, 2); kappa_h [1]; speed of rotation [rad/s]."""

    by_d: np.ndarray
    by_v: np.ndarray
    kappa_h: float
    speed: float

    @property
    def by_d_if_fast(self) -> np.ndarray:
        """Z by displacement of motions faster than the rotation, exp(i w t) with w > 0."""
        return self.by_d + self.kappa_h * (np.sign(self.speed) * TURN + 1j * np.eye(2))

    @property
    def with_rotation(self) -> "Strain":
        """That of motions with the rotation: the mean of slower and faster ones."""
        return self._replace(by_d=(self.by_d + self.by_d_if_fast) / 2, kappa_h=0.0)

    def at(self, root: complex) -> np.ndarray:
        """Return Z of a motion exp(root t); of one with the rotation the mean of a slower and a
        faster one."""
        frequency, speed = abs(complex(root).imag), abs(self.speed)
        result = self.by_d + root * self.by_v
        if self.kappa_h == 0.0 or frequency < (1.0 - _WITH_IT) * speed or frequency == 0.0:
            return result
        fast = self.by_d_if_fast if complex(root).imag > 0.0 else self.by_d_if_fast.conj()
        share = 1.0 if frequency > (1.0 + _WITH_IT) * speed else 0.5
        return result + share * (fast - self.by_d)


class Linear(NamedTuple):
    """The machine at one speed [rad/s]: the system of its unknowns, and the numbers in it of the
    matrices, of which D and K lack what the shaft's strain adds, and that; the displacements at
    rest, shape (N,) [m, rad], 0 where nothing holds the machine, the elements' end forces [N, N.m],
    what the interfaces do there (those that are open or pinned: nothing), and the states of their
    laws; own_states: those that are unknowns, None of a machine where all follow."""

    speed: float
    system: StrainedMatrices
    own_M: np.ndarray
    own_D: np.ndarray
    own_K: np.ndarray
    strain: Strain
    rest: np.ndarray
    pull: np.ndarray
    laws: Tangents
    states: np.ndarray
    own_states: OwnStates | None = None

    @property
    def M(self) -> sp.csc_array:
        """Mass, shape (N, N)."""
        return self.system.places.matrix(self.own_M)

    @property
    def D(self) -> sp.csc_array:
        """Damping, that of the shaft included."""
        return self.system.matrix(self.own_D, self.strain.by_v)

    @property
    def K(self) -> sp.csc_array:
        """Stiffness, that of the shaft included, of motions slower than the rotation."""
        return self.system.matrix(self.own_K, self.strain.by_d)

    def factorized(self, root: complex = 0.0, turned: np.ndarray | None = None) -> Solve:
        """Return the solver of (root^2 M + root D + K) u = f, root [1/s]; turned: Z, by default
        that of the root. Raises `LinearError` if it is singular."""
        own = self.own_K + (root**2 * self.own_M + root * self.own_D if root else 0)
        turned = self.strain.at(root) if turned is None else turned
        try:
            return self.system.factorized(own, turned)
        except RuntimeError as error:
            raise LinearError(f"the machine's system matrix is singular at {root:g} 1/s") from error
