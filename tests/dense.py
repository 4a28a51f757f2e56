"""The machine in plain dense matrices: the oracle for the band form, and for eigenvalues."""

import numpy as np
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.structure.structure import Structure


def dense_matrices(
    structure: Structure,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """M, C, K, G and K_circulatory as real matrices of the whole machine, housings included.

    Shape (N, N), N = 2 (n + housings): first all x (rotor, housings), then all y, so that
    M q'' + (C + Omega G) q' + (K + kappa K_circulatory) q = f. For eigenvalues, static solutions
    and as the plain form against which the band form is tested.
    """
    housings = structure.housings
    n = structure.M.shape[0]
    size = n + len(housings)

    def both_planes(band: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        full = np.zeros((2 * size, 2 * size))
        for start, housing in ((0, x), (size, y)):
            full[start : start + n, start : start + n] = to_dense(band)
            at = np.arange(start + n, start + size)
            full[at, at] = housing
        return full

    def skew(band: np.ndarray) -> np.ndarray:
        full = np.zeros((2 * size, 2 * size))
        full[:n, size : size + n] = to_dense(band)
        full[size : size + n, :n] = -to_dense(band)
        return full

    return (
        both_planes(structure.M, housings.mass, housings.mass * housings.mass_ratio),
        both_planes(structure.C, housings.cx, housings.cy),
        both_planes(structure.K, housings.kx, housings.ky),
        skew(structure.G),
        skew(structure.K_shaft),
    )
