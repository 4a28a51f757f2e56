"""The spectrum that a run at one speed leaves in its folder."""

import math

import numpy as np
import pytest

from rotor_fmu.run_pictures.run_folder import spectra
from rotor_fmu.runs.recording import Recording


@pytest.mark.parametrize("order", [1.0, 0.5, 1 / 3, 0.75])
def test_a_motion_that_repeats_after_some_turns_has_its_amplitude(order):
    """In 95 turns, the second half of 190, a half lies between two lines, where 15 % is lost."""
    phi = np.arange(190 * 64 + 1) * (2 * math.pi / 64)
    x = 5e-5 * np.cos(order * phi + 0.3)
    columns = {"phi": phi, "w": 0 * phi + 100.0, "disc[1].x": x, "disc[1].y": 0 * phi}
    (axes,) = spectra(Recording(phi / 100.0, columns, {}, {}), "disc[1]", "").axes
    assert axes.lines[0].get_ydata().max() == pytest.approx(50.0, rel=2e-3)
