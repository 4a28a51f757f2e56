"""The effect of a time integrator on one oscillation: growth, damping, period, order, stability.

One step of a free oscillator (omega, damping ratio xi) multiplies its state by the amplification
matrix A (Ishikawa and Koguchi, eq. 15), a function of w = omega h alone; w / 2 pi is their dt/T.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.polynomial import polynomial

# Coefficients of the stability conditions below this are the rounding errors of a zero.
_ROUNDING = 1e-12
# Ten steps a period [rad].
SLOW_W = 2 * math.pi * 0.1
# Where the order of accuracy is measured [rad]: its halving still stands clear of rounding.
_ORDER_W = 1e-3
# The range of w [rad] in which the least spectral radius is looked for, ever closer.
_FIGURE_1 = (2 * math.pi * 0.01, 2 * math.pi * 100)
_REFINEMENTS = 4

Coefficients = tuple[float, ...]


class Method(Protocol):
    """A linear time integrator, as this module sees it."""

    @property
    def rho_infinity(self) -> float:
        """Spectral radius for w -> infinity [1]."""

    def amplification(self, w: float, xi: float = 0.0) -> np.ndarray:
        """Amplification matrix over one step, shape (n, n); w [rad] may be infinite, xi [1]."""

    def characteristic(self) -> tuple[Coefficients, Coefficients, Coefficients]:
        """Polynomials p0, p1, p2 in x = lambda - 1, constant term first, such that
        p0 + 2 xi w p1 + w^2 p2 vanishes at the eigenvalues lambda of A."""


def spectral_radius(method: Method, w: float, xi: float = 0.0) -> float:
    """Return the largest modulus of the amplification matrix's eigenvalues [1] (paper B, eq. 16).

    w = omega h [rad], which may be infinite; xi: physical damping ratio [1].
    """
    if math.isinf(w):
        return method.rho_infinity
    return float(np.abs(np.linalg.eigvals(method.amplification(w, xi))).max())


def least_spectral_radius(method: Method, xi: float = 0.0) -> tuple[float, float]:
    """Return where the spectral radius is smallest, w [rad], and what it is there [1].

    w is infinite where the radius falls to the end, 0 where it nowhere falls below 1.
    """
    low, high = _FIGURE_1
    for _ in range(_REFINEMENTS):
        grid = np.geomspace(low, high, 121)
        rho = [spectral_radius(method, w, xi) for w in grid]
        k = int(np.argmin(rho))
        low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    if method.rho_infinity <= rho[k] + 1e-6:
        return math.inf, method.rho_infinity
    if rho[k] >= 1 - 1e-9:
        return 0.0, 1.0
    return float(grid[k]), float(rho[k])


def principal_root(method: Method, w: float, xi: float = 0.0) -> complex:
    """ln(lambda) of the oscillation's own eigenvalue, imaginary part in (0, pi); 0 < w < infinity.

    Exact would be w (-xi + i sqrt(1 - xi^2)). NaN where all eigenvalues are real: the oscillation
    has gone. Raises `ValueError` unless 0 <= xi < 1.
    """
    if not 0 <= xi < 1:
        raise ValueError(f"xi = {xi:g}: must be at least 0 and below 1")
    terms = _joined(method, w, xi)
    # In x / w the roots stay apart however small w is; the eigenvalues of A all meet at 1.
    scaled = terms * w ** np.arange(-2.0, len(terms) - 2.0)
    x = w * polynomial.polyroots(np.trim_zeros(scaled, "b"))
    # The pair of a double real root can come out with an imaginary part of rounding errors.
    pair = x[x.imag > 1e-7 * np.abs(x)]
    if len(pair) == 0:
        return complex(math.nan, math.nan)
    re, im = float(pair[0].real), float(pair[0].imag)
    return complex(math.log1p(2 * re + re**2 + im**2) / 2, math.atan2(im, 1 + re))


def damping_ratio(method: Method, w: float, xi: float = 0.0) -> float:
    """Return the damping ratio that the computed oscillation shows, -ln|lambda| / arg(lambda) [1].

    The amplitude falls by exp(-2 pi ratio) in each period; exact would be xi / sqrt(1 - xi^2).
    (Hilber, Hughes and Taylor 1977.) NaN where nothing oscillates.
    """
    root = principal_root(method, w, xi)
    return -root.real / root.imag


def numerical_damping(method: Method, w: float, xi: float = 0.0) -> float:
    """Return the damping ratio that the method adds [1]; negative where it feeds the
    oscillation."""
    return damping_ratio(method, w, xi) - xi / math.sqrt(1 - xi**2)


def period_elongation(method: Method, w: float, xi: float = 0.0) -> float:
    """Return the computed period over the exact one, less 1 [1]; NaN where nothing oscillates."""
    return w * math.sqrt(1 - xi**2) / principal_root(method, w, xi).imag - 1


def order_of_accuracy(method: Method, xi: float = 0.05) -> float:
    """Return the power of h with which decay and frequency converge [1], measured between two small
    steps.

    The oscillator has some damping by default: without it Newmark's beta = 1/12 looks better than
    it is.
    """
    exact = complex(-xi, math.sqrt(1 - xi**2))
    coarse, fine = (
        abs(principal_root(method, w, xi) / w - exact) for w in (_ORDER_W, _ORDER_W / 2)
    )
    return math.log2(coarse / fine)


def is_stable(method: Method, w: float, xi: float = 0.0) -> bool:
    """Return whether no oscillation of this w [rad], which may be infinite, grows (paper B, eq.
    17)."""
    if math.isinf(w):
        return method.rho_infinity <= 1 + _ROUNDING
    return all(
        polynomial.polyval(w, condition) >= -_ROUNDING for condition in _conditions(method, xi)
    )


def stability_limit(method: Method, xi: float = 0.0) -> float:
    """Return the largest w [rad] up to which nothing grows: 0 for never, infinity for always.

    Exact: the roots of the Routh-Hurwitz conditions after lambda = (1 + s) / (1 - s).
    """
    edges = {0.0}
    for condition in _conditions(method, xi):
        roots = polynomial.polyroots(condition)
        is_real = np.abs(roots.imag) <= 1e-9 * np.abs(roots)
        edges.update(float(root) for root in roots.real[is_real & (roots.real > 0)])
    ordered = sorted(edges)
    inside = [(a + b) / 2 for a, b in pairwise(ordered)]
    inside.append(2 * ordered[-1] + 1)
    for edge, w in zip(ordered, inside, strict=True):
        if not is_stable(method, w, xi):
            return edge
    return math.inf


@dataclass(frozen=True)
class Survey:
    """One method in numbers; w [rad].

    limit: largest stable w; least: w of the smallest spectral radius, and that radius [1]; order:
    order of accuracy [1]; damping, elongation: numerical damping ratio and period elongation at
    `SLOW_W` [1].
    """

    limit: float
    least: tuple[float, float]
    order: float
    damping: float
    elongation: float


def survey(method: Method, xi: float = 0.0) -> Survey:
    """Return all properties that do not depend on a user's frequency and step; xi: damping
    ratio."""
    return Survey(
        limit=stability_limit(method, xi),
        least=least_spectral_radius(method, xi),
        order=order_of_accuracy(method),
        damping=numerical_damping(method, SLOW_W, xi),
        elongation=period_elongation(method, SLOW_W, xi),
    )


def balance(w: float, xi: float) -> tuple[float, float, float]:
    """Return an oscillator's 1, 2 xi w, w^2 up to a common factor with which w may be 0 or
    infinite."""
    if math.isinf(w):
        return 0.0, 0.0, 1.0
    if w > 1:
        return 1 / w**2, 2 * xi / w, 1.0
    return 1.0, 2 * xi * w, w**2


def _joined(method: Method, w: float, xi: float) -> np.ndarray:
    inertia, damping, stiffness = method.characteristic()
    total = polynomial.polyadd(inertia, np.multiply(2 * xi * w, damping))
    return polynomial.polyadd(total, np.multiply(w**2, stiffness))


def _conditions(method: Method, xi: float) -> list[np.ndarray]:
    """Return the polynomials in w, none of which may be negative if no root is to lie outside the
    circle."""
    parts = method.characteristic()
    degree = max(len(part) for part in parts) - 1
    inertia, damping, stiffness = (_in_half_plane(part, degree) for part in parts)
    # coefficient k of s as a polynomial in w
    c = [np.array([inertia[k], 2 * xi * damping[k], stiffness[k]]) for k in range(degree + 1)]
    if degree == 3:
        c.append(polynomial.polysub(polynomial.polymul(c[2], c[1]), polynomial.polymul(c[3], c[0])))
    return [_clean(condition) for condition in c]


def _in_half_plane(part: Coefficients, degree: int) -> np.ndarray:
    """Return the coefficients in s of (1 - s)^degree part(x), x = 2 s / (1 - s)."""
    total = np.zeros(degree + 1)
    for k, coefficient in enumerate(part):
        term = polynomial.polymul(
            polynomial.polypow((0.0, 2.0), k), polynomial.polypow((1.0, -1.0), degree - k)
        )
        total[: len(term)] += coefficient * term
    return total


def _clean(condition: np.ndarray) -> np.ndarray:
    """Return the polynomial without rounding errors and without common powers of w, which is
    positive."""
    retained = np.trim_zeros(np.where(np.abs(condition) < _ROUNDING, 0.0, condition))
    return retained if len(retained) else np.zeros(1)
