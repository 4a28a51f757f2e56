"""Small dense linear systems: LU factors with partial pivoting, in place."""

from .jit import jit


@jit
def factorize_dense(a, pivots, count):
    """Overwrite the first rows and columns of a by its factors, with partial pivoting; return False
    if they are singular."""
    for k in range(count):
        pivot = k
        for i in range(k + 1, count):
            if abs(a[i, k]) > abs(a[pivot, k]):
                pivot = i
        pivots[k] = pivot
        if not abs(a[pivot, k]) > 0.0:
            return False
        if pivot != k:
            for j in range(count):
                a[k, j], a[pivot, j] = a[pivot, j], a[k, j]
        inverse = 1.0 / a[k, k]
        a[k, k] = inverse
        for i in range(k + 1, count):
            ratio = a[i, k] * inverse
            a[i, k] = ratio
            if ratio != 0.0:
                for j in range(k + 1, count):
                    a[i, j] -= ratio * a[k, j]
    return True


@jit
def solve_dense(a, pivots, count, x):
    """Overwrite the first entries of x by the solution, with the factors of `factorize_dense`."""
    for k in range(count):
        pivot = pivots[k]
        if pivot != k:
            x[k], x[pivot] = x[pivot], x[k]
    for k in range(count):
        for i in range(k + 1, count):
            x[i] -= a[i, k] * x[k]
    for k in range(count - 1, -1, -1):
        total = x[k]
        for j in range(k + 1, count):
            total -= a[k, j] * x[j]
        x[k] = total * a[k, k]
