"""The tapered element against closed forms of the cone and against Timoshenko's equations, solved
by Chebyshev collocation without elements."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.shaft import TAPERS, Material, Section
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.beam import shaft_element, shear_coefficient

from .machines import STEEL as STEEL_TABLE
from .machines import sections

STEEL = Material(2.1e11, 7800.0)
CONE = Section(1.0, 0.2, 0.05, STEEL)
SLENDER = Section(1.0, 0.02, 0.005, STEEL)
TUBE = Section(1.0, 0.2, 0.1, STEEL, 0.15, 0.02)


def cantilever(section, elements):
    """Mass and stiffness of a section in equal elements, clamped at its left end."""
    size = 2 * elements + 2
    M, K = np.zeros((size, size)), np.zeros((size, size))
    for i in range(elements):
        element = shaft_element(section.part(i / elements, (i + 1) / elements))
        at = slice(2 * i, 2 * i + 4)
        M[at, at] += element.translation + element.tilting
        K[at, at] += element.stiffness
    return M[2:, 2:], K[2:, 2:]


def frequencies(section, elements):
    M, K = cantilever(section, elements)
    return np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True))


def differentiation(degree):
    """Chebyshev points from 1 to -1 and the matrix that differentiates there (Trefethen 2000)."""
    k = np.arange(degree + 1)
    x = np.cos(np.pi * k / degree)
    c = np.where((k == 0) | (k == degree), 2.0, 1.0) * (-1.0) ** k
    D = np.outer(c, 1 / c) / (x[:, None] - x[None, :] + np.eye(degree + 1))
    return x, D - np.diag(D.sum(axis=1))


def timoshenko(section, degree=36):
    """Frequencies [rad/s] of a tapered beam clamped at its left end, free at its right:

    (S (w' - psi))' = -omega^2 rho A w,  (E I psi')' + S (w' - psi) = -omega^2 rho I psi
    """
    x, D = differentiation(degree)
    share, D = (1 - x) / 2, -2 * D / section.length
    outer = section.outer_left + share * (section.outer_right - section.outer_left)
    bore = section.bore_left + share * (section.bore_right - section.bore_left)
    area = math.pi / 4 * (outer**2 - bore**2)
    moment = math.pi / 64 * (outer**4 - bore**4)
    steel = section.material
    S = np.diag(shear_coefficient(steel.poisson, bore / outer) * steel.shear * area)
    bending, n = np.diag(steel.young * moment), degree + 1
    L = np.block([[-D @ S @ D, D @ S], [-S @ D, S - D @ bending @ D]])
    R = steel.density * np.diag(np.concatenate([area, moment]))
    ends = np.zeros((4, 2 * n))
    ends[0, 0] = ends[1, n] = 1.0
    ends[2, :n], ends[2, -1] = D[-1], -1.0
    ends[3, n:] = D[-1]
    outer_rows = [0, n - 1, n, 2 * n - 1]
    inner = np.setdiff1d(np.arange(2 * n), outer_rows)
    follow = np.zeros((2 * n, len(inner)))
    follow[inner] = np.eye(len(inner))
    follow[outer_rows] = -np.linalg.solve(ends[:, outer_rows], ends[:, inner])
    squares = scipy.linalg.eigvals((L @ follow)[inner], (R @ follow)[inner])
    real = squares.real[(np.abs(squares.imag) < 1e-6 * np.abs(squares)) & (squares.real > 0)]
    return np.sqrt(np.sort(real))


def test_one_element_bends_as_a_cone_does():
    """F L^3 / (3 E I) d / D of bending, and F over kappa G times the mean of 1 / A of shear."""
    R, r = CONE.outer_left / 2, CONE.outer_right / 2
    bending = 4 / (3 * math.pi * STEEL.young * R**3 * r)
    shear = 1 / (shear_coefficient(STEEL.poisson) * STEEL.shear * math.pi * R * r)
    for elements in (1, 7):
        _, K = cantilever(CONE, elements)
        tip = np.linalg.solve(K, np.eye(len(K))[-2])[-2]
        assert tip == pytest.approx(bending + shear, rel=1e-10)


@pytest.mark.parametrize("section", [CONE, SLENDER, TUBE], ids=["cone", "slender", "tube"])
def test_frequencies_converge_to_timoshenkos_of_a_taper(section):
    exact = timoshenko(section)[:3]
    np.testing.assert_allclose(exact, timoshenko(section, 44)[:3], rtol=1e-7)
    errors = [frequencies(section, n)[:3] / exact - 1 for n in (4, 8, 16, 32)]
    assert np.all(errors[-1] > 0)  # consistent masses: from above
    assert np.all(errors[1] < [5e-4, 3e-3, 1.2e-2])
    orders = np.log2([a / b for a, b in pairwise(errors[1:])])
    assert np.all(orders > 1.95)


def test_elements_longer_than_thick_converge_with_the_fourth_power():
    exact = timoshenko(SLENDER)[0]
    errors = [frequencies(SLENDER, n)[0] / exact - 1 for n in (4, 8, 16)]
    orders = np.log2([errors[0] / errors[1], errors[1] / errors[2]])
    np.testing.assert_allclose(orders, 4, atol=0.2)


def test_the_shapes_of_a_cylinder_are_far_behind():
    exact = timoshenko(SLENDER)[0]
    own, mean, middle = (
        abs(frequencies(replace(SLENDER, taper=taper), 16)[0] / exact - 1) for taper in TAPERS
    )
    assert min(mean, middle) > 50 * own


@pytest.mark.parametrize("outer", [0.05, 0.05 * (1 + 1e-9)], ids=["cylinder", "hardly a taper"])
def test_a_taper_goes_over_into_a_cylinder(outer):
    cylinder = Section(0.3, 0.05, 0.05, STEEL, 0.01, 0.01, 1e4)
    taper = replace(cylinder, outer_right=outer)
    for own, output in zip(shaft_element(taper), shaft_element(cylinder), strict=True):
        np.testing.assert_allclose(own, output, rtol=1e-7, atol=1e-9 * np.abs(output).max())


def test_a_cylinder_without_shear_is_the_element_of_rayleigh():
    cylinder = Section.cylinder(0.3, 0.05, STEEL)
    moment, area = np.pi * 0.05**4 / 64, np.pi * 0.05**2 / 4
    scale = np.diag([1.0, 0.3, 1.0, 0.3])
    element = shaft_element(replace(cylinder, shear="rigid"))
    bent = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    moved = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    tilted = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]])
    for own, factor, shape in (
        (element.stiffness, STEEL.young * moment / 0.3**3, bent),
        (element.translation, STEEL.density * area * 0.3 / 420, moved),
        (element.tilting, STEEL.density * moment / (30 * 0.3), tilted),
    ):
        np.testing.assert_allclose(own, factor * scale @ shape @ scale, rtol=1e-12)


def test_a_cone_with_a_sleeve_of_the_same_metal_is_the_thicker_cone():
    """Layers bend as one; without shear, whose coefficient knows of bores."""
    whole = replace(CONE, shear="rigid")
    core = Section(1.0, 0.1, 0.025, STEEL, shear="rigid")
    sleeve = Section(1.0, 0.2, 0.05, STEEL, 0.1, 0.025, shear="rigid")
    for one, both in zip(
        shaft_element(whole), shaft_element(core.with_layers(sleeve)), strict=True
    ):
        np.testing.assert_allclose(
            both, one, rtol=1e-9, atol=1e-12 * np.abs(one).max(), equal_nan=False
        )


def test_layers_yield_to_forces_at_their_end_as_one_beam_does():
    """Also cylinders, each of which would shear by another share of its deflection alone."""
    alloy = Material(7e10, 2700.0, 0.33)
    core, sleeve = Section(0.1, 0.05, 0.05, STEEL), Section(0.1, 0.12, 0.12, alloy, 0.05, 0.05)
    bending = shearing = 0.0
    for layer in (core, sleeve):
        outer, bore = layer.outer_left, layer.bore_left
        bending += layer.material.young * math.pi / 64 * (outer**4 - bore**4)
        coefficient = shear_coefficient(layer.material.poisson, bore / outer)
        shearing += coefficient * layer.material.shear * math.pi / 4 * (outer**2 - bore**2)
    L = core.length
    turned = L**2 / (2 * bending)
    expected = [[L**3 / (3 * bending) + L / shearing, turned], [turned, L / bending]]
    stiffness = shaft_element(core.with_layers(sleeve)).stiffness[2:, 2:]
    np.testing.assert_allclose(np.linalg.inv(stiffness), expected, rtol=1e-9)


def test_a_taper_moved_as_one_body_strains_nothing_but_its_axial_force():
    element = shaft_element(replace(TUBE, axial_force=1e4))
    length = TUBE.length
    moved = np.array([[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, length, 1.0]])
    assert np.abs(element.stiffness @ moved.T).max() < 1e-12 * element.stiffness.max()
    work = moved @ element.tension @ moved.T
    np.testing.assert_allclose(work, [[0.0, 0.0], [0.0, 1e4 * length]], atol=1e-8)


def test_a_taper_is_of_its_own_shape_unless_the_file_says_otherwise():
    text = STEEL_TABLE + sections(0.5, outer_left=0.02, outer_right=0.04, elements=3)
    own, exact, mean = (
        assemble(parse_rotor(text + word)).K_shaft
        for word in ("", 'taper = "exact"\n', 'taper = "mean"\n')
    )
    np.testing.assert_array_equal(own, exact)
    assert np.abs(mean - own).max() > 1e-3 * own.max()
