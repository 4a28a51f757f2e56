"""One-step implicit time integrators: parameters, stability, spectral radius.

All are the generalized-alpha family with paper A's signs (Zigulic et al. 2003, eqs 6 to 10;
Chung and Hulbert 1993), its misprints mended:

    q1 = q0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1)
    v1 = v0 + h ((1 - gamma) a0 + gamma a1)
    M ((1 - alpha_m) a1 + alpha_m a0) + (1 - alpha_f) r1 + alpha_f r0 = 0

with r = C v + K q - f. Paper B's alpha_B is alpha_m, its alpha_H is alpha_f, Abaqus' alpha is
-alpha_f.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class SchemeError(ValueError):
    """Parameters with which no implicit step can be made."""


class Scheme(NamedTuple):
    """Parameters of one integrator [1]: alpha_m, alpha_f, beta, gamma."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float

    @property
    def rho_infinity(self) -> float:
        """Spectral radius for h omega -> infinity [1]: above 1 the scheme is unstable."""
        return spectral_radius(self, math.inf)


def generalized_alpha(alpha_f: float, alpha_m: float) -> Scheme:
    """Generalized-alpha of second order (paper A, eqs 9 and 10; Chung and Hulbert 1993).

    beta is the square (1 - alpha_m + alpha_f)^2 / 4: read as the equality that paper A prints, its
    (10) gives no high-frequency damping at all.

    Raises `SchemeError` for parameters that leave no implicit equation.
    """
    for name, value in (("alpha_f", alpha_f), ("alpha_m", alpha_m)):
        if not math.isfinite(value) or value >= 1 or value < -1:
            raise SchemeError(f"{name} = {value:g}: must be at least -1 and below 1")
    difference = alpha_f - alpha_m
    if difference <= -1:
        raise SchemeError(f"alpha_f - alpha_m = {difference:g}: must be above -1 (beta would be 0)")
    return Scheme(alpha_m, alpha_f, (1 + difference) ** 2 / 4, 0.5 + difference)


def newmark() -> Scheme:
    """Newmark's average acceleration, beta = 1/4, gamma = 1/2 (Newmark 1959)."""
    return generalized_alpha(0.0, 0.0)


def hht(alpha_f: float) -> Scheme:
    """Hilber, Hughes and Taylor 1977; alpha_f = sqrt(2) - 1 is Abaqus' moderate dissipation."""
    return generalized_alpha(alpha_f, 0.0)


def wbz(alpha_m: float) -> Scheme:
    """Wood, Bossak and Zienkiewicz 1980; damps for alpha_m < 0, unstable for alpha_m > 0."""
    return generalized_alpha(0.0, alpha_m)


def chung_hulbert(rho: float) -> Scheme:
    """Generalized-alpha with the least low-frequency damping for its rho at infinity [1].

    Raises `SchemeError` unless 0 <= rho <= 1.
    """
    if not 0 <= rho <= 1:
        raise SchemeError(f"rho = {rho:g}: must be between 0 and 1")
    return generalized_alpha(rho / (rho + 1), (2 * rho - 1) / (rho + 1))


def amplification(scheme: Scheme, w: float, xi: float = 0.0) -> np.ndarray:
    """Amplification matrix of an oscillator over one step, shape (3, 3), for (q, h v, h^2 a).

    w = omega h [rad], which may be infinite; xi: physical damping ratio [1]. (Paper B, eq. 15.)
    """
    am, af, beta, gamma = scheme
    # Divided by w^2, so that infinitely stiff needs no case of its own.
    inertia = 0.0 if math.isinf(w) else 1 / w**2 if w else 1.0
    damping = 0.0 if math.isinf(w) else 2 * xi / w if w else 0.0
    stiffness = 1.0 if w else 0.0
    left = np.array(
        [
            [1, 0, -beta],
            [0, 1, -gamma],
            [stiffness * (1 - af), damping * (1 - af), inertia * (1 - am)],
        ]
    )
    right = np.array(
        [[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [-stiffness * af, -damping * af, -inertia * am]]
    )
    return np.linalg.solve(left, right)


def spectral_radius(scheme: Scheme, w: float, xi: float = 0.0) -> float:
    """Largest modulus of the amplification matrix's eigenvalues [1] (paper B, eq. 16)."""
    if math.isinf(w):
        difference = scheme.alpha_f - scheme.alpha_m
        return max(
            abs(difference - 1) / (difference + 1), abs(scheme.alpha_f / (1 - scheme.alpha_f))
        )
    return float(np.abs(np.linalg.eigvals(amplification(scheme, w, xi))).max())


def is_unconditionally_stable(scheme: Scheme) -> bool:
    """Whether no undamped oscillation grows at any step length (paper A, eq. 10)."""
    return scheme.alpha_m <= scheme.alpha_f <= 0.5
