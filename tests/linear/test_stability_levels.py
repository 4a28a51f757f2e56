"""Stability levels 1 and 2 of API 617: against closed forms, eigenvalues and ROSS 2.3."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import Stage, level_1, level_2, modes
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.linear_bearing import LinearBearing, Seal

from rotor_fmu.linear import stability_answers
from tests.linear.api_617 import CLOSE, ROOT, ROSS, RPM, SHAFT, coupling, support
from tests.validation.test_ross import machine


@pytest.mark.parametrize("file", ROSS)
def test_level_1_is_that_of_ross(file):
    expected = ROSS[file]["level_1"]
    result = level_1(
        machine(file), 900.0, node=4, stiffness=expected["stiffness"], seals=True, contacts="open"
    )
    scale = np.abs(expected["log_dec"]).max()
    first = result.first_log_dec
    np.testing.assert_allclose(first, expected["log_dec"], rtol=CLOSE, atol=CLOSE * scale)
    assert (result.log_dec <= first).all()


def test_alford_s_cross_coupling_is_that_of_the_formula_in_its_own_units():
    """API 617: q = HP B C / (D H N) (rho_d / rho_s) with N.m/s, mm, rev/min, C = 9.55, B = 3, q
    in kN/mm."""
    stage = Stage(3, 2000e3, 0.4, 0.02, 1.6)
    expected = 2000e3 * 3 * 9.55 / (400 * 20 * 9000) * 1.6 * 1e6
    assert stage.cross_coupling(9000 * RPM) == pytest.approx(expected, rel=1e-4)


def test_the_rotor_is_unstable_from_the_threshold_on():
    rotor = machine("under_tension.toml")
    result = level_1(rotor, 900.0, node=4, anticipated=5e3)
    below, above = (
        level_1(rotor, 900.0, node=4, stiffness=[q * result.threshold]).log_dec[0]
        for q in (0.999, 1.001)
    )
    assert below > 0 > above
    assert result.ratio == pytest.approx(result.threshold / 5e3)
    assert result.sensitivity < 0
    # of API 617 the range need only hold the smaller of these two
    assert result.stiffness[[0, -1]] == pytest.approx([0.0, 10 * 5e3])
    assert result.threshold < 5e4


def test_a_jeffcott_rotor_is_unstable_where_the_cross_coupling_is_its_damping_times_its_frequency():
    """Q0 = c omega, of a mass between two bearings, and log dec = pi (c omega - q) / k nearly."""
    text = SHAFT.replace("diameters = [0.03", "diameters = [0.1").replace("0.03,", "0.1,")
    rotor = parse_rotor(text + support(4, 1e4, 2.0) + support(1, 1e-3) + support(7, 1e-3))
    result = level_1(rotor, 50.0, node=4)
    assert result.threshold == pytest.approx(2.0 * result.frequency[0], rel=1e-3)


def test_without_gyroscopic_moments_the_forward_mode_is_the_one_that_cross_coupling_drives():
    """A point mass on a light shaft: Q0 = c omega exactly, where both circles have one eigenvalue
    without cross coupling."""
    text = (ROOT / "examples" / "jeffcott_rub" / "jeffcott.toml").read_text()
    result = level_1(parse_rotor(text), 150.0, node=2)
    assert result.threshold == pytest.approx(20.0 * 100.0, rel=1e-3)
    assert result.log_dec_alone == pytest.approx(2 * math.pi * 0.1 / math.sqrt(1 - 0.01), rel=1e-3)
    # the root of s^2 + 20 s + 1e4 - i q has the derivative 1 / (2 omega_d) by q
    assert result.sensitivity == pytest.approx(-math.pi / (1e4 - 10.0**2), rel=1e-3)
    # Q0 is within the range without QA too, and what is beyond it
    assert result.stiffness[[0, -1]] == pytest.approx([0.0, 1.2 * result.threshold])
    assert result.log_dec[-1] < 0 < result.log_dec[0]


def test_on_stiffnesses_that_differ_cross_coupling_has_to_overcome_their_difference_too():
    """Q0^2 = (ky - kx)^2 / 4 + c^2 (kx + ky) / (2 m), of a point mass with k = 10 kN/m, c = 20
    N.s/m, m = 1 kg, by the characteristic polynomial of its two coordinates."""
    text = (ROOT / "examples" / "jeffcott_rub" / "jeffcott.toml").read_text()
    bearing = "[[linear_bearing]]\nnode = 2\nkxx = {}\nkyy = {}\ncxx = 0.0\ncyy = 0.0\n"
    for kxx, kyy in ((0.0, 3e3), (3e3, 0.0), (0.0, 300.0)):
        rotor = parse_rotor(text + bearing.format(kxx, kyy))
        expected = math.hypot((kyy - kxx) / 2, 20.0 * math.sqrt((2e4 + kxx + kyy) / 2))
        assert level_1(rotor, 150.0, node=2).threshold == pytest.approx(expected, rel=1e-3)


def test_below_the_threshold_no_mode_of_the_rotor_grows_and_above_one_does():
    """Of a rotor whose lowest mode whirls forward without cross coupling, and backward with it."""
    rotor = parse_rotor(ANISOTROPIC)
    result = level_1(rotor, 1152.0, node=4)
    for share, grows in ((0.2, False), (0.99, False), (1.01, True)):
        q = share * result.threshold
        coupled = replace(rotor, parts=(*rotor.parts, coupling(4, q)))
        assert (modes(coupled, 1152.0, count=8).eigenvalues.real > 0).any() == grows
    assert (np.diff(result.log_dec[10:]) < 0).all()


ANISOTROPIC = """
name = "compressor"
[material]
young = 2.1e11
density = 7833.0
[shaft]
nodes = [0.0, 0.254, 0.4572, 0.635, 0.8, 1.016, 1.27]
diameters = [0.1, 0.1, 0.115, 0.127, 0.115, 0.1]
eta_v = 2e-5
[[disc]]
node = 3
diameter = 0.406
width = 0.0508
[[disc]]
node = 5
diameter = 0.406
width = 0.0508
""" + "".join(
    f"[[linear_bearing]]\nnode = {node}\nkxx = 1e8\nkyy = 1.2e8\ncxx = 1e5\ncyy = 1e5\n"
    for node in (2, 6)
)


def test_level_2_adds_what_acts_one_by_one():
    rotor = machine("compressor.toml")
    result = level_2(rotor, 900.0, cross_couplings={4: 1e6})
    names = [case.name for case in result.cases]
    assert names == ["rotor and bearings", "with seal[1]", "with the cross coupling", "with all"]
    everything = level_1(rotor, 900.0, node=4, stiffness=[1e6], seals=True)
    assert result.cases[-1].log_dec == pytest.approx(everything.log_dec[0])
    bare = replace(rotor, parts=tuple(p for p in rotor.parts if not isinstance(p, Seal)))
    assert result.cases[0].log_dec == pytest.approx(level_1(bare, 900.0).log_dec_alone)


@pytest.mark.parametrize("q", [0.0, 3e7])
def test_both_levels_are_of_the_same_mode(q):
    """Of a rotor on bearings that differ in x and y, where the lowest mode that is not backward
    becomes another one by cross coupling."""
    rotor = parse_rotor(ANISOTROPIC)
    of_1 = level_1(rotor, 1152.0, node=4, anticipated=q, stiffness=[q])
    of_2 = level_2(rotor, 1152.0, cross_couplings={4: q} if q else None)
    assert of_2.cases[0].log_dec == pytest.approx(of_1.log_dec_alone, rel=1e-9)
    assert of_2.cases[-1].log_dec == pytest.approx(of_1.log_dec_anticipated, rel=1e-6)


def test_a_second_mode_that_grows_is_seen_at_both_levels():
    """Damping in the middle, where the second mode has a node, and the opposite of it beside."""
    sides = "".join(
        f"[[linear_bearing]]\nnode = {node}\nkxx = 0\nkyy = 0\ncxx = -50\ncyy = -50\n"
        for node in (2, 6)
    )
    rotor = parse_rotor(SHAFT + support(1, 1e8) + support(7, 1e8) + support(4, 1e3, 500.0) + sides)
    seen = modes(rotor, 50.0)
    lowest = int(np.argmin(seen.log_dec))
    assert seen.log_dec[:2].min() > 0 > seen.log_dec[lowest]
    of_1, of_2 = level_1(rotor, 50.0, stiffness=[0.0]), level_2(rotor, 50.0)
    for found in (of_1.log_dec_alone, of_2.cases[0].log_dec):
        assert found == pytest.approx(seen.log_dec[lowest], rel=1e-6)
    assert of_1.threshold == 0.0
    assert of_1.is_level_2_required
    assert not of_2.is_met


def test_a_seal_that_makes_another_mode_grow_is_seen():
    """Without it every mode decays."""
    text = SHAFT + support(1, 1e8) + support(7, 1e8) + support(4, 1e3, 500.0)
    seal = "[[seal]]\nnode = 2\nkxx = 0\nkyy = 0\ncxx = -100\ncyy = -100\n"
    rotor = parse_rotor(text + support(2, 1.0, 5.0) + support(6, 1.0, 5.0) + seal)
    alone, with_seal = level_2(rotor, 50.0).cases
    assert alone.log_dec > 0 > with_seal.log_dec
    assert with_seal.log_dec == pytest.approx(modes(rotor, 50.0).log_dec.min(), rel=1e-6)


def test_cross_coupling_does_not_move_a_journal_in_its_film():
    """Both levels are those of the machine on bearings with the coefficients that its films have
    where gravity alone holds it."""
    text = (ROOT / "examples" / "oil_film" / "rotor.toml").read_text()
    rotor, speed, q = parse_rotor(text), 300.0, 1e3
    machine = LinearMachine(rotor)
    linear, names = machine.at(speed), machine.supports.interfaces
    fixed = {
        where: LinearBearing(
            node=part.node,
            **{
                letter + axes: -float(tangent[names.index(where)][i, j])
                for letter, tangent in (("k", linear.laws.by_d), ("c", linear.laws.by_v))
                for axes, i, j in (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
            },
        )
        for where, part in rotor.named_parts()
        if isinstance(part, JournalBearing)
    }
    assert len(fixed) == 2
    kept = tuple(fixed.get(where, part) for where, part in rotor.named_parts())
    same = replace(rotor, parts=kept)
    for node in (2, 4):
        one, other = (level_1(r, speed, node=node, anticipated=q) for r in (rotor, same))
        assert one.log_dec_anticipated == pytest.approx(other.log_dec_anticipated, rel=1e-6)
        assert one.threshold == pytest.approx(other.threshold, rel=1e-6)
        cases = [level_2(r, speed, cross_couplings={node: q}).cases[-1] for r in (rotor, same)]
        assert cases[0].log_dec == pytest.approx(cases[1].log_dec, rel=1e-6)


@pytest.mark.parametrize(
    ("share", "is_required", "depends"),
    [(0.6, True, False), (0.4, False, True), (0.12, False, True), (0.08, False, False)],
)
def test_level_1_asks_for_the_gas_density_where_q0_is_two_to_ten_times_qa(
    share, is_required, depends
):
    """QA and Q0 = 2 kN/m of a rotor whose logarithmic decrement is 0.63 (1 - QA / Q0)."""
    text = (ROOT / "examples" / "jeffcott_rub" / "jeffcott.toml").read_text()
    result = stability_answers.level_1(
        parse_rotor(text), 150.0, node=2, anticipated=share * 2000.0, stiffness=[0.0]
    )
    assert result.is_level_2_required == is_required
    assert result.depends_on_density == depends
    assert ("region B of API 617" in result.table().title) == depends
