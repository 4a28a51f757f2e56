"""What goes wrong, and whatever is called after it: an error with one plain sentence, no crash.

A grid of failures x sequences of later calls in processes of their own, through FMPy and through a
plain C host: a crash shows in the exit status and in the answers that are missing.
"""

import itertools
import math
import subprocess
import sys
import zipfile
from dataclasses import dataclass

import pytest

from .masters import Master, expanded, host_environment

H = 0.01
INITIALIZE = ("setup 0", "enter", "exit")
GOOD = (*INITIALIZE, f"step 0 {H}")


@dataclass(frozen=True)
class Failure:
    """The calls that lead to it, the call that must fail, and part of what must be said."""

    before: tuple[str, ...]
    call: str
    sentence: str

    @property
    def is_running(self) -> bool:
        """Whether there is a state to be read when it happens."""
        return "exit" in self.before


FAILURES = {
    "NaN input": Failure(GOOD, "real speed nan", "speed = nan: must be a finite number"),
    "angle without a turn": Failure(
        GOOD,
        "real disc[1].phase 1e13",
        "disc[1].phase = 1e+13 rad: must be finite and at most 1e+09 rad in",
    ),
    "infinite load": Failure(GOOD, "real disc[1].fx inf", "disc[1].fx = inf: must be a finite"),
    "gap in time": Failure(GOOD, f"step 5 {H}", "without gap or overlap"),
    "overlap in time": Failure(GOOD, f"step 0 {H}", "without gap or overlap"),
    "time that is no number": Failure(GOOD, f"step nan {H}", "without gap or overlap"),
    "no step": Failure(GOOD, f"step {H} 0", "doStep over 0 s: the step must be > 0"),
    "step backwards": Failure(GOOD, f"step {H} -{H}", "the step must be > 0"),
    "infinite step": Failure(GOOD, f"step {H} inf", "doStep over inf s"),
    "fixed parameter": Failure(GOOD, "real gravity 1", "gravity: a fixed parameter cannot be set"),
    "computed variable": Failure(GOOD, "real phi 1", "phi: is computed and cannot be set"),
    "step before initialization": Failure((), f"step 0 {H}", "the initialization has not begun"),
    "no such choice": Failure((), "integer solver.preset 99", "solver.preset = 99: must be"),
    "negative gravity": Failure(
        ("setup 0", "enter", "real gravity -1"), "exit", "gravity = -1 m/s2: must be >= 0"
    ),
    "negative clearance": Failure(
        ("setup 0", "enter", "real bearing[1].clearance -1"), "exit", "bearing[1].clearance = -1 m"
    ),
    "settings that contradict each other": Failure(
        ("setup 0", "enter", "real solver.alpha_f 0"), "exit", "solver.alpha_f = 0"
    ),
    "negative solver step": Failure(
        ("setup 0", "enter", "real solver.h -1"), "exit", "solver.h = -1 s: must be > 0"
    ),
    "spectral radius above 1": Failure(
        ("setup 0", "enter", "real solver.rho 2"), "exit", "rho = 2"
    ),
    "damping that is not to be had": Failure(
        ("setup 0", "enter", "real shaft.eta_h 0.1"), "exit", "shaft.eta_h = 0.1"
    ),
    "unstable scheme": Failure(
        (
            *("integer solver.preset 1", "integer solver.method 3", "real solver.alpha_m 0.08"),
            *GOOD,
        ),
        f"step {H} 2",
        "the scheme is unstable",
    ),
    "no convergence": Failure(
        ("integer solver.preset 1", "real bearing[1].mu 1e6", "real speed 300", *INITIALIZE),
        "step 0 1",
        "did not converge",
    ),
}
# one after a good step and one before the first; three calls after each are made by the slow tests
KINDS = ("gap in time", "negative gravity")
LATER = {
    "get": ("get phi",),
    "step": (f"step {H} {H}",),
    "reset": ("reset",),
    "restart": ("reset", *GOOD, "get phi"),
    "terminate": ("terminate",),
}


def commands(failure, sequence):
    later = [call for name in sequence for call in LATER[name]]
    return ["instantiate", *failure.before, "get phi", failure.call, "get phi", *later, "free"]


def sequences(longest):
    """All sequences of later calls, up to a length."""
    return [s for n in range(longest + 1) for s in itertools.product(LATER, repeat=n)]


def mistakes(failure, sequence, replies):
    """What does not hold of the answers to `commands` and has to."""
    failing_at = len(failure.before) + 2
    good, failed, after = replies[failing_at - 1 : failing_at + 2]
    holds = {
        "the call fails": failed.is_error,
        "its sentence is said": bool(failed.log) and failure.sentence in failed.log[-1],
        "no message holds a %": not any("%" in line for reply in replies for line in reply.log),
        "every error has a message": all(reply.log or not reply.is_error for reply in replies),
    }
    if failure.is_running:
        is_readable = good.status == after.status == 0 and good.value <= after.value < math.inf
        holds["the last good state is readable"] = is_readable
    if sequence and sequence[-1] == "restart":
        *_, end, freed = replies
        holds["a run begins anew"] = (end.status, freed.status) == (0, 0) and (
            end.value == pytest.approx(400 * H)
        )
    return [(what, sequence, replies) for what, does_hold in holds.items() if not does_hold]


