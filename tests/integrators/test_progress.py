"""What a run in progress says of its steps."""

import pytest
from rich.console import Console
from rotor_fmu.model.settings import choose

from rotor_fmu import screen
from rotor_fmu.runs.job import prepare
from rotor_fmu.runs.progress import shown, steps
from rotor_fmu.runs.run_down import run_direct


def words_of(preset, *sets, stop=0.2, step=None):
    """What is said at each communication point of a run of the rig in its resonance."""
    job = prepare(None, preset, ["speed=185", *sets], None, stop, step)
    said = []
    run_direct(job, lambda t, observe: said.append(steps(observe(), job.step, job.settings)))
    return said


def test_a_rub_says_which_contacts_keep_its_steps_short():
    said = words_of(None, stop=0.5)
    assert any(" by the tolerance while bearing[1] and bearing[2] touch" in text for text in said)
    assert any(text.endswith(", by the tolerance") for text in said)  # both journals in the air


def test_a_step_as_long_as_was_asked_for_needs_no_reason():
    assert set(words_of("robust")) == {"steps of 0.5 ms"}
    # cut to the communication step
    assert "steps of 50 µs" in words_of(None, "solver.tolerance=1", stop=0.002, step=5e-5)


def test_steps_at_the_shortest_allowed_say_so():
    said = words_of(None, "solver.tolerance=1e-9", "solver.h_min=1e-4", "solver.h=1e-4", stop=0.02)
    assert {text.partition(", ")[2] for text in said} == {"the shortest allowed"}


@pytest.mark.parametrize("is_terminal", [False, True])
def test_progress_is_shown_every_now_and_then(monkeypatch, capsys, is_terminal):
    """On a clock of which every look takes 6 s."""
    clock = iter(range(0, 600, 6))
    monkeypatch.setattr(screen.time, "monotonic", lambda: next(clock))
    monkeypatch.setattr(Console, "is_terminal", is_terminal)
    looks = []

    def observe():
        looks.append(1)
        return {"solver.h_last": 4e-6, "contact[1].fn": 2.0}

    with shown("a run", 10.0, 4e-3, choose("controlled")) as report:
        for t in range(6):
            report(float(t), observe)
    err = capsys.readouterr().err
    if is_terminal:
        assert len(looks) == 6
    else:
        assert err.splitlines() == [
            f"a run: {t} of 10 s, steps of 4 µs, by the tolerance while contact[1] touches"
            for t in (1, 3, 5)
        ]
