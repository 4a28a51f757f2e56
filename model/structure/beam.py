"""Timoshenko shaft element of a circular section that may taper and be hollow, in one plane.

Degrees of freedom: deflection w and slope psi at its left, then at its right node. A circular shaft
has the same matrices in both planes, so with complex coordinates z = x + i y one real 4x4 matrix
serves both. The shape functions are those of static deflection, so that the stiffness is exact: of
a cylinder Nelson's polynomials (1980); of an element that tapers or has layers the integrals of
bending and shear under unit forces at its end (force method; Przemieniecki 1968, ch. 5). As in
ROSS, or on demand, each of its layers uses the polynomials of a cylinder with its own middle or
mean shear ratio instead; the element is then of second order or less.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..parts.shaft import Section

# Points at which polynomials of degree 9 are integrated exactly: shape functions squared, of
# degree 6, times an area, or of degree 4 times a moment of area of degree 4.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


def _integration(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return Gauss points in (0, 1) and their weights, shape (count,) each, and the matrix from a
    function's values there to those of its integral from 0."""
    legendre = np.polynomial.legendre
    points, weights = legendre.leggauss(count)
    coefficients = np.linalg.inv(legendre.legvander(points, count - 1))
    integrals = legendre.legint(coefficients, lbnd=-1, axis=0)
    return (1 + points) / 2, weights / 2, legendre.legvander(points, count) @ integrals / 2


# Enough for an element whose diameter changes by a factor of ten.
_SHARES, _SHARE_WEIGHTS, _UP_TO = _integration(32)


class ElementMatrices(NamedTuple):
    """Matrices of a shaft element, shape (4, 4) each: mass of translation, mass of the sections'
    tilting [kg, kg.m, kg.m2], elastic stiffness, and stiffness of the axial force [N/m, N, N.m].

    The gyroscopic matrix is twice that of the tilting, since a circular section's polar inertia is
    twice its diametral one.
    """

    translation: np.ndarray
    tilting: np.ndarray
    stiffness: np.ndarray
    tension: np.ndarray


def shear_coefficient(poisson: float, ratio: Any = 0.0, name: str = "cowper") -> Any:
    """Return the shear coefficient of a circular section [1]; ratio: bore over diameter; name:
    `cowper` (Cowper 1966), `hutchinson` (Hutchinson 2001), or `ross-hutchinson`, ROSS 2's version
    of it, which lacks a factor 1 + poisson."""
    ring = (1 + ratio**2) ** 2
    if name in ("hutchinson", "ross-hutchinson"):
        solid = 7 + 12 * poisson + 4 * poisson**2
        hollow = 4 * (5 + 6 * poisson + 2 * poisson**2)
        factor = (1 + poisson) ** (2 if name == "hutchinson" else 1)
        return 6 * factor * ring / (solid * ring + hollow * ratio**2)
    return 6 * (1 + poisson) * ring / ((7 + 6 * poisson) * ring + (20 + 12 * poisson) * ratio**2)


