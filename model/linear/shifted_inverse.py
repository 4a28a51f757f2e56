"""The eigenvalues of a machine nearest to rest, by its inverse at a real shift sigma, whose largest
eigenvalues 1 / (lambda - sigma) they are: they come out exact to rounding however stiff the shaft
is, its stiffness being inverted only."""

from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from .system_at_speed import Linear, LinearError

DENSE = 220  # states up to which all eigenvalues cost less than a few
SHIFT = 0.3  # of the lowest elastic frequency
# Share of the imaginary part: equal real eigenvalues come out apart by the root of rounding.
REAL = 1e-5
_DECAYS = 8  # eigenvalues looked for beyond those asked for: oil films add so many that decay
DOUBTFUL = 1e-6  # a residual that is said
# Of the lowest elastic frequency: what is slower may be a motion that nothing holds, whose
# eigenvalue 0 is there twice, and so comes out off by the root of rounding, as any pair.
_ZERO = 1e-6
# Of Arnoldi's method, which needs one or two; where damping crowds the eigenvalues of a stiff shaft
# it needs thousands, or never ends, and all of them cost less, up to so many states.
RESTARTS, _DENSE_IF_CROWDED = 6, 2000


class ShiftedInverse:
    """(A - sigma)^-1 of x' = A x, x = (u, u', own states of laws), at a real shift sigma, in units
    of time of 1 / scale, so that displacements and velocities are alike; scale: a frequency
    [rad/s]; by_d: Z of the shaft by displacement, see `system_at_speed`."""

    def __init__(self, linear: Linear, scale: float, by_d: np.ndarray) -> None:
        self.scale, self.sigma = scale, SHIFT
        M, D, matrix = scale**2 * linear.own_M, scale * linear.own_D, linear.system.places.matrix
        # of displacements and velocities together: one product takes half the time of two
        self._by_motion = sp.hstack([matrix(D + self.sigma * M), matrix(M)]).tocsr()
        self._states = None
        if linear.own_states is not None:
            self._states = linear.own_states.following(self.sigma * scale)
            linear = linear._replace(own_K=linear.own_K - self._states.stiffness)
        self._shifted = matrix(self.sigma**2 * M + self.sigma * D + linear.own_K)
        by_v = scale * linear.strain.by_v
        turned = by_d + self.sigma * by_v
        self.dtype = turned.dtype
        self._solve = linear.factorized(self.sigma * scale, turned)
        # The shaft's part of D u is Z_v Z^-1 of its part of (sigma^2 M + sigma D + K) u, which is
        # what is solved for.
        self._viscous = by_v @ np.linalg.inv(turned)
        self.size = linear.system.places.size
        self.states = 2 * self.size + (len(self._states.by_d) if self._states else 0)

    def __call__(self, state: np.ndarray) -> np.ndarray:
        """Apply the inverse to states, shape (2 size,) or (2 size, columns)."""
        if np.iscomplexobj(state):
            return self(state.real) + 1j * self(state.imag)
        q, _, s = np.split(state, [self.size, 2 * self.size])
        pairs = q.reshape(-1, 2, *q.shape[1:])
        viscous = np.einsum("ab,jb...->ja...", self._viscous, pairs).reshape(q.shape)
        pushed = self._shifted @ viscous - self._by_motion @ state[: 2 * self.size]
        if (own := self._states) is not None:
            lacking = self.scale * (own.by_rates @ s)
            pushed += own.push @ (self.scale * (own.by_v @ q) - lacking)
        moved = self._solve(pushed)[0] - viscous
        moving = q + self.sigma * moved
        if own is not None:
            s = own.by_d @ moved + self.scale * (own.by_v @ moving) - lacking
        return np.concatenate([moved, moving, s])

    def eigenvalues(self, inverted: np.ndarray) -> np.ndarray:
        """Return the machine's eigenvalues [1/s] from those of the inverse."""
        return self.scale * (self.sigma + 1 / inverted)

    def is_zero(self, values: np.ndarray) -> np.ndarray:
        """Return which eigenvalues [1/s] may be those of motions that nothing holds."""
        return np.abs(values) <= _ZERO * self.scale

    def residuals(self, values: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Return what eigenvalues [1/s] and their states leave of (A - sigma)^-1 x = x / (lambda -
        sigma), of its right side: the larger of the shares of velocities and of all else [1]."""
        left = self(states) * (values / self.scale - self.sigma) - states
        speeds = np.s_[self.size : 2 * self.size]
        parts = [(np.delete(x, speeds, 0), x[speeds]) for x in (left, states)]
        norms = [[np.linalg.norm(x, axis=0) for x in pair] for pair in parts]
        # the speed of a ring amid its films is an unknown beside which no other moves
        return np.max([a / np.where(b > 0, b, 1.0) for a, b in zip(*norms, strict=True)], axis=0)


class Lowest(NamedTuple):
    """Eigenvalues of modes that oscillate [1/s], by ascending frequency, their shapes and
    residuals; decays: eigenvalues of those that do not [1/s]; is_held: whether none was 0."""

    values: np.ndarray
    shapes: np.ndarray
    residuals: np.ndarray
    decays: np.ndarray
    is_held: bool


def lowest(inverse: ShiftedInverse, count: int) -> Lowest:
    """Return at least `count` modes, where there are so many."""
    values, states = _eigen(inverse, count)
    is_zero = inverse.is_zero(values)
    values, states = values[~is_zero], states[:, ~is_zero]
    # of two that are conjugate one is looked at
    one = values.imag >= -REAL * np.abs(values)
    values, states = values[one], states[:, one]
    residuals = inverse.residuals(values, states)
    is_real = (np.abs(values.imag) <= REAL * np.abs(values)) & (residuals <= DOUBTFUL)
    result = np.flatnonzero(values.imag > REAL * np.abs(values))
    result = result[np.argsort(values.imag[result])]
    decays = np.sort(values[is_real].real)[::-1]
    shapes = states[: inverse.size, result]
    return Lowest(values[result], shapes, residuals[result], decays, not is_zero.any())


def _eigen(inverse: ShiftedInverse, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the eigenvalues [1/s] and the states that belong to them; at least `count` that
    oscillate where there are so many."""
    size = inverse.states
    wanted = 2 * count + _DECAYS + size - 2 * inverse.size  # own states mostly decay
    while True:
        if size <= DENSE or wanted + 2 >= size // 3:
            inverted, states = scipy.linalg.eig(inverse(np.eye(size)))
        else:
            operator = LinearOperator((size, size), matvec=inverse, dtype=inverse.dtype)
            start = np.random.default_rng(1).standard_normal(size)
            try:
                restarts = RESTARTS if size <= _DENSE_IF_CROWDED else None
                inverted, states = eigs(operator, wanted, v0=start, maxiter=restarts)
            except ArpackNoConvergence as error:
                if size <= _DENSE_IF_CROWDED:
                    wanted = size
                    continue
                # what is faster by many decades is rounding beside the slowest: there are no more
                inverted, states = error.eigenvalues, error.eigenvectors
                if not len(inverted):
                    raise LinearError("the modes did not converge") from error
                return inverse.eigenvalues(inverted), states
        values = inverse.eigenvalues(inverted)
        whirls = ~inverse.is_zero(values) & (values.imag > REAL * np.abs(values))
        if len(values) == size or np.sum(whirls) >= count:
            return values, states
        wanted *= 2
