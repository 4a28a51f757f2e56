"""Rotors that whirl slowly, far above their lowest natural frequency, beside CVODE: one that rubs,
one on soft mounts.

They whirl once while they turn 27 and 169 times, so that errors which were tolerated in a cycle of
the rotation would add up to hundreds of tolerances.
"""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose

from .judge import PROMISED, TOLERANCES, judged
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


# its start sends it into a whirl of 1 mm on mounts of 2 Hz
ON_SOFT_MOUNTS = """
gravity = 0.0
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.2, 0.4, 0.6]
diameters = [0.03, 0.03, 0.03]
eta_v = 1e-5
[[disc]]
node = 2
diameter = 0.2
width = 0.03
e = 1e-5
"""
ON_SOFT_MOUNTS += "".join(
    f"[[support]]\nnode = {node}\nstiffness = 790.0\ndamping = 1.25\n" for node in (1, 4)
)


@pytest.mark.slow
def test_errors_of_a_rotor_on_soft_mounts_do_not_add_up():
    rotor = parse_rotor(ON_SOFT_MOUNTS)
    case = Case("soft", "open", rotor, 2000.0, -300.0, 0.94, 2, np.zeros(0))
    exact = Truth(orbit(case, 1e-8), 0.0)
    for tolerance in TOLERANCES:
        assert judged(case, exact, choose(tolerance=tolerance)).orbit < PROMISED * tolerance
        assert judged(case, exact, choose(method="radau5", tolerance=tolerance)).orbit < tolerance
