"""Timoshenko shaft element in one plane (Nelson 1980).

Degrees of freedom of an element: deflection and slope at its first, then at its second node. A
circular shaft has the same matrices in both planes, so with complex coordinates
z = x + i y one real 4x4 matrix serves both.
"""

from __future__ import annotations

import math

import numpy as np

from ..machine.rotor import Material


def shear_coefficient(poisson: float) -> float:
    """Cowper's shear coefficient of a solid circular section [1] (Cowper 1966)."""
    return 6 * (1 + poisson) / (7 + 6 * poisson)


def _section(diameter: float) -> tuple[float, float]:
    return math.pi / 4 * diameter**2, math.pi / 64 * diameter**4


def _shear_ratio(material: Material, length: float, diameter: float) -> float:
    area, inertia = _section(diameter)
    kappa = shear_coefficient(material.poisson)
    return 12 * material.young * inertia / (kappa * material.shear * area * length**2)


def stiffness(material: Material, length: float, diameter: float) -> np.ndarray:
    """Stiffness matrix, shape (4, 4) [N/m, N, N.m]; length and diameter [m] (Nelson 1980)."""
    phi = _shear_ratio(material, length, diameter)
    _, inertia = _section(diameter)
    n = length
    a, b = (4 + phi) * n**2, (2 - phi) * n**2
    shape = np.array(
        [
            [12, 6 * n, -12, 6 * n],
            [6 * n, a, -6 * n, b],
            [-12, -6 * n, 12, -6 * n],
            [6 * n, b, -6 * n, a],
        ]
    )
    return material.young * inertia / (n**3 * (1 + phi)) * shape


def translational_mass(material: Material, length: float, diameter: float) -> np.ndarray:
    """Mass matrix of the translation, shape (4, 4) [kg, kg.m, kg.m2] (Nelson 1980)."""
    phi = _shear_ratio(material, length, diameter)
    area, _ = _section(diameter)
    n = length
    a = 13 / 35 + 7 * phi / 10 + phi**2 / 3
    b = (11 / 210 + 11 * phi / 120 + phi**2 / 24) * n
    c = 9 / 70 + 3 * phi / 10 + phi**2 / 6
    d = (13 / 420 + 3 * phi / 40 + phi**2 / 24) * n
    e = (1 / 105 + phi / 60 + phi**2 / 120) * n**2
    f = (1 / 140 + phi / 60 + phi**2 / 120) * n**2
    shape = np.array([[a, b, c, -d], [b, e, d, -f], [c, d, a, -b], [-d, -f, -b, e]])
    return material.density * area * n / (1 + phi) ** 2 * shape


def rotary_mass(material: Material, length: float, diameter: float) -> np.ndarray:
    """Mass matrix of the sections' tilting, shape (4, 4) [kg, kg.m, kg.m2] (Nelson 1980).

    The gyroscopic matrix of a shaft element is twice this one, a circular section's polar inertia
    being twice its diametral one.
    """
    phi = _shear_ratio(material, length, diameter)
    _, inertia = _section(diameter)
    n = length
    b = (1 / 10 - phi / 2) * n
    e = (2 / 15 + phi / 6 + phi**2 / 3) * n**2
    f = (1 / 30 + phi / 6 - phi**2 / 6) * n**2
    shape = np.array([[1.2, b, -1.2, b], [b, e, -b, -f], [-1.2, -b, 1.2, -b], [b, -f, -b, e]])
    return material.density * inertia / (n * (1 + phi) ** 2) * shape
