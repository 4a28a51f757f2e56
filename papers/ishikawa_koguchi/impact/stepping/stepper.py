"""One implicit step of a structure, its linear part solved and condensed to the contacts.

    M ((1 - alpha_m) a1 + alpha_m a0) + (1 - alpha_f) r1 + alpha_f r0 = B F,   r = C v + K q - f

The contact force acts at the end of the step and is not weighted by alpha_f: only so does eq. (12)
of paper B give the restitution 1. What is left is a problem in the accelerations of the relative
displacements p = B^T q at the contacts, p1'' = w + W F; displacements as unknowns would lose digits
in very short steps.
"""

from typing import NamedTuple

import numpy as np
from rotor_fmu.model.schemes.family import Scheme
from rotor_fmu.model.step.linear_step import correct, predict, weights

from .failures import ImpactError
from .structure import Structure


class Instant(NamedTuple):
    """State at time t [s]: displacement [m], velocity, acceleration, r = C v + K q - f [N], each of
    shape (n,); force of the contacts [N], shape (m,)."""

    t: float
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    r: np.ndarray
    force: np.ndarray


class FreeStep(NamedTuple):
    """A step of length h [s] to the time t [s] before its contact forces are known.

    q, v: predictions; a: accelerations without contact; columns: S^-1 B, shape (n, k).
    p, p_dot: predictions at the contacts; w: their accelerations without contact [m/s2]; W:
    flexibility B^T S^-1 B [1/kg], shape (k, k); b = beta h^2, so that p + b (w + W F) is reached.
    """

    h: float
    t: float
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    columns: np.ndarray
    p: np.ndarray
    p_dot: np.ndarray
    w: np.ndarray
    W: np.ndarray
    b: float


class Stepper:
    """Steps of one structure by one scheme.

    Raises `ImpactError` for a scheme with which no step matrix can be solved.
    """

    _KEPT = 16

    def __init__(self, structure: Structure, scheme: Scheme) -> None:
        if not scheme.beta > 0 or not scheme.alpha_f < 1 or not scheme.alpha_m < 1:
            raise ImpactError(
                f"{scheme}: an implicit step needs beta > 0, alpha_f < 1 and alpha_m < 1"
            )
        self.structure = structure
        self.scheme = scheme
        self._factorized: dict[float, tuple] = {}
        self._mass_solver = structure.mass_solver()
        self.mass_columns = self._mass_solver(structure.contacts.B)
        self.mass_flexibility = structure.contacts.B.T @ self.mass_columns

    def start(self, t: float, q: np.ndarray, v: np.ndarray) -> Instant:
        """Instant at rest in its contacts, accelerations from the equation of motion."""
        r = self.residual(t, q, v)
        force = np.zeros(len(self.structure.contacts.compliance))
        return Instant(t, q, v, -self._mass_solver(r), r, force)

    def residual(self, t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """r = C v + K q - f(t) [N]."""
        return self.structure.internal(q, v, t) - self.structure.load(t)

    def free_acceleration(self, r: np.ndarray) -> np.ndarray:
        """-M^-1 r [m/s2], the accelerations without contact."""
        return -self._mass_solver(r)

    def free(self, old: Instant, h: float) -> FreeStep:
        """Predict and solve the linear part of a step of length h [s]."""
        am, af, beta, _ = self.scheme
        t = old.t + h
        solver, columns, flexibility = self._linear(h, t)
        # the rotor's kernels take complex displacements, x + i y
        q, v = np.empty((2, len(old.q)), dtype=complex)
        predict(self.scheme, h, *(x.astype(complex) for x in (old.q, old.v, old.a)), q, v)
        q, v = q.real.copy(), v.real.copy()
        right = -(1 - af) * self.residual(t, q, v) - af * old.r
        if am:
            right -= am * self.structure.inertia(old.a)
        a = solver(right)
        B = self.structure.contacts.B
        at_contacts = (B.T @ q, B.T @ v, B.T @ a)
        return FreeStep(h, t, q, v, a, columns, *at_contacts, flexibility, beta * h * h)

    def finish(self, free: FreeStep, N: np.ndarray, force: np.ndarray) -> Instant:
        """The motion at the end of the step; contact forces [N], shape (m,), along N, (k, m)."""
        a = free.a + free.columns @ (N @ force)
        q, v = free.q.astype(complex), free.v.astype(complex)
        correct(self.scheme, free.h, a.astype(complex), q, v)
        q, v = q.real.copy(), v.real.copy()
        return Instant(free.t, q, v, a, self.residual(free.t, q, v), force)

    def _linear(self, h: float, t: float) -> tuple:
        """Solver of the step matrix, S^-1 B and B^T S^-1 B; kept for the step lengths in use."""
        if h in self._factorized:
            return self._factorized[h]
        m, c, k = weights(self.scheme, h)
        solver = self.structure.step_solver(m, c, k, t)
        B = self.structure.contacts.B
        columns = solver(B)
        result = solver, columns, B.T @ columns
        if self.structure.is_constant:
            while len(self._factorized) >= self._KEPT:
                self._factorized.pop(next(iter(self._factorized)))
            self._factorized[h] = result
        return result
