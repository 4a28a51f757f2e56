"""Symmetric band matrices: product, form, factorization A = L D L^T without pivoting, solution.

Storage: `band[i, d]` is A[i + d, i], d = 0 .. half-bandwidth, a column of the lower triangle in a
row. Factorization and solution take real or complex symmetric (not Hermitian) matrices. The step
matrices of the time integration need no pivoting: their real part is positive definite, and growth
is then bounded (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., sec. 10.4; George,
Ikramov and Kucherov 2002).
"""

import numpy as np

from .functions import scaled
from .jit import jit


def to_band(dense: np.ndarray, half_bandwidth: int) -> np.ndarray:
    """Return the band storage, shape (n, half_bandwidth + 1), of a dense symmetric matrix."""
    n = len(dense)
    band = np.zeros((n, half_bandwidth + 1), dtype=dense.dtype)
    for d in range(half_bandwidth + 1):
        band[: n - d, d] = np.diagonal(dense, -d)
    return band


def to_dense(band: np.ndarray) -> np.ndarray:
    """Return the dense symmetric matrix, shape (n, n), of a band matrix."""
    n, width = band.shape
    dense = np.zeros((n, n), dtype=band.dtype)
    for d in range(width):
        for i in range(n - d):
            dense[i + d, i] = dense[i, i + d] = band[i, d]
    return dense


def product(band: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return A x; x of shape (n,) or (n, columns)."""
    n, width = band.shape
    columns = band.reshape(n, width, *[1] * (x.ndim - 1))
    y = columns[:, 0] * x
    for d in range(1, width):
        y[: n - d] += columns[: n - d, d] * x[d:]
        y[d:] += columns[: n - d, d] * x[: n - d]
    return y


@jit
def add_product(band, x, y):
    """Add A x to y, for a real matrix and complex vectors of shape (n,)."""
    n, width = band.shape
    for i in range(n):
        total = y[i] + scaled(band[i, 0], x[i])
        for d in range(1, width):
            if d < n - i:
                total += scaled(band[i, d], x[i + d])
            if d <= i:
                total += scaled(band[i - d, d], x[i - d])
        y[i] = total


@jit
def form(band, x, y):
    """Return x^H A y for a real matrix and complex vectors of shape (n,)."""
    n, width = band.shape
    total = 0.0j
    for i in range(n):
        along = scaled(0.5 * band[i, 0], y[i])
        across = scaled(0.5 * band[i, 0], x[i])
        for d in range(1, min(width, n - i)):
            along += scaled(band[i, d], y[i + d])
            across += scaled(band[i, d], x[i + d])
        total += x[i].conjugate() * along + across.conjugate() * y[i]
    return total


@jit
def square(band, x):
    """Return x^H A x for a real matrix and a complex vector of shape (n,)."""
    n, width = band.shape
    total = 0.0
    for i in range(n):
        along = scaled(0.5 * band[i, 0], x[i])
        for d in range(1, min(width, n - i)):
            along += scaled(band[i, d], x[i + d])
        total += x[i].real * along.real + x[i].imag * along.imag
    return 2.0 * total


@jit
def factorize(band):
    """Overwrite A by its factors: band[:, 0] becomes 1 / D, band[:, 1:] the unit lower triangle."""
    n, width = band.shape
    for j in range(n):
        pivot = band[j, 0]
        # the compiler's own complex division guards against overflow at several times the cost
        inverse = pivot.conjugate() * (1.0 / (pivot.real * pivot.real + pivot.imag * pivot.imag))
        last = min(width, n - j)
        for d in range(1, last):
            ratio = band[j, d] * inverse
            for e in range(d, last):
                band[j + d, e - d] -= ratio * band[j, e]
            band[j, d] = ratio
        band[j, 0] = inverse


@jit
def solve(factors, x, first=0):
    """Overwrite the right-hand side x, shape (n,), by A^-1 x; `factors` from `factorize`; x is zero
    before its entry `first`."""
    n, width = factors.shape
    for j in range(first, n):
        known = x[j]
        for d in range(1, min(width, n - j)):
            x[j + d] -= factors[j, d] * known
    for j in range(n - 1, -1, -1):
        total = factors[j, 0] * x[j]
        for d in range(1, min(width, n - j)):
            total -= factors[j, d] * x[j + d]
        x[j] = total
