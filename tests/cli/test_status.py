"""What a run's status says, in every way of running one."""

import pickle
import re
import warnings

import pytest
from rotor_fmu.model.kernels.library import RAISED
from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.message_templates import NOTES, Message
from rotor_fmu.model.messages import CODES, SENTENCES
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import RotorNote, RotorWarning, Simulation, StepFailure
from rotor_fmu.model.step import step_status as of_step
from rotor_fmu.model.time_loop import early_return, equilibrium

import rotor_fmu as rf
from rotor_fmu.fmi.log import read_message, with_code
from rotor_fmu.library.build import C_SOURCES
from rotor_fmu.run_status import first_of_each, status_of
from tools.checkout import ROOT

COARSE = "doubtful: too-coarse-in-contact"
# of a shaft whose damping turns with it, far above its critical speed
UNSTABLE = rig_toml().replace("rotating_damping = false", "rotating_damping = true")


OF_A_STEP = (of_step.DONE, of_step.NOT_CONVERGED, of_step.NOT_FINITE, of_step.FILM_INVALID)
ENDS_EARLY = (
    *(early_return.PAST_DISPLACEMENT, early_return.PAST_FORCE),
    *(early_return.CLOSED, early_return.OPENED),
)
OF_A_START = (
    *(equilibrium.AT_EQUILIBRIUM, equilibrium.NOT_SUPPORTED, equilibrium.NOT_CONVERGED_AT_REST),
    equilibrium.UNFINISHED_AT_REST,
    *(equilibrium.UNSTABLE, equilibrium.OUT_OF_BOUNDS, equilibrium.MOVED),
    *(early_return.LIMITED, early_return.IN_STAGES, early_return.NO_INERTIA),
)


def test_every_way_in_which_a_start_or_an_advance_ends_has_a_status_of_its_own():
    early = [of_step.ENDED_EARLY + end for end in (early_return.GOES_ON, *ENDS_EARLY)]
    of_an_advance = [*OF_A_STEP, of_step.UNFINISHED, *early]
    for statuses in (of_an_advance, OF_A_START):
        assert len({*statuses}) == len(statuses)
    # all is well
    assert (of_step.DONE, equilibrium.AT_EQUILIBRIUM, early_return.GOES_ON) == (0, 0, 0)
    # what ended it early is above this, and nothing else is
    assert max(*OF_A_STEP, of_step.UNFINISHED) < of_step.ENDED_EARLY
    assert min(ENDS_EARLY) > early_return.GOES_ON


def test_a_status_lists_the_codes_of_warnings_once_and_leaves_out_notes():
    said = [Message("a", "overdamped"), Message("b", "slow"), Message("c", "overdamped")]
    assert status_of(said) == "doubtful: overdamped"
    assert status_of([*said, Message("d", "false-state")]) == "doubtful: overdamped, false-state"
    assert status_of(said[1:2]) == status_of([]) == "ok"
    assert status_of(said, "it broke") == "failed: it broke"


NOT_OF_KERNELS = {"hysteretic-as-slower", "interpreted", "reduction-pays", "tolerance-raised"}


def test_every_warning_has_a_code_and_every_note_is_said_somewhere():
    assert len(CODES) == len(SENTENCES)
    assert {*CODES} >= NOTES - NOT_OF_KERNELS
    assert all(SENTENCES[i] for i, code in enumerate(CODES) if code not in ("", "idle-setting"))
    page = (ROOT / "docs" / "reference" / "api.md").read_text(encoding="utf-8")
    periodic = "".join(
        p.read_text(encoding="utf-8") for p in (ROOT / "model/periodic").glob("*.py")
    )
    of_responses = re.findall(r'"([a-z]+(?:-[a-z]+)+)"', periodic)
    assert "branch-lost" in of_responses
    known = {*CODES, *NOTES, *of_responses} - {""}
    assert not [code for code in known if f"`{code}`" not in page]


def test_a_message_goes_through_a_log_and_a_pickle_with_its_code():
    for message in (Message("slow since t = 1 s: much work", "slow"), Message("no code", "")):
        logged = with_code(message, message.code).encode()
        for copy in (read_message(logged), pickle.loads(pickle.dumps(message))):
            assert (copy, copy.code) == (message, message.code)
    assert read_message(b"a [slow] (t from the start, 5 s)").code == "slow"


def test_a_coarse_run_is_doubtful_through_the_fmu_and_without_it(tmp_path):
    fmu = rf.build_fmu(rf.load(), tmp_path)
    given = {"speed": 400.0, "stop": 0.1, "preset": "paper", "step": 0.02}
    with pytest.warns(RotorWarning, match="too coarse in contact"):
        direct = rf.simulate(rf.load(), **given)
    with pytest.warns(RotorWarning, match="too coarse in contact"):
        driven = rf.simulate_fmu(fmu, **given)
    assert direct.status == driven.status == COARSE
    assert direct.codes == driven.codes == ("too-coarse-in-contact",)
    assert direct.messages == driven.messages


def test_a_machine_that_is_unstable_by_itself_is_a_note_and_the_run_ok():
    machine = rf.parse(UNSTABLE)
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        run = rf.simulate(machine, speed=400.0, stop=0.05)
    assert run.status == "ok"
    assert "unstable" in run.codes
    assert {note.category for note in seen} == {RotorNote}


def test_the_instance_in_c_has_the_statuses_of_the_kernels():
    header = (C_SOURCES / "kernels.h").read_text(encoding="utf-8")
    numbers = dict(re.findall(r"\b(UNFINISHED|ENDED_EARLY) = (\d+)", header))
    assert numbers == {name: str(getattr(of_step, name)) for name in ("UNFINISHED", "ENDED_EARLY")}
    assert max(of_step.UNFINISHED, of_step.FILM_INVALID) < of_step.ENDED_EARLY


def test_an_exception_in_the_solver_is_a_sentence_in_c_and_in_python():
    header = (C_SOURCES / "kernels.h").read_text(encoding="utf-8")
    assert re.search(r"enum \{ RAISED = 1 << (\d+) \};", header)[1] == str(RAISED.bit_length() - 1)
    run = Simulation(rig(), choose(), speed=100.0)
    run._entry_points = run._entry_points._replace(advance=lambda *_: RAISED)
    with pytest.raises(StepFailure, match=r"^internal error in a step$"):
        run.advance(0.01, 100.0)


def test_messages_of_several_runs_that_differ_in_numbers_alone_are_given_once():
    above = [
        Message(f"film_{i}: speed {speed} rad/s is above 328 rad/s", "beyond-the-film")
        for speed in (328.5, 392.7)
        for i in (1, 2)
    ]
    other = Message("film_1: speed 328.5 rad/s is above 300 rad/s", "outside-the-table")
    assert first_of_each([*above, other]) == [*above[:2], other]
