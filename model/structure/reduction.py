"""Fewer degrees of freedom: Craig and Bampton's component modes on a `Structure`.

Kept as they are: the deflections where something acts, of bearings, discs, coupling and supports.
The rest of the shaft follows them as it would at rest, q_i = Psi q_b, and vibrates besides in its
lowest modes with those deflections held (Craig and Bampton 1968).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..kernels.band import factorize, to_band, to_dense
from ..kernels.compiled import plain
from .assembly import moved
from .structure import Structure

_MATRICES = ("M", "C", "K", "G", "K_shaft", "K_axial")


def component_modes(structure: Structure, modes: int) -> tuple[np.ndarray, np.ndarray]:
    """The dofs kept, shape (b,), and the basis T of all n dofs, shape (n, b + modes).

    modes: how many fixed-interface modes; all there are where there are fewer.
    """
    n = len(structure.weight)
    on_shaft = structure.load_dof >= 0
    acted_on = [structure.load_dof[on_shaft], structure.load_arms.slope[on_shaft]]
    acted_on += [
        getattr(structure, of).dof
        for of in ("interfaces", "springs", "unbalances", "probes", "velocities")
    ]
    acted_on += [structure.unbalances.slope, structure.probes.slope]
    kept = np.unique(np.concatenate(acted_on))
    rest = np.setdiff1d(np.arange(n), kept)
    M, K = to_dense(structure.M), to_dense(structure.K_shaft)
    inner = np.ix_(rest, rest)
    inverse = np.linalg.inv(np.linalg.cholesky(M[inner]))
    _, shapes = np.linalg.eigh(inverse @ K[inner] @ inverse.T)
    modes = min(modes, len(rest))
    T = np.zeros((n, len(kept) + modes))
    T[kept, np.arange(len(kept))] = 1.0
    T[np.ix_(rest, np.arange(len(kept)))] = -np.linalg.solve(K[inner], K[np.ix_(rest, kept)])
    T[np.ix_(rest, np.arange(len(kept), T.shape[1]))] = (inverse.T @ shapes)[:, :modes]
    return kept, T


def reduced(structure: Structure, modes: int) -> Structure:
    """The structure in its component modes: full matrices of b + modes dofs, the kept ones first.

    Exact with all modes; with few, for motions slower than the first mode left out.
    """
    kept, T = component_modes(structure, modes)
    n, size = T.shape
    dense = {name: T.T @ to_dense(getattr(structure, name)) @ T for name in _MATRICES}
    bands: dict[str, Any] = {name: to_band(matrix, size - 1) for name, matrix in dense.items()}
    M_factors = bands["M"].copy()
    plain(factorize)(M_factors)
    place = {dof: i for i, dof in enumerate(kept.tolist())}

    def place_of(dofs: np.ndarray) -> np.ndarray:
        return np.array([place[dof] for dof in dofs.tolist()], dtype=np.int64)

    at = moved(structure, place_of)
    # housings and ground stand behind the dofs
    at["interfaces"].end += size - n
    deflections = structure.deflections[np.isin(structure.deflections[:, 0], kept)].copy()
    deflections[:, 0] = place_of(deflections[:, 0])
    # a motion as one body needs no mode
    one_body = np.zeros((2, size))
    one_body[:, : len(kept)] = structure.one_body[:, kept]
    weights = T.T @ to_dense(structure.weights) @ T
    return structure._replace(
        **bands,
        **at,
        M_factors=M_factors,
        weights=to_band(weights, size - 1),
        mass_sum=T.T @ structure.mass_sum,
        weight=T.T @ structure.weight,
        one_body=one_body,
        deflections=deflections,
    )