def _area_and_moment(outer: np.ndarray, bore: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return area [m2] and second moment of area [m4] of sections."""
    return math.pi / 4 * (outer**2 - bore**2), math.pi / 64 * (outer**4 - bore**4)


@lru_cache(maxsize=256)
def shaft_element(section: Section) -> ElementMatrices:
    """Return the matrices of the shaft between two nodes, its layers included."""
    layers = section.all_layers
    if section.taper == "exact" and not (len(layers) == 1 and section.is_cylinder):
        return _by_forces(layers)
    each = [_polynomial(layer) for layer in layers]
    return ElementMatrices(
        *(sum(matrices[1:], matrices[0]) for matrices in zip(*each, strict=True))
    )


def _by_forces(layers: Sequence[Section]) -> ElementMatrices:
    """Return the matrices of layers that bend as one, by the force method."""
    length = layers[0].length
    x, weight = _SHARES * length, _SHARE_WEIGHTS * length
    bending, shearing, mass, tilting, tension = (np.zeros_like(x) for _ in range(5))
    is_rigid = False
    for layer in layers:
        outer, bore = _diameters(layer, _SHARES)
        area, moment = _area_and_moment(outer, bore)
        bending += layer.material.young * moment
        is_rigid |= layer.shear == "rigid"
        shearing += _shear_stiffness(layer, bore / outer) * area
        mass += layer.material.density * area
        tilting += layer.material.density * moment
        tension += layer.axial_force
    # by a unit force and by a unit moment at the right end, the left end being clamped
    curvature = np.array([length - x, np.ones_like(x)]) / bending
    strain = np.array([np.zeros_like(x) if is_rigid else 1 / shearing, np.zeros_like(x)])
    flexibility = (curvature * (bending * weight)) @ curvature.T
    flexibility += (strain * (shearing * weight)) @ strain.T
    # forces by the nodes' deflections and slopes less the rigid-body motion of the element
    left = np.array([[-1.0, -length, 1.0, 0.0], [0.0, -1.0, 0.0, 1.0]])
    forces = np.linalg.solve(flexibility, left)
    slope = curvature @ _UP_TO.T * length
    deflection = (slope + strain) @ _UP_TO.T * length
    slopes = forces.T @ slope + np.outer([0, 1, 0, 0], np.ones_like(x))
    strains = forces.T @ strain
    deflections = forces.T @ deflection + np.array([np.ones_like(x), x, 0 * x, 0 * x])

    def integral(factor: np.ndarray, shape: np.ndarray) -> np.ndarray:
        return (shape * (factor * weight)) @ shape.T

    return ElementMatrices(
        translation=integral(mass, deflections),
        tilting=integral(tilting, slopes),
        stiffness=left.T @ forces,
        tension=integral(tension, slopes + strains),
    )


def _polynomial(section: Section) -> ElementMatrices:
    """Return the matrices of one layer with the shape functions of a cylinder (Nelson 1980)."""
    material, length = section.material, section.length
    x = (1 + _POINTS) / 2
    weight = _WEIGHTS / 2 * length
    area, moment = _area_and_moment(*_diameters(section, x))
    # bore over outer diameter in the middle
    ratio = (section.bore_left + section.bore_right) / (section.outer_left + section.outer_right)
    shear = _shear_stiffness(section, ratio)
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

    return ElementMatrices(
        translation=integral(material.density * area, deflection),
        tilting=integral(material.density * moment, slope),
        stiffness=integral(material.young * moment, curvature) + integral(shear * area, strain),
        tension=integral(section.axial_force * one, slope + strain),
    )


def _diameters(section: Section, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return outer diameter and bore [m] at fractions x of the length."""
    outer = section.outer_left + x * (section.outer_right - section.outer_left)
    bore = section.bore_left + x * (section.bore_right - section.bore_left)
    return outer, bore


def _shear_stiffness(section: Section, ratio: Any) -> Any:
    """Return kappa G [Pa] for a ratio of bore to outer diameter; 0 for a section without shear
    deflection."""
    if section.shear == "rigid":
        return 0.0
    coefficient = shear_coefficient(section.material.poisson, ratio, section.shear)
    return coefficient * section.material.shear


def _shear_ratio(section: Section, shear: float) -> float:
    """Return phi = 12 E I / (kappa G A L^2), deflection by shear over that by bending [1].

    Tapered sections use the values in the middle, as in ROSS, or the mean area and moment.
    """
    if section.shear == "rigid":
        return 0.0
    x = np.array([0.5]) if section.taper == "middle" else (1 + _POINTS) / 2
    weight = np.array([1.0]) if section.taper == "middle" else _WEIGHTS / 2
    area, moment = _area_and_moment(*_diameters(section, x))
    bending = 12 * section.material.young * (weight @ moment)
    return bending / (shear * (weight @ area) * section.length**2)
