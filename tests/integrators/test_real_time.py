"""The mode for real time: fixed steps with a limit of iterations, and nothing beside them."""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import SettingsError, choose
from rotor_fmu.model.simulation import Simulation

SPEED, H = 190.0, 1e-4


def run(stop=0.5, rate=0.0, speed=SPEED, **changes):
    """A run of the rig in communication steps of ten steps; h: 0.1 ms."""
    simulation = Simulation(rig(), choose("realtime", **{"h": H} | changes), speed=speed)
    points = round(stop / (10 * H))
    for i in range(points):
        simulation.advance((i + 1) * 10 * H, speed + rate * i * 10 * H, rate=rate)
    return simulation


def test_within_the_limit_it_is_the_fixed_mode_bit_for_bit():
    """Where Newton ends within the limit in every step."""
    limited, free = run(newton_limit=20), run(mode="fixed")
    assert limited.read("bearing[1].fn") > 0 or limited.read("bearing[2].fn") > 0
    assert limited.read("solver.newton") == free.read("solver.newton")
    for name in ("disc[3].x", "disc[3].y", "tau", "energy.residual"):
        assert limited.read(name) == free.read(name)
    assert free.read("solver.residual") == 0.0


def test_no_step_takes_more_iterations_and_the_residual_says_what_that_costs():
    runs = [run(newton_limit=limit) for limit in (1, 2, 4)]
    for limit, simulation in zip((1, 2, 4), runs, strict=True):
        assert simulation.read("solver.steps") == 5000
        assert simulation.read("solver.newton") <= limit * 5000
        assert simulation.read("solver.rejected") == 0
    one, two, four = (simulation.read("solver.residual") for simulation in runs)
    assert one > 10 * two > 0
    assert two > 10 * four > 0


def test_peaks_of_the_run_down_are_those_without_a_limit():
    """At 0.1 ms with four iterations a step, within 0.1 %."""
    peaks = []
    for changes in ({}, {"mode": "fixed"}):
        simulation = Simulation(rig(), choose("realtime", h=H, **changes), speed=230.0)
        names = [n for n in simulation.names if n.endswith(("].x_amp", "].y_amp"))]
        at = [simulation.names.index(name) for name in names]
        largest = np.zeros(len(at))
        for i in range(1300):  # to 100 rad/s, through all peaks
            simulation.advance((i + 1) * 0.01, 230.0 - 0.1 * i, rate=-10.0)
            largest = np.maximum(largest, simulation.observed[at])
        peaks.append(largest)
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-3)


def test_nothing_is_surveyed_after_the_start(monkeypatch):
    """A run through a speed range in which the fixed mode looks for growing whirls anew."""
    counts = []
    for changes in ({}, {"mode": "fixed"}):
        simulation = Simulation(rig(), choose("realtime", h=H, **changes), speed=100.0)
        calls = []
        monkeypatch.setattr(simulation, "_survey", lambda *given, calls=calls: calls.append(given))
        for i in range(40):
            simulation.advance((i + 1) * 0.01, 100.0 + 10.0 * i, rate=1000.0)
        counts.append(len(calls))
    assert counts[0] == 0
    assert counts[1] > 0


def test_every_step_is_as_long_as_another():
    simulation = run(0.1)
    assert simulation.read("solver.h_min_used") == simulation.read("solver.h_max_used") == H


@pytest.mark.parametrize("limit", [0, 1001, 2.5])
def test_a_limit_that_cannot_be_is_refused(limit):
    with pytest.raises(SettingsError, match=rf"newton_limit = {limit}: must be"):
        choose("realtime", newton_limit=limit)
