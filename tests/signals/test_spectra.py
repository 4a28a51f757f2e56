"""Spectra and orders of motions that repeat, and of those whose mean position drifts."""

import math

import numpy as np
import pytest

from rotor_fmu import vibration
from rotor_fmu.run_pictures.run_folder import spectra
from rotor_fmu.run_pictures.signal_plots import cascade, orbit
from rotor_fmu.run_pictures.view import View
from rotor_fmu.runs.recording import Recording


@pytest.mark.parametrize("order", [1.0, 0.5, 1 / 3, 0.75])
def test_a_motion_that_repeats_after_some_turns_has_its_amplitude(order):
    """In 95 turns, the second half of 190, a half lies between two lines, where 15 % is lost."""
    phi = np.arange(190 * 64 + 1) * (2 * math.pi / 64)
    x = 5e-5 * np.cos(order * phi + 0.3)
    columns = {"phi": phi, "w": 0 * phi + 100.0, "disc[1].x": x, "disc[1].y": 0 * phi}
    (axes,) = spectra(Recording(phi / 100.0, columns, {}, {}), "disc[1]", "").axes
    assert axes.lines[0].get_ydata().max() == pytest.approx(50.0, rel=2e-3)


@pytest.mark.parametrize("sense", [1, -1])
def test_a_shaft_that_rises_on_its_oil_film_has_no_orders_of_that(sense):
    """By 1 um a turn, in 1x of 1 um: the drift was read as 0.21 um of 0.5x, and as 1.9 um beside
    the mean."""
    phi = sense * np.arange(60 * 64 + 1) * (2 * math.pi / 64)
    z = 1e-6 * np.exp(1j * phi) + (0.5 + 1j) * 1e-6 * abs(phi) / (2 * math.pi)
    t = abs(phi) / 100.0
    track = vibration.order_track(t, phi, z)
    assert track.major(0.5) == pytest.approx(0, abs=1e-11)
    assert np.abs(track.y()) == pytest.approx(1e-6, rel=1e-5)
    found = vibration.full_spectrum(t, phi, z, sense * 100.0)
    assert found.order[found.amplitude > 1e-9] == pytest.approx([0.9375, 1.0, 1.0625])
    direct = vibration.displacement(t, phi, z)
    assert [direct.x_pp, direct.y_pp] == pytest.approx(np.full((2, 45), 2e-6), rel=2e-3)
    assert direct.s_max == pytest.approx(np.full(45, 1e-6), rel=2e-3)


@pytest.mark.parametrize(("sunk", "label", "width"), [(5, "rest", 5), (80, "rest: 80 µm away", 2)])
def test_an_orbit_is_seen_however_far_its_shaft_has_risen_from_rest(sunk, label, width):
    """A probe of a compressor, 1.2 um wide, was a dot in a corner of a picture of 60 um."""
    phi = np.arange(20 * 64 + 1) * (2 * math.pi / 64)
    x, y = 1e-6 * np.cos(phi), 1e-6 * np.sin(phi)
    x[0] = -1e-6 * sunk
    columns = {"phi": phi, "w": 0 * phi + 100.0, "disc[1].x": x, "disc[1].y": y}
    view = View(Recording(phi / 100.0, columns, {}, {}), "disc[1]", time=9e9)
    (axes,) = orbit(view).axes
    assert axes.lines[-1].get_label() == label
    assert width < np.diff(axes.get_xlim()) < 2 * width


@pytest.mark.parametrize(("order", "amplitude", "seen"), [(7.0, 2e-6, 7.0), (7.0, 2e-8, 3.0)])
def test_a_cascade_reaches_as_far_as_what_is_large_in_it(order, amplitude, seen):
    """Elements that pass the load of a rolling bearing, beside 1x of 1 um of a run-up to 320 rad/s.
    Beyond 3x they were left out though larger than 1x."""
    t = np.arange(0, 8, 2.5e-4)
    phi = 20.0 * t**2
    z = 1e-6 * np.exp(1j * phi) + amplitude * np.exp(1j * order * phi)
    columns = {"phi": phi, "w": 40.0 * t, "disc[1].x": z.real, "disc[1].y": z.imag}
    axes = cascade(View(Recording(t, columns, {}, {}), "disc[1]")).axes[0]
    assert axes.get_xlim()[1] == pytest.approx(1.1 * seen * 320.0 / (2 * math.pi), rel=0.03)
