"""Peaks of the response to unbalance that are narrower than the distance of the speeds asked for:
every output of a command has the same one."""

import json
import math
from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.linear import (
    LinearError,
    critical_peaks,
    response_with_peaks,
    unbalance_check,
    unbalance_peaks,
    unbalance_response,
)
from rotor_fmu.model.linear.amplification import peaks
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.linear import acceptance, answers, linear_tables
from rotor_fmu.machine_report.rub_check import rub_check

from ..parts.machines import shaft
from ..toml_text import table

OVERHUNG = """
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.2, 0.4, 0.6]
diameters = [0.03, 0.03, 0.03]
[[disc]]
node = 4
diameter = 0.3
width = 0.03
e = 1e-7
[[support]]
node = 1
stiffness = 2e7
damping = DAMPING
[[support]]
node = 3
stiffness = 2e7
damping = DAMPING
[[contact]]
node = 4
journal_radius = 0.15
clearance = 2e-3
mu = 0.1
k = 1e7
"""
LIGHT = OVERHUNG.replace("DAMPING", "30.0")  # an amplification factor of 19 000


def test_the_response_is_asked_for_at_its_peaks():
    rotor = parse_rotor(LIGHT)
    found = response_with_peaks(rotor, np.linspace(0.0, 400.0, 41))
    (x, _) = critical_peaks(rotor, 400.0, [4])
    i = int(np.argmax(found.major[:, 3]))
    assert found.speeds[i] == pytest.approx(x.peak.speed, rel=1e-9)
    assert found.major[i, 3] == pytest.approx(x.peak.amplitude, rel=1e-6)
    assert found.peaks[4] == pytest.approx((x.peak.speed,), rel=1e-9)


def test_a_step_of_the_response_is_no_row_of_its_table(monkeypatch):
    real = unbalance_peaks.major_axis
    rotor, speeds = parse_rotor(LIGHT), np.linspace(0.0, 400.0, 41)
    found = answers.response_with_peaks(rotor, speeds, nodes=[4])
    monkeypatch.setattr(
        *(unbalance_peaks, "major_axis"),
        lambda *of: real(*of) * (1.0 if of[-1] < 104.0 else 0.5),
    )
    stepped = answers.response_with_peaks(rotor, speeds, nodes=[4])
    assert len(stepped.speeds) > len(speeds)
    assert stepped.table([4]).rows == found.table([4]).rows
    assert len(found.table([4]).rows) == 1


def test_a_rotor_that_nothing_holds_has_no_peak_near_rest():
    """It turns about its centre of mass, as far from it as its unbalance has that, at any speed; at
    rest nothing says so, and between the two there was a peak."""
    free = OVERHUNG.replace("stiffness = 2e7", "stiffness = 0.0").replace("DAMPING", "0.0")
    found = response_with_peaks(parse_rotor(free), np.linspace(0.0, 200.0, 41), contacts="open")
    assert len(found.peaks) == 3
    assert not any(found.peaks.values())
    assert found.major[0] == pytest.approx(found.major[1], rel=1e-3)


def test_critical_speeds_that_are_all_but_the_same_are_marked_within_their_picture():
    figure = acceptance.critical_peaks(parse_rotor(LIGHT), 400.0, [2, 4]).figure()
    figure.draw_without_rendering()
    (axes,) = figure.axes
    within = [mark.get_window_extent().x1 < axes.bbox.x1 for mark in axes.lines[1:]]
    assert within == 4 * [True]


def test_where_nothing_peaks_the_table_says_so():
    table = acceptance.critical_peaks(parse_rotor(LIGHT), 100.0, [2, 4]).table()
    assert table.text() == "No critical speed: the response of these nodes has no peak there"


def test_an_operating_range_of_one_speed_is_seen():
    figure = acceptance.unbalance_check(parse_rotor(LIGHT), 300.0, 300.0, [4]).figure()
    (span,) = figure.axes[0].patches
    assert span.get_linewidth() > 0


def test_of_a_rotor_that_turns_backward_too():
    rotor = parse_rotor(LIGHT)
    found = response_with_peaks(rotor, np.linspace(-400.0, 0.0, 41), nodes=[4])
    mirrored = response_with_peaks(rotor, np.linspace(0.0, 400.0, 41), nodes=[4])
    assert found.major[:, 3].max() == pytest.approx(mirrored.major[:, 3].max(), rel=1e-6)


