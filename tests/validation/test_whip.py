"""No run is wrong in silence: a machine whose journal whips, the rig."""

import math

import pytest
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.settings import PRESETS, choose
from rotor_fmu.model.simulation import HYSTERETIC_AS_SLOWER, RotorWarning, Simulation, StepFailure

from ..machines import overhung
from .whip import overhung_machine, run_down
from .windows import rig

STOP = 5.0


@pytest.mark.parametrize(
    "tolerance",
    [1e-3, *(pytest.param(t, marks=pytest.mark.slow) for t in (1e-2, 1e-4, 1e-5))],
)
def test_error_control_finds_the_whip_at_every_tolerance(tolerance):
    """CVODE with an independent right-hand side: apart between 3.2 and 3.5 s."""
    said = []
    with pytest.raises(StepFailure) as failure:
        run_down(overhung_machine(), choose(tolerance=tolerance), STOP, said.append)
    message = str(failure.value)
    assert 3.1 < float(message.split("t = ")[1].split(" s")[0]) < 3.6
    assert said == []
    for part in (
        "diverged by an instability of the machine",
        "backward whirl",
        "bearing[1] in contact",
        "grows by",
    ):
        assert part in message
    assert "robust" not in message


@pytest.mark.parametrize("preset", ["robust", "moderate"])
def test_fixed_steps_that_hide_the_whip_say_so_before_and_after(preset):
    said = []
    sim, peak = run_down(overhung_machine(), choose(preset), STOP, said.append)
    assert peak < 3e-4  # it looks calm
    assert "hide an instability" in said[0]
    assert any(message.startswith("overdamped since t = ") for message in said[1:])
    assert 0.0 <= sim.read("solver.overdamped_at") < STOP


@pytest.mark.parametrize("preset", ["paper", "paper-adaptive"])
def test_steps_as_coarse_as_the_papers_say_so_before(preset):
    with pytest.warns(RotorWarning) as said:
        Simulation(overhung_machine(), choose(preset), speed=400.0)
    assert any("hide an instability" in str(warning.message) for warning in said)


def test_with_little_friction_the_machine_is_stable_and_error_control_silent():
    said = []
    sim, peak = run_down(overhung_machine(mu=0.02), choose(), 2.0, said.append)
    _, finer = run_down(overhung_machine(mu=0.02), choose(tolerance=1e-4), 2.0, said.append)
    assert peak == pytest.approx(finer, rel=0.02)
    assert said == []
    assert sim.read("solver.overdamped_at") == -1.0


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_hysteretic_damping_that_turns_is_no_loss_to_the_integrator(tolerance):
    """It feeds the whirl of a journal that rubs, which other dampers hold back."""
    wall = ClearanceContact(node=2, journal_radius=0.01, clearance=5e-5, mu=0.05, k=1e6)
    rotor = overhung(others=(wall,), eta_h=0.01, rotating_damping=True, gravity=0.0)
    said, touched = [], 0.0
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=100.0, rate=40.0, warn=said.append)
    for k in range(300):
        sim.advance(0.01 * (k + 1), 100.0 + 0.4 * k)
        touched += sim.read("contact[1].contact")
    assert touched > 100
    assert said == [HYSTERETIC_AS_SLOWER]


def test_a_rub_is_overdamped_from_its_first_touch_on():
    sim = Simulation(overhung_machine(), choose("robust"), speed=400.0, warn=lambda message: None)
    first = math.inf
    for k in range(1000):
        sim.advance(1e-3 * (k + 1), 400.0)
        if sim.read("bearing[1].contact"):
            first = min(first, sim.time)
    assert first - 1e-3 <= sim.read("solver.overdamped_at") <= first
    assert first > 0.01


RIGHT = {
    **{name: PRESETS[name] for name in ("controlled", "robust")},
    "tolerance 0.1": choose(tolerance=0.1),
    "robust, 0.2 ms": choose("robust", h=2e-4),
}


def warnings_on_the_rig(settings):
    said = []
    sim = Simulation(rig(), settings, speed=400.0, rate=-10.0, warn=said.append)
    for k in range(250):
        sim.advance(0.16 * (k + 1), 400.0 - 1.6 * k)
    return said


@pytest.mark.parametrize(
    "name",
    # advice of a smaller step is followed in an ordinary run (tests/cli/test_advice.py)
    [pytest.param(name, marks=[pytest.mark.slow] if "ms" in name else []) for name in RIGHT],
)
def test_of_no_fine_run_of_the_rig_anything_is_said(name):
    assert warnings_on_the_rig(RIGHT[name]) == []


@pytest.mark.parametrize(
    ("settings", "warnings"),
    [
        (PRESETS["paper"], ["too coarse in contact"]),
        (PRESETS["paper-adaptive"], ["too coarse in contact"]),
        (choose("robust", h=7e-4), ["too coarse in contact"]),
        (PRESETS["moderate"], ["too coarse in contact", "false state"]),
    ],
)
def test_of_coarse_steps_that_is_said_and_of_one_preset_the_false_state(settings, warnings):
    said = warnings_on_the_rig(settings)
    assert [message.partition(" since t = ")[0] for message in said] == warnings


def test_when_the_rub_is_overdamped_is_part_of_the_state():
    sim, _ = run_down(overhung_machine(), choose("robust"), 1.0, lambda message: None)
    retained, at = sim.snapshot(), sim.read("solver.overdamped_at")
    other = Simulation(overhung_machine(), choose("robust"), speed=400.0, warn=lambda m: None)
    assert other.read("solver.overdamped_at") == -1.0
    other.restore(retained)
    assert other.read("solver.overdamped_at") == at >= 0.0
