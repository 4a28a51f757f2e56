"""A linear structure with a few unilateral contacts, as the impact experiments need it.

    M q'' + C q' + K q = f(t) + B N lambda,   s(B^T q) >= -compliance lambda,   lambda >= 0

s: openings of the contacts, N their gradient (see `contacts`), lambda: contact forces. For a hard
stop, whose compliance is zero, lambda s = 0; a penalty law has lambda = -s / compliance.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from rotor_fmu.model.kernels.band import factorize, product, solve
from rotor_fmu.model.kernels.jit import jit

from .contacts import Contacts

Solver = Callable[[np.ndarray], np.ndarray]


class Structure(Protocol):
    """What a step has to know; all in SI units, vectors of shape (n,), right-hand sides (n, k)."""

    @property
    def contacts(self) -> Contacts:
        """Where it can touch."""

    @property
    def is_constant(self) -> bool:
        """Whether the matrices do not change with time."""

    @property
    def energy_scale(self) -> float:
        """That of the system [J]; a run past a million times it has diverged."""

    def load(self, t: float) -> np.ndarray:
        """External forces f(t) [N]."""

    def inertia(self, a: np.ndarray) -> np.ndarray:
        """M a [N]."""

    def internal(self, q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        """C v + K q [N]."""

    def step_solver(self, m: float, c: float, k: float, t: float) -> Solver:
        """Solver with the matrix m M + c C + k K at time t."""

    def mass_solver(self) -> Solver:
        """Solver with M."""

    def energy(self, q: np.ndarray, v: np.ndarray) -> float:
        """Kinetic and elastic energy and the potential of constant loads [J]."""


@dataclass(frozen=True)
class Elastic:
    """Undamped elastic bodies under a constant load; see `Structure`.

    mass, stiffness: band storage (see `band`), half-bandwidths of their own; force: shape (n,) [N].
    """

    mass: np.ndarray
    stiffness: np.ndarray
    force: np.ndarray
    contacts: Contacts
    energy_scale: float
    is_constant: bool = True

    def load(self, t: float) -> np.ndarray:
        """See `Structure`."""
        return self.force

    def inertia(self, a: np.ndarray) -> np.ndarray:
        """See `Structure`."""
        return product(self.mass, a)

    def internal(self, q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        """See `Structure`."""
        return product(self.stiffness, q)

    def step_solver(self, m: float, c: float, k: float, t: float) -> Solver:
        """See `Structure`."""
        matrix = k * self.stiffness
        matrix[:, : self.mass.shape[1]] += m * self.mass
        return _factorized(matrix)

    def mass_solver(self) -> Solver:
        """See `Structure`."""
        return _factorized(self.mass.copy())

    def energy(self, q: np.ndarray, v: np.ndarray) -> float:
        """See `Structure`."""
        kinetic, elastic = v @ product(self.mass, v), q @ product(self.stiffness, q)
        return float(0.5 * (kinetic + elastic) - self.force @ q)


@jit
def _solve_rows(factors, rows):
    for k in range(len(rows)):
        solve(factors, rows[k])


def _factorized(band: np.ndarray) -> Solver:
    factorize(band)

    def solved(right: np.ndarray) -> np.ndarray:
        if right.ndim == 1:
            x = right.copy()
            solve(band, x)
            return x
        rows = np.ascontiguousarray(right.T).copy()
        _solve_rows(band, rows)
        return np.ascontiguousarray(rows.T)

    return solved
