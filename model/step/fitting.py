"""Generalized-alpha fitted to the speed of rotation.

A rotor's motion is nearly harmonic with the speed of rotation, q ~ exp(i Omega t). For such a
motion the scheme relates accelerations, velocities and displacements by factors known in closed
form; with the mass and the damping of a step divided by them, a steady whirl comes out with its
own period (trigonometric fitting: Gautschi 1961). Both factors are 1 + O((Omega h)^2), so the order
stays, and so does what holds at rest.
"""

from __future__ import annotations

from typing import NamedTuple

from ..kernels.compiled import compiled
from ..kernels.functions import direction, inverse

SLOWEST = 1e-4  # Omega h [rad] below which the factors are 1 to rounding


class Fit(NamedTuple):
    """Real factors [1] of a step's mass and of its damping and gyroscopic terms."""

    mass: float
    damping: float


@compiled
def unfitted():
    """The scheme as it is."""
    return Fit(1.0, 1.0)


@compiled
def fitted(scheme, w):
    """`Fit` with which the scheme takes a whirl of w = Omega h [rad] over a step as it is."""
    am, af, beta, gamma = scheme
    if abs(w) < SLOWEST:
        return Fit(1.0, 1.0)
    z = direction(w)
    velocity = (1.0 - gamma + gamma * z) * inverse(z - 1.0)  # v over h a
    displacement = (velocity + 0.5 - beta + beta * z) * inverse(z - 1.0)  # q over h^2 a
    balance = (am + (1.0 - am) * z) * inverse(af + (1.0 - af) * z)  # v_dot over a
    mass = -w * w * displacement * inverse(balance)
    return Fit(mass.real, (1j * w * displacement * inverse(velocity)).real)
