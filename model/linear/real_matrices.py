"""A machine's matrices over x and y of every dof, housing and ground, and how unknowns are made of
these: dofs that are pinned to one another, and differences of dofs."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from ..kernels.kernel import interpreted
from ..machine.rotor import Rotor
from ..parts.housing import masses
from ..structure.strain_solver import strains
from ..structure.structure import Structure

TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # i z as a matrix of (x, y)


class Matrices(NamedTuple):
    """Matrices of x, y of every dof, housing and ground, before anything is pinned, C and K without
    what the shaft's strain adds; its strains by them, and each element's stiffness."""

    M: sp.csr_matrix
    C: sp.csr_matrix
    K: sp.csr_matrix
    gyroscopic: sp.csr_matrix
    strained: sp.csr_matrix
    stiffness: np.ndarray


def matrices_of(rotor: Rotor, s: Structure) -> Matrices:
    """Return the matrices of a machine."""
    housings = s.housings
    by_deflection, stiffness = strains(rotor)
    behind = sp.csr_array((by_deflection.shape[0], len(housings) + 1))
    both = np.eye(2)

    def full(band: np.ndarray, matrix: np.ndarray, x: np.ndarray, y: np.ndarray) -> sp.csr_matrix:
        """Return the matrix of a band, with what housings add in x and in y."""
        n, width = band.shape
        below = [band[: n - d, d] for d in range(width)]
        offsets = list(range(width))
        half = sp.diags_array(below[1:], offsets=[-d for d in offsets[1:]], shape=(n, n))
        plane = half + half.T + sp.diags_array(band[:, 0])
        own = np.append(np.column_stack([x, y]).ravel(), [0.0, 0.0])
        return sp.block_diag([sp.kron(plane, matrix), sp.diags_array(own)]).tocsr()

    damping, stiff = np.zeros_like(s.K), s.K_axial.copy()
    np.add.at(damping[:, 0], s.springs.dof, s.springs.damping)
    np.add.at(stiff[:, 0], s.springs.dof, s.springs.stiffness)
    none = np.zeros(len(housings))
    return Matrices(
        M=full(s.M, both, *interpreted(masses)(housings)),
        C=full(damping, both, housings.cx, housings.cy),
        K=full(stiff, both, housings.kx, housings.ky),
        gyroscopic=full(s.G, -TURN, none, none),
        strained=sp.kron(sp.hstack([by_deflection, behind]), both).tocsr(),
        stiffness=stiffness,
    )


def expansion(size: int, pairs: Iterable[tuple[int, int]]) -> sp.csr_matrix:
    """Return the matrix from the unknowns to all dofs, of which ground, the last, stays; pairs:
    (dof, end) that move as one."""
    leader = np.arange(size)
    for dof, end in pairs:
        retained, merged = sorted((leader[dof], leader[end]))
        if retained == leader[-1] or merged == leader[-1]:
            retained, merged = leader[-1], retained + merged - leader[-1]
        leader[leader == merged] = retained
    moving = leader != leader[-1]
    unknowns, column = np.unique(leader[moving], return_inverse=True)
    row = np.flatnonzero(moving)
    selection = sp.csr_array((np.ones(len(row)), (row, column)), shape=(size, len(unknowns)))
    return sp.kron(selection, np.eye(2)).tocsr()


def differences(size: int, pairs: list[tuple[int, int]]) -> sp.csr_matrix:
    """Return x, y of each pair's first less its second."""
    matrix = sp.lil_array((len(pairs), size))
    for j, (dof, end) in enumerate(pairs):
        matrix[j, dof] = 1.0
        matrix[j, end] = -1.0
    return sp.kron(matrix, np.eye(2)).tocsr()


class Between:
    """Makes the matrix of what acts between nodes and housings, X^T T X, of tangents T by
    interface; across: X, x and y of each interface's displacement by the unknowns."""

    def __init__(self, across: sp.csr_array) -> None:
        self._size = across.shape[1]
        whole = across.tocoo()
        left, right = (grid.ravel() for grid in np.indices((whole.nnz, whole.nnz)))
        one = whole.row // 2
        own = one[left] == one[right]
        left, right = left[own], right[own]
        self._factor = whole.data[left] * whole.data[right]
        self._place = whole.col[left], whole.col[right]
        self._of = one[left], whole.row[left] % 2, whole.row[right] % 2

    def __call__(self, tangents: np.ndarray) -> sp.csc_array:
        """Return the matrix; tangents: shape (m, 2, 2)."""
        values = self._factor * tangents[self._of]
        return sp.coo_array((values, self._place), (self._size, self._size)).tocsc()


def in_plane(z: np.ndarray) -> np.ndarray:
    """Return x, y in turn of complex numbers, shape (..., n), in the shape (..., 2 n)."""
    return np.stack([z.real, z.imag], axis=-1).reshape(*z.shape[:-1], 2 * z.shape[-1])


def to_complex(u: np.ndarray) -> np.ndarray:
    """Return x + i y of x, y in turn, shape (n,)."""
    return u[::2] + 1j * u[1::2]
