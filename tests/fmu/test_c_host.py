"""A plain C master on this machine: it gets the numbers that FMPy gets, and ends well."""

import fmpy
import pytest

from rotor_fmu.cli import main

from .masters import ENVIRONMENT

START = ["instantiate", "real speed 300", "setup 0", "enter", "exit"]


def march(steps, h):
    """Commands of a run that reads disc 3 after each step."""
    calls = [(f"step {i * h!r} {h!r}", "get disc[3].x") for i in range(steps)]
    return [*START, *(call for pair in calls for call in pair), "terminate", "free"]


def test_the_environment_printed_is_the_one_used_here(c_host, capsys, monkeypatch):
    monkeypatch.setattr("sys.argv", ["rotor-fmu", "host-env"])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed == [f'export {name}="{value}"' for name, value in ENVIRONMENT.items()]


def test_it_gets_the_numbers_that_fmpy_gets(c_host):
    done = c_host.tell(march(25, 0.04))
    assert done.status == 0, done.stderr
    other = fmpy.simulate_fmu(
        str(c_host.folder),
        stop_time=1.0,
        output_interval=0.04,
        start_values={"speed": 300.0},
        output=["disc[3].x"],
    )
    seen = [answer.value for answer in done.named("get")]
    assert seen == pytest.approx(other["disc[3].x"][1:].tolist(), rel=1e-9)


def test_many_runs_in_a_row_all_end_well(c_host):
    """Tearing the wrapper down twice used to abort now and then."""
    assert [c_host.tell(march(2, 0.004)).status for _ in range(5)] == [0] * 5
