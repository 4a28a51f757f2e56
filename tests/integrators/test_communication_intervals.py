"""Communication steps of unequal lengths: the speed between them, and what slivers cost."""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

RIG = rig()
H = 1e-3


def simulation(**options):
    return Simulation(RIG, choose("controlled"), warn=lambda message: None, **options)


@pytest.mark.parametrize("sliver", [3e-4, 1e-5, 5e-10])
def test_a_jump_of_the_speed_is_overshot_by_at_most_twice_its_size(sliver):
    """Where a host cuts a step at the jump, the next step is far longer than the last."""
    sim = simulation(speed=400.0)
    speeds = []
    for k in range(20):
        for to in (k * H + sliver, (k + 1) * H) if k == 10 else ((k + 1) * H,):
            sim.advance(to, 400.0 if sim.time < 10 * H + sliver else 401.0)
            speeds.append(sim.read("w"))
    assert min(speeds) >= 400.0
    assert max(speeds) <= 401.0 + 2.0
    assert sim.read("w") == pytest.approx(401.0, abs=1e-12)


@pytest.mark.parametrize("between", range(1, 6))
def test_a_jump_is_overshot_no_more_in_a_step_longer_than_all_before(between):
    """As of a host that lengthens its steps after an event, which is no rate to go on with."""
    sim = simulation(speed=400.0)
    for k in range(5 + between):
        sim.advance((k + 1) * 0.1 * H, 400.0 if k < 5 else 401.0)
    sim.advance(sim.time + 10 * H, 401.0)
    assert 401.0 <= sim.read("w") <= 401.0 + 2.0


@pytest.mark.parametrize("rate", [-10.0, 30.0])
def test_a_ramp_is_followed_exactly_however_unequal_the_steps_are(rate):
    rng = np.random.default_rng(5)
    sim = simulation(speed=100.0, rate=rate)
    for length in 10.0 ** rng.uniform(-9, -2, 200):
        to = sim.time + length
        sim.advance(to, 100.0 + rate * sim.time)
        assert sim.read("w") == pytest.approx(100.0 + rate * to, rel=1e-9)
    assert sim.read("phi") == pytest.approx(100.0 * to + 0.5 * rate * to**2, rel=1e-9)


@pytest.mark.parametrize("sliver", [1e-6, 1e-9])
def test_a_sliver_costs_a_step_and_no_error(sliver):
    """A step that a communication point cuts short leaves the next one as long as it was."""
    whole, cut = simulation(speed=400.0), simulation(speed=400.0)
    for k in range(300):
        whole.advance((k + 1) * H, 400.0)
        cut.advance((k + 1) * H - sliver, 400.0)
        cut.advance((k + 1) * H, 400.0)
    assert cut.read("solver.steps") < 1.3 * (whole.read("solver.steps") + 300)
    assert cut.read("energy.residual") < 3.0 * whole.read("energy.residual")
