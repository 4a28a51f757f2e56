"""Classical integrators outside the generalized-alpha family, as paper B's Figure 1 shows them.

They turn no rotor here: they stand beside the others in the survey of spectral radii.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial

from papers.integrators.members import LARGEST, SchemeError
from papers.integrators.spectral import Coefficients, balance


@dataclass(frozen=True)
class CentralDifference:
    """Explicit central differences; with damping the velocity is (d_{n+1} - d_{n-1}) / 2h.

    Stable up to w = 2, that is dt/T = 1/pi, whatever the damping.
    """

    rho_infinity = math.inf

    def amplification(self, w: float, xi: float = 0.0) -> np.ndarray:
        """Amplification matrix, shape (2, 2), for (d_n, d_{n-1}); w = omega h [rad], xi [1].

        Raises `SchemeError` for infinite w: an explicit step of that length has no matrix.
        """
        if math.isinf(w):
            raise SchemeError("w = inf: must be finite for central difference")
        left = 1 + xi * w
        return np.array([[(2 - w**2) / left, -(1 - xi * w) / left], [1, 0]])

    def characteristic(self) -> tuple[Coefficients, Coefficients, Coefficients]:
        """See `spectral.Method`."""
        return (0, 0, 1), (0, 1, 0.5), (1, 1)


@dataclass(frozen=True)
class Houbolt:
    """Houbolt 1950: acceleration and velocity from a cubic through four displacements."""

    rho_infinity = 0.0

    def amplification(self, w: float, xi: float = 0.0) -> np.ndarray:
        """Amplification matrix, shape (3, 3), for (d_n, d_{n-1}, d_{n-2}); w [rad], xi [1]."""
        inertia, damping, stiffness = balance(w, xi)
        left = 2 * inertia + 11 / 6 * damping + stiffness
        return np.array(
            [
                [
                    (5 * inertia + 3 * damping) / left,
                    -(4 * inertia + 1.5 * damping) / left,
                    (inertia + damping / 3) / left,
                ],
                [1, 0, 0],
                [0, 1, 0],
            ]
        )

    def characteristic(self) -> tuple[Coefficients, Coefficients, Coefficients]:
        """See `spectral.Method`."""
        return (0, 0, 1, 2), (0, 1, 5 / 2, 11 / 6), (1, 3, 3, 1)


@dataclass(frozen=True)
class WilsonTheta:
    """Wilson's method: the acceleration is linear in time up to t_n + theta h, where it balances.

    theta [1]: 1 is linear acceleration; unconditionally stable from (1 + sqrt 3)/2 = 1.366 on.
    Raises `SchemeError` unless theta is above 0 and not past all reason.
    """

    theta: float = 1.4

    def __post_init__(self) -> None:
        if not 0 < self.theta <= LARGEST:
            raise SchemeError(
                f"theta = {self.theta:g}: must be above 0 and at most {LARGEST:g} (1.4 is usual)"
            )

    @property
    def rho_infinity(self) -> float:
        """Spectral radius for w -> infinity [1]."""
        return float(np.abs(1 + polynomial.polyroots(self.characteristic()[2])).max())

    def amplification(self, w: float, xi: float = 0.0) -> np.ndarray:
        """Amplification matrix, shape (3, 3), for (d, h v, h^2 a); w = omega h [rad], xi [1]."""
        theta = self.theta
        inertia, damping, stiffness = balance(w, xi)
        # the balance at t_n + theta h, solved for h^2 a there, as a row over (d, h v, h^2 a)
        left = inertia + damping * theta / 2 + stiffness * theta**2 / 6
        ahead = -np.array(
            [
                stiffness,
                damping + stiffness * theta,
                damping * theta / 2 + stiffness * theta**2 / 3,
            ]
        )
        a = ahead / (left * theta) + np.array([0, 0, 1 - 1 / theta])
        v = np.array([0, 1, 0.5]) + a / 2
        d = np.array([1, 1, 1 / 3]) + a / 6
        return np.array([d, v, a])

    def characteristic(self) -> tuple[Coefficients, Coefficients, Coefficients]:
        """See `spectral.Method`."""
        theta = self.theta
        return (
            (0, 0, 1, theta),
            (0, 1, 0.5 + theta, theta**2 / 2),
            (1, 1 + theta, 1 / 6 + theta / 2 + theta**2 / 2, theta**3 / 6),
        )
