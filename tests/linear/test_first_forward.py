"""Of which mode stability is judged: the first forward one, whatever cross coupling does to it."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.linear import first_forward, level_1, level_2, modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.structure.assembly import assemble

from tests.dense import dense_matrices
from tests.linear.api_617 import RPM, SHAFT, coupling, support

OVERHUNG = """
name = "overhung"
[material]
young = 2.1e11
density = 7850.0
[[section]]
length = 0.6
elements = 8
outer = 0.08
bore = 0.02
[[section]]
length = 0.15
elements = 3
outer_left = 0.08
outer_right = 0.05
[[disc]]
node = 12
diameter = 0.35
width = 0.05
bore = 0.05
""" + "".join(
    f"[[linear_bearing]]\nnode = {node}\nkxx = 5e7\nkyy = 9e7\ncxx = 3e4\ncyy = 4e4\n"
    for node in (2, 8)
)


def test_the_first_forward_mode_of_an_overhung_rotor_stays_the_one_it_is():
    """Also where cross coupling between the bearings would make a higher mode grow first: as many
    see it who look at eigenvalues with the coupling where the impeller is."""
    rotor, speed = parse_rotor(OVERHUNG), 9000 * RPM
    bare = modes(rotor, speed)
    clear = int(np.flatnonzero(bare.forwardness > 0.5)[0])
    for node in (None, 5):
        result = level_1(rotor, speed, node=node, stiffness=[0.0])
        assert result.node == (node or 12)
        assert result.frequency[0] == pytest.approx(bare.damped[clear], rel=1e-9)
        assert result.log_dec[0] == pytest.approx(bare.log_dec[clear], rel=1e-9)
    threshold = level_1(rotor, speed).threshold
    for q in (0.3 * threshold, 0.999 * threshold, 1.001 * threshold):
        seen = modes(replace(rotor, parts=(*rotor.parts, coupling(12, q))), speed)
        expected = seen.log_dec[np.flatnonzero(seen.forwardness > 0.5)[0]]
        *_, with_all = level_2(rotor, speed, cross_couplings={12: q}).cases
        assert with_all.log_dec == pytest.approx(expected, rel=1e-6)
        assert (with_all.log_dec > 0) == (q < threshold)


@pytest.mark.parametrize(
    ("stages", "node"),
    [
        ({10: 2e5, 12: 1e5}, 10),
        ({5: 1e5, 12: 2e5}, 5),
        pytest.param({5: 1e5}, 5, marks=pytest.mark.slow),
    ],
)
def test_cross_coupling_is_put_where_the_stages_are_only_if_all_stand_beyond_the_bearings(
    stages, node
):
    result = level_1(parse_rotor(OVERHUNG), 9000 * RPM, anticipated=stages, stiffness=[0.0])
    assert result.node == node
    assert result.anticipated == pytest.approx(sum(stages.values()))


PINION = """
name = "pinion with two overhung wheels"
[material]
young = 2.05e11
density = 7833.0
[shaft]
nodes = [0.0, 0.05, 0.1, 0.13, 0.16, 0.26, 0.36, 0.39, 0.42, 0.47, 0.52]
diameters = [0.05, 0.05, 0.06, 0.06, 0.09, 0.09, 0.06, 0.06, 0.05, 0.05]
[[body]]
node = 1
mass = 3.5
I_d = 0.008
I_p = 0.013
[[body]]
node = 11
mass = 2.8
I_d = 0.006
I_p = 0.0095
"""
PINION_BEARING = 2.0446e8, 8.978e4  # N/m, N.s/m


def dense_roots(rotor, speed, bearings, coupled, q):
    """Eigenvalues, and whether each whirls forward, of the dense matrices of a machine on bearings
    (node, k, c) with a cross coupling q at the node `coupled`, of x and y of all dofs."""
    M, C, K, G, _ = dense_matrices(assemble(rotor))
    half = len(M) // 2
    for node, k, c in bearings:
        for at in (2 * (node - 1), half + 2 * (node - 1)):
            K[at, at] += k
            C[at, at] += c
    x, y = 2 * (coupled - 1), half + 2 * (coupled - 1)
    K[x, y] += q
    K[y, x] -= q
    D = C + speed * G
    inverse = np.linalg.inv(M)
    roots, states = np.linalg.eig(
        np.block([[np.zeros_like(M), np.eye(2 * half)], [-inverse @ K, -inverse @ D]])
    )
    x, y = states[:half:2], states[half : 2 * half : 2]
    turning, against = (np.sum(np.abs(x + s * y) ** 2, axis=0) for s in (1j, -1j))
    return roots, turning > against


def test_a_heavily_damped_lowest_mode_does_not_hide_one_that_is_nearly_unstable():
    """The least decrement of the forward modes up to twice the speed, by dense eigenvalues: the
    lowest forward mode keeps more than 1.3, while that above it becomes unstable."""
    (k, c), speed = PINION_BEARING, 30_000 * RPM
    shaft = parse_rotor(PINION)
    bearings = "".join(
        f"[[linear_bearing]]\nnode = {n}\nkxx = {k}\nkyy = {k}\ncxx = {c}\ncyy = {c}\n"
        for n in (4, 8)
    )
    rotor = parse_rotor(PINION + bearings)
    threshold = level_1(rotor, speed, node=1).threshold
    for share in (0.0, 0.5, 0.96, 1.0):
        q = share * threshold
        roots, is_forward = dense_roots(shaft, speed, [(4, k, c), (8, k, c)], 1, q)
        counts = is_forward & (roots.imag > 0) & (roots.imag < 2 * speed)
        expected = (-2 * math.pi * roots.real / roots.imag)[counts].min()
        found = level_1(rotor, speed, node=1, anticipated=q, stiffness=[q])
        with_all = level_2(rotor, speed, cross_couplings={1: q} if q else None)
        for log_dec in (found.log_dec[0], found.log_dec_anticipated, with_all.cases[-1].log_dec):
            assert log_dec == pytest.approx(expected, rel=1e-6, abs=1e-7)
        assert with_all.is_met == (share < 0.9)
        assert with_all.cases[-1].first_log_dec > 1.0


def test_a_mode_that_whirls_backward_but_for_some_nodes_is_not_the_first_forward_one():
    lowest = SimpleNamespace(
        whirl=("mixed", "backward", "mixed", "forward"),
        forwardness=np.array([-0.84, -0.23, 0.3, 0.9]),
        damping_ratio=np.full(4, 0.05),
    )
    assert first_forward._place(lowest) == 2


@pytest.mark.parametrize(("damping", "speed"), [(0.0, 50.0), (0.0, 300.0), (1.0, 300.0)])
def test_a_motion_that_nothing_holds_is_not_the_first_forward_mode(damping, speed):
    """Its frequency is rounding. The first forward mode is the cone about the centre of mass, whose
    frequency is the speed times I_p / I_d of rotor and disc, 0.31."""
    rotor = parse_rotor(SHAFT + support(1, 0.0, damping) + support(7, 0.0, damping))
    result = level_1(rotor, speed, stiffness=[0.0])
    assert result.first_frequency[0] == pytest.approx(0.31 * speed, rel=0.02)
