"""All eigenvalues of a real matrix: Hessenberg form by elimination, then Francis' double-shift QR
(Wilkinson and Reinsch, Handbook for Automatic Computation II, contributions 13 to 15)."""

import math

import numpy as np

from ..kernels.jit import jit, jit_not_inlined
from ..kernels.kernel import Kernel

_MOST_SWEEPS = 60  # for one eigenvalue; two or three are usual
_UNUSUAL = 10  # after so many in vain the shift is chosen otherwise
_RADIX = 2.0


@jit
def _balance(a, n):
    """Scale rows and columns by powers of two until each pair has sums of one size."""
    is_done = False
    while not is_done:
        is_done = True
        for i in range(n):
            column = row = 0.0
            for j in range(n):
                if j != i:
                    column += abs(a[j, i])
                    row += abs(a[i, j])
            if not (column > 0.0 and row > 0.0 and column + row < math.inf):
                continue
            factor, total = 1.0, column + row
            while column < row / _RADIX:
                factor *= _RADIX
                column *= _RADIX * _RADIX
            while column > row * _RADIX:
                factor /= _RADIX
                column /= _RADIX * _RADIX
            if (column + row) / factor < 0.95 * total:
                is_done = False
                for j in range(n):
                    a[i, j] *= 1.0 / factor
                for j in range(n):
                    a[j, i] *= factor


@jit
def _reduce(a, n):
    """Reduce a matrix to Hessenberg form, by elimination with pivots."""
    for m in range(1, n - 1):
        pivot = m
        for j in range(m + 1, n):
            if abs(a[j, m - 1]) > abs(a[pivot, m - 1]):
                pivot = j
        if pivot != m:
            for j in range(m - 1, n):
                a[pivot, j], a[m, j] = a[m, j], a[pivot, j]
            for i in range(n):
                a[i, pivot], a[i, m] = a[i, m], a[i, pivot]
        if a[m, m - 1] == 0.0:
            continue
        for i in range(m + 1, n):
            ratio = a[i, m - 1] / a[m, m - 1]
            if ratio == 0.0:
                continue
            a[i, m - 1] = 0.0
            for j in range(m, n):
                a[i, j] -= ratio * a[m, j]
            for j in range(n):
                a[j, m] += ratio * a[j, i]


@jit
def _first_of_block(a, last, size):
    """Return the row from which the matrix is unreduced up to row `last`; set the negligible
    element above it to 0."""
    for i in range(last, 0, -1):
        near = abs(a[i - 1, i - 1]) + abs(a[i, i])
        if near == 0.0:
            near = size
        if abs(a[i, i - 1]) + near == near:
            a[i, i - 1] = 0.0
            return i
    return 0


@jit
def _first_of_sweep(a, first, last, x, y, w):
    """Return the row in which a sweep with these shifts can begin, and its first column there."""
    for m in range(last - 2, first - 1, -1):
        z = a[m, m]
        r, s = x - z, y - z
        p = (r * s - w) / a[m + 1, m] + a[m, m + 1]
        q = a[m + 1, m + 1] - z - r - s
        r = a[m + 2, m + 1]
        s = abs(p) + abs(q) + abs(r)
        p, q, r = p / s, q / s, r / s
        if m == first:
            break
        side = abs(a[m, m - 1]) * (abs(q) + abs(r))
        near = abs(p) * (abs(a[m - 1, m - 1]) + abs(z) + abs(a[m + 1, m + 1]))
        if side + near == near:
            break
    return m, p, q, r


@jit
def _sweep(a, first, last, corner, before, product):
    """Do one double step of QR on rows first .. last, with shifts from the two last diagonal
    elements and the product beside them."""
    begin, p, q, r = _first_of_sweep(a, first, last, corner, before, product)
    size = 0.0
    for i in range(begin + 2, last + 1):
        a[i, i - 2] = 0.0
        if i > begin + 2:
            a[i, i - 3] = 0.0
    for k in range(begin, last):
        is_three = k + 1 < last
        if k > begin:
            p, q = a[k, k - 1], a[k + 1, k - 1]
            r = a[k + 2, k - 1] if is_three else 0.0
            size = abs(p) + abs(q) + abs(r)
            if size == 0.0:
                continue
            p, q, r = p / size, q / size, r / size
        s = math.sqrt(p * p + q * q + r * r)
        if p < 0.0:
            s = -s
        if k > begin:
            a[k, k - 1] = -s * size
        elif first < begin:
            a[k, k - 1] = -a[k, k - 1]
        p += s
        x, y, z, q, r = p / s, q / s, r / s, q / p, r / p
        if is_three:
            for j in range(k, last + 1):
                t = a[k, j] + q * a[k + 1, j] + r * a[k + 2, j]
                a[k, j] -= t * x
                a[k + 1, j] -= t * y
                a[k + 2, j] -= t * z
            for i in range(first, min(last, k + 3) + 1):
                t = x * a[i, k] + y * a[i, k + 1] + z * a[i, k + 2]
                a[i, k] -= t
                a[i, k + 1] -= t * q
                a[i, k + 2] -= t * r
        else:
            for j in range(k, last + 1):
                t = a[k, j] + q * a[k + 1, j]
                a[k, j] -= t * x
                a[k + 1, j] -= t * y
            for i in range(first, last + 1):
                t = x * a[i, k] + y * a[i, k + 1]
                a[i, k] -= t
                a[i, k + 1] -= t * q


@jit_not_inlined
def eigenvalues(a, re, im):
    """Fill in the real and the imaginary parts, shape (n,), of the eigenvalues of the first n rows
    and columns of a, which is overwritten; NaN if they are not found."""
    n = len(re)
    size = 0.0
    for i in range(n):
        for j in range(n):
            size += abs(a[i, j])
    for i in range(n):
        re[i] = im[i] = math.nan
    if not size < math.inf:
        return
    _balance(a, n)
    _reduce(a, n)
    last, shifted, sweeps = n - 1, 0.0, 0
    while last >= 0:
        first = _first_of_block(a, last, size)
        x = a[last, last]
        if first == last:
            re[last], im[last] = x + shifted, 0.0
            last, sweeps = last - 1, 0
            continue
        y, w = a[last - 1, last - 1], a[last, last - 1] * a[last - 1, last]
        if first == last - 1:
            p = 0.5 * (y - x)
            square = p * p + w
            z = math.sqrt(abs(square))
            x += shifted
            if square >= 0.0:
                z = p + z if p >= 0.0 else p - z
                re[last - 1] = re[last] = x + z
                if z != 0.0:
                    re[last] = x - w / z
                im[last - 1] = im[last] = 0.0
            else:
                re[last - 1] = re[last] = x + p
                im[last - 1], im[last] = z, -z
            last, sweeps = last - 2, 0
            continue
        if sweeps == _MOST_SWEEPS:
            return
        if sweeps > 0 and sweeps % _UNUSUAL == 0:
            shifted += x
            for i in range(last + 1):
                a[i, i] -= x
            s = abs(a[last, last - 1]) + abs(a[last - 1, last - 2])
            x = y = 0.75 * s
            w = -0.4375 * s * s
        sweeps += 1
        _sweep(a, first, last, x, y, w)


def eigenvalues_lapack(a, re, im):
    """Do the same by LAPACK for interpreted kernels, whose loops would take seconds."""
    n = len(re)
    result = np.linalg.eigvals(a[:n, :n])
    re[:], im[:] = result.real, result.imag


if isinstance(eigenvalues, Kernel):
    eigenvalues.interpreted = eigenvalues_lapack
else:
    eigenvalues = eigenvalues_lapack
