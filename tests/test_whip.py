"""No run is wrong in silence: a machine whose journal whips, machines drawn at random, examples."""

import numpy as np
import pytest
from rotor_fmu.model.settings import PRESETS, choose
from rotor_fmu.model.simulation import RotorWarning, Simulation, StepFailure

from . import known
from .population import by_cvode, condition, judged, machine
from .whip import overhung_machine, run_down
from .windows import rig

STOP = 5.0


@pytest.mark.parametrize(
    "tolerance",
    [1e-2, 1e-3, *(pytest.param(t, marks=pytest.mark.slow) for t in (1e-4, 1e-5))],
)
def test_error_control_finds_the_whip_at_every_tolerance(tolerance):
    """CVODE with an independent right-hand side: apart between 3.2 and 3.5 s."""
    said = []
    with pytest.raises(StepFailure) as failure:
        run_down(overhung_machine(), choose(tolerance=tolerance), STOP, said.append)
    message = str(failure.value)
    assert 3.1 < float(message.split("t = ")[1].split(" s")[0]) < 3.6
    assert said == []
    for part in ("whirled itself apart", "backward whirl", "bearing[1] in contact", "grows by"):
        assert part in message
    assert "robust" not in message


@pytest.mark.parametrize("preset", ["robust", "moderate"])
def test_fixed_steps_that_hide_the_whip_say_so_before_and_after(preset):
    said = []
    sim, peak = run_down(overhung_machine(), choose(preset), STOP, said.append)
    assert peak < 3e-4  # it looks calm
    assert "hide an instability" in said[0]
    assert said[1].startswith("overdamped since t = ")
    assert 0.0 <= sim.read("solver.overdamped_at") < STOP


@pytest.mark.parametrize("preset", ["paper", "paper-adaptive"])
def test_steps_as_coarse_as_the_papers_say_so_before(preset):
    with pytest.warns(RotorWarning, match="hide an instability"):
        Simulation(overhung_machine(), choose(preset), speed=400.0)


def test_with_little_friction_the_machine_is_stable_and_error_control_silent():
    said = []
    sim, peak = run_down(overhung_machine(mu=0.02), choose(), 2.0, said.append)
    _, finer = run_down(overhung_machine(mu=0.02), choose(tolerance=1e-4), 2.0, said.append)
    assert peak == pytest.approx(finer, rel=0.02)
    assert said == []
    assert sim.read("solver.overdamped_at") == -1.0


RIGHT = {
    **{name: PRESETS[name] for name in PRESETS if name != "moderate"},
    "tolerance 0.1": choose(tolerance=0.1),
    "robust, 0.7 ms": choose("robust", h=7e-4),
}


def doubts_on_the_rig(settings):
    said = []
    sim = Simulation(rig(), settings, speed=400.0, rate=-10.0, warn=said.append)
    for k in range(250):
        sim.advance(0.16 * (k + 1), 400.0 - 1.6 * k)
    return said


@pytest.mark.parametrize("name", RIGHT)
def test_of_no_run_of_the_rig_anything_is_said_but_of_the_preset_in_the_false_state(name):
    assert doubts_on_the_rig(RIGHT[name]) == []


def test_of_the_preset_that_falls_into_the_false_state_that_is_said():
    (said,) = doubts_on_the_rig(PRESETS["moderate"])
    assert said.startswith("false state since t = ")


def test_when_the_rub_is_overdamped_is_part_of_the_state():
    sim, _ = run_down(overhung_machine(), choose("robust"), 1.0, lambda message: None)
    kept, at = sim.snapshot(), sim.read("solver.overdamped_at")
    other = Simulation(overhung_machine(), choose("robust"), speed=400.0, warn=lambda m: None)
    assert other.read("solver.overdamped_at") == -1.0
    other.restore(kept)
    assert other.read("solver.overdamped_at") == at >= 0.0


def promised(tolerance, told):
    """The largest error of an orbit, by the machine's condition; see docs/integrators.md."""
    return tolerance * min(10 * (1 + told), 14 * told)


def check(seed):
    rotor, speed = machine(seed)
    exact = by_cvode(rotor, speed)
    told = condition(rotor, speed, exact[0])
    for tolerance in (1e-2, 1e-3, 1e-4):
        run = judged(rotor, speed, choose(tolerance=tolerance), exact)
        if run.status == "ok":
            assert run.peak < 0.1, tolerance
            assert run.beyond < 0.01 or tolerance > 1e-3, tolerance
            assert run.orbit < promised(tolerance, told), tolerance


@pytest.mark.parametrize("seed", range(5))
def test_no_machine_that_ends_well_is_far_from_what_cvode_finds(seed):
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5, 50))
def test_none_of_fifty_machines_that_ends_well_is_far_from_what_cvode_finds(seed):
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("run", [*known.examples()], ids=lambda run: run.name)
def test_the_examples_keep_to_the_tolerance_as_the_fifty_machines_do(run):
    exact = run.exact()
    told = known.condition(run, exact)
    for tolerance in (1e-2, 1e-3, 1e-4):
        status, orbit = run.found(choose(tolerance=tolerance))
        assert status == "ok"
        assert np.abs(orbit - exact).max() < promised(tolerance, told) * np.abs(exact).max()
