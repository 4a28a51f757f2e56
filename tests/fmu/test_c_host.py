"""A plain C master on this machine: it gets the numbers that FMPy gets, and survives failures."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import fmpy
import pytest

from rotor_fmu.cli import main
from rotor_fmu.errors import InputError
from rotor_fmu.host_env import host_environment

COMPILER = shutil.which("cc") or shutil.which("gcc")
try:
    ENVIRONMENT = host_environment()
except InputError as reason:
    ENVIRONMENT, REASON = None, str(reason)
else:
    REASON = "no C compiler on this machine"

pytestmark = pytest.mark.skipif(COMPILER is None or ENVIRONMENT is None, reason=REASON)


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    program = tmp_path_factory.mktemp("host") / "host"
    source = Path(__file__).with_name("host.c")
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-o", str(program), str(source), "-ldl"]
    subprocess.run([COMPILER, *options], check=True)
    return program


@pytest.fixture(scope="module")
def extracted(fmu):
    folder = Path(fmpy.extract(str(fmu)))
    yield folder
    shutil.rmtree(folder)


def run(host, extracted, steps, step, *parameters, output="disc[3].x"):
    description = fmpy.read_model_description(str(extracted))
    refs = {v.name: v.valueReference for v in description.modelVariables}
    pairs = [str(x) for name, value in parameters for x in (refs[name], value)]
    return subprocess.run(
        [
            *(host, extracted / "binaries" / "linux64" / "RotorBearing.so"),
            *(f"file://{extracted}/resources", description.guid, str(steps), repr(step)),
            *(str(refs[output]), *pairs),
        ],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env={
            **os.environ,
            **{name: os.path.expandvars(value) for name, value in ENVIRONMENT.items()},
        },
    )


def test_the_environment_printed_is_the_one_used_here(capsys, monkeypatch):
    monkeypatch.setattr("sys.argv", ["rotor-fmu", "host-env"])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed == [f'export {name}="{value}"' for name, value in ENVIRONMENT.items()]


def test_it_marches_and_ends_well(host, extracted):
    done = run(host, extracted, 50, 0.004, ("bearing[1].clearance", 60e-6))
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 50


def test_an_impossible_parameter_is_an_error_and_no_crash(host, extracted):
    done = run(host, extracted, 50, 0.004, ("bearing[1].clearance", -1.0))
    assert done.returncode == 1
    assert done.stdout.startswith("fmi2ExitInitializationMode")
    assert "bearing[1].clearance = -1 m: must be > 0" in done.stderr


def test_settings_that_contradict_each_other_are_an_error_and_no_crash(host, extracted):
    done = run(host, extracted, 200, 0.004, ("solver.alpha_f", 0.0), ("solver.alpha_m", 0.08))
    assert done.returncode == 1
    assert "solver.alpha_f = 0: chung-hulbert does not take it" in done.stderr


def test_a_step_that_fails_is_an_error_and_no_crash(host, extracted):
    """A weight that no shaft carries: the first steps throw the rotor out of all bounds."""
    done = run(host, extracted, 50, 0.004, ("gravity", 1e9))
    assert done.returncode == 1
    assert done.stdout.splitlines()[-1].startswith("fmi2DoStep")
    assert re.search("diverged|did not converge", done.stderr)


def test_it_gets_the_numbers_that_fmpy_gets(host, extracted):
    done = run(host, extracted, 25, 0.04, ("speed", 300.0))
    seen = [float(line.split()[1]) for line in done.stdout.splitlines()]
    other = fmpy.simulate_fmu(
        str(extracted),
        stop_time=1.0,
        output_interval=0.04,
        start_values={"speed": 300.0},
        output=["disc[3].x"],
    )
    assert seen == pytest.approx(other["disc[3].x"][1:].tolist(), rel=1e-9)


def test_many_runs_in_a_row_all_end_well(host, extracted):
    """Tearing the wrapper down twice used to abort now and then."""
    assert [run(host, extracted, 2, 0.004).returncode for _ in range(8)] == [0] * 8
