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

# From f to q and the end forces, see `StrainedMatrices.factorized`.
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


class Places:
    """Where the numbers of several sparse square matrices are: as arrays over the same places they
    are added without their places being looked for again.

    rows, columns: of the numbers, by columns.
    """

    def __init__(self, size: int, rows: np.ndarray, columns: np.ndarray) -> None:
        """Take the places at these rows and columns, each once."""
        self.size = size
        self._keys = np.unique(columns.astype(np.int64) * size + rows)
        self.columns, self.rows = (at.astype(np.int32) for at in np.divmod(self._keys, size))
        self._starts = np.searchsorted(self._keys, size * np.arange(size + 1)).astype(np.int32)

    def at(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return which of the places are those of these rows and columns."""
        return np.searchsorted(self._keys, columns.astype(np.int64) * self.size + rows)

    def summed(self, at: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Return the numbers of a matrix that is the sum of values at these of the places."""
        return np.bincount(at, values, minlength=len(self._keys))

    def numbers(self, rows: np.ndarray, columns: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Return the numbers of a matrix that is the sum of values at these rows and columns."""
        return self.summed(self.at(rows, columns), values)

    def matrix(self, numbers: np.ndarray) -> sp.csc_array:
        """Return the matrix of these numbers."""
        return sp.csc_array((numbers, self.rows, self._starts), shape=(self.size,) * 2)


class StrainedMatrices:
    """Matrices A + B^T (k x Z) B, with numbers A at some places, and Z of both planes."""

    def __init__(self, places: Places, B: sp.sparray, stiffness: np.ndarray) -> None:
        """Take what is the same in all of them; stiffness: k of each element, shape (count, 2, 2);
        B: of one plane, or of x and y in turn."""
        self.places, self.B, self.stiffness = places, B, stiffness
        self._flexibility = np.linalg.inv(stiffness)
        b, size, count = B.tocoo(), places.size, len(stiffness)
        self.size = size + B.shape[0]
        own = size + np.arange(B.shape[0]).reshape(count, -1, 1)
        across, along = np.broadcast_arrays(own, own.transpose(0, 2, 1))
        rows = np.concatenate([places.rows, size + b.row, b.col, across.ravel()])
        columns = np.concatenate([places.columns, b.col, size + b.row, along.ravel()])
        self._by_column = np.lexsort((rows, columns))
        self._rows, self._columns = (at[self._by_column].astype(np.int32) for at in (rows, columns))
        # numbers row by row, for what is the largest in each
        self._by_row = np.lexsort((self._columns, self._rows))
        self._row_starts, self._column_starts = (
            np.searchsorted(at, np.arange(self.size))
            for at in (self._rows[self._by_row], self._columns)
        )
        self._strains = np.concatenate([b.data, b.data])
        self._is_flexibility = self._by_column >= len(places.rows) + 2 * b.nnz

    def matrix(self, numbers: np.ndarray, turned: np.ndarray) -> sp.csc_array:
        """Return the matrix of numbers A, with Z = turned."""
        blocks = _turned(self.stiffness, turned)
        count, size, _ = blocks.shape
        k = sp.bsr_array(
            (blocks, np.arange(count), np.arange(count + 1)), shape=(count * size,) * 2
        )
        return self.places.matrix(numbers) + (self.B.T @ k @ self.B).tocsc()

    def factorized(self, numbers: np.ndarray, turned: np.ndarray, *, refines: bool = True) -> Solve:
        """Return the solver of A q + B^T (k x Z) B q = f, with Z = turned; real or complex.

        refines: whether a solution is corrected once by what it leaves of f: where masses are small
        beside bearings, the rounding of the end forces is 1e-8 of q otherwise, as in the deflection
        of a rotor of 60 t. Raises `RuntimeError` if the matrix is singular.
        """
        flexibility = _turned(self._flexibility, np.linalg.inv(turned))
        values = np.concatenate([numbers, self._strains, -flexibility.ravel()])[self._by_column]
        scale = self._balance(np.abs(values))
        acts = (values != 0) | self._is_flexibility
        values, rows, columns = values[acts], self._rows[acts], self._columns[acts]
        starts = np.searchsorted(columns, np.arange(self.size + 1, dtype=np.int32))
        starts = starts.astype(np.int32)  # as SciPy would, in less time
        values *= scale[rows] * scale[columns]
        matrix = sp.csc_array((values, rows, starts), shape=(self.size,) * 2)
        factors = splu(matrix)

        def solve(f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            """Return q [m, rad] and the elements' end forces [N, N.m] under f [N, N.m], each of
            shape (size,) or with columns as f has."""
            by_row = scale.reshape(-1, *[1] * (f.ndim - 1))
            right = np.zeros((len(scale), *f.shape[1:]), dtype=values.dtype)
            right[: len(f)] = f
            right *= by_row
            result = factors.solve(right)
            if refines:
                result += factors.solve(right - matrix @ result)
            result *= by_row
            return result[: len(f)], result[len(f) :]

        return solve

    def _balance(self, sizes: np.ndarray) -> np.ndarray:
        """Return factors for rows and columns, powers of two, that scale the largest numbers of
        each to about 1 (Ruiz 2001); sizes: of all numbers."""
        scale = np.ones(self.size)
        for _ in range(_SCALINGS):
            scaled = sizes * scale[self._rows] * scale[self._columns]
            largest = np.maximum(
                np.maximum.reduceat(scaled[self._by_row], self._row_starts),
                np.maximum.reduceat(scaled, self._column_starts),
            )
            scale /= np.sqrt(np.where(largest > 0, largest, 1.0))
        return 2.0 ** np.round(np.log2(scale))


def _turned(each: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Return the Kronecker product of each of `count` matrices, shape (count, 2, 2), with one."""
    size = each.shape[1] * len(turned)
    return np.einsum("eij,ab->eiajb", each, turned).reshape(-1, size, size)
