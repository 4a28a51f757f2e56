"""The mode for real time in the FMU: its fixed step is declared, and a step takes no memory and
calls no system."""

import os
import shutil
import struct
import subprocess
import sys
from pathlib import Path
from xml.etree.ElementTree import fromstring

import fmpy
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.errors import InputError
from rotor_fmu.fmi.packing.archive import contents_of
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

from ..fmu.masters import COMPILER, NO_COMPILER
from ..processes import ROTOR_FMU, run_anew

STEP = 1e-4
# through the contact of the rig, slower by 1 rad/s a step's hundredth of a second
STEPS, SPEED, RATE = 2000, 190.0, -0.01
STRACE = shutil.which("strace")
BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


def _traces() -> bool:
    """Whether strace is installed and may trace here."""
    command = [STRACE, "-o", os.devnull, sys.executable, "-c", ""]
    return STRACE is not None and subprocess.run(command, check=False).returncode == 0


def described(fmu, name):
    root = fromstring(contents_of(fmu)["modelDescription.xml"])
    return root, {v.get("name"): v for v in root.find("ModelVariables")}[name]


@pytest.fixture(scope="module")
def fmu(make):
    return make(fmi=3, step=STEP)


@pytest.fixture(scope="module")
def quiet(fmu, tmp_path_factory):
    """Runs the C master; returns what it printed."""
    if sys.platform != "linux":
        pytest.skip("seccomp and strace are Linux's")
    if COMPILER is None:
        pytest.skip(NO_COMPILER)
    folder = tmp_path_factory.mktemp("quiet")
    program = folder / "quiet"
    source = Path(__file__).with_name("quiet.c")
    options = ["-O1", "-rdynamic", "-I", BENCHMARKS, "-o", program, source, "-ldl"]
    subprocess.run([COMPILER, *options], check=True)
    unpacked = fmpy.extract(str(fmu), str(folder / "fmu"))
    description = fmpy.read_model_description(unpacked)
    references = {v.name: v.valueReference for v in description.modelVariables}
    library = f"{unpacked}/binaries/x86_64-linux/RotorBearingNative.so"
    arguments = [library, f"{unpacked}/resources/", description.instantiationToken]

    def run(is_early, *behind, before=()):
        rest = map(str, (is_early, STEP, STEPS, SPEED, RATE, references["disc[3].x"], *behind))
        command = [*before, program, *arguments, *rest]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    return run


@pytest.mark.parametrize("is_early", [0, 1])
def test_a_step_takes_no_memory_and_calls_no_system(quiet, is_early):
    """The kernel ends the process at the first call; the run rubs, and is that of Python."""
    done = quiet(is_early, "guard")
    assert done.returncode == 0
    calls, bits = done.stdout.splitlines()[-1].split()
    assert calls == "0"
    simulation = Simulation(rig(), choose("realtime", h=STEP), speed=SPEED)
    for i in range(STEPS):
        simulation.advance(i * STEP + STEP, SPEED + RATE * i)
    assert simulation.read("solver.residual") > 0
    assert bits == struct.pack(">d", simulation.read("disc[3].x")).hex()


@pytest.mark.skipif(not _traces(), reason="strace is not installed, or may not trace here")
def test_strace_sees_no_call_between_the_first_step_and_the_last(quiet, tmp_path):
    log = tmp_path / "log"
    done = quiet(1, before=(STRACE, "-f", "-o", log))
    assert done.returncode == 0, done.stderr
    lines = log.read_text().splitlines()
    begin, end = (
        next(i for i, line in enumerate(lines) if f'"{mark}' in line) for mark in ("begin", "end")
    )
    # but for a warning of the run, which is written to standard error
    assert [line for line in lines[begin + 1 : end] if "write(2," not in line] == []


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_description_declares_the_step(make, fmi):
    fmu = make(fmi=fmi, step=STEP)
    root, h = described(fmu, "solver.h")
    simulated = root.find("CoSimulation")
    assert simulated.get("fixedInternalStepSize") == (repr(STEP) if fmi == 3 else None)
    assert simulated.get("maxOutputDerivativeOrder") == "2"
    assert root.find("DefaultExperiment").get("stepSize") == repr(STEP)
    start = h.get("start") if fmi == 3 else h[0].get("start")
    assert float(start) == STEP
    assert validate_fmu(str(fmu)) == []


def test_other_fmus_declare_no_step(make):
    root, _ = described(make(fmi=3), "solver.h")
    assert root.find("CoSimulation").get("fixedInternalStepSize") is None


def test_the_fmu_steps_as_declared_and_a_host_may_change_it(fmu):
    options = {"stop_time": 0.01, "output_interval": 1e-3, "output": ["solver.steps"]}
    options["start_values"] = {"speed": 190.0}
    assert fmpy.simulate_fmu(str(fmu), **options)["solver.steps"][-1] == 100
    options["start_values"]["solver.h"] = 0.5 * STEP
    assert fmpy.simulate_fmu(str(fmu), **options)["solver.steps"][-1] == 200


def test_the_command_takes_the_step_with_its_unit(tmp_path):
    options = "--native", "--fmi", "3", "--platform", "here", "--realtime", "0.05ms"
    done = run_anew(ROTOR_FMU, "build", *options, "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    root, _ = described(tmp_path / "RotorBearingNative.fmu", "solver.h")
    assert root.find("CoSimulation").get("fixedInternalStepSize") == "5e-05"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--realtime", "50us"], "--realtime 50us: only with --native or --source"),
        (["--native", "--realtime", "2 s"], "--realtime 2 s: must be > 0 and at most 1 s"),
        (["--native", "--realtime", "0"], "--realtime 0: must be > 0 and at most 1 s"),
        (["--native", "--realtime", "fast"], "--realtime fast: must be"),
    ],
)
def test_a_step_that_cannot_be_is_one_sentence(tmp_path, options, said):
    done = run_anew(ROTOR_FMU, "build", *options, "--out", tmp_path)
    assert done.returncode == 2
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_an_impossible_step_of_the_interface_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"h = 2 s: must be"):
        build_native(tmp_path, machine_of(step=2.0))
    import rotor_fmu as rf

    with pytest.raises(InputError, match=r"step = 0.0001 s: only with is_native or is_source"):
        rf.build_fmu(rf.load(), tmp_path, step=STEP)
