"""Lowest modes of shafts of many elements, by sparse matrices: no operation is of order n^2.

SciPy's sparse solvers are imported when needed; most machines do not need them.
"""

from typing import Any

import numpy as np

LONG = 200  # dofs of a shaft, from which on dense matrices do not pay
_ITERATIONS = 50
_CONVERGED = 1e-9
_RIGID = 1e-7  # of the shift: below it a square is of a motion as a rigid body


def sparse(band: np.ndarray) -> Any:
    """Return a symmetric band matrix as SciPy's, in columns."""
    from scipy.sparse import diags_array

    n, width = band.shape
    lower = [band[: n - d, d] for d in range(width)]
    offsets = [*range(width), *(-d for d in range(1, width))]
    return diags_array([*lower, *lower[1:]], offsets=offsets, shape=(n, n), format="csc")


def lowest_square_supported(solve: Any, M: Any) -> float:
    """Return the lowest squared natural frequency [rad2/s2] of a supported machine.

    solve: applies the inverse of its stiffness; M: its mass matrix, sparse. By simultaneous
    iteration with three vectors and Rayleigh-Ritz, so that close frequencies do not slow it down.
    """
    shapes = np.eye(M.shape[0], 3)
    shapes[:, 2] = 1.0
    largest = 0.0
    for _ in range(_ITERATIONS):
        shapes, _ = np.linalg.qr(shapes)
        root = np.linalg.cholesky(shapes.T @ (M @ shapes))
        driven = M @ np.linalg.solve(root, shapes.T).T
        shapes = solve(driven)
        inverse = driven.T @ shapes
        before, largest = largest, float(np.linalg.eigvalsh(inverse)[-1])
        if abs(largest - before) <= _CONVERGED * largest:
            break
    return 1.0 / largest


def lowest_square_free(K: Any, M: Any, shift: float) -> float:
    """Return the lowest square of an elastic mode [rad2/s2] of a shaft with rigid-body motions.

    K, M: sparse; shift: an estimate of that square, by which the stiffness is made definite.
    """
    from scipy.sparse.linalg import eigsh

    squares = np.sort(eigsh(K, k=6, M=M, sigma=-shift, v0=np.ones(K.shape[0]))[0])
    return float(squares[squares > _RIGID * shift][0])


def fixed_interface_modes(
    K: Any, M: Any, rest: np.ndarray, retained: np.ndarray, modes: int
) -> Any:
    """Return the static response of the dofs `rest` to those `retained`, and their lowest modes
    with these fixed, shapes (rest, retained) and (rest, modes); K, M: sparse, of all dofs."""
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    rows = K[rest]
    inner = rows[:, rest].tocsc()
    factors = splu(inner)
    static = -factors.solve(rows[:, retained].toarray())
    inverse = LinearOperator(inner.shape, matvec=factors.solve, dtype=float)
    _, shapes = eigsh(
        inner, k=modes, M=M[rest][:, rest], sigma=0.0, v0=np.ones(len(rest)), OPinv=inverse
    )
    return static, shapes
