"""Radau IIA with three stages, of order five, L-stable (Ehle 1969; Hairer and Wanner, Solving
Ordinary Differential Equations II, sec. IV.5 and IV.8).

The stages lie at C h and have the weights A; the last stage is the end of the step. With A = T
diag(LAMBDA) T^-1 the linear part of a step decouples into three systems, each of the size of one
stage.
"""

import math

import numpy as np

from ..kernels.functions import inverse, modulus, scaled
from ..kernels.jit import jit

STAGES = 3
_ROOT = math.sqrt(6.0)
C = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
A = np.array(
    [
        [(88 - 7 * _ROOT) / 360, (296 - 169 * _ROOT) / 1800, (-2 + 3 * _ROOT) / 225],
        [(296 + 169 * _ROOT) / 1800, (88 + 7 * _ROOT) / 360, (-2 - 3 * _ROOT) / 225],
        [(16 - _ROOT) / 36, (16 + _ROOT) / 36, 1 / 9],
    ]
)


def _cofactors(a: list[list[complex]]) -> list[list[complex]]:
    """Return the cofactors of a matrix of three rows."""
    return [
        [
            a[(i + 1) % 3][(j + 1) % 3] * a[(i + 2) % 3][(j + 2) % 3]
            - a[(i + 1) % 3][(j + 2) % 3] * a[(i + 2) % 3][(j + 1) % 3]
            for j in range(3)
        ]
        for i in range(3)
    ]


def _inverse(a: list[list[complex]]) -> list[list[complex]]:
    """Return the inverse of a matrix of three rows."""
    minors = _cofactors(a)
    determinant = sum(x * y for x, y in zip(a[0], minors[0], strict=True))
    return [[minors[j][i] / determinant for j in range(3)] for i in range(3)]


def _eigenvalues() -> list[complex]:
    """Return the reciprocals of the roots of s^3 - 9 s^2 + 36 s - 60, the real one first."""
    s = 3.6
    for _ in range(60):
        s -= (((s - 9.0) * s + 36.0) * s - 60.0) / ((3.0 * s - 18.0) * s + 36.0)
    half, product = 0.5 * (9.0 - s), 60.0 / s
    pair = complex(half, math.sqrt(product - half * half))
    return [1.0 / s + 0j, 1.0 / pair, 1.0 / pair.conjugate()]


def _eigenvector(value: complex) -> list[complex]:
    """Return the eigenvector of A, its last entry 1: a row of cofactors of A - value."""
    shifted = [[complex(A[i, j]) - (value if i == j else 0.0) for j in range(3)] for i in range(3)]
    row = _cofactors(shifted)[0]
    return [entry / row[2] for entry in row]


_VALUES = _eigenvalues()
_VECTORS = [_eigenvector(value) for value in _VALUES]
_T = [[_VECTORS[s][i] for s in range(3)] for i in range(3)]
_T_INVERSE = _inverse(_T)
LAMBDA, T, T_INVERSE = np.array(_VALUES), np.array(_T), np.array(_T_INVERSE)
# A^2, of displacements by accelerations, and A^-1, of rates by changes.
A_SQUARED = np.array(
    [[sum(A[i, k] * A[k, j] for k in range(3)) for j in range(3)] for i in range(3)]
)
A_INVERSE = np.array(
    [[entry.real for entry in row] for row in _inverse([[complex(x) for x in row] for row in A])]
)


def _parts(first: complex, second: complex) -> list[float]:
    """Return the real weights of the three parts of the systems' values, from the weights of the
    first and the second system; the third has the conjugate of the second."""
    return [first.real, second.real, second.imag]


# The first system is real, the third has the weights of the second conjugated. With a, b, c of the
# systems as parts a, b + c, i (b - c), all weights are real: TO_STAGES[i] those by which a stage is
# the parts, OF_STAGES[:, k] those by which a stage enters the first and, real and imaginary, the
# others, OF_START and OF_TIME those of what is the same at all stages and of what grows with time,
# SHARES[i, k] those of the parts in what stage k does to stage i.
TO_STAGES = np.array([_parts(_T[i][0], _T[i][1]) for i in range(3)])
OF_STAGES = np.array([_parts(_T_INVERSE[0][k], _T_INVERSE[1][k]) for k in range(3)]).T.copy()
OF_START, OF_TIME = OF_STAGES.sum(axis=1), OF_STAGES @ C
SHARES = np.array(
    [
        [_parts(_T[i][0] * _T_INVERSE[0][k], _T[i][1] * _T_INVERSE[1][k]) for k in range(3)]
        for i in range(3)
    ]
)


def _lagrange(nodes: list[float], x: float) -> list[float]:
    """Return the weights of values at the nodes in the value of their interpolating polynomial at
    x."""
    return [
        math.prod((x - other) / (node - other) for other in nodes if other != node)
        for node in nodes
    ]


def _derivative_at_end() -> list[float]:
    """Return the weights of the stages' values in the derivative of their interpolating polynomial
    at the end of the step, times its length."""
    nodes = C.tolist()
    by_last = sum(1.0 / (1.0 - other) for other in nodes[:2])
    others = [
        (1.0 - nodes[1 - i]) / ((nodes[i] - nodes[1 - i]) * (nodes[i] - 1.0)) for i in range(2)
    ]
    return [*others, by_last]


# What the start of a step and its first two stages lead one to expect of its end.
EXPECTED = np.array(_lagrange([0.0, float(C[0]), float(C[1])], 1.0))
END_SLOPE = np.array(_derivative_at_end())


def _integrals() -> np.ndarray:
    """Return the polynomials of the integrals from 0 to x of the stages' Lagrange polynomials: rows
    of the coefficients of x, x^2, x^3."""
    rows = []
    for i in range(3):
        a, b = (float(C[j]) for j in range(3) if j != i)
        scale = (float(C[i]) - a) * (float(C[i]) - b)
        rows.append([a * b / scale, -0.5 * (a + b) / scale, 1.0 / (3.0 * scale)])
    return np.array(rows)


INTEGRALS = _integrals()
# Of the third difference of a step's accelerations times h^2, what counts as its local error.
ERROR_CONSTANT = 0.01


@jit
def of_parts(weights, p, s, t):
    """Return the sum of the parts with these weights."""
    return scaled(weights[0], p) + scaled(weights[1], s) + scaled(weights[2], t)


@jit
def parts_times(factor, s, t):
    """Return the parts b + c and i (b - c) after b is multiplied by a factor and c by its
    conjugate."""
    real, imaginary = factor.real, factor.imag
    return scaled(real, s) + scaled(imaginary, t), scaled(real, t) - scaled(imaginary, s)


@jit
def weight_until(i, x):
    """Return the weight of stage i [1] in the integral over the first share x of a step, 0 < x <=
    1."""
    return ((INTEGRALS[i, 2] * x + INTEGRALS[i, 1]) * x + INTEGRALS[i, 0]) * x


@jit
def weight_at(i, x):
    """Return the weight of stage i [1] in the value at the share x of a step."""
    return (3.0 * INTEGRALS[i, 2] * x + 2.0 * INTEGRALS[i, 1]) * x + INTEGRALS[i, 0]


@jit
def amplification(z):
    """Return the amplification of an oscillation in a step [1]; z = lambda h, its root times the
    step length."""
    above = 1.0 + z * (0.4 + z * 0.05)
    below = 1.0 - z * (0.6 - z * (0.15 - z * (1.0 / 60.0)))
    return modulus(above * inverse(below))