def test_critical_speeds_of_a_rotor_that_turns_backward_are_those_of_its_response():
    """Cross coupling that drives a forward whirl damps one when it turns backward."""
    seal = "[[seal]]\nnode = 4\nkxx = 0.0\nkyy = 0.0\nkxy = 1e4\nkyx = -1e4\ncxx = 0.0\ncyy = 0.0\n"
    rotor = parse_rotor(LIGHT + seal)
    seen = acceptance.critical_peaks(rotor, -400.0, [4])
    (peak,) = response_with_peaks(rotor, np.linspace(-400.0, 0.0, 41), nodes=[4]).peaks[4]
    of_response = abs(unbalance_response(rotor, [peak]).x[0, 3])
    for critical in seen.criticals:
        found = critical.peak
        assert found.speed == pytest.approx(peak, rel=1e-7)
        assert found.amplitude == pytest.approx(of_response, rel=1e-6)
        assert found.below < found.speed < found.above
        assert found.amplification == pytest.approx(-peak / (found.above - found.below))
    (axes,) = seen.figure().axes
    assert axes.get_xlim()[0] < peak / (2 * math.pi) < axes.get_xlim()[1] == 0.0


def test_critical_speeds_of_both_senses_of_rotation_stand_in_one_table():
    seen = acceptance.critical_peaks(parse_rotor(LIGHT), [-400.0, 400.0], [4])
    speeds = [critical.peak.speed for critical in seen.criticals]
    assert speeds == pytest.approx([-252.218, -252.218, 252.218, 252.218], rel=1e-4)
    (axes,) = seen.figure().axes
    assert axes.get_xlim()[0] < -252.218 / (2 * math.pi) < 0.0 < axes.get_xlim()[1]


def test_the_command_shows_one_peak_in_its_table_its_file_and_its_check(tmp_path, command):
    file = tmp_path / "light.toml"
    file.write_text(LIGHT)
    command("unbalance", "--rotor", str(file), "--range", "100:200", "--node", "4")
    data = json.loads((tmp_path / "out" / "unbalance.json").read_text())
    peak = max(critical["peak"]["amplitude"] for critical in data["check"]["criticals"])
    assert np.max(data["major"], axis=0)[3] == pytest.approx(peak, rel=1e-6)
    table = np.genfromtxt(tmp_path / "out" / "unbalance.csv", delimiter=",", names=True)
    assert table["node4major_m"].max() == pytest.approx(peak, rel=1e-6)


@pytest.mark.parametrize("damping", ["0.0", "1e-3"])
def test_a_mode_that_nothing_drives_and_hardly_anything_damps_has_no_critical_speed(damping):
    seen = critical_peaks(parse_rotor(OVERHUNG.replace("DAMPING", damping)), 1000.0, [4])
    assert [c.axis for c in seen] == ["x", "y"]
    assert all(c.peak.speed == pytest.approx(252.218, rel=1e-4) for c in seen)


@pytest.mark.usefixtures("without_runs")
def test_the_clearance_that_is_checked_is_the_one_that_closes_in_the_runs():
    """Of 2 mm the response takes 2.1 mm, in a range of speeds of 3e-5 of the critical one."""
    rotor = parse_rotor(LIGHT)
    (gap,) = unbalance_check(rotor, 200.0, 300.0, [4]).clearances
    assert gap.amplitude > gap.clearance
    (closing,) = rub_check(rotor, 200.0, 300.0).closings
    assert closing.amplitude == pytest.approx(gap.amplitude, rel=1e-6)
    assert closing.begin < gap.speed < closing.end
    ends = response_with_peaks(rotor, [closing.begin, gap.speed, closing.end], nodes=[4])
    taken = np.interp([closing.begin, closing.end], ends.speeds, ends.major[:, 3])
    np.testing.assert_allclose(taken + closing.sag, gap.clearance, rtol=1e-4)


def test_a_step_is_no_critical_speed_where_its_edge_depends_on_what_was_asked_before():
    """As of a pad that is about to bear: whether it does, within rounding of where it begins to,
    depends on where its equilibrium was looked for from."""
    bears = [True]

    @cache
    def stepped(s):
        apart = s / 0.7 - 1.0
        bears[0] = apart < -4e-6 or (bears[0] and apart < 4e-6)
        return (1.0 if bears[0] else 0.98) / abs(1.0 - s * s + 0.2j * s)

    (found,) = peaks(stepped, np.linspace(0.4, 1.8, 301))
    assert found.speed == pytest.approx(math.sqrt(1.0 - 0.02), rel=1e-6)


