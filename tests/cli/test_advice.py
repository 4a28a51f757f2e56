"""Whoever does what a message advises gets rid of it."""

from dataclasses import replace

import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import StepFailure

from ..integrators.test_work import rubbing
from ..physics.test_simulation import unstable
from ..validation.test_whip import warnings_on_the_rig
from ..validation.whip import overhung_machine, run_down


def outcome(rotor, settings, stop, interval=0.005):
    """What a run-down says on its way, and why it ends early, if it does."""
    said = []
    try:
        run_down(rotor, settings, stop, said.append, interval)
    except StepFailure as failure:
        said.append(str(failure))
    return said


SLOW = {
    "a stiff wall": ({"k": 1e20}, {}),
    "friction that locks": ({"mu": 5.0}, {"max_iterations": 10**5}),
}
MENDED = {
    "preset robust": ("friction that locks", {}, {"preset": "robust"}),
    "less friction": ("friction that locks", {"mu": 0.5}, {}),
    "softer contacts": ("a stiff wall", {"k": 1e9}, {}),
}


@pytest.mark.parametrize(
    "advice",
    [
        pytest.param(each, marks=() if each == "less friction" else pytest.mark.slow)
        for each in MENDED
    ],
)
def test_a_run_that_takes_too_much_work_gets_on_with_the_advice_for_its_trouble(advice):
    trouble, bearing, settings = MENDED[advice]
    before = SLOW[trouble]
    output = outcome(rubbing(**before[0]), choose(**before[1]), 0.01, interval=0.01)
    assert advice in output[-1]
    most = before[1].get("max_iterations", 10**7)
    assert f"stopped after {most} iterations" in output[-1]
    output = outcome(
        rubbing(**before[0] | bearing), choose(**before[1] | settings), 0.01, interval=0.01
    )
    assert not [message for message in output if "iterations" in message]


def test_steps_too_coarse_are_mended_by_a_smaller_least_step_or_a_larger_tolerance():
    coarse = {"tolerance": 1e-5, "h_min": 1e-3, "h": 1e-3}
    (output,) = outcome(rig(), choose(**coarse), 0.1)
    assert "lower solver.h_min, or raise solver.tolerance" in output
    assert outcome(rig(), choose(**coarse | {"h_min": 1e-9}), 0.1) == []
    larger = outcome(rig(), choose(**coarse | {"tolerance": 1.0}), 0.1)
    assert not [message for message in larger if "solver.h_min" in message]


def test_the_false_state_is_avoided_by_the_preset_robust_and_by_a_smaller_step():
    *_, output = warnings_on_the_rig(choose("moderate"))
    assert output.startswith("false state")
    assert "take the preset robust, or a smaller solver.h" in output
    assert warnings_on_the_rig(choose("robust")) == []
    # a contact may close in a step that is too coarse for it, by chance: that is another message
    smaller = warnings_on_the_rig(choose("moderate", h=2e-4))
    assert not [message for message in smaller if message.startswith("false state")]


@pytest.mark.parametrize(
    ("output", "advice", "followed"),
    [
        (unstable(), "take alpha_m <= alpha_f <= 0.5", choose("paper")),
        (replace(unstable(), h=1e-3), "or the preset robust", choose("robust", h=1e-3)),
    ],
)
def test_a_scheme_that_diverges_is_mended_by_what_is_advised(output, advice, followed):
    assert advice in outcome(rig(), output, 0.5, interval=0.5)[-1]
    assert not [message for message in outcome(rig(), followed, 0.5) if "unstable" in message]


def test_an_overdamped_rub_is_seen_by_the_preset_controlled_and_by_a_smaller_step():
    output = outcome(overhung_machine(), choose("robust"), 1.0)
    (overdamped,) = (message for message in output if message.startswith("overdamped"))
    assert "take the preset controlled, or a smaller solver.h" in overdamped
    for settings in (choose("controlled"), choose("robust", h=2e-5)):
        assert outcome(overhung_machine(), settings, 1.0) == []


def test_error_control_is_not_advised_to_take_itself_but_a_tolerance():
    """Its steps do not depend on `solver.h`, which is the length of the first one alone."""
    coarse, false_state = outcome(rig(), choose(method="newmark", tolerance=0.5), 1.0)
    assert "the preset controlled with a solver.tolerance of at most 0.1" in coarse
    assert false_state.startswith("false state")
    assert "a smaller solver.h or solver.tolerance" in false_state
    assert outcome(rig(), choose(method="newmark", tolerance=0.1), 1.0) == []
