"""The textbook machines of these tests, and closed forms of them."""

import math

import numpy as np

import rotor_fmu as rf

from ..parts.machines import bearings, rigid

OMEGA, CLEARANCE, RADIUS = 100.0, 1e-3, 0.05
ZETA, BETA, MU, E = 0.1, 4.0, 0.05, 0.5  # of T1


def jeffcott(zeta=ZETA, beta=BETA, mu=MU, e=E, gap=CLEARANCE, v_s=1e-5, c=0.0):
    """A rigid disc of 1 kg in a stator, natural frequency OMEGA."""
    return rf.parse(
        rigid(
            parts=bearings(OMEGA**2, 2 * zeta * OMEGA)
            + f"""
[[contact]]
node = 2
journal_radius = {RADIUS}
clearance = {gap}
mu = {mu}
k = {beta * OMEGA**2}
c = {c}
v_s = {v_s}
[[sensor]]
node = 2
name = "disc"
[[unbalance]]
node = 2
amount = {e * gap}
"""
        )
    )


FAINT = 0.195  # eccentricity in clearances whose whirl, e / (2 zeta) at most, touches nothing
FAINT_RUB = jeffcott(e=FAINT, mu=0.0)


def sagging(c=0.0, gravity=9.81, k=4 * OMEGA**2, mu=0.0, e=0.3):
    """A Jeffcott rotor whose weight nearly closes the clearance: half of each turn it rubs."""
    return rf.parse(
        rigid(
            gravity=gravity,
            parts=bearings(OMEGA**2, 0.1 * OMEGA)
            + f"""
[[contact]]
node = 2
journal_radius = 0.05
clearance = {CLEARANCE}
mu = {mu}
k = {k}
c = {c}
[[sensor]]
node = 2
name = "disc"
[[unbalance]]
node = 2
amount = {e * CLEARANCE}
""",
        )
    )


def rub(omega, mu=MU, sign=1):
    """Radius of the synchronous full annular rub, the larger or the smaller."""
    s, d = 1 + BETA - omega**2, 2 * ZETA * omega + mu * BETA
    a, b = s * s + d * d, BETA * (s + mu * d)
    c = (1 + mu**2) * BETA**2 - (E * omega**2) ** 2
    return (b + sign * math.sqrt(b * b - a * c)) / a


def growth(omega, r, mu=MU):
    """The four exponents of its stability, real parts, the largest first."""
    x = np.poly1d([1, 0])
    p, q = (
        (x + i * omega) ** 2
        + 2 * ZETA * (x + i * omega)
        + 1
        + BETA * (1 + i * mu) * (1 - 1 / (2 * r))
        for i in (1j, -1j)
    )
    return -np.sort(-(p * q - BETA**2 * (1 + mu**2) / (4 * r * r)).roots.real)


def rolling(v, beta=20.0):
    """Whirl and radius of rolling at the surface speed v."""
    omega = (math.sqrt(beta**2 + 4 * v * v * (1 + beta)) - beta) / (2 * v)
    return omega, v / omega
