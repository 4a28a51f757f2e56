"""What API 617 and 684 ask for: amplification factors and margins, the critical speed map,
unbalances placed by mode shape; against closed forms and against ROSS 2.3
(tests/reference/make_ross_api.py made its numbers)."""

import json
import math

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.linear import (
    LinearError,
    LinearMachine,
    critical_map,
    critical_peaks,
    level_1,
    level_2,
    placed_unbalances,
    static,
    unbalance_check,
    unbalance_response,
)
from rotor_fmu.model.linear.amplification import Peak, margin, peaks, required_margin
from rotor_fmu.model.linear.unbalance_placement import residual_unbalance, vibration_limit
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.parts.linear_bearing import LinearBearing

from tests.validation.test_ross import HERE, machine

ROSS = json.loads((HERE / "ross_api_answers.json").read_text())
ROOT = HERE.parent.parent
RPM = math.pi / 30
CLOSE = 1e-4


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
    def at(speed):  # AF = 5
        return margin(Peak(speed, 1.0, 0.9 * speed, 1.1 * speed), 100.0, 200.0)

    assert at(80.0).actual == pytest.approx(0.2)
    assert at(80.0).is_met
    assert at(230.0).actual == pytest.approx(0.15)
    assert not at(230.0).is_met
    assert at(150.0).actual == 0.0
    assert not at(150.0).is_met


def test_limits_are_those_of_api_617():
    """6350 W / N g.mm, W / 3.937 from 25 000 rev/min on; 25.4 um sqrt(12000 / N)."""
    assert residual_unbalance(100.0, 10_000 * RPM) == pytest.approx(63.5e-6)
    assert residual_unbalance(100.0, 40_000 * RPM) == pytest.approx(100 / 3.937 * 1e-6, rel=1e-5)
    assert vibration_limit(6000 * RPM) == pytest.approx(25.4e-6)
    assert vibration_limit(48_000 * RPM) == pytest.approx(12.7e-6)


@pytest.mark.parametrize("file", ROSS)
@pytest.mark.parametrize("is_synchronous", [False, True])
def test_the_critical_map_is_that_of_ross(file, is_synchronous):
    lines = ROSS[file]["critical_map"]["synchronous" if is_synchronous else "at rest"]
    result = critical_map(
        machine(file),
        np.logspace(6, 9, 7),
        synchronous=is_synchronous,
        rigid_pedestals=True,
        contacts="open",
    )
    np.testing.assert_allclose(result.speeds.T, lines, rtol=CLOSE)


def test_on_the_stiffness_of_its_bearings_the_map_has_the_undamped_critical_speeds():
    """Of a rotor on isotropic springs with little damping: where the unbalance response peaks."""
    rotor = parse_rotor(SHAFT + support(1, 3e6, 10.0) + support(7, 3e6, 10.0))
    result = critical_map(rotor, [1e6, 3e6, 1e7], count=2)
    top = 1.2 * result.speeds[1, 1]
    criticals = critical_peaks(rotor, top, [6], unbalances=[(5, 1e-5, 0.0)])
    speeds = [c.peak.speed for c in criticals if c.axis == "x"]
    np.testing.assert_allclose(speeds, result.speeds[1], rtol=1e-3)
    crossings = [c for c in result.crossings if c.mode == 0]
    assert {c.bearing for c in crossings} == {"support[1]", "support[2]"}
    assert all(c.stiffness == pytest.approx(3e6) for c in crossings)


def test_a_bearing_over_the_speed_meets_a_line_where_it_has_that_stiffness():
    result = critical_map(machine("compressor.toml"), np.geomspace(1e7, 1e9, 9), count=2)
    bearing = machine("compressor.toml").of_kind(LinearBearing)[0]
    crossing = next(
        c for c in result.crossings if (c.bearing, c.axis, c.mode) == ("linear_bearing[1]", "x", 0)
    )
    K, _ = bearing.matrices(crossing.speed)
    assert K[0, 0] == pytest.approx(crossing.stiffness, rel=1e-9)


