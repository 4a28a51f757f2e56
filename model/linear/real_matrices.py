"""A machine's matrices over x and y of every dof, housing and ground, and how unknowns are made of
these: dofs that are pinned to one another, and differences of dofs."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from ..kernels.kernel import interpreted
from ..machine.rotor import Rotor
from ..parts.housing import masses
from ..structure.strain_solver import Places, strains
from ..structure.structure import Structure

TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # i z as a matrix of (x, y)


class Matrices(NamedTuple):
    """Matrices of x, y of every dof, housing and ground, before anything is pinned, C and K without
    what the shaft's strain adds, as numbers at the same rows and columns; the shaft's strains by
    them, and each element's stiffness."""

    rows: np.ndarray
    columns: np.ndarray
    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    gyroscopic: np.ndarray
    strained: sp.csr_array
    stiffness: np.ndarray

    def matrix(self, numbers: np.ndarray) -> sp.csr_array:
        """Return the matrix of these numbers."""
        size = self.strained.shape[1]
        return sp.csr_array((numbers, (self.rows, self.columns)), shape=(size, size))

    def resistance(self, speed: float, root: complex, u: np.ndarray) -> np.ndarray:
        """Return (root^2 M + root (C + speed G) + K) u, without the shaft's strain."""
        of_velocity = self.C + speed * self.gyroscopic
        M, D, K = (self.matrix(numbers) @ u for numbers in (self.M, of_velocity, self.K))
        return root**2 * M + root * D + K


def matrices_of(rotor: Rotor, s: Structure) -> Matrices:
    """Return the matrices of a machine."""
    housings = s.housings
    n, width = s.M.shape
    size = n + len(housings) + 1
    by_deflection, stiffness = strains(rotor)
    below = [(d + np.arange(n - d), np.arange(n - d)) for d in range(width)]
    above = [(columns, rows) for rows, columns in below[1:]]
    alone = np.arange(n, size - 1)
    rows, columns = np.hstack([*below, *above, (alone, alone)])

    def full(band: np.ndarray, matrix: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the numbers of a band, with what housings add in x and in y."""
        lower = [band[: n - d, d] for d in range(width)]
        own = [np.diag(both) for both in zip(x, y, strict=True)]
        shaft = np.concatenate([*lower, *lower[1:]])[:, None, None] * matrix
        return np.concatenate([shaft, np.reshape(own, (-1, 2, 2))]).ravel()

    damping, stiff = s.numbers[0].mass_damping * s.M_shaft, s.K_axial.copy()
    np.add.at(damping[:, 0], s.springs.dof, s.springs.damping)
    np.add.at(stiff[:, 0], s.springs.dof, s.springs.stiffness)
    none = np.zeros(len(housings))
    both = np.eye(2)
    strained = sp.csr_array(
        (by_deflection.data, by_deflection.indices, by_deflection.indptr),
        shape=(by_deflection.shape[0], size),
    )
    axes = np.arange(2)
    of_rows, of_columns = np.broadcast_arrays(
        2 * rows[:, None, None] + axes[:, None], 2 * columns[:, None, None] + axes
    )
    return Matrices(
        rows=of_rows.ravel(),
        columns=of_columns.ravel(),
        M=full(s.M, both, *interpreted(masses)(housings)),
        C=full(damping, both, housings.cx, housings.cy),
        K=full(stiff, both, housings.kx, housings.ky),
        gyroscopic=full(s.G, -TURN, none, none),
        strained=sp.kron(strained, both).tocsr(),
        stiffness=stiffness,
    )


def unknowns(size: int, pairs: Iterable[tuple[int, int]]) -> np.ndarray:
    """Return which unknown x and y of all dofs are, in turn, -1 of ground, the last; pairs: (dof,
    end) that move as one."""
    leader = np.arange(size)
    for dof, end in pairs:
        retained, merged = sorted((leader[dof], leader[end]))
        if retained == leader[-1] or merged == leader[-1]:
            retained, merged = leader[-1], retained + merged - leader[-1]
        leader[leader == merged] = retained
    moving = np.repeat(leader != leader[-1], 2)
    both = 2 * np.repeat(leader, 2) + np.tile([0, 1], size)
    result = np.full(2 * size, -1)
    result[moving] = np.unique(both[moving], return_inverse=True)[1]
    return result


def expansion(unknown: np.ndarray) -> sp.csr_array:
    """Return the matrix from the unknowns to all dofs; unknown: see `unknowns`."""
    row = np.flatnonzero(unknown >= 0)
    shape = len(unknown), int(unknown.max()) + 1
    return sp.csr_array((np.ones(len(row)), (row, unknown[row])), shape=shape)


def differences(size: int, pairs: list[tuple[int, int]]) -> sp.csr_array:
    """Return x, y of each pair's first less its second."""
    at = np.array(pairs, int).reshape(-1, 2)
    first, axes = np.arange(len(at))[:, None, None], np.arange(2)
    rows, columns = np.broadcast_arrays(2 * first + axes, 2 * at[:, :, None] + axes)
    signs = np.broadcast_to([[1.0], [-1.0]], rows.shape).ravel()
    shape = 2 * len(at), 2 * size
    return sp.csr_array((signs, (rows.ravel(), columns.ravel())), shape=shape)


class Between:
    """Numbers of the matrix of what acts between nodes and housings, X^T T X, of tangents T.

    across: X, x and y of each interface's displacement by the unknowns; rows, columns: where other
    matrices have numbers; places: where these or any of them has one.
    """

    def __init__(self, across: sp.csr_array, rows: np.ndarray, columns: np.ndarray) -> None:
        whole = across.tocoo()
        left, right = (grid.ravel() for grid in np.indices((whole.nnz, whole.nnz)))
        one = whole.row // 2
        own = one[left] == one[right]
        left, right = left[own], right[own]
        self._factor = whole.data[left] * whole.data[right]
        self._of = one[left], whole.row[left] % 2, whole.row[right] % 2
        at = whole.col[left], whole.col[right]
        every = (np.concatenate(pair) for pair in zip((rows, columns), at, strict=True))
        self.places = Places(across.shape[1], *every)
        self._at = self.places.at(*at)

    def __call__(self, tangents: np.ndarray) -> np.ndarray:
        """Return the numbers; tangents: shape (m, 2, 2)."""
        return self.places.summed(self._at, self._factor * tangents[self._of])


def in_plane(z: np.ndarray) -> np.ndarray:
    """Return x, y in turn of complex numbers, shape (..., n), in the shape (..., 2 n)."""
    return np.stack([z.real, z.imag], axis=-1).reshape(*z.shape[:-1], 2 * z.shape[-1])


def x_and_y(at: np.ndarray) -> np.ndarray:
    """Return the places of x and y of these deflections, or interfaces, among x, y in turn."""
    return np.column_stack([2 * at, 2 * at + 1]).ravel()


def to_complex(u: np.ndarray) -> np.ndarray:
    """Return x + i y of x, y in turn, shape (n,)."""
    return u[::2] + 1j * u[1::2]
