"""A long shaft has more modes up to its speed than are listed by default: none that counts is left
out of what is said of its stability and of its critical speeds."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.linear import campbell, critical_peaks, level_1, level_2, modes
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.linear.where_linearized import where_not_reached
from rotor_fmu.machine_report.report_page import ReportOptions, machine_report
from rotor_fmu.report.criticals import criticals_of

LENGTH, DIAMETER, YOUNG, DENSITY = 6.0, 0.03, 2.1e11, 7800.0
OUTER, SPEED = 3.0, 1800.0  # external damping [1/s], speed [rad/s]
SHAFT = f"""
[material]
young = {YOUNG}
density = {DENSITY}
[shaft]
DAMPED
[[section]]
length = {LENGTH}
elements = 24
outer = {DIAMETER}
""" + "".join(f"[[support]]\nnode = {node}\nstiffness = 1e8\ndamping = 10.0\n" for node in (1, 25))
FREQUENCIES = (np.arange(1, 19) * np.pi / LENGTH) ** 2 * np.sqrt(YOUNG / DENSITY) * DIAMETER / 4
DISC = "[[disc]]\nnode = 9\ndiameter = 0.1\nwidth = 0.02\ne = 1e-5\n"
LIGHT = SHAFT.replace("DAMPED", "eta_v = 1e-7") + DISC


@pytest.mark.parametrize("inner", [2e-6, 5e-6])
def test_a_high_mode_that_grows_is_the_one_that_stability_is_judged_by(inner):
    """The forward whirl of a mode w decays by (OUTER + inner w (w - SPEED)) / 2 where inner damping
    turns with the shaft: first it grows at half the speed, above a dozen other modes."""
    damped = f"eta_v = {inner}\nrotating_damping = true\nmass_damping = {OUTER}"
    rotor = parse_rotor(SHAFT.replace("DAMPED", damped))
    expected = np.min(np.pi * (OUTER + inner * FREQUENCIES * (FREQUENCIES - SPEED)) / FREQUENCIES)
    found = level_1(rotor, SPEED, stiffness=[0.0])
    assert found.log_dec_alone == pytest.approx(expected, rel=0.03)
    assert level_2(rotor, SPEED).cases[-1].log_dec == found.log_dec_alone
    said = where_not_reached(rotor, [SPEED])
    assert bool(said) == (expected < 0.0) == (found.threshold == 0.0)


def test_a_critical_speed_above_a_dozen_modes_is_found():
    rotor = parse_rotor(LIGHT)
    found = [
        c.peak
        for c in critical_peaks(rotor, SPEED, [3], unbalances=[(13, 1e-5, 0.0)])
        if c.axis == "x" and 1500.0 < c.peak.speed < 1600.0
    ]
    assert len(found) == 1
    there = modes(rotor, found[0].speed, count=40)
    at = np.argmin(np.abs(there.damped - found[0].speed))
    assert found[0].speed == pytest.approx(there.damped[at], rel=1e-4)
    assert found[0].amplification == pytest.approx(1 / (2 * there.damping_ratio[at]), rel=0.05)


def test_the_picture_of_a_run_marks_critical_speeds_above_the_lowest_modes():
    rotor = parse_rotor(LIGHT)
    run = SimpleNamespace(w=np.linspace(1000.0, 1300.0, 100), rotor=rotor, about={})
    found = np.array(criticals_of(run).hz) * 2 * np.pi
    for w in FREQUENCIES[9:11]:
        assert np.abs(found / w - 1).min() < 0.03


def test_a_diagram_of_few_modes_has_the_threshold_of_all():
    """The ninth mode's, above the eight that are shown."""
    damped = f"eta_v = 5e-6\nrotating_damping = true\nmass_damping = {OUTER}"
    rotor = parse_rotor(SHAFT.replace("DAMPED", damped))
    found = campbell(rotor, np.linspace(1400.0, SPEED, 5), count=2).threshold
    assert found == pytest.approx(np.min(FREQUENCIES + OUTER / (5e-6 * FREQUENCIES)), rel=0.02)


def test_the_report_of_a_long_shaft_has_the_speed_above_which_its_first_mode_grows():
    """That at which w + OUTER / (inner w) is least, of the ninth mode."""
    damped = f"eta_v = 5e-6\nrotating_damping = true\nmass_damping = {OUTER}"
    rotor = parse_rotor(SHAFT.replace("DAMPED", damped))
    said = machine_report(rotor, ReportOptions(1700.0, SPEED)).conclusions[0].text
    found = float(re.search(r"unstable above .*\(([0-9.]+) rad/s\)", said)[1])
    assert found == pytest.approx(np.min(FREQUENCIES + OUTER / (5e-6 * FREQUENCIES)), rel=0.02)
