"""Natural frequencies and damping against another program's and against closed forms."""

import json
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.shaft import Section
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.structure import beam
from rotor_fmu.model.structure.assembly import assemble

from papers.dense_machine import clearance_contacts
from tests.dense import dense_matrices

from ..machines import STEEL, disc_dofs

ROSS = json.loads((Path(__file__).parents[1] / "reference" / "rig_frequencies.json").read_text())


def pairs(structure):
    """Indices of each journal and its housing in the dense matrices, in both planes."""
    for plane in (0, structure.M.shape[0] + len(structure.housings)):
        for contact in clearance_contacts(structure):
            yield plane + contact.dof, plane + contact.end


def pinned(structure):
    """M, K, G of the whole machine with every housing moving as its journal does."""
    M, _, K, G, _ = dense_matrices(structure)
    merge = np.eye(len(M))
    housings = []
    for journal, housing in pairs(structure):
        merge[housing, housing] = 0.0
        merge[housing, journal] = 1.0
        housings.append(housing)
    merge = np.delete(merge, housings, axis=1)
    return tuple(merge.T @ matrix @ merge for matrix in (M, K, G))


def in_contact(structure, stiffness):
    """M, K, G with journals and housings joined by springs in both planes."""
    M, _, K, G, _ = dense_matrices(structure)
    for journal, housing in pairs(structure):
        at = np.ix_([journal, housing], [journal, housing])
        K[at] += stiffness * np.array([[1, -1], [-1, 1]])
    return M, K, G


def whirl(M, K, G, omega):
    """Natural frequencies [rad/s], ascending, and their modes as columns: q = Re(mode exp(i w t)).

    The undamped gyroscopic system is turned into a Hermitian one, whose eigenvalues are exact to
    rounding.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(M))
    B = np.linalg.cholesky(K).T @ inverse.T
    g = inverse @ G @ inverse.T
    w, vectors = np.linalg.eigh(-1j * np.block([[0 * B, B], [-B.T, -omega * g]]))
    return w[w > 0], (inverse.T @ vectors[len(M) :])[:, w > 0]


@pytest.mark.parametrize("omega", [0, 200, 400])
def test_the_rig_pinned_in_its_housings_has_the_frequencies_of_ross(omega):
    expected = ROSS["values"][f"journals_pinned_to_housings_{omega}"]
    # ROSS pins by a stiff spring, hence not closer
    np.testing.assert_allclose(whirl(*pinned(assemble(rig())), omega)[0][:8], expected, rtol=1e-6)


@pytest.mark.parametrize("omega", [0, 200, 400])
def test_the_rig_on_its_contact_springs_has_the_frequencies_of_ross(omega):
    expected = ROSS["values"][f"contact_stiffness_2e8_{omega}"]
    result = whirl(*in_contact(assemble(rig()), 2e8), omega)[0][:8]
    np.testing.assert_allclose(result, expected, rtol=1e-11)


def test_the_rig_has_the_two_lowest_frequencies_of_the_paper():
    hertz = whirl(*pinned(assemble(rig())), 0)[0][:2] / (2 * np.pi)
    np.testing.assert_allclose(hertz, [29.49, 32.42], atol=0.005)
    np.testing.assert_allclose(hertz, [29.4, 32.5], atol=0.1)  # Zigulic et al. 2003, to the digit


def test_forward_whirl_speeds_up_and_backward_whirl_slows_down_with_the_spin():
    matrices = pinned(assemble(rig()))
    disc = disc_dofs(rig())[1]
    plane = len(matrices[0]) // 2
    at_rest, slow, fast = (whirl(*matrices, omega) for omega in (0, 100, 300))
    for i, sense in enumerate((-1, 1)):
        x, y = slow[1][disc, i], slow[1][plane + disc, i]
        # x = cos, y = sin, turning with the spin, has the phasors 1 and -i
        assert np.sign(-(x.conjugate() * y).imag) == sense
        assert sense * at_rest[0][i] < sense * slow[0][i] < sense * fast[0][i]


def test_whirl_does_not_care_which_way_the_shaft_turns():
    matrices = pinned(assemble(rig()))
    np.testing.assert_allclose(whirl(*matrices, -300)[0], whirl(*matrices, 300)[0], rtol=1e-9)


def pinned_beam(elements, length, diameter):
    """Natural frequencies [rad/s] of a uniform beam on two pins."""
    M, K = (np.zeros((2 * elements + 2, 2 * elements + 2)) for _ in range(2))
    for i in range(elements):
        at = slice(2 * i, 2 * i + 4)
        element = beam.shaft_element(Section.cylinder(length / elements, diameter, STEEL))
        M[at, at] += element.translation + element.tilting
        K[at, at] += element.stiffness
    free = [i for i in range(2 * elements + 2) if i not in (0, 2 * elements)]
    at = np.ix_(free, free)
    return np.sqrt(scipy.linalg.eigh(K[at], M[at], eigvals_only=True))


def test_a_slender_beam_approaches_euler_and_bernoulli_with_the_fourth_power_of_its_elements():
    length, diameter = 1.0, 1e-4
    mode = np.arange(1, 3)
    speed = diameter / 4 * np.sqrt(STEEL.young / STEEL.density)  # sqrt(E I / (rho A))
    exact = (mode * np.pi / length) ** 2 * speed
    errors = [pinned_beam(n, length, diameter)[:2] / exact - 1 for n in (4, 8, 16)]
    assert np.all(errors[2] > 0)  # consistent masses: from above
    assert np.all(errors[2] < 1e-4)
    orders = np.log2([errors[0] / errors[1], errors[1] / errors[2]])
    np.testing.assert_allclose(orders, 4, atol=0.1)


def test_a_stubby_beam_has_the_frequencies_of_timoshenko():
    length, diameter = 1.0, 0.2
    k = np.arange(1, 4) * np.pi / length
    area, inertia = np.pi / 4 * diameter**2, np.pi / 64 * diameter**4
    E, rho = STEEL.young, STEEL.density
    shear = beam.shear_coefficient(STEEL.poisson) * STEEL.shear
    # E I k^4 - (rho A + rho I k^2 (1 + E / kappa G)) w^2 + rho^2 I / (kappa G) w^4 = 0
    a, b = rho**2 * inertia / shear, rho * area + rho * inertia * k**2 * (1 + E / shear)
    exact = np.sqrt((b - np.sqrt(b**2 - 4 * a * E * inertia * k**4)) / (2 * a))
    coarse, fine = (pinned_beam(n, length, diameter)[:3] for n in (32, 64))
    # static shape functions: thick elements converge with the square only, hence extrapolated
    np.testing.assert_allclose(fine, exact, rtol=4e-4)
    np.testing.assert_allclose((4 * fine - coarse) / 3, exact, rtol=2e-6)


def test_damping_by_mass_and_by_stiffness_is_rayleighs():
    shaft = tuple(Section.cylinder(length, 0.03, STEEL) for length in (0.2, 0.3, 0.2))
    alpha, beta = 20.0, 1e-5
    parts = Support(1, 1e12), Support(4, 1e12)
    found = modes(Rotor(STEEL, shaft, parts, mass_damping=alpha, eta_v=beta), count=4)
    expected = (alpha / found.natural + beta * found.natural) / 2
    np.testing.assert_allclose(found.damping_ratio, expected, rtol=1e-3)
