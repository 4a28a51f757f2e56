"""The rig at constant speeds under gravity: the curve against integration in time."""

import math

import numpy as np
import pytest
from rotor_fmu.model.periodic.fourier import basis
from rotor_fmu.model.periodic.linear_structure import CondensedMachine
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf

TURNS, SAMPLES = 75, 200
LAST = (145.0, 160.0)  # of `curve`


@pytest.fixture(scope="module")
def curve():
    return rf.response(rf.load(), speed=LAST, step=0.4)


@pytest.mark.parametrize(
    "ends",
    [LAST, *(pytest.param(e, marks=pytest.mark.slow) for e in ((140.0, 155.0), (100.0, 160.0)))],
)
def test_a_curve_ends_at_the_end_of_its_range_and_is_there_once(curve, ends):
    """Also where the last point takes more harmonics than the one before, as at 155 rad/s."""
    result = curve if ends == LAST else rf.response(rf.load(), speed=ends)
    assert result.points[-1].value == ends[1]
    for speed in ends:
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
TOUCHING = (197.0, 205.0)  # between stretches where a journal leaves its bearing
LIFTING = (184.5, 186.0, 190.0, 193.0, 214.0, 217.0, 220.0, 225.0, 230.0, 236.0, 240.0, 248.0)


@pytest.mark.slow
@pytest.mark.parametrize("speed", SMOOTH + TOUCHING + LIFTING)
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
def test_where_a_journal_lifts_off_the_curve_goes_on(whole):
    (branch,) = whole.branches
    assert branch.ends == ("start", "end of the range")
    assert (branch.points[0].value, branch.points[-1].value) == (100.0, 400.0)
    assert all(point.is_stable for point in branch.points)
    machine = CondensedMachine(rf.load().rotor)
    for speed in LIFTING:
        (point,) = whole.at(speed)
        value, _ = basis(point.orbit.H, np.linspace(0, 2 * math.pi, 2000))
        gap = machine.laws.gaps(value @ point.orbit.b @ machine.B.T)
        assert gap.max() > 1e-3 * machine.laws.length.min()


@pytest.mark.parametrize(
    "speed", [150.0, *(pytest.param(s, marks=pytest.mark.slow) for s in (100.0, 120.0))]
)
def test_a_stable_branch_is_what_time_integration_settles_on(request, speed):
    curve = request.getfixturevalue("curve" if speed > LAST[0] else "whole")
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
