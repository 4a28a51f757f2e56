"""Timoshenko shaft element of a circular section that may taper and be hollow, in one plane.

Degrees of freedom: deflection w and slope psi at its left, then at its right node. A circular shaft
has the same matrices in both planes, so with complex coordinates z = x + i y one real 4x4 matrix
serves both. The shape functions are those of a uniform element with the section's mean shear ratio
(Nelson 1980); the integrals over them take the section as it changes, exactly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..parts.shaft import Section

# Points at which polynomials of degree 9 are integrated exactly: shape functions squared, of
# degree 6, times an area, or of degree 4 times a moment of area of degree 4.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


class Element(NamedTuple):
    """Matrices of a shaft element, each of shape (4, 4): mass of the translation, mass of the
    sections' tilting [kg, kg.m, kg.m2], stiffness, elastic and that of the axial force [N/m, N,
    N.m].

    The gyroscopic matrix is twice that of the tilting, a circular section's polar inertia being
    twice its diametral one.
    """

    translation: np.ndarray
    tilting: np.ndarray
    stiffness: np.ndarray
    tension: np.ndarray


def shear_coefficient(poisson: float, ratio: float = 0.0, name: str = "cowper") -> float:
    """Shear coefficient of a circular section [1]; ratio: bore over diameter; name: `cowper`
    (Cowper 1966), `hutchinson` (Hutchinson 2001), or `ross-hutchinson`, ROSS 2's reading of it,
    which lacks a factor 1 + poisson."""
    ring = (1 + ratio**2) ** 2
    if name in ("hutchinson", "ross-hutchinson"):
        solid = 7 + 12 * poisson + 4 * poisson**2
        hollow = 4 * (5 + 6 * poisson + 2 * poisson**2)
        factor = (1 + poisson) ** (2 if name == "hutchinson" else 1)
        return 6 * factor * ring / (solid * ring + hollow * ratio**2)
    return 6 * (1 + poisson) * ring / ((7 + 6 * poisson) * ring + (20 + 12 * poisson) * ratio**2)


def _area_and_moment(outer: np.ndarray, bore: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Area [m2] and second moment of area [m4] of sections."""
    return math.pi / 4 * (outer**2 - bore**2), math.pi / 64 * (outer**4 - bore**4)


def shaft_element(section: Section) -> Element:
    """The matrices of the shaft between two nodes (Nelson 1980)."""
    material, length = section.material, section.length
    x = (1 + _POINTS) / 2
    weight = _WEIGHTS / 2 * length
    outer = section.outer_left + x * (section.outer_right - section.outer_left)
    bore = section.bore_left + x * (section.bore_right - section.bore_left)
    area, moment = _area_and_moment(outer, bore)
    shear = _shear_stiffness(section)
    phi = _shear_ratio(section, shear)
    one = np.ones_like(x)
    deflection = np.array(
        [
            1 - 3 * x**2 + 2 * x**3 + phi * (1 - x),
            length * (x - 2 * x**2 + x**3 + phi / 2 * (x - x**2)),
            3 * x**2 - 2 * x**3 + phi * x,
            length * (-(x**2) + x**3 - phi / 2 * (x - x**2)),
        ]
    ) / (1 + phi)
    slope = np.array(
        [
            6 / length * (x**2 - x),
            1 - 4 * x + 3 * x**2 + phi * (1 - x),
            6 / length * (x - x**2),
            3 * x**2 - 2 * x + phi * x,
        ]
    ) / (1 + phi)
    curvature = np.array(
        [6 / length * (2 * x - 1), 6 * x - 4 - phi, 6 / length * (1 - 2 * x), 6 * x - 2 + phi]
    ) / ((1 + phi) * length)
    # deflection' - slope, the same along the element
    strain = np.outer([-1 / length, -0.5, 1 / length, -0.5], one) * phi / (1 + phi)

    def integral(factor: np.ndarray, shape: np.ndarray) -> np.ndarray:
        return (shape * (factor * weight)) @ shape.T

    return Element(
        translation=integral(material.density * area, deflection),
        tilting=integral(material.density * moment, slope),
        stiffness=integral(material.young * moment, curvature) + integral(shear * area, strain),
        tension=integral(section.axial_force * one, slope + strain),
    )


def _shear_stiffness(section: Section) -> float:
    """kappa G [Pa] of the section's middle; of one that shear does not bend, 0."""
    if section.shear == "rigid":
        return 0.0
    outer = section.outer_left + section.outer_right
    ratio = (section.bore_left + section.bore_right) / outer
    return (
        shear_coefficient(section.material.poisson, ratio, section.shear) * section.material.shear
    )


def _shear_ratio(section: Section, shear: float) -> float:
    """phi = 12 E I / (kappa G A L^2), deflection by shear over that by bending [1].

    Where diameters change, of the mean area and moment, or, as ROSS has it, of those at the middle.
    """
    if section.shear == "rigid":
        return 0.0
    x = np.array([0.5]) if section.taper == "middle" else (1 + _POINTS) / 2
    weight = np.array([1.0]) if section.taper == "middle" else _WEIGHTS / 2
    outer = section.outer_left + x * (section.outer_right - section.outer_left)
    bore = section.bore_left + x * (section.bore_right - section.bore_left)
    area, moment = _area_and_moment(outer, bore)
    bending = 12 * section.material.young * (weight @ moment)
    return bending / (shear * (weight @ area) * section.length**2)
