"""A run that takes more work than it should says so, and one that stands still is given up."""

from dataclasses import replace

import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation, StepFailure

from rotor_fmu.runs.job import prepare
from rotor_fmu.runs.run_down import run_direct

RIG = rig()


def rubbing(**bearing):
    """The rig with other bearings."""
    return RIG.with_parts(Bearing, *(replace(b, **bearing) for b in RIG.bearings))


@pytest.mark.parametrize("most", [10**5, pytest.param(None, marks=pytest.mark.slow)])
def test_friction_that_takes_too_much_work_ends_the_run_with_what_to_try(most):
    """By default after ten million iterations."""
    settings = choose(**({"max_iterations": most} if most else {}))
    sim = Simulation(rubbing(mu=5.0), settings, speed=400.0, rate=-10.0, warn=lambda message: None)
    most = most or 10**7
    with pytest.raises(
        StepFailure, match=rf"stopped after {most} iterations .* allow more of them.* less friction"
    ):
        sim.advance(0.2, 400.0)
    assert 0 < sim.time < 0.2
    assert sim.read("solver.newton") >= most


@pytest.mark.slow
def test_a_contact_stiffer_than_any_step_is_slow_too_coarse_and_given_up():
    said = []
    sim = Simulation(rubbing(k=1e20), speed=400.0, rate=-10.0, warn=said.append)
    sim.advance(0.004, 400.0)
    with pytest.raises(StepFailure, match=r"stopped after 10000000 iterations .* softer contacts"):
        sim.advance(0.04, 400.0)
    assert {message.split(" since")[0] for message in said} >= {"slow", "too coarse"}


def test_the_rig_is_never_slow():
    said = []
    sim = Simulation(RIG, choose(tolerance=1e-5), speed=400.0, rate=-10.0, warn=said.append)
    for n in range(1, 6):
        sim.advance(0.02 * n, 400.0 - 0.2 * (n - 1))
    assert said == []


def test_a_run_whose_shortest_steps_miss_the_tolerance_is_not_ok():
    sets = ["solver.tolerance=1e-5", "solver.h_min=1e-3", "solver.h=1e-3"]
    job = prepare(None, None, sets, None, 0.1, 0.05)
    run = run_direct(job)
    assert run.status == "doubtful: too-coarse"
    assert any("lower solver.h_min" in message for message in run.messages)
