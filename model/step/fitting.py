"""Generalized-alpha fitted to the characteristic frequency of the motion.

A rotor's motion is nearly harmonic with the speed of rotation, q ~ exp(i Omega t). For such a
motion the scheme relates accelerations, velocities and displacements by factors known in closed
form; with the mass and the damping of a step divided by them, a steady whirl is integrated with its
exact period (trigonometric fitting: Gautschi 1961). Both factors are 1 + O((Omega h)^2), so the
order of the scheme remains, and so do static equilibria.

For a slower motion the mass would be wrong by the same factor: a rotor that falls, fitted to its
rotation, would fall with the wrong acceleration. So the scheme is fitted to the motion's own
characteristic frequency (`characteristic_frequency_after`): that of the rotation where the rotor
whirls synchronously, and its lowest natural frequency where it swings freely below it.
"""

import math
from typing import NamedTuple

from ..kernels.functions import direction, inverse
from ..kernels.jit import jit

SLOWEST = 1e-4  # Omega h [rad] below which the factors are 1 to rounding
# The characteristic frequency follows a faster and a slower motion over these angles [rad]: after
# an impact the rotor falls freely, and at the frequency of the impact its mass would be wrong.
FASTER, SLOWER = 2.0 * math.pi, 1.0


class Fit(NamedTuple):
    """Real factors [1] of a step's mass and of its damping and gyroscopic terms."""

    mass: float
    damping: float


@jit
def unfitted():
    """Return the factors of the unchanged scheme."""
    return Fit(1.0, 1.0)


@jit
def fitted(scheme, w):
    """Return the `Fit` with which the scheme reproduces a whirl of w = Omega h [rad] exactly."""
    am, af, beta, gamma = scheme
    if abs(w) < SLOWEST:
        return Fit(1.0, 1.0)
    z = direction(w)
    velocity = (1.0 - gamma + gamma * z) * inverse(z - 1.0)  # v over h a
    displacement = (velocity + 0.5 - beta + beta * z) * inverse(z - 1.0)  # q over h^2 a
    balance = (am + (1.0 - am) * z) * inverse(af + (1.0 - af) * z)  # v_dot over a
    mass = -w * w * displacement * inverse(balance)
    return Fit(mass.real, (1j * w * displacement * inverse(velocity)).real)


@jit
def characteristic_frequency_after(structure, omega, h, measures, before):
    """Return the square of the angular frequency of the motion [rad2/s2] after a step of length h
    [s], at most that of the rotation or of the machine's slowest motion, whichever is faster;
    measures: of the step (`error_control.measure`); before: after the last step.

    For q ~ exp(i p t), and for a swing along a line as well, p^2 = (|jerk|^2 + p^2 |a|^2) over
    (|a|^2 + p^2 |v|^2), weighted with the masses; p is 0 in a free fall.
    """
    a, v = measures.acceleration, measures.velocity
    above, below = measures.change / (h * h) + before * a, a + before * v
    slowest = structure.numbers[0].slowest
    most = max(omega * omega, slowest * slowest)
    if below == 0.0:
        return min(most, before)
    seen = min(most, above / below)
    radians = FASTER if seen > before else SLOWER
    part = min(1.0, h * math.sqrt(most) / radians) if before > 0.0 else 1.0
    return min(most, before + part * (seen - before))
