"""Solution with the stiffness of a shaft that is never assembled: the elements' end forces s are
unknowns too.

The strain of an element is its nodes' motion less its rigid-body part,

    B q = (w_2 - w_1 - L psi_1, psi_2 - psi_1),   s = k B q,

and the element pulls at its nodes with B^T s. In A q + B^T s = f, B q - k^-1 s = 0 a stiff shaft
has a small k^-1, and is solved as accurately as any other; in A + B^T k B the rounding of k hides
bearings that are softer by many decades.
"""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from ..machine.rotor import Rotor
from .beam import shaft_element

# Returns q and s for a right-hand side f, shape (N,) or (N, columns).
Solve = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
_SCALINGS = 4


def strains(rotor: Rotor) -> tuple[sp.csr_array, np.ndarray]:
    """Return B of one plane, shape (2 elements, dofs), and each element's k, shape (elements, 2, 2)
    [N/m, N, N.m]."""
    count = len(rotor.sections)
    lengths = np.array([section.length for section in rotor.sections])
    at, one = 2 * np.arange(count), np.ones(count)
    rows = np.concatenate([at, at, at, at + 1, at + 1])
    columns = np.concatenate([at, at + 1, at + 2, at + 1, at + 3])
    values = np.concatenate([-one, -lengths, one, -one, one])
    B = sp.csr_array((values, (rows, columns)), shape=(2 * count, 2 * count + 2))
    return B, np.array([shaft_element(s).stiffness[2:, 2:] for s in rotor.sections])


def diagonal(blocks: np.ndarray) -> sp.bsr_array:
    """Return the matrix with these blocks, shape (count, size, size), along its diagonal."""
    count, size, _ = blocks.shape
    places = np.arange(count), np.arange(count + 1)
    return sp.bsr_array((blocks, *places), shape=(count * size, count * size))


def factorized(A: sp.sparray, B: sp.sparray, flexibility: np.ndarray) -> Solve:
    """Return the solver of A q + B^T k B q = f; flexibility: the diagonal blocks of k^-1; real or
    complex. Raises `RuntimeError` if the matrix is singular."""
    # as `sp.block_array` does it, in a third of the time
    a, b, size = A.tocoo(), B.tocoo(), A.shape[0]
    own = size + np.arange(B.shape[0]).reshape(*flexibility.shape[:2], 1)
    across, along = np.broadcast_arrays(own, own.transpose(0, 2, 1))
    values = np.concatenate([a.data, b.data, b.data, -flexibility.ravel()])
    rows = np.concatenate([a.row, size + b.row, b.col, across.ravel()])
    columns = np.concatenate([a.col, b.col, size + b.row, along.ravel()])
    whole = sp.coo_array((values, (rows, columns)), shape=(size + B.shape[0],) * 2).tocsc()
    column = np.repeat(np.arange(whole.shape[1]), np.diff(whole.indptr))
    scale = _balance(np.abs(whole.data), whole.indices, column, whole.shape[0])
    whole.data *= scale[whole.indices] * scale[column]
    factors = splu(whole)

    def solve(f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        by_row = scale.reshape(-1, *[1] * (f.ndim - 1))
        right = np.zeros((len(scale), *f.shape[1:]), dtype=whole.dtype)
        right[:size] = f
        result = by_row * factors.solve(by_row * right)
        return result[:size], result[size:]

    return solve


def _balance(sizes: np.ndarray, row: np.ndarray, column: np.ndarray, count: int) -> np.ndarray:
    """Return factors for rows and columns, powers of two, that scale the largest numbers of each to
    about 1 (Ruiz 2001); sizes: of the numbers at these rows and columns."""
    scale = np.ones(count)
    for _ in range(_SCALINGS):
        scaled = sizes * scale[row] * scale[column]
        largest = np.zeros(count)
        np.maximum.at(largest, row, scaled)
        np.maximum.at(largest, column, scaled)
        scale /= np.sqrt(np.where(largest > 0, largest, 1.0))
    return 2.0 ** np.round(np.log2(scale))
