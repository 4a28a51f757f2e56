"""What grows faster than it oscillates, however far from rest: a strong negative stiffness makes
real eigenvalues lambda > 0 that are not among those nearest to rest.

About a shift s > 0 the Cayley transform (A + s) (A - s)^-1 has the eigenvalues (lambda + s) /
(lambda - s), of which those of growth, and no others, are larger than 1. Where the symmetric part
of s^2 M + s D + K is definite nothing grows as exp(s t).
"""

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from .shifted_inverse import DENSE, DOUBTFUL, REAL, RESTARTS, SHIFT, Lowest, ShiftedInverse
from .system_at_speed import Linear

_APART, _SHIFTS = 10.0, 14  # shifts: each so many times the one before, at most so many
_COUNT, _VECTORS = 6, 40  # eigenvalues looked for about each at first, and Arnoldi's vectors
_LEAST = 0.03  # of the diagonal of M: a consistent M is no less (0.039 of a slender element)


def with_fast_growth(found: Lowest, linear: Linear, scale: float, by_d: np.ndarray) -> Lowest:
    """Return eigenvalues nearest to rest with those of growth that lie further away; linear, scale,
    by_d: see `ShiftedInverse`."""
    for shift in _shifts(linear, SHIFT * scale):
        inverse = ShiftedInverse(linear, shift / SHIFT, by_d)
        values, states = _growing(inverse, shift)
        known = np.concatenate([found.values, found.decays])
        is_new = np.abs(values[:, None] - known).min(axis=1, initial=np.inf) > REAL * values.real
        if not is_new.any():
            continue
        values, states = values[is_new], states[:, is_new]
        residuals = inverse.residuals(values, states)
        whirls = values.imag > REAL * values.real
        is_real = (np.abs(values.imag) <= REAL * values.real) & (residuals <= DOUBTFUL)
        found = found._replace(
            values=np.append(found.values, values[whirls]),
            shapes=np.hstack([found.shapes, states[: inverse.size, whirls]]),
            residuals=np.append(found.residuals, residuals[whirls]),
            decays=np.sort(np.append(found.decays, values[is_real].real))[::-1],
        )
    return found


def _shifts(linear: Linear, first: float) -> list[float]:
    """Return shifts beyond the first [1/s], about which there may be growth."""
    matrix, states = linear.system.places.matrix, linear.own_states
    mass = matrix(linear.own_M).diagonal()
    result = [first]
    while len(result) <= _SHIFTS:
        s, K = result[-1], linear.own_K
        if states is not None:
            K = K - states.following(s).stiffness
        slope, whole = linear.own_D, s * linear.own_D + K
        if all(
            _is_definite(_LEAST * factor * mass, matrix(numbers))
            for factor, numbers in ((2 * s, slope), (s**2, whole))
        ):
            break
        result.append(_APART * s)
    return result[1:]


def _is_definite(diagonal: np.ndarray, matrix: sp.csc_array) -> bool:
    """Return whether the symmetric part of a matrix, with this diagonal added to it, is positive
    definite."""
    whole = (matrix + matrix.T) / 2
    acts = abs(whole).sum(axis=0) > 0
    whole = whole[acts][:, acts].toarray() + np.diag(diagonal[acts])
    each = np.abs(np.diagonal(whole)) ** -0.5
    try:
        np.linalg.cholesky(each[:, None] * whole * each)
    except np.linalg.LinAlgError:
        return False
    return True


def _growing(inverse: ShiftedInverse, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Return eigenvalues about a shift that grow faster than they oscillate, and their states."""
    size, count = inverse.states, _COUNT
    while True:
        if size <= DENSE or count + 2 >= size // 3:
            inverted, states = scipy.linalg.eig(inverse(np.eye(size)))
        else:
            cayley = LinearOperator(
                (size, size), lambda x: x + 2 * SHIFT * inverse(x), dtype=inverse.dtype
            )
            start = np.random.default_rng(1).standard_normal(size)
            vectors = min(max(_VECTORS, 3 * count), size)
            try:
                values, states = eigs(cayley, count, v0=start, ncv=vectors, maxiter=RESTARTS)
            except ArpackNoConvergence as error:  # where nothing more grows
                values, states = error.eigenvalues, error.eigenvectors
            inverted = (values - 1) / (2 * SHIFT)
        values = inverse.eigenvalues(inverted)
        grows = values.real > np.abs(values.imag)
        if len(values) == size or np.sum(grows) < count:
            break
        count *= 2
    grows &= np.abs(np.log(np.abs(values) / shift)) <= np.log(_APART) / 2
    return values[grows], states[:, grows]
