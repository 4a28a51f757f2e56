"""Corners of forces: the sums of samples that have them, Floquet multipliers across them, and the
bifurcations that are located by these."""

import numpy as np
import pytest
import scipy.integrate
from rotor_fmu.model.periodic.floquet import multipliers
from rotor_fmu.model.periodic.force_corners import SampledOrbit
from rotor_fmu.model.periodic.fourier import derivative
from rotor_fmu.model.periodic.linear_structure import CondensedMachine

import rotor_fmu as rf

from .machines import BETA, CLEARANCE, OMEGA, jeffcott, sagging

STIFFNESS = BETA * OMEGA**2  # of the contact


@pytest.mark.parametrize("offset", [0.0, 0.2, 0.37])
def test_coefficients_of_a_force_with_corners_are_its_integrals(offset):
    """Of a journal that goes to and fro through its clearance, wherever a corner lies between two
    samples."""
    laws = CondensedMachine(jeffcott(mu=0.0).rotor).laws
    n, H, amplitude = 256, 10, 1.5 * CLEARANCE
    phase = offset * 2 * np.pi / n
    d = np.zeros((2 * H + 1, 2))
    d[1:3, 0] = amplitude * np.cos(phase), amplitude * np.sin(phase)
    at = SampledOrbit(laws, d, np.zeros((2 * H + 1, 0)), 100.0, n, derivative(d))
    seen = at.spectrum(laws.forces(at.d, at.v, at.states, 100.0).force[:, 0], H)
    edge = np.arccos(CLEARANCE / amplitude)

    def press(t, k):
        return (amplitude * np.cos(t) - CLEARANCE) * np.cos(k * t)

    for k in range(H + 1):
        half = scipy.integrate.quad(press, 0.0, edge, (k,), epsabs=1e-18)[0]
        expected = -STIFFNESS * (2 / np.pi) * half * (k % 2) * np.exp(-1j * k * phase)
        assert abs(seen[k] - expected) < 1e-7 * STIFFNESS * amplitude


def test_multipliers_do_not_depend_on_the_steps_although_a_contact_opens_and_closes(doubled):
    machine = CondensedMachine(sagging().rotor)
    for point in doubled.branches[0].points[::4]:
        few, many = (
            np.sort(np.abs(multipliers(machine, point.orbit, steps).values)) for steps in (0, 1000)
        )
        assert few == pytest.approx(many, rel=1e-6)


def test_each_located_bifurcation_has_its_multiplier(doubled):
    """A doubling's is -1, a fold's +1 as nearly as the harmonics give the fold."""
    kinds = [b.kind for b in doubled.bifurcations]
    assert set(kinds) == {"period doubling", "fold"}
    for b in doubled.bifurcations:
        if b.kind == "fold":
            assert abs(b.multiplier - 1) < 1e-3
        else:
            assert abs(b.multiplier + 1) < 2e-6


@pytest.mark.slow
def test_with_more_harmonics_a_folds_multiplier_is_nearer_to_one():
    options = {"speed": (240.0, 400.0), "branches": True, "harmonics": 60}
    off = []
    for share, step in ((1e-4, 0.1), (1e-6, 0.03)):
        result = rf.response(sagging(), share=share, step=step, **options)
        off.append(max(abs(b.multiplier - 1) for b in result.bifurcations if b.kind == "fold"))
    assert off[0] < 1e-3
    assert off[1] < 3e-5


def test_a_torus_begins_where_a_pair_of_multipliers_leaves_the_circle(curve, over_friction):
    (torus,) = [b for b in over_friction.bifurcations if b.kind == "Neimark-Sacker"]
    assert abs(torus.multiplier) == pytest.approx(1.0, abs=2e-6)
    assert abs(torus.multiplier.imag) > 0.1
    (fold,) = [b for b in curve.bifurcations if b.kind == "fold"]
    assert abs(fold.multiplier - 1) < 1e-6
    (grazing,) = [b for b in curve.bifurcations if b.kind == "grazing"]
    assert np.isnan(grazing.multiplier)
