"""The vector of one eigenvalue of the machine's matrix, by inverse iteration."""

import math

from ..kernels.functions import inverse
from ..kernels.jit import jit


@jit
def fill_eigenvector(survey, size, root):
    """Fill in the displacements of the eigenvector of A, of `size` displacements, for a root, by
    inverse iteration."""
    unknowns = size + len(survey.rates)
    for i in range(unknowns):
        survey.vector[i] = complex(1.0, 1.0 / (1.0 + i))
    for _ in range(2):
        for i in range(unknowns):
            row = size + i
            for k in range(unknowns):
                survey.D[i, k] = -survey.A[row, k if k < size else size + k]
            for k in range(size):
                survey.D[i, k] -= root * survey.A[row, size + k]
            survey.D[i, i] += root * root if i < size else root
        _solve_complex(survey.D, survey.vector[:unknowns])
        largest = 0.0
        for i in range(unknowns):
            largest = max(largest, abs(survey.vector[i].real), abs(survey.vector[i].imag))
        for i in range(unknowns):
            survey.vector[i] = survey.vector[i] * (1.0 / largest)


@jit
def _square(z):
    return z.real * z.real + z.imag * z.imag


@jit
def _solve_complex(a, x):
    """Overwrite x, shape (m,), by a^-1 x of the first m rows and columns of a, by elimination with
    pivots; a vanishing pivot is replaced by rounding."""
    m = len(x)
    size = 0.0
    for i in range(m):
        for k in range(m):
            size = max(size, _square(a[i, k]))
    least = 1e-17 * math.sqrt(size)
    for k in range(m):
        pivot = k
        for i in range(k + 1, m):
            if _square(a[i, k]) > _square(a[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(k, m):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
            x[k], x[pivot] = x[pivot], x[k]
        if _square(a[k, k]) < least * least:
            a[k, k] = complex(least, 0.0)
        over = inverse(a[k, k])
        for i in range(k + 1, m):
            ratio = a[i, k] * over
            for j in range(k + 1, m):
                a[i, j] -= ratio * a[k, j]
            x[i] -= ratio * x[k]
    for i in range(m - 1, -1, -1):
        for j in range(i + 1, m):
            x[i] -= a[i, j] * x[j]
        x[i] *= inverse(a[i, i])
