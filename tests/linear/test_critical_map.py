"""The undamped critical speed map (API 684) against ROSS 2.3, dense eigenvalues and closed forms
(tests/reference/make_ross_api.py made ROSS' numbers)."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.errors import InputError
from rotor_fmu.model.linear import (
    LinearMachine,
    critical_map,
    critical_peaks,
    mean_stiffness,
    modes,
    static,
)
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.linear_bearing import LinearBearing

from tests.linear.api_617 import CLOSE, ROSS, SHAFT, example, support
from tests.validation.test_ross import machine


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


@pytest.mark.parametrize("eta_h", [0.02, 0.1])
def test_the_map_of_a_hysteretic_shaft_is_as_stiff_as_the_shaft(eta_h):
    """An unbalance whirls with the shaft, whose strain stays: hysteresis has no part in it but that
    it stiffens the shaft (Zorzi and Nelson 1977)."""
    rotor = parse_rotor(SHAFT + support(1, 1e7, 10.0) + support(7, 1e7, 10.0))
    rotor = replace(rotor, eta_v=0.0, eta_h=eta_h, rotating_damping=True)
    found = critical_map(rotor, [1e7, 2e7], count=1)
    unbalances = [(5, 1e-5, 0.0)]
    x, *_ = critical_peaks(rotor, 1.2 * found.speeds[0, 0], [4], unbalances=unbalances)
    assert found.speeds[0, 0] == pytest.approx(x.peak.speed, rel=1e-6)


@pytest.mark.parametrize("stiffness", [(3e6, 1e7), (1e6, 3e6)])
def test_a_stiffness_at_either_end_of_the_map_meets_its_lines(stiffness):
    rotor = parse_rotor(SHAFT + support(1, 3e6, 10.0) + support(7, 3e6, 10.0))
    result = critical_map(rotor, stiffness, count=1)
    assert [c.stiffness for c in result.crossings] == [3e6, 3e6]


def test_a_bearing_over_the_speed_meets_a_line_where_it_has_that_stiffness():
    result = critical_map(machine("compressor.toml"), np.geomspace(1e7, 1e9, 9), count=2)
    bearing = machine("compressor.toml").of_kind(LinearBearing)[0]
    crossing = next(
        c for c in result.crossings if (c.bearing, c.axis, c.mode) == ("linear_bearing[1]", "x", 0)
    )
    K, _ = bearing.matrices(crossing.speed)
    assert K[0, 0] == pytest.approx(crossing.stiffness, rel=1e-9)


@pytest.mark.parametrize(
    "name", [pytest.param("rolling_bearing", marks=pytest.mark.slow), "oil_film"]
)
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
    forward, backward = (
        np.trapezoid(np.abs(x + s * 1j * y) ** 2, machine.nodes, axis=0) for s in (1, -1)
    )
    some = values > 1e-12 * values.max()
    return values[some] ** -0.5, ((forward - backward) / (forward + backward))[some]


@pytest.mark.parametrize(
    ("kx", "ky"),
    [
        (8e6, 9e6),
        *(pytest.param(*each, marks=pytest.mark.slow) for each in ((5e6, 2e7), (2e7, 5e6))),
    ],
)
def test_lines_of_the_map_on_pedestals_that_differ_are_the_dense_eigenvalues_and_do_not_jump(
    kx, ky
):
    """The lowest, as many as are asked for, that do not clearly whirl backward lie on one at each
    stiffness; u^H K_b u / u^H K u is between 0 and 1, so that the square of a critical speed grows
    at most as the stiffness does."""
    stiffness = np.geomspace(1e5, 1e9, 25)
    lines = critical_map(on_pedestals(kx, ky), stiffness, count=6).speeds
    for k, found in zip(stiffness, lines, strict=True):
        speeds, forwardness = dense_synchronous(kx, ky, k)
        here = found[np.isfinite(found)]
        for speed in here:
            assert np.abs(speeds / speed - 1).min() < 1e-6
        for speed in np.sort(speeds[forwardness > -0.49])[:6]:
            assert np.abs(here / speed - 1).min() < 1e-6
    growth = lines[1:] / lines[:-1]
    growth = growth[np.isfinite(growth)]
    assert len(growth) > 90
    assert growth.min() > 1 - 1e-9
    assert growth.max() < math.sqrt(stiffness[1] / stiffness[0]) * (1 + 1e-9)


def test_a_backward_mode_that_is_hardly_so_at_one_stiffness_is_no_line():
    """Of the rotor that the how-to imports: near 5.8e5 N/m its first backward mode is -0.5 forward,
    within 0.01."""
    result = critical_map(machine("on_pedestals.json"), np.geomspace(2.45e5, 2.45e9, 33))
    drawn = np.isfinite(result.speeds).sum(axis=0)
    assert drawn[0] == 33
    assert ((drawn == 0) | (drawn > 1)).all()


def test_lines_on_pedestals_that_hardly_differ_are_those_of_alike_ones():
    """Where a forward line crosses a backward one too, which both then only seem to avoid."""
    stiffness = np.geomspace(1e5, 1e9, 25)
    alike, others = (
        critical_map(on_pedestals(5e6, ky), stiffness, count=5).speeds for ky in (5e6, 5.00001e6)
    )
    np.testing.assert_allclose(others, alike, rtol=1e-5)


def test_the_own_stiffness_of_a_film_is_listed_where_it_meets_the_lines():
    """It is drawn over a logarithmic axis of speeds, from below the lowest of its crossings on."""
    result = critical_map(example("oil_film"), np.geomspace(1e5, 1e8, 9), count=4)
    assert result.crossings
    for crossing in result.crossings:
        own = next(o for o in result.own if o[:2] == crossing[:2])
        known = np.isfinite(own.stiffness)
        listed = np.interp(crossing.speed, own.speed[known], own.stiffness[known])
        assert own.speed[known][0] < crossing.speed
        assert listed == pytest.approx(crossing.stiffness, rel=0.05)


def test_the_own_stiffness_of_a_hertzian_wall_is_that_under_its_static_load():
    """Its k is no stiffness, in N/m^1.5: the load presses by (load / k)^(2/3)."""
    bearings = (replace(bearing, k=1e9, exponent=1.5) for bearing in rig().bearings)
    rotor = rig().with_parts(Bearing, *bearings)
    at_rest = static(rotor)
    pressed = dict(zip(at_rest.supports, (np.abs(at_rest.load_y) / 1e9) ** (2 / 3), strict=True))
    crossings = critical_map(rotor, [1e6, 1e7, 1e8], count=1).crossings
    assert {c.bearing for c in crossings} == {"bearing[1]", "bearing[2]"}
    for crossing in crossings:
        expected = 1.5 * 1e9 * math.sqrt(pressed[crossing.bearing])
        assert crossing.stiffness == pytest.approx(expected, rel=1e-9)


def test_the_own_stiffness_of_a_damper_is_that_of_its_springs():
    """Two of them under 10 kg, 250 rad/s, as the example says."""
    crossings = critical_map(example("squeeze_film"), [1e5, 1e6], count=1).crossings
    assert {c.bearing for c in crossings} == {"squeeze_film_damper[1]", "squeeze_film_damper[2]"}
    for crossing in crossings:
        assert crossing.stiffness == pytest.approx(312500.0)
        assert crossing.speed == pytest.approx(250.0, rel=1e-3)


@pytest.mark.parametrize("heavier", [1.0, 1e-6, 1e6])
def test_bearings_without_stiffness_are_varied_about_that_of_the_rotor(heavier):
    """So does the map show the same of any that differ in mass and in stiffness by one factor."""
    text = SHAFT.replace("2.1e11", f"{2.1e11 * heavier}").replace("7800.0", f"{7800.0 * heavier}")
    rotor = parse_rotor(text + support(1, 0.0, 1.0) + support(7, 0.0, 1.0))
    shown = critical_map(rotor, mean_stiffness(rotor) * np.array([1e-2, 1e2]), count=1)
    soft, stiff = shown.speeds[:, 0] / shown.rigid
    assert soft < 0.2 < 0.9 < stiff


@pytest.mark.parametrize(
    ("stiffness", "count", "expected"),
    [
        ([1e6, 1e5], 5, "stiffness: must be at least 2 finite values"),
        ([1e6, math.inf], 5, "stiffness: must be at least 2 finite values"),
        ([1e-300, 1e7], 5, r"stiffness = 1e-300 N/m: must be from 2.3e-07 to 2.3e\+17 N/m"),
        ([1e6, 1e30], 5, r"stiffness = 1e\+30 N/m: must be from"),
        (1e6, 5, "stiffness = 1000000.0: must be a list of numbers"),
        (["1e6", "1e7"], 5, "must be a list of numbers"),
        ([1e6, 1e7], 0, "count = 0"),
    ],
)
def test_impossible_input_is_named(stiffness, count, expected):
    with pytest.raises(InputError, match=expected):
        critical_map(rig(), stiffness, count=count)


def test_magnetic_pull_is_no_bearing_and_keeps_its_negative_stiffness():
    """A motor whose air gap pulls its core outwards: on its bearings' stiffness the map has the
    natural frequency of the whole machine, and none where they are too soft to hold it."""
    pull = LinearBearing(node=4, kxx=-1e6, kyy=-1e6, cxx=0.0, cyy=0.0, name="pull")
    rotor = parse_rotor(SHAFT + support(1, 3e6) + support(7, 3e6))
    rotor = replace(rotor, eta_v=0.0, parts=(*rotor.parts, pull))
    stiffness = [3e5, 3e6, 1e7]
    result = critical_map(rotor, stiffness, count=2, synchronous=False)
    expected = abs(modes(rotor, 0.0).eigenvalues[0])
    assert result.bearings == ("support[1]", "support[2]")
    assert result.speeds[1, 0] == pytest.approx(expected, rel=1e-9)
    assert np.isnan(result.speeds[0]).all()
    assert mean_stiffness(rotor) == pytest.approx(3e6)
    with pytest.raises(InputError, match="not held by its bearings against what pulls"):
        critical_map(rotor, [2e5, 3e5])
