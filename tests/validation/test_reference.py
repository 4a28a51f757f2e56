"""The run-down against SUNDIALS' CVODE, on equations that are not this project's own code."""

import math
from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.settings import choose

from benchmarks import equations
from papers.dense_machine import rest

from .windows import ATOL, SPEEDS_HZ, rig, windows

RTOL = 1e-8
# before and at a peak in an ordinary run
SPEEDS = [SPEEDS_HZ[0], *(pytest.param(hz, marks=pytest.mark.slow) for hz in SPEEDS_HZ[1:])]


@pytest.fixture(scope="module")
def stretches():
    return dict(zip(SPEEDS_HZ, windows(), strict=True))


@pytest.fixture(scope="module")
def reference(stretches):
    return cache(lambda hz: stretches[hz].reference(RTOL))


def size(orbit):
    """Half of the larger side of the box around an orbit [m]."""
    return max(np.ptp(orbit.real), np.ptp(orbit.imag)) / 2


def test_the_reference_rests_where_the_machine_does():
    still = equations.equations(rig(), 0.0, 0.0)
    q = rest(rig())
    state, size = equations.real_state(q, 0 * q), still.size
    slope = still.slope(0.0, state)
    assert np.all(slope[:size] == 0)
    # what is out of balance, beside the weight; the steps that find the rest cancel free fall
    unbalanced = still.mass @ slope[size:]
    weight = np.abs(still.mass @ np.ones(size)).sum() * rig().gravity
    assert np.abs(unbalanced).max() < 1e-9 * weight


def test_the_jacobian_of_the_reference_is_the_derivative_of_its_slope():
    turning = equations.equations(rig(), 200.0, -10.0)
    random = np.random.default_rng(0)
    state = np.concatenate([random.normal(0, 3e-5, 36), random.normal(0, 1e-2, 36)])
    exact = turning.jacobian(0.1, state)
    numeric = np.empty_like(exact)
    for i in range(72):
        shift = np.zeros(72)
        shift[i] = 1e-8 if i < 36 else 1e-4
        change = turning.slope(0.1, state + shift) - turning.slope(0.1, state - shift)
        numeric[:, i] = change / (2 * shift[i])
    assert np.abs(turning.slope(0.1, state)).max() > 1e6  # both journals press on their walls
    scale = np.abs(exact).max(axis=0)
    assert (np.abs(numeric - exact) / scale).max() < 1e-5


@pytest.mark.slow  # nor would small steps converge to it below
@pytest.mark.parametrize("hz", SPEEDS_HZ)
def test_the_reference_has_converged_and_its_motion_is_not_chaotic(hz, stretches, reference):
    exact = reference(hz)
    coarser = stretches[hz].reference(100 * RTOL)
    # asked of every step; over a window, by where the steps fall, up to six times of it were seen
    allowed = 100 * RTOL * (np.abs(exact).max() + ATOL)
    assert np.abs(coarser - exact).max() < 20 * allowed
    shift = 1e-10  # [m], orbits of 28 to 400 um
    shifted = stretches[hz].reference(RTOL, shift=shift)
    assert np.abs(shifted - exact)[-1] < 10 * shift


@pytest.mark.parametrize("hz", SPEEDS)
def test_a_run_in_small_steps_converges_to_the_reference(hz, stretches, reference):
    exact = reference(hz)
    errors = []
    for h in (1e-4, 2e-5):
        orbit, steps = stretches[hz].orbit(choose("moderate", h=h))
        assert steps == pytest.approx(0.2 / h, abs=1)
        errors.append(np.abs(orbit - exact).max() / size(exact))
    assert errors[0] < 2e-3
    assert errors[1] < errors[0] / 10


@pytest.mark.parametrize("hz", SPEEDS)
def test_an_error_controlled_run_keeps_to_the_tolerance_asked(hz, stretches, reference):
    exact = reference(hz)
    reach = np.abs(exact).max()  # from the bearings' axis, what the tolerance is relative to
    before = math.inf
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-5):
        orbit, _ = stretches[hz].orbit(choose("controlled", tolerance=tolerance))
        error = np.abs(orbit - exact).max() / reach
        assert error < 10 * tolerance
        assert error < before / 3
        before = error
