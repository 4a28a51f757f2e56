"""Vibration in a study, as ISO 20816-1 has it, of a shaft that does not lie at zero."""

import math

import numpy as np
import pytest

from rotor_fmu.errors import InputError

from .test_metrics import UNBALANCE, C, K, jeffcott, row

SAG = 9.81 / K
RUNS = {
    'kind = "constant"\nspeed = 80\nsettle = 2\nturns = 4': 2
    * abs(UNBALANCE * 80**2 / (K - 80**2 + 80j * C)),
    'kind = "run-up"\nfrom = 20\nto = 200\nrate = 20': np.ptp(jeffcott(20.0, 20.0, 9.0)[2].real),
}


@pytest.mark.parametrize(("run", "vibration"), RUNS.items())
def test_vibration_is_peak_to_peak_about_wherever_the_shaft_lies(tmp_path, run, vibration):
    """Gravity bends the shaft by 981 um."""
    keep = """
x = { peak_to_peak = "disc.x" }
y = { peak_to_peak = "disc.y" }
peak = { peak = "disc.y" }
never = { peak_to_peak = "disc.x", after = 500 }
"""
    data = row(tmp_path, run, keep, vary="gravity = { values = [9.81] }")
    assert [float(data.x), float(data.y)] == pytest.approx([vibration, vibration], rel=5e-3)
    assert float(data.peak) == pytest.approx(vibration / 2 + SAG, rel=5e-3)
    assert math.isnan(float(data.never))
    with pytest.raises(InputError, match=r"keep r: disc\.r: vibration is peak-to-peak along"):
        row(tmp_path, run, 'r = { peak_to_peak = "disc.r" }')
