"""Random and wrong calls of the C interface, in processes of their own: no crash, no hang."""

import signal
from pathlib import Path

import pytest

from ..processes import run_python

FUZZ = Path(__file__).with_name("fuzz.py")


def survive(*arguments, seconds):
    """Run fuzz.py; its last line. A crash fails with the calls that led to it."""
    done = run_python(FUZZ, *arguments, seconds=seconds)
    lines = done.stdout.splitlines()
    assert done.returncode == 0, (done.returncode, lines[-12:], done.stderr[-2000:])
    assert "Traceback" not in done.stderr
    assert "internal error" not in done.stderr
    return lines[-1] if lines else ""


def test_a_crash_is_seen():
    done = run_python("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    assert done.returncode == -signal.SIGSEGV


def test_a_process_does_not_import_what_an_fmu_here_carries(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(tmp_path)
    done = run_python(f"import sys; sys.exit({str(tmp_path)!r} in sys.path)")
    assert done.returncode == 0


@pytest.mark.parametrize(
    "call",
    [
        *("GetReal", "GetInteger", "GetBoolean", "GetString"),
        *("SetReal", "SetInteger", "SetBoolean", "SetString"),
        *("early GetString", "early SetString", "early GetReal", "NULL state"),
    ],
)
def test_a_wrong_call_made_300_times_leaves_the_host_alive(fmu, call):
    assert survive(fmu, call, seconds=300) == "refused 300 times, then stepped"


def test_some_hundred_random_calls_leave_the_host_alive(fmu):
    statuses = survive(fmu, 1, 600, seconds=600)
    assert "0: " in statuses
    assert "4: " in statuses


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 6))
def test_twenty_thousand_random_calls_leave_the_host_alive(fmu, seed):
    statuses = survive(fmu, seed, 5000, seconds=3000)
    assert "0: " in statuses
    assert "4: " in statuses
