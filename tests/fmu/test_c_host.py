"""A plain C master on this machine: it gets the numbers that FMPy gets, and ends well."""

import os
import subprocess
import sys

import fmpy
import pytest

START = ["instantiate", "real speed 300", "setup 0", "enter", "exit"]


def march(steps, h):
    """Commands of a run that reads disc 3 after each step."""
    calls = [(f"step {i * h!r} {h!r}", "get disc[3].x") for i in range(steps)]
    return [*START, *(call for pair in calls for call in pair), "terminate", "free"]


def test_what_host_env_prints_is_all_that_a_shell_needs(c_host):
    """In a shell that knows nothing of this project's environment."""
    host_env = f"'{sys.executable}' -c 'from rotor_fmu.cli import main; main()' host-env"
    done = subprocess.run(
        ["sh", "-c", f'eval "$({host_env})"; exec "$0" "$@"', *c_host.program()],
        input=c_host.script(march(3, 0.004)),
        capture_output=True,
        text=True,
        check=False,
        env={
            "PATH": "/usr/bin:/bin",
            **{n: os.environ[n] for n in ("HOME", "XDG_CACHE_HOME") if n in os.environ},
        },
    )
    assert done.returncode == 0, done.stderr
    assert [line.split()[:2] for line in done.stdout.splitlines()][-2:] == [
        ["terminate", "0"],
        ["free", "0"],
    ]


def test_without_it_the_host_is_told_what_is_missing(c_host):
    """Python's library, which the wrapper does not link."""
    done = subprocess.run(c_host.program(), input="", capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "undefined symbol" in done.stderr


def test_it_gets_the_numbers_that_fmpy_gets(c_host):
    # a step that binary numbers have: both hosts' times are the same to the last digit
    done = c_host.tell(march(32, 1 / 32))
    assert done.status == 0, done.stderr
    other = fmpy.simulate_fmu(
        str(c_host.folder),
        stop_time=1.0,
        output_interval=1 / 32,
        start_values={"speed": 300.0},
        output=["disc[3].x"],
    )
    seen = [answer.value for answer in done.named("get")]
    assert seen == pytest.approx(other["disc[3].x"][1:].tolist(), rel=1e-9)


def test_many_runs_in_a_row_all_end_well(c_host):
    """Tearing the wrapper down twice used to abort now and then."""
    assert [c_host.tell(march(2, 0.004)).status for _ in range(5)] == [0] * 5
