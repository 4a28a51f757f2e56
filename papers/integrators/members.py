"""Members of the generalized-alpha family (`model.schemes.family`), classical and optimal ones, and
their properties."""

import cmath
import math

import numpy as np
from numpy.polynomial import polynomial
from rotor_fmu.model.errors import InputError
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.quantities import between
from rotor_fmu.model.schemes import family

from .spectral import Coefficients, balance

# Past it the squares and products of the parameters lose their meaning.
LARGEST = 1e6
ALPHA, RHO = between(-1.0, 1.0, is_below=True), between(0.0, 1.0)
_ROUNDING = 1e-12


class SchemeError(InputError):
    """Parameters with which no step can be made."""


class Scheme(family.Scheme):
    """Parameters of one integrator, with the properties of a `spectral.Method`."""

    __slots__ = ()

    @property
    def rho_infinity(self) -> float:
        """Spectral radius for h omega -> infinity [1]: above 1 the scheme is unstable."""
        return max(abs(root) for root in roots_at_infinity(self))

    def amplification(self, w: float, xi: float = 0.0) -> np.ndarray:
        """See `amplification`."""
        return amplification(self, w, xi)

    def characteristic(self) -> tuple[Coefficients, Coefficients, Coefficients]:
        """See `spectral.Method`."""
        am, af, beta, gamma = self
        force = (1, 1 - af)
        return (
            (0, 0, 1, 1 - am),
            tuple(polynomial.polymul((0, 1, gamma), force)),
            tuple(polynomial.polymul((1, 0.5 + gamma, beta), force)),
        )


def general(alpha_f: float, alpha_m: float, beta: float, gamma: float) -> Scheme:
    """Return any member of the family, stable and consistent or not.

    Raises `SchemeError` for parameters that leave no implicit equation: an alpha outside [-1, 1),
    beta <= 0; or that are above 1e6.
    """
    _check_alphas(alpha_f, alpha_m)
    if not 0 < beta <= LARGEST:
        raise SchemeError(
            f"beta = {beta:g}: must be above 0 in an implicit step and at most {LARGEST:g}"
        )
    if not abs(gamma) <= LARGEST:
        raise SchemeError(f"gamma = {gamma:g}: must be between {-LARGEST:g} and {LARGEST:g}")
    return Scheme(alpha_m, alpha_f, beta, gamma)


def _check_alphas(alpha_f: float, alpha_m: float) -> None:
    for name, value in (("alpha_f", alpha_f), ("alpha_m", alpha_m)):
        if not ALPHA.allows(value):
            raise SchemeError(f"{name} = {value:g}: {ALPHA.words}")


def generalized_alpha(alpha_f: float, alpha_m: float) -> Scheme:
    """Generalized-alpha of second order (paper A, eqs 9 and 10; Chung and Hulbert 1993).

    beta is the square (1 - alpha_m + alpha_f)^2 / 4: read as the equality that paper A prints, its
    (10) gives no high-frequency damping at all.

    Raises `SchemeError` for parameters that leave no implicit equation.
    """
    _check_alphas(alpha_f, alpha_m)
    difference = alpha_f - alpha_m
    if difference <= -1:
        raise SchemeError(f"alpha_f - alpha_m = {difference:g}: must be above -1 (beta would be 0)")
    return Scheme(*interpreted(family.second_order)(alpha_f, alpha_m))


def newmark(beta: float = 0.25, gamma: float = 0.5) -> Scheme:
    """Newmark 1959: average acceleration by default; linear acceleration is beta = 1/6.

    Raises `SchemeError` for beta <= 0 and for a parameter above 1e6.
    """
    return general(0.0, 0.0, beta, gamma)


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
    if not RHO.allows(rho):
        raise SchemeError(f"rho = {rho:g}: {RHO.words}")
    return generalized_alpha(*interpreted(family.alphas)(rho))


def amplification(scheme: Scheme, w: float, xi: float = 0.0) -> np.ndarray:
    """Return the amplification matrix of an oscillator over one step, shape (3, 3), for (q, h v,
    h^2 a).

    w = omega h [rad], which may be infinite; xi: physical damping ratio [1]. (Paper B, eq. 15.)
    """
    am, af, beta, gamma = scheme
    inertia, damping, stiffness = balance(w, xi)
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


def roots_at_infinity(scheme: Scheme) -> tuple[complex, complex, complex]:
    """Return the eigenvalues of the amplification matrix for h omega -> infinity [1].

    The pair of beta z^2 + (1/2 + gamma - 2 beta) z + (1/2 - gamma + beta) = 0 and
    -alpha_f / (1 - alpha_f). With D = alpha_f - alpha_m, gamma = 1/2 + D and beta = (1 + D)^2 / 4
    the pair is (D - 1) / (D + 1) twice.
    """
    _, af, beta, gamma = scheme
    discriminant = (0.5 + gamma) ** 2 - 4 * beta
    # a double root must not be torn apart by the square root of a rounding error
    if abs(discriminant) < _ROUNDING:
        discriminant = 0.0
    root = cmath.sqrt(discriminant)
    middle = 2 * beta - 0.5 - gamma
    return (middle - root) / (2 * beta), (middle + root) / (2 * beta), complex(-af / (1 - af))


def rebound(scheme: Scheme) -> float:
    """Return the speed of a free node after it touched a wall for one step, over its speed before
    [1].

    -v_{n+2} / v_n with d_{n+1} = d_n, a_n = 0 and the contact force acting at t_{n+1} alone: 1 is
    eq. (12), above 1 an impact creates energy.
    """
    am, _, beta, gamma = scheme
    return (1 - gamma * am / (1 - am)) / beta - 1


MODERATE_DISSIPATION = hht(math.sqrt(2) - 1)
TRANSIENT_FIDELITY = hht(0.05)