def march_through(master, failures, longest):
    """The answers to every sequence after every failure, all in one process."""
    grid = [(failure, sequence) for failure in failures for sequence in sequences(longest)]
    calls = [call for failure, sequence in grid for call in commands(failure, sequence)]
    done = master.tell(calls)
    if len(done.answers) < len(calls):
        at = len(done.answers)
        pytest.fail(
            f"crash, status {done.status}, at {calls[at - 8 : at + 1]}\n{done.stderr[-900:]}"
        )
    errors = sum(answer.is_error for answer in done.answers)
    printed = [line for line in done.stderr.splitlines() if ": error: " in line]
    assert len(printed) == errors, "an error without its one sentence on standard error"
    assert "Traceback" not in done.stderr
    answers = iter(done.answers)
    return [
        (failure, sequence, list(itertools.islice(answers, len(commands(failure, sequence)))))
        for failure, sequence in grid
    ]


@pytest.fixture(scope="module")
def grid(master):
    """One call after each failure, and in C two after one of each kind."""
    kinds = KINDS if master.c_program else ()
    others = [failure for name, failure in FAILURES.items() if name not in kinds]
    of_kinds = march_through(master, [FAILURES[name] for name in kinds], 2)
    return of_kinds + march_through(master, others, 1)


@pytest.mark.parametrize("name", FAILURES)
def test_a_failure_is_told_and_whatever_is_called_then_survives(master, grid, name):
    mine = [entry for entry in grid if entry[0] is FAILURES[name]]
    assert len(mine) == len(sequences(2 if master.c_program and name in KINDS else 1))
    assert [mistake for entry in mine for mistake in mistakes(*entry)] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", FAILURES)
def test_so_do_three_calls_after_a_failure_in_a_process_of_its_own(master, name):
    entries = march_through(master, [FAILURES[name]], 3)
    assert len(entries) == len(sequences(3))
    assert [mistake for entry in entries for mistake in mistakes(*entry)] == []


def test_a_refused_call_changes_nothing(master):
    """The run goes on as if it had not been made."""
    steps = [f"step {H * (1 + i)!r} {H}" for i in range(3)]
    refused = ["NaN input", "gap in time", "no step", "fixed parameter", "computed variable"]
    calls = ["instantiate", *GOOD, *steps, "get disc[3].y", "free"]
    for name in refused:
        calls += ["instantiate", *GOOD, FAILURES[name].call, *steps, "get disc[3].y", "free"]
    undisturbed, *others = (answer.value for answer in master.tell(calls).named("get"))
    assert others == [undisturbed] * len(refused)


def test_an_unstable_scheme_is_warned_of_before_it_diverges(master):
    failure = FAILURES["unstable scheme"]
    done = master.tell(["instantiate", *failure.before, "free"])
    ended = done.named("exit")[0]
    assert ended.status == 0
    assert any("is unstable: its spectral radius" in line for line in ended.log)
    assert "warning: wbz with" in done.stderr


def test_a_step_after_one_that_failed_says_what_to_do(master):
    failure = FAILURES["unstable scheme"]
    done = master.tell(["instantiate", *failure.before, failure.call, f"step {H} 0.001", "free"])
    assert "an earlier step failed" in done.named("step")[-1].log[-1]
    assert "reset the FMU" in done.named("step")[-1].log[-1]


def test_a_host_whose_python_has_no_package_gets_the_same_numbers(c_host, tmp_path):
    """The Python of a fresh environment, which has none."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path], check=True)
    bare = expanded({**host_environment(), "PATH": f"{tmp_path / 'bin'}:$PATH"})
    calls = ["instantiate", *GOOD, "get disc[3].y", "free"] * 3
    answers = [c_host.tell(calls, environment) for environment in (bare, None)]
    assert all(answer.status == 0 for done in answers for answer in done.answers)
    seen = [[answer.value for answer in done.named("get")] for done in answers]
    assert seen[0] == seen[1]
    assert answers[0].stderr == ""


def without(fmu, target, change):
    """A copy of the FMU with its library changed, or left out where `change` gives None."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as sink:
        for name in source.namelist():
            data = source.read(name)
            data = change(data) if name.endswith("/linux64.so") else data
            if data is not None:
                sink.writestr(name, data)
    return target


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda data: None, "carries no library for linux; build it with one: rotor-fmu build"),
        (lambda data: b"no library", "the FMU's library is damaged: linux64.so is not what was"),
        # which the system's loader would take, and end the host
        (lambda data: data[: len(data) // 2], "the FMU's library is damaged: linux64.so is not"),
    ],
)
def test_without_its_library_the_fmu_says_so_each_time(fmu, tmp_path, change, sentence):
    done = Master(without(fmu, tmp_path / "without.fmu", change)).tell(["instantiate", "free"] * 3)
    assert [answer.status for answer in done.answers] == [4, 0] * 3
    assert done.stderr.count(f"error: {sentence}") + done.stderr.count(f"this FMU {sentence}") == 3
    assert all(sentence in answer.log[-1] for answer in done.named("instantiate"))
