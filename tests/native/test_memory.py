"""Valgrind and the compiler's sanitizers find nothing over the grid of failures, and random calls
of the whole C interface leave the host alive."""

import shutil
import subprocess
from pathlib import Path

import pytest
from fmpy import extract, read_model_description

from rotor_fmu.library.build import C_SOURCES, fmi_headers, kernels, objects, sources_digest
from rotor_fmu.library.platforms import PLATFORMS

from ..fmu.masters import COMPILER, HERE, NEEDS_COMPILER, Master
from ..fmu.test_failures import FAILURES, commands, sequences
from ..fmu.test_fuzz import survive

SANITIZED = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
CALLS = [
    *("GetReal", "GetInteger", "GetBoolean", "GetString"),
    *("SetReal", "SetInteger", "SetBoolean", "SetString"),
    *("early GetString", "early SetString", "early GetReal", "NULL state"),
]


def failures(longest):
    """Every failure, and what is called after it."""
    return [
        call
        for failure in FAILURES.values()
        for sequence in sequences(longest)
        for call in commands(failure, sequence)
    ]


def run(program, master, calls):
    """Answered, all of them; what was printed."""
    done = subprocess.run(
        [*program, *master.program()],
        input=master.script(calls),
        capture_output=True,
        text=True,
        check=False,
        env={},
    )
    answers = [line for line in done.stdout.splitlines() if not line.startswith("log ")]
    assert len(answers) == len(calls), done.stderr[-3000:]
    assert done.returncode == 1, done.stderr[-3000:]  # since calls failed, as they must
    return done.stderr


@pytest.mark.slow
def test_valgrind_finds_neither_a_wrong_access_nor_a_leak(c_host):
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        pytest.skip("valgrind is not installed")
    printed = run((valgrind, "-q", "--leak-check=full"), c_host, failures(1))
    assert "==" not in printed, printed[-3000:]


@NEEDS_COMPILER
def test_where_memory_is_out_a_call_fails_and_can_be_made_again(make, tmp_path):
    folder, host = extract(make(fmi=3), str(tmp_path / "fmu")), tmp_path / "host"
    include = f"-I{fmi_headers()}"
    source = Path(__file__).with_name("no_memory.c")
    subprocess.run([COMPILER, "-rdynamic", include, "-o", host, source, "-ldl"], check=True)
    library = f"{folder}/binaries/x86_64-linux/RotorBearingNative.so"
    token = read_model_description(folder).guid
    command = [host, library, f"{folder}/resources/", token]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    runs = [line.split() for line in done.stdout.splitlines()]
    failed = [run[0] for run in runs]
    assert set(failed) == {"0", "1"}
    assert {tuple(run[1:]) for run in runs} == {("0", runs[0][2], "0")}
    # of two there is no instance yet that could speak, and of one the file cannot be opened
    assert done.stderr.count("out of memory") == failed.count("1") - 3


@pytest.mark.slow
@NEEDS_COMPILER
def test_the_sanitizers_find_neither_a_wrong_access_nor_undefined_behaviour(fmu, tmp_path):
    """The skin compiled with them by the system's compiler, and the kernels as they are."""
    master = Master(fmu, tmp_path / "host", is_alone=True)
    target = master.folder / "binaries" / "linux64" / "RotorBearingNative.so"
    parts = objects(PLATFORMS["linux64"], kernels(), tmp_path)
    name = f'-DSOURCES="{sources_digest()}"'
    skin = ("-std=c2x", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
    skin += (name, f"-I{fmi_headers()}")
    for options, files in (
        ((*skin, "-o", target), (*C_SOURCES.glob("*.c"), *parts)),
        (("-std=c99", "-o", tmp_path / "host"), (HERE / "host.c",)),
    ):
        subprocess.run([COMPILER, *SANITIZED, *options, *files, "-lm", "-ldl"], check=True)
    printed = run((), master, failures(2))
    assert "Sanitizer" not in printed, printed[-3000:]
    assert "runtime error" not in printed, printed[-3000:]
    master.close()


@pytest.mark.parametrize("call", CALLS)
def test_a_wrong_call_made_300_times_leaves_the_host_alive(fmu, call):
    assert survive(fmu, call, seconds=300) == "refused 300 times, then stepped"


def test_some_hundred_random_calls_end_in_errors_that_are_not_fatal(fmu):
    statuses = survive(fmu, 1, 2000, seconds=600)
    assert "0: " in statuses
    assert "3: " in statuses
    assert "4: " not in statuses


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 6))
def test_twenty_thousand_random_calls_leave_the_host_alive(fmu, seed):
    statuses = survive(fmu, seed, 5000, seconds=3000)
    assert "0: " in statuses
    assert "4: " not in statuses