@pytest.mark.parametrize("file", [file for file in ROSS if "peaks" in ROSS[file]])
def test_critical_speeds_and_amplification_factors_are_those_of_ross(file):
    of_ross = ROSS[file]["peaks"]
    unbalances = [(node + 1, amount, phase) for node, amount, phase in of_ross["unbalances"]]
    result = critical_peaks(machine(file), 1200.0, [of_ross["node"] + 1], unbalances=unbalances)
    for expected in of_ross["found"]:
        seen = [c.peak for c in result if c.axis == expected["axis"]]
        peak = min(seen, key=lambda p: abs(p.speed - expected["speed"]))
        assert peak.speed == pytest.approx(expected["speed"], rel=CLOSE)
        assert peak.amplification == pytest.approx(expected["factor"], rel=CLOSE)


SHAFT = """
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
diameters = [0.03, 0.03, 0.03, 0.03, 0.03, 0.03]
[[disc]]
node = 4
diameter = 0.2
width = 0.03
"""


def support(node, stiffness, damping=0.0):
    return f"[[support]]\nnode = {node}\nstiffness = {stiffness}\ndamping = {damping}\n"


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


def test_an_overhung_disc_has_the_unbalance_of_its_overhung_mass():
    rotor = parse_rotor(SHAFT.replace("node = 4", "node = 7") + support(1, 1e9) + support(5, 1e9))
    (placed,) = placed_unbalances(rotor, 1, 5000 * RPM)
    assert placed.node == 7
    disc = 7800 * math.pi / 4 * 0.2**2 * 0.03
    shaft = 7800 * math.pi / 4 * 0.03**2 * 0.2
    assert disc + 0.5 * shaft < placed.mass < disc + shaft


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
    doubled = unbalance_check(
        rotor,
        2500 * RPM,
        3000 * RPM,
        [2],
        unbalances=[(n, 2 * u, p) for n, u, p in placed],
        clearances={4: 2e-5},
    )
    assert doubled.clearances[0].scaled == pytest.approx(gap.scaled)


@pytest.mark.parametrize("damping", [5.0, 500.0])
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
        (lambda: critical_map(rig(), [1e6, 1e5]), "stiffness: must be at least 2 values"),
        (lambda: critical_map(rig(), [1e6, 1e7], count=0), "count = 0"),
        (lambda: placed_unbalances(rig(), 99, 100.0), "mode = 99: must be from 1"),
        (lambda: placed_unbalances(rig(), 1, 0.0), "maximum continuous speed = 0"),
        (lambda: unbalance_check(rig(), 200.0, 100.0, [1]), "operating range = 200 to 100"),
        (lambda: unbalance_check(rig(), 100.0, 200.0, [99]), "node = 99"),
        (lambda: level_1(rig(), -1.0), "speed = -1 rad/s: must be > 0"),
        (lambda: level_1(rig(), 100.0, node=99), "node = 99: must be from 1 to 8"),
        (lambda: level_2(rig(), 100.0, cross_couplings={99: 1.0}), "node = 99"),
    ],
)
def test_impossible_input_is_named(ask, expected):
    with pytest.raises(LinearError, match=expected):
        ask()


def example(name):
    return parse_rotor((ROOT / "examples" / name / "rotor.toml").read_text())


@pytest.mark.parametrize("name", ["rolling_bearing", "oil_film"])
def test_the_own_stiffness_of_a_bearing_is_that_of_its_force_where_the_machine_rests(name):
    """By the loads and the displacements of two small further forces on the shaft, at the speed
    of the crossing."""
    rotor = example(name)
    for crossing in critical_map(rotor, [1e5, 1e6, 1e7, 1e8], count=1).crossings:
        node = dict(rotor.named_parts())[crossing.bearing].node

        def at_rest(x, y, node=node, crossing=crossing):
            seen = static(rotor, crossing.speed, loads=[(node, x, y)])
            i = seen.supports.index(crossing.bearing)
            moved = np.array([seen.x[node - 1], seen.y[node - 1]])
            return moved, np.array([seen.load_x[i], seen.load_y[i]])

        (before, no_load), *after = at_rest(0.0, 0.0), at_rest(0.01, 0.0), at_rest(0.0, 0.01)
        moved = np.column_stack([moved - before for moved, _ in after])
        loaded = np.column_stack([load - no_load for _, load in after])
        stiffness = np.diag(loaded @ np.linalg.inv(moved))
        axis = "xy".index(crossing.axis)
        assert crossing.stiffness == pytest.approx(stiffness[axis], rel=2e-3)