@pytest.mark.parametrize("less", [0.5, 0.99])
def test_a_step_of_the_response_is_no_critical_speed(less):
    """Upwards where it falls anyway, downwards where it rises, beside a resonance at 1 rad/s."""

    def response(s):
        step = 1.0 if s < 0.7 else less
        return step * (1.0 if s < 1.4 else 1.0 / less) / abs(1.0 - s * s + 0.2j * s)

    (peak,) = peaks(response, np.linspace(0.1, 2.0, 39))
    assert peak.speed == pytest.approx(math.sqrt(1.0 - 2.0 * 0.1**2), rel=1e-6)


PADS = """
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.5, 1.0]
diameters = [0.08, 0.08]
[[disc]]
node = 2
diameter = 0.4
width = 0.05
e = 1e-5
"""
PADS += "".join(
    f"""
[[journal_bearing]]
node = {node}
journal_radius = 0.04
length = 0.04
clearance = 6e-5
viscosity = 0.02
tilting = true
pads = [0.7853981634, 2.3561944902, 3.926990817, 5.4977871438]
arc = 1.3
preload = 0.05
"""
    for node in (1, 3)
)


def test_the_response_just_beyond_where_pads_begin_to_bear_does_not_depend_on_the_way_there():
    """The upper pads do at 360.90 rad/s, with a force whose slope is infinite there."""
    seen = [unbalance_response(parse_rotor(PADS), [first, 360.91]) for first in (360.5, 360.92)]
    assert seen[0].major[1] == pytest.approx(seen[1].major[1], rel=1e-3)


def test_a_response_and_its_check_look_for_the_critical_speeds_once(monkeypatch):
    real, diagrams = unbalance_peaks.campbell, []
    monkeypatch.setattr(
        *(unbalance_peaks, "campbell"),
        lambda rotor, speeds, **options: diagrams.append(0) or real(rotor, speeds, **options),
    )
    rotor = parse_rotor(OVERHUNG.replace("DAMPING", "3000.0"))
    response_with_peaks(rotor, np.linspace(0.0, 450.0, 21), nodes=[4])
    unbalance_check(rotor, 200.0, 300.0, [4])
    assert len(diagrams) == 1


def test_a_largest_value_before_an_antiresonance_is_no_critical_speed():
    """Two discs with unbalances that oppose each other, on a shaft whose modes are forward at 233
    rad/s and backward at 217: the end's motion is largest at 182 rad/s, and hardly any at 212."""
    disc = "[[disc]]\ndiameter = 0.2\nwidth = 0.02\n"
    rotor = parse_rotor(
        f"gravity = 0.0\n{shaft(0.0, 0.3, 0.6, diameter=0.02)}"
        f"{disc}node = 1\ne = 2e-5\n{disc}node = 2\ne = 1e-5\nphase = {math.pi}\n"
        + "".join(
            table("[linear_bearing]", node=n, kxx=1e6, kyy=1e6, cxx=50.0, cyy=50.0) for n in (1, 3)
        )
    )
    rising, most, fallen = unbalance_response(rotor, [150.0, 182.0, 212.0]).major[:, 0]
    assert most > 1.2 * rising > 4.0 * fallen
    criticals = critical_peaks(rotor, 300.0, [1])
    assert [c.peak.speed for c in criticals] == pytest.approx([233.0, 233.0], rel=0.01)


def test_unbalances_that_take_each_other_away_drive_nothing():
    rotor = parse_rotor(OVERHUNG.replace("DAMPING", "3000.0"))
    opposite = [(4, 1e-4, 0.3), (4, 1e-4, 0.3 + math.pi)]
    with pytest.raises(LinearError, match="no unbalance acts"):
        critical_peaks(rotor, 400.0, [4], unbalances=opposite)


def test_two_values_of_one_height_with_rounding_between_them_are_one_peak():
    size = np.array([1.0, 2.0, 4.0, 4.0 - 1e-15, 4.0, 2.0, 3.0, 1.0])
    assert linear_tables.peaks(size) == [2, 6]
    apart = np.array([1.0, 4.0, 3.0, 4.0, 1.0])
    assert linear_tables.peaks(apart) == [1, 3]
