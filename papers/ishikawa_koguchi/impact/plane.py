"""Bilinear quadrilaterals in plane strain, in band storage (matrices by scikit-fem)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from skfem import Basis, BilinearForm, ElementQuad1, ElementVector, MeshQuad
from skfem.helpers import dot
from skfem.models.elasticity import lame_parameters, linear_elasticity

from .stepping.failures import ImpactError


@dataclass(frozen=True)
class Solid:
    """A plate of nx by ny elements, its nodes counted up each column, columns along x.

    points: reference positions [m], shape ((nx + 1) (ny + 1), 2); mass, stiffness: sparse, two
    unknowns a node (x, y); columns: shape (nx + 1, ny + 1), the nodes.
    """

    points: np.ndarray
    columns: np.ndarray
    mass: coo_matrix
    stiffness: coo_matrix


def solid(
    x: np.ndarray,
    y: np.ndarray,
    E: float,
    nu: float,
    density: float,
    thickness: float,
    shape: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None,
    is_lumped: bool = True,
) -> Solid:
    """Plate between the lines x and y [m], moved by `shape`; E [Pa], density [kg/m3].

    is_lumped: a diagonal mass matrix, its rows summed. Raises `ImpactError` for impossible
    material or mesh.
    """
    for name, value in (("E", E), ("density", density), ("thickness", thickness)):
        if not 0 < value < np.inf:
            raise ImpactError(f"{name} = {value:g}: must be > 0 and finite")
    if not -1 < nu < 0.5:
        raise ImpactError(f"nu = {nu:g}: must be above -1 and below 0.5")
    nx, ny = len(x) - 1, len(y) - 1
    if nx < 1 or ny < 1:
        raise ImpactError(f"mesh of {nx} x {ny} elements: must have at least 1 x 1")
    columns = np.arange((nx + 1) * (ny + 1)).reshape(nx + 1, ny + 1)
    px, py = np.meshgrid(x, y, indexing="ij")
    if shape is not None:
        px, py = shape(px, py)
    corners = (columns[:-1, :-1], columns[1:, :-1], columns[1:, 1:], columns[:-1, 1:])
    points = np.stack([px.ravel(), py.ravel()])
    mesh = MeshQuad(points, np.stack([c.ravel() for c in corners]))
    basis = Basis(mesh, ElementVector(ElementQuad1()))
    order = np.empty(basis.N, dtype=int)
    order[basis.nodal_dofs] = 2 * np.arange(columns.size) + np.arange(2)[:, None]
    mass = density * thickness * BilinearForm(lambda u, v, _: dot(u, v)).assemble(basis)
    stiffness = thickness * linear_elasticity(*lame_parameters(E, nu)).assemble(basis)
    if is_lumped:
        mass = coo_matrix(np.diag(np.asarray(mass.sum(axis=1)).ravel()))
    return Solid(points.T, columns, _renumbered(mass, order), _renumbered(stiffness, order))


def _renumbered(matrix: object, order: np.ndarray) -> coo_matrix:
    result = coo_matrix(matrix)
    return coo_matrix((result.data, (order[result.row], order[result.col])), result.shape)


def to_band(parts: list[coo_matrix], retained: np.ndarray | None = None) -> np.ndarray:
    """Band storage (see `band`) of matrices one after another on the diagonal.

    retained: the unknowns that stay, in order, shape (n,); all by default.
    """
    rows, cols, data, at = [], [], [], 0
    for part in parts:
        rows.append(part.row + at)
        cols.append(part.col + at)
        data.append(part.data)
        at += part.shape[0]
    place = np.full(at, -1)
    retained = np.arange(at) if retained is None else retained
    place[retained] = np.arange(len(retained))
    i, j, value = place[np.concatenate(rows)], place[np.concatenate(cols)], np.concatenate(data)
    stays = (i >= j) & (j >= 0) & (value != 0)
    i, j, value = i[stays], j[stays], value[stays]
    band = np.zeros((len(retained), int((i - j).max()) + 1))
    np.add.at(band, (j, i - j), value)
    return band