def on_pedestals(kx, ky, bearings=1e6):
    """Two discs, one overhung, on bearings in housings of 4 kg."""
    more = "[[disc]]\nnode = 7\ndiameter = 0.25\nwidth = 0.03\n"
    for node in (1, 5):
        more += f'[[housing]]\nname = "h{node}"\nmass = 4.0\nkx = {kx}\nky = {ky}\ncx = 0\ncy = 0\n'
        more += f'[[linear_bearing]]\nnode = {node}\nhousing = "h{node}"\n'
        more += f"kxx = {bearings}\nkyy = {bearings}\ncxx = 0.0\ncyy = 0.0\n"
    return parse_rotor(SHAFT.replace("node = 4", "node = 3") + more)


def dense_synchronous(kx, ky, bearings):
    """Synchronous critical speeds [rad/s] and forwardness of the dense matrices."""
    machine = LinearMachine(on_pedestals(kx, ky, bearings))
    rest, turning = machine.at(0.0), machine.at(1.0)
    G = (turning.D - rest.D).toarray()
    values, shapes = scipy.linalg.eigh(rest.M.toarray() - 1j * G, rest.K.toarray())
    x, y = shapes[: 4 * 7 : 4], shapes[1 : 4 * 7 : 4]
    forward, backward = (np.sum(np.abs(x + s * 1j * y) ** 2, axis=0) for s in (1, -1))
    some = values > 1e-12 * values.max()
    return values[some] ** -0.5, ((forward - backward) / (forward + backward))[some]


@pytest.mark.parametrize(("kx", "ky"), [(5e6, 2e7), (8e6, 9e6), (2e7, 5e6)])
def test_lines_of_the_map_on_pedestals_that_differ_are_the_dense_eigenvalues_and_do_not_jump(
    kx, ky
):
    """All that do not clearly whirl backward lie on one; u^H K_b u / u^H K u is between 0 and 1, so
    that the square of a critical speed grows at most as the stiffness does."""
    stiffness = np.geomspace(1e5, 1e9, 25)
    lines = critical_map(on_pedestals(kx, ky), stiffness, count=6).speeds
    for k, found in zip(stiffness, lines, strict=True):
        speeds, forwardness = dense_synchronous(kx, ky, k)
        here = found[np.isfinite(found)]
        for speed in here:
            assert np.abs(speeds / speed - 1).min() < 1e-6
        for speed in speeds[(forwardness > -0.49) & (speeds < np.sort(here)[3])]:
            assert np.abs(here / speed - 1).min() < 1e-6
    growth = lines[1:] / lines[:-1]
    growth = growth[np.isfinite(growth)]
    assert len(growth) > 90
    assert growth.min() > 1 - 1e-9
    assert growth.max() < math.sqrt(stiffness[1] / stiffness[0]) * (1 + 1e-9)


def test_lines_on_pedestals_that_hardly_differ_are_those_of_alike_ones():
    """Where a forward line crosses a backward one too, which both then only seem to avoid."""
    stiffness = np.geomspace(1e5, 1e9, 25)
    alike, others = (
        critical_map(on_pedestals(5e6, ky), stiffness, count=5).speeds for ky in (5e6, 5.00001e6)
    )
    np.testing.assert_allclose(others, alike, rtol=1e-5)


def test_the_own_stiffness_of_a_damper_is_that_of_its_springs():
    """Two of them under 10 kg, 250 rad/s, as the example says."""
    crossings = critical_map(example("squeeze_film"), [1e5, 1e6], count=1).crossings
    assert {c.bearing for c in crossings} == {"squeeze_film_damper[1]", "squeeze_film_damper[2]"}
    for crossing in crossings:
        assert crossing.stiffness == pytest.approx(312500.0)
        assert crossing.speed == pytest.approx(250.0, rel=1e-3)


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
