"""What API 617 and 684 ask for: amplification factors, margins, unbalances placed by mode shape;
against closed forms and against ROSS 2.3 (tests/reference/make_ross_api.py made its numbers)."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import (
    LinearError,
    critical_map,
    critical_peaks,
    level_1,
    level_2,
    placed_unbalances,
    static,
    unbalance_check,
    unbalance_response,
)
from rotor_fmu.model.linear.amplification import Margin, Peak, margin, peaks, required_margin
from rotor_fmu.model.linear.unbalance_placement import residual_unbalance, vibration_limit
from rotor_fmu.model.machine.operating_speeds import Operation
from rotor_fmu.model.machine.toml import parse_rotor, rig

from tests.linear.api_617 import CLOSE, ROSS, RPM, SHAFT, example, support
from tests.validation.test_ross import machine


def one_degree(zeta, natural=100.0):
    """A mass on a spring under unbalance: the amplitude over the speed."""

    def response(speed):
        r = speed / natural
        return r**2 / math.hypot(1 - r**2, 2 * zeta * r)

    return response


def grid(zeta):
    return np.linspace(1.0, 300.0, 50 + int(20 / zeta))


@pytest.mark.parametrize("zeta", [0.005, 0.02, 0.05])
def test_the_amplification_factor_of_one_degree_of_freedom_is_half_the_inverse_damping(zeta):
    (peak,) = peaks(one_degree(zeta), grid(zeta))
    assert peak.amplification == pytest.approx(1 / (2 * zeta), rel=0.02)


@pytest.mark.parametrize("zeta", [0.02, 0.1, 0.2])
def test_critical_speed_and_half_power_speeds_are_those_of_the_closed_form(zeta):
    """With s = (natural / speed)^2 the inverse square of the amplitude is (s - 1)^2 + 4 zeta^2 s:
    a parabola, least at 1 - 2 zeta^2 and twice that at 2 zeta sqrt(1 - zeta^2) on either side."""
    (peak,) = peaks(one_degree(zeta), grid(zeta))
    middle, half = 1 - 2 * zeta**2, 2 * zeta * math.sqrt(1 - zeta**2)
    assert peak.speed == pytest.approx(100 / math.sqrt(middle), rel=1e-6)
    assert peak.below == pytest.approx(100 / math.sqrt(middle + half), rel=1e-6)
    assert peak.above == pytest.approx(100 / math.sqrt(middle - half), rel=1e-6)


def test_a_peak_beside_a_higher_one_has_one_side():
    def response(speed):
        return 1 / (1 + (speed - 100) ** 2) + 2 / (1 + ((speed - 103) / 1.2) ** 2)

    low, high = peaks(response, np.linspace(90, 110, 2001))
    assert math.isnan(low.above)
    assert low.is_one_sided
    assert low.amplification == pytest.approx(low.speed / (2 * (low.speed - low.below)))
    assert not high.is_one_sided


def test_two_peaks_that_run_into_each_other_have_one_side_each():
    """Neither is as wide as both."""

    def response(speed):
        return 1 / (1 + (speed - 100) ** 2) + 0.9 / (1 + (speed - 102) ** 2)

    first, second = peaks(response, np.linspace(90, 110, 2001))
    assert math.isnan(first.above)
    assert math.isnan(second.below)
    for peak, half in ((first, first.speed - first.below), (second, second.above - second.speed)):
        assert peak.amplification == pytest.approx(peak.speed / (2 * half))


def test_a_response_without_a_peak_has_no_critical_speed():
    assert peaks(one_degree(0.8), grid(0.8)) == []


@pytest.mark.parametrize(
    ("factor", "is_above", "expected"),
    [
        (5.0, False, 0.17 * (1 - 1 / 3.5)),
        (5.0, True, 0.10 + 0.17 * (1 - 1 / 3.5)),
        (2.49, False, 0.0),
        (2.49, True, 0.0),
        (2.5, False, 0.0),
        (2.5, True, 0.10),
        (40.0, False, 0.16),
        (40.0, True, 0.26),
    ],
)
def test_required_margins_are_those_of_api_617(factor, is_above, expected):
    """API 617, 7th edition, part 1, 2.6.2."""
    assert required_margin(factor, is_above) == pytest.approx(expected, abs=1e-12)


def test_margins_are_shares_of_the_nearer_end_of_the_range():
    def at(speed, width=0.2):  # AF = 5
        half = width * speed / 2
        return margin(Peak(speed, 1.0, speed - half, speed + half), 100.0, 200.0)

    assert at(80.0).actual == pytest.approx(0.2)
    assert at(80.0).is_met
    assert at(230.0).actual == pytest.approx(0.15)
    assert not at(230.0).is_met
    for within in (100.0, 150.0, 200.0):
        assert at(within) == Margin(required_margin(5.0, is_above=True), 0.0)
        assert not at(within, 0.4).is_met  # AF = 2.5, which needs none below the range


def test_limits_are_those_of_api_617():
    """6350 W / N g.mm, W / 3.937 from 25 000 rev/min on; 25.4 um sqrt(12000 / N)."""
    assert residual_unbalance(100.0, 10_000 * RPM) == pytest.approx(63.5e-6)
    assert residual_unbalance(100.0, 40_000 * RPM) == pytest.approx(100 / 3.937 * 1e-6, rel=1e-5)
    assert vibration_limit(6000 * RPM) == pytest.approx(25.4e-6)
    assert vibration_limit(48_000 * RPM) == pytest.approx(12.7e-6)


@pytest.mark.parametrize(
    "file", ["on_pedestals.json", pytest.param("under_tension.toml", marks=pytest.mark.slow)]
)
def test_critical_speeds_and_amplification_factors_are_those_of_ross(file):
    of_ross = ROSS[file]["peaks"]
    unbalances = [(node + 1, amount, phase) for node, amount, phase in of_ross["unbalances"]]
    result = critical_peaks(machine(file), 1200.0, [of_ross["node"] + 1], unbalances=unbalances)
    for expected in of_ross["found"]:
        seen = [c.peak for c in result if c.axis == expected["axis"]]
        peak = min(seen, key=lambda p: abs(p.speed - expected["speed"]))
        assert peak.speed == pytest.approx(expected["speed"], rel=CLOSE)
        assert peak.amplification == pytest.approx(expected["factor"], rel=CLOSE)


def test_unbalances_stand_where_the_mode_bends():
    """First mode: one in the middle for the whole weight; second: one a half, against each
    other, each for the load of its bearing."""
    rotor = parse_rotor(SHAFT + support(1, 1e8) + support(7, 1e8))
    mass = float(sum(s.material.density * math.pi / 4 * 0.03**2 * 0.1 for s in rotor.sections))
    mass += 7800 * math.pi / 4 * 0.2**2 * 0.03
    speed = 10_000 * RPM
    (first,) = placed_unbalances(rotor, 1, speed)
    assert first.node == 4
    assert first.mass == pytest.approx(mass, rel=1e-6)
    assert first.amount == pytest.approx(2 * 6350e-6 * mass / 10_000, rel=1e-6)
    left, right = placed_unbalances(rotor, 2, speed, factor=1.0)
    assert left.node < 4 < right.node
    assert abs(left.phase - right.phase) == pytest.approx(math.pi)
    assert left.mass + right.mass == pytest.approx(mass, rel=1e-6)


@pytest.mark.parametrize(("diameter", "mode", "nodes"), [(0.6, 2, [2, 5]), (0.2, 3, [6])])
def test_a_lobe_of_less_than_a_quarter_of_the_largest_has_no_unbalance(diameter, mode, nodes):
    """Of 0.29 it has one; of 0.21 none, and the other one is for the whole weight."""
    disc = SHAFT.replace("node = 4", "node = 3").replace("= 0.2\n", f"= {diameter}\n")
    placed = placed_unbalances(parse_rotor(disc + support(1, 1e9) + support(7, 1e9)), mode, 300.0)
    assert [p.node for p in placed] == nodes
    mass = 7800 * math.pi / 4 * (diameter**2 * 0.03 + 0.03**2 * 0.6)
    assert sum(p.mass for p in placed) == pytest.approx(mass, rel=1e-6)


def test_unbalances_of_a_vertical_rotor_stand_where_it_moves_as_one_body():
    """In plain films that nothing loads, which have no direct stiffness: mode 1 moves it across,
    mode 2 tilts it, each for the load that it would have lying."""
    lying = example("oil_film")
    rotor = replace(lying, inclination=math.pi / 2)
    (whole,) = placed_unbalances(rotor, 1, 400.0)
    left, right = placed_unbalances(rotor, 2, 400.0)
    assert (left.node, right.node) == (1, 7)
    assert abs(left.phase - right.phase) == pytest.approx(math.pi)
    loads = -static(lying, 400.0).load_y / lying.gravity
    assert [left.mass, right.mass] == pytest.approx(loads, rel=1e-3)
    assert whole.mass == pytest.approx(loads.sum(), rel=1e-3)


@pytest.mark.parametrize(("end", "bearings"), [(7, (1, 5)), (7, (1, 6)), (1, (3, 7)), (1, (2, 7))])
def test_an_overhung_disc_has_the_unbalance_of_its_overhung_mass(end, bearings):
    """Of all that lies beyond the bearing, by however many elements that is."""
    held = "".join(support(node, 1e9) for node in bearings)
    rotor = parse_rotor(SHAFT.replace("node = 4", f"node = {end}") + held)
    (placed,) = placed_unbalances(rotor, 1, 5000 * RPM)
    assert placed.node == end
    length = min(abs(rotor.nodes[end - 1] - rotor.nodes[node - 1]) for node in bearings)
    mass = 7800 * math.pi / 4 * (0.2**2 * 0.03 + 0.03**2 * length)
    assert placed.mass == pytest.approx(mass, rel=1e-9)


def test_discs_overhung_at_both_ends_have_unbalances_as_the_mode_moves_them():
    """By symmetry as one, or against one another; one that hardly moves has none."""
    both = SHAFT + SHAFT[SHAFT.index("[[") :].replace("node = 4", "node = 1")
    both = both.replace("node = 4", "node = 7") + support(3, 1e7) + support(5, 1e7)
    pairs = [placed_unbalances(parse_rotor(both), mode, 5000 * RPM) for mode in (1, 2)]
    for pair in pairs:
        assert [placed.node for placed in pair] == [1, 7]
        assert pair[0].mass == pytest.approx(pair[1].mass)
    assert {abs(left.phase - right.phase) for left, right in pairs} == {0.0, math.pi}
    light = both.replace("width = 0.03", "width = 0.002", 1)
    (placed,) = placed_unbalances(parse_rotor(light), 1, 5000 * RPM)
    assert placed.node == 1
    assert type(placed.mass) is float


def test_a_rotor_that_lifts_one_bearing_has_the_unbalance_of_its_weight():
    """Overhung, its third mode bends between the bearings, which bear 7.4 kg upwards and 18 kg
    downwards: together the mass of the rotor, 10.7 kg."""
    overhung = SHAFT.replace("node = 4", "node = 7")
    rotor = parse_rotor(overhung + support(1, 1e7) + support(4, 1e7))
    assert static(rotor).load_y[0] > 0.0
    mass = 7800 * math.pi / 4 * (0.2**2 * 0.03 + 0.03**2 * 0.6)
    (placed,) = placed_unbalances(rotor, 3, 5000 * RPM)
    assert placed.node in (2, 3)
    assert placed.mass == pytest.approx(mass, rel=1e-6)
    # of two lobes each has that of the bearing next to it, which is a size
    lobes = placed_unbalances(rotor, 4, 5000 * RPM)
    loads = np.abs(static(rotor).load_y) / rotor.gravity
    np.testing.assert_allclose([p.mass for p in lobes], loads, rtol=1e-6)


def test_the_check_scales_until_the_probes_read_their_limit_and_sees_the_clearance():
    rotor = parse_rotor(SHAFT + support(1, 1e7, 500.0) + support(7, 1e7, 500.0))
    placed = [p[:3] for p in placed_unbalances(rotor, 1, 3000 * RPM)]
    result = unbalance_check(
        rotor, 2500 * RPM, 3000 * RPM, [2], unbalances=placed, clearances={4: 2e-5}
    )
    assert result.scale * result.probes[0].peak_to_peak == pytest.approx(25.4e-6)
    (gap,) = result.clearances
    assert gap.scaled == pytest.approx(result.scale * gap.amplitude)
    critical = replace(result.criticals[0], margin=None)
    room = replace(gap, scaled=0.74 * gap.clearance)
    met = replace(result, criticals=(critical,), clearances=(room,))
    assert met.is_met
    for changes in (
        {"criticals": (replace(critical, margin=Margin(0.2, 0.1)),)},
        {"limit": 0.9 * result.probes[0].peak_to_peak},
        {"clearances": (replace(gap, scaled=0.76 * gap.clearance),)},
    ):
        assert not replace(met, **changes).is_met
    doubled = unbalance_check(
        rotor,
        2500 * RPM,
        3000 * RPM,
        [2],
        unbalances=[(n, 2 * u, p) for n, u, p in placed],
        clearances={4: 2e-5},
    )
    assert doubled.clearances[0].scaled == pytest.approx(gap.scaled)


@pytest.mark.parametrize("damping", [5.0, pytest.param(500.0, marks=pytest.mark.slow)])
def test_the_level_of_a_probe_is_that_of_the_peak_itself(damping):
    rotor = parse_rotor(SHAFT + support(1, 1e7, damping) + support(7, 1e7, damping))
    placed = [p[:3] for p in placed_unbalances(rotor, 1, 3000 * RPM)]
    ends = (400.0, 450.0)
    result = unbalance_check(rotor, *ends, [2, 4], unbalances=placed, clearances={4: 1e-3})

    def major(speed, node):
        return unbalance_response(rotor, [speed], unbalances=placed).major[0, node - 1]

    for probe in result.probes:
        fine = probe.speed * (1 + np.linspace(-1e-5, 1e-5, 21))
        most = max(major(speed, probe.node) for speed in fine)
        assert probe.peak_to_peak == pytest.approx(2 * most, rel=1e-6)
    assert result.clearances[0].amplitude == pytest.approx(result.probes[1].peak_to_peak / 2)


@pytest.mark.parametrize("share", [pytest.param(1.1, marks=pytest.mark.slow), 1.7])
def test_a_clearance_is_checked_up_to_the_trip_speed(share):
    """Below a critical speed the motion grows with the speed, so that it is largest there."""
    rotor = parse_rotor(SHAFT + support(1, 1e7, 500.0) + support(7, 1e7, 500.0))
    high, tripped = 500 * RPM, replace(rotor, operation=Operation(trip_speed=share * 500 * RPM))
    acting = {"unbalances": [(4, 1e-5, 0.0)], "clearances": {4: 1e-3}}
    (until,) = unbalance_check(tripped, high, high, [4], **acting).clearances
    expected = unbalance_response(rotor, [share * high], unbalances=acting["unbalances"])
    assert until.speed == pytest.approx(share * high)
    assert until.amplitude == pytest.approx(expected.major[0, 3])
    slower = replace(rotor, operation=Operation(trip_speed=0.9 * high))
    for other in (rotor, slower):  # a range that is given may end above the trip speed
        (without,) = unbalance_check(other, high, high, [4], **acting).clearances
        assert without.speed == pytest.approx(high)
    heavy = unbalance_check(rotor, high, high, [4], **acting | {"unbalances": [(4, 1.0, 0.0)]})
    assert heavy.scale < 1.0  # it is never scaled down
    assert heavy.clearances[0].scaled == heavy.clearances[0].amplitude


def test_a_critical_speed_just_within_the_largest_margin_is_seen():
    """A sharp one at 1.255 times the highest speed, of which 26 % are required."""
    rotor = parse_rotor(SHAFT + support(1, 1e7, 500.0) + support(7, 1e7, 500.0))
    placed = [p[:3] for p in placed_unbalances(rotor, 1, 3000 * RPM)]
    natural = unbalance_check(rotor, 2500 * RPM, 3000 * RPM, [4], unbalances=placed).criticals
    speed = natural[0].peak.speed
    high = speed / 1.255
    seen = unbalance_check(rotor, 0.9 * high, high, [4], unbalances=placed).criticals
    assert [critical.axis for critical in seen] == ["x", "y"]
    for critical in seen:
        assert critical.peak.speed == pytest.approx(speed, rel=1e-6)
        assert not critical.peak.is_one_sided
        assert critical.margin.actual == pytest.approx(0.255, rel=1e-5)
        assert not critical.margin.is_met


@pytest.mark.parametrize(
    ("ask", "expected"),
    [
        (lambda: placed_unbalances(rig(), 99, 100.0), "mode = 99: must be an integer from 1"),
        (lambda: placed_unbalances(rig(), 1, 0.0), "maximum continuous speed = 0"),
        (lambda: unbalance_check(rig(), 200.0, 100.0, [1]), "operating range = 200 to 100"),
        (lambda: unbalance_check(rig(), 100.0, 200.0, [99]), "node = 99"),
        (lambda: level_1(rig(), -1.0), "speed = -1 rad/s: must be > 0"),
        (lambda: level_1(rig(), 100.0, node=99), "node = 99: must be an integer from 1 to 8"),
        (lambda: level_2(rig(), 100.0, cross_couplings={99: 1.0}), "node = 99"),
    ],
)
def test_impossible_input_is_named(ask, expected):
    with pytest.raises(LinearError, match=expected):
        ask()


def test_in_films_the_unbalance_is_placed_by_what_they_bear_as_the_shaft_turns():
    (placed,) = placed_unbalances(example("oil_film"), 1, 600.0)
    shaft = 7850.0 * math.pi / 4 * 0.02**2 * 0.5
    assert placed.mass == pytest.approx(4.0 + shaft, rel=1e-6)
    assert placed.node == 4


def test_a_peak_without_damping_is_one_whose_factor_is_infinite():
    rotor = parse_rotor(SHAFT + support(1, 3e6) + support(7, 3e6))
    expected = critical_map(rotor, [1e6, 3e6], count=1).speeds[1, 0]
    seen = critical_peaks(rotor, 1.2 * expected, [4], unbalances=[(4, 1e-5, 0.0)])
    assert [c.axis for c in seen] == ["x", "y"]
    for critical in seen:
        assert critical.peak.speed == pytest.approx(expected, rel=1e-6)
        assert critical.peak.amplification > 1e6
        assert required_margin(critical.peak.amplification, is_above=True) == 0.26


def test_a_node_that_does_not_move_has_no_peaks_of_rounding():
    """The middle of a symmetric rotor, its unbalances against each other."""
    rotor = example("squeeze_film")
    result = unbalance_check(
        rotor, 500.0, 500.0, [1, 2], unbalances=[(1, 1e-5, 0.0), (3, 1e-5, math.pi)]
    )
    assert not [c for c in result.criticals if c.node == 2]
