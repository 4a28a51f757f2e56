"""Symmetric band matrices: product, factorization A = L D L^T without pivoting, solution.

Storage: `band[d, i]` is A[i + d, i], d = 0 .. half-bandwidth. The kernels take real or complex
symmetric (not Hermitian) matrices. No pivoting is needed for the step matrices of the time
integration: their real part is positive definite, and growth is then bounded (Higham, Accuracy and
Stability of Numerical Algorithms, 2nd ed., sec. 10.4; George, Ikramov and Kucherov 2002).
"""

from __future__ import annotations

import numpy as np

from .compiled import compiled


def to_band(dense: np.ndarray, half_bandwidth: int) -> np.ndarray:
    """Band storage, shape (half_bandwidth + 1, n), of a dense symmetric matrix, shape (n, n)."""
    n = len(dense)
    band = np.zeros((half_bandwidth + 1, n), dtype=dense.dtype)
    for d in range(half_bandwidth + 1):
        band[d, : n - d] = np.diagonal(dense, -d)
    return band


def to_dense(band: np.ndarray) -> np.ndarray:
    """Dense symmetric matrix, shape (n, n), of a band matrix."""
    n = band.shape[1]
    dense = np.zeros((n, n), dtype=band.dtype)
    for d in range(band.shape[0]):
        for i in range(n - d):
            dense[i + d, i] = dense[i, i + d] = band[d, i]
    return dense


@compiled
def add_product(factor, band, x, y):
    """y += factor * A x, x and y of shape (n,)."""
    n = band.shape[1]
    width = band.shape[0]
    for i in range(n):
        total = band[0, i] * x[i]
        for d in range(1, min(width, n - i)):
            total += band[d, i] * x[i + d]
        for d in range(1, min(width, i + 1)):
            total += band[d, i - d] * x[i - d]
        y[i] += factor * total


@compiled
def factorize(band):
    """Overwrite A by its factors: band[0] becomes 1 / D, band[1:] the unit lower triangle L."""
    n = band.shape[1]
    width = band.shape[0]
    for j in range(n):
        inverse = 1.0 / band[0, j]
        last = min(width, n - j)
        for d in range(1, last):
            ratio = band[d, j] * inverse
            for e in range(d, last):
                band[e - d, j + d] -= ratio * band[e, j]
        for d in range(1, last):
            band[d, j] *= inverse
        band[0, j] = inverse


@compiled
def solve(factors, x):
    """Overwrite the right-hand sides x, shape (n, m), by A^-1 x; `factors` from `factorize`."""
    n = factors.shape[1]
    width = factors.shape[0]
    m = x.shape[1]
    for j in range(n):
        for d in range(1, min(width, n - j)):
            ratio = factors[d, j]
            for k in range(m):
                x[j + d, k] -= ratio * x[j, k]
    for j in range(n - 1, -1, -1):
        for k in range(m):
            x[j, k] *= factors[0, j]
        for d in range(1, min(width, n - j)):
            ratio = factors[d, j]
            for k in range(m):
                x[j, k] -= ratio * x[j + d, k]
