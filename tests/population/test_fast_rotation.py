"""A rotor that rubs and whirls slowly, far above its lowest natural frequency, beside CVODE.

It whirls once while it turns 27 times, so that errors which were tolerated in a cycle of the
rotation would add up to 180 tolerances.
"""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose

from .judge import TOLERANCES, judged
from .machines import Case
from .truth import Truth, orbit

# it whirls backward with 529 rad/s, as slowly as a shaft on springs, growing by 6.7 1/s
MACHINE = """
name = "fast"
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.262, 0.546]
diameters = [0.0164, 0.0164]
eta_v = 3.8e-6
[[disc]]
node = 2
diameter = 0.0983
width = 0.0164
e = 2.5e-6
"""
_BEARING = """
[[bearing]]
node = {}
journal_radius = 0.0082
clearance = 1.3e-6
mu = 0.112
k = 2.7e5
c = 51.0
delta_c = 9e-8
v_s = 2e-4
mass = 0.17
mass_ratio = 1.2
kx = 6.6e5
ky = 1.3e6
cx = 67.0
cy = 95.0
"""
MACHINE += _BEARING.format(1) + _BEARING.format(3)


@pytest.mark.slow
def test_errors_of_many_revolutions_do_not_add_up():
    case = Case("fast", "bearing", parse_rotor(MACHINE), 14250.0, 45000.0, 0.16, 2, np.zeros(0))
    exact = Truth(orbit(case, 1e-8), 0.0)
    for tolerance in TOLERANCES:
        assert judged(case, exact, choose(tolerance=tolerance)).orbit < 20 * tolerance
        assert judged(case, exact, choose(method="radau5", tolerance=tolerance)).orbit < tolerance
