"""Linear analyses of machines in rolling bearings: upright, turned, and in large clearances."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, modes, static
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

_SHAFT = """
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.15, 0.3, 0.45, 0.6]
diameters = [0.02, 0.02, 0.022, 0.02]
[[disc]]
node = 3
diameter = 0.15
width = 0.03
"""
_BEARING = """
[[rolling_bearing]]
node = {node}
count = 8
pitch_diameter = 0.04
element_diameter = 0.006
k = 5e9
"""
_SUPPORT = "[[support]]\nnode = 5\nstiffness = 1e6\ndamping = 300.0\n"
_UPRIGHT = "inclination = 1.5707963267948966\n"


def _machine(head, clearance, other=None):
    first, second = (_BEARING.format(node=n) + f"clearance = {clearance}\n" for n in (1, 5))
    return parse_rotor(head + _SHAFT + first + (other or second))


@pytest.mark.parametrize("head", [_UPRIGHT, "gravity = 0.0\n"])
@pytest.mark.parametrize("other", [None, _SUPPORT])
def test_an_upright_machine_in_preloaded_bearings_swings_as_in_springs(head, other):
    """Of K = Z / 2 n k preload^(n - 1), the closed form in the middle."""
    preload = 3e-6
    stiffness = 8 / 2 * 1.5 * 5e9 * math.sqrt(preload)
    springs = "".join(
        f"[[linear_bearing]]\nnode = {n}\nkxx = {stiffness!r}\nkyy = {stiffness!r}\n"
        "cxx = 800.0\ncyy = 800.0\n"
        for n in (1, 5)[: 1 if other else 2]
    )
    rotor = _machine(head, -preload, other)
    expected = modes(parse_rotor(head + _SHAFT + springs + (other or "")), 300.0)
    found = modes(rotor, 300.0)
    np.testing.assert_allclose(found.eigenvalues.imag, expected.eigenvalues.imag, rtol=1e-3)
    rest = static(rotor)
    assert max(abs(rest.x).max(), abs(rest.y).max()) < 1e-12 * preload


@pytest.mark.parametrize("angle", [0.3, 1.0, 1.6, 3.0, -2.2])
def test_a_machine_rests_where_gravity_pulls_it_in_its_clearance(angle):
    """Wherever that is, as a run does; and turned with its elements it is the same machine."""
    head = f"gravity_angle = {angle}\n"
    rotor = _machine(head, 1e-5)
    rest = static(rotor)
    motion = Simulation(rotor, choose(), warn=lambda _: None).motion
    seen = complex(rest.x[2], rest.y[2])
    assert abs(seen - motion.q[4]) < 1e-6 * abs(seen)
    turned = parse_rotor(head + _SHAFT + _turned(angle))
    level = parse_rotor(_SHAFT + _turned(0.0))
    np.testing.assert_allclose(
        modes(turned, 300.0).eigenvalues.imag, modes(level, 300.0).eigenvalues.imag, rtol=1e-6
    )


@pytest.mark.parametrize("cage", [0.0, pytest.param(-0.5 * math.pi, marks=pytest.mark.slow)])
@pytest.mark.parametrize("left", [-1e-6, 0.0, 1e-6, 2e-5, 5e-4])
@pytest.mark.parametrize("right", [-1e-6, 1e-6, 2e-5, 5e-4])
def test_clearances_may_be_unlike(left, right, cage):
    """Where a run rests; with a single element below, free sideways, in the middle of the play."""
    ends = [
        _BEARING.format(node=node) + f"clearance = {clearance}\ncage_angle = {cage}\n"
        for node, clearance in ((1, left), (5, right))
    ]
    rotor = parse_rotor(_SHAFT + "".join(ends))
    rest = static(rotor, speed=100.0)
    motion = Simulation(rotor, choose(), speed=100.0, warn=lambda _: None).motion
    size = abs(rest.y).max()
    np.testing.assert_allclose(rest.x + 1j * rest.y, motion.q[:10:2], rtol=0, atol=1e-6 * size)
    if min(left, right) == 2e-5:
        slowest, *_, fastest = modes(rotor, 0.0).natural
        assert not 1e-8 * fastest < slowest < 1e-3 * fastest


def _turned(angle):
    """Both bearings in a clearance, with an element near the load on each side."""
    more = f"clearance = 1e-5\ncage_angle = {angle - 0.5 * math.pi + 0.2}\n"
    return "".join(_BEARING.format(node=n) + more for n in (1, 5))


@pytest.mark.parametrize(
    ("head", "why"), [(_UPRIGHT, "stands upright"), ("gravity = 0.0\n", "is 0")]
)
@pytest.mark.parametrize("clearance", [1e-5, 0.0])
def test_an_upright_machine_in_a_clearance_is_said_not_to_be_held(head, why, clearance):
    with pytest.raises(LinearError, match=f"not held.* no stiffness.*{why}.*without preload"):
        static(_machine(head, clearance))


def test_a_load_holds_an_upright_machine_in_its_clearance():
    """As gravity does that pulls alike."""
    rotor, weight = _machine(_UPRIGHT, 1e-5), 50.0
    by_load = static(rotor, loads=[(3, weight * math.sin(1.0), -weight * math.cos(1.0))])
    assert by_load.load_x.sum() == pytest.approx(weight * math.sin(1.0))
    assert by_load.load_y.sum() == pytest.approx(-weight * math.cos(1.0))


@pytest.mark.parametrize("cage", [0.0, 0.5 * math.pi])
@pytest.mark.parametrize("count", [3, 4, 6])
def test_a_machine_falls_between_its_elements(count, cage):
    """Further than the clearance: to it over cos(pi / count) between two elements."""
    given = f"clearance = 1e-4\ncage_angle = {cage}\n"
    bearings = "".join(
        _BEARING.format(node=n).replace("count = 8", f"count = {count}") + given for n in (1, 5)
    )
    rotor = parse_rotor(_SHAFT + bearings)
    rest = static(rotor)
    motion = Simulation(rotor, choose(), warn=lambda _: None).motion
    assert abs(complex(rest.x[0], rest.y[0]) - motion.q[0]) < 1e-6 * abs(motion.q[0])
