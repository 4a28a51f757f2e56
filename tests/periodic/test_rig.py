"""The rig at constant speeds under gravity: the curve against integration in time."""

import math
import re

import numpy as np
import pytest
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf

TURNS, SAMPLES = 150, 200


@pytest.fixture(scope="module")
def curve():
    return rf.response(rf.load(), speed=(100.0, 160.0))


@pytest.mark.parametrize("high", [155.0, 160.0])
def test_a_curve_ends_at_the_end_of_its_range_and_is_there_once(high):
    """Also where the last point takes more harmonics than the one before, as at 155 rad/s."""
    result = rf.response(rf.load(), speed=(140.0, high))
    assert result.points[-1].value == high
    for speed in (140.0, high):
        assert [p.value for p in result.at(speed)] == [speed]


def in_time(machine, speed):
    """x of the last disc over a turn at a tolerance of 1e-6, and how far the turns differ [m]."""
    run = Simulation(machine.rotor, choose(tolerance=1e-6), speed=speed, warn=lambda message: None)
    period = 2 * math.pi / speed
    run.advance(TURNS * period, speed)
    seen = []
    for i in range(2 * SAMPLES):
        run.advance((TURNS + i / SAMPLES) * period, speed)
        seen.append(run.read("disc[3].x"))
    turns = np.array(seen).reshape(2, SAMPLES)
    return turns[1], np.abs(turns[1] - turns[0]).max()


@pytest.fixture(scope="module")
def whole():
    return rf.response(rf.load(), speed=(100.0, 400.0))


SMOOTH = (110.0, 130.0, 165.0, 170.0, 175.0, 180.0, 183.0, 255.0, 260.0, 280.0, 300.0, 350.0, 400.0)
LIFTING = (186.0, 190.0, 200.0, 210.0, 220.0, 230.0, 240.0)  # a journal leaves its bearing


@pytest.mark.slow
@pytest.mark.parametrize("speed", SMOOTH)
def test_over_the_whole_range_the_stable_branch_is_the_motion_in_time(whole, speed):
    """At each of 200 instants of a turn, so in amplitude and in phase."""
    (point,) = whole.at(speed)
    assert point.is_stable
    x, differ = in_time(rf.load(), speed)
    amplitude = np.ptp(x) / 2
    assert differ < 1e-5 * amplitude
    seen, _ = whole.series(point, "disc[3]", SAMPLES)
    assert np.abs(seen - x).max() < 1e-4 * amplitude
    once, of_curve = (
        2 * np.mean(z * np.exp(-2j * np.pi * np.arange(SAMPLES) / SAMPLES)) for z in (x, seen)
    )
    assert abs(of_curve - once) < 1e-4 * abs(once)
    assert whole.amplitude(point, "disc[3]", "x_1x") == pytest.approx(abs(once), rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("speed", LIFTING)
def test_where_a_journal_lifts_off_the_curve_says_that_it_ends(whole, speed):
    """The motion is periodic in time there too: the curve has no answer, and says why."""
    _, differ = in_time(rf.load(), speed)
    assert differ < 1e-3 * 1e-4
    assert whole.at(speed) == []
    notes = [note for note in whole.notes if "lost: " in note]
    assert any(re.match(r"branch 1 ends at speed = 18[345]", note) for note in notes)
    assert all("harmonics" in note or "a corner of a law" in note for note in notes)


@pytest.mark.parametrize("speed", [120.0, 150.0, pytest.param(100.0, marks=pytest.mark.slow)])
def test_a_stable_branch_is_what_time_integration_settles_on(curve, speed):
    (point,) = curve.at(speed)
    assert point.is_stable
    x, differ = in_time(rf.load(), speed)
    amplitude = np.ptp(x) / 2
    assert differ < 1e-5 * amplitude
    assert curve.amplitude(point, "disc[3]", "x_amp") == pytest.approx(amplitude, rel=1e-4)
    once = 2 * np.mean(x * np.exp(-2j * np.pi * np.arange(SAMPLES) / SAMPLES))
    assert curve.amplitude(point, "disc[3]", "x_1x") == pytest.approx(abs(once), rel=1e-4)
    phase = curve.amplitude(point, "disc[3]", "x_1x_phase")
    assert abs(np.exp(1j * phase) - once / abs(once)) < 1e-4
