"""One-step implicit time integrators: the generalized-alpha family and its parameters.

With paper A's signs (Zigulic et al. 2003, eqs 6 to 10; Chung and Hulbert 1993), its misprints
corrected:

    q1 = q0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1)
    v1 = v0 + h ((1 - gamma) a0 + gamma a1)
    M ((1 - alpha_m) a1 + alpha_m a0) + (1 - alpha_f) r1 + alpha_f r0 = 0

with r = C v + K q - f. Paper B's (Ishikawa and Koguchi) alpha_B is alpha_m, its alpha_H is alpha_f,
Abaqus' ALPHA is -alpha_f.
"""

from typing import NamedTuple

from ..kernels.jit import jit


class Scheme(NamedTuple):
    """Parameters of one integrator [1]: alpha_m, alpha_f, beta, gamma."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float


@jit
def second_order(alpha_f, alpha_m):
    """Return the member of second order with these alphas, for any values."""
    difference = alpha_f - alpha_m
    root = 1.0 + difference
    return Scheme(alpha_m, alpha_f, root * root / 4, 0.5 + difference)


@jit
def alphas(rho):
    """Return alpha_f and alpha_m with the least low-frequency damping for a rho at infinity."""
    return rho / (rho + 1.0), (2.0 * rho - 1.0) / (rho + 1.0)
