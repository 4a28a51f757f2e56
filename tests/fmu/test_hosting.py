"""What a host does to the FMU: many instances, failures, calls at the wrong time.

Everything that might crash runs in a process of its own, and a crash shows in its exit status.
"""

import subprocess
import sys

import pytest

PRELUDE = """
import sys, fmpy, shutil
path = sys.argv[1]
folder = fmpy.extract(path)
description = fmpy.read_model_description(folder)
refs = {v.name: v.valueReference for v in description.modelVariables}
log = []
def logger(environment, name, status, category, message):
    log.append((status, message.decode()))
def new():
    options = dict(fmi_type="CoSimulation", debug_logging=True, logger=logger)
    return fmpy.instantiate_fmu(folder, description, **options)
def start(instance, **values):
    instance.setupExperiment(startTime=0.0)
    for name, value in values.items():
        instance.setReal([refs[name.replace("__", ".")]], [value])
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    return instance
def fails(call, *arguments):
    try:
        call(*arguments)
    except fmpy.fmi1.FMICallException as error:
        assert error.status in (fmpy.fmi2.fmi2Error, fmpy.fmi2.fmi2Fatal), error.status
        return True
    return False
"""


def in_a_process(fmu, script):
    """Standard output of a script that ends well; fails on a crash or an error."""
    done = subprocess.run(
        [sys.executable, "-c", PRELUDE + script, str(fmu)],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done


def test_thirty_instances_one_after_another_in_one_process(fmu):
    in_a_process(
        fmu,
        """
for i in range(30):
    instance = start(new())
    instance.doStep(0.0, 0.01)
    assert abs(instance.getReal([refs["phi"]])[0] - 4.0) < 1e-12
    instance.terminate()
    instance.freeInstance()
""",
    )


def test_a_run_goes_on_after_its_extraction_folder_is_deleted(fmu):
    in_a_process(
        fmu,
        """
results = []
for i in range(3):
    folder = fmpy.extract(path)
    r = fmpy.simulate_fmu(folder, stop_time=0.2, output=["disc[3].x"])
    results.append(r["disc[3].x"].tolist())
    shutil.rmtree(folder)
assert results[0] == results[1] == results[2]
""",
    )


def test_two_builds_in_one_process_do_not_meet(fmu, tmp_path):
    from model.rotor_toml import rig_toml
    from rotor_fmu.bundle import build

    other = build(tmp_path, rig_toml().replace("diameter = 0.12", "diameter = 0.11"))
    in_a_process(
        fmu,
        f"""
def last(which):
    return fmpy.simulate_fmu(which, stop_time=0.2, output=["disc[3].y"])["disc[3].y"].tolist()
alone = last(path)
other = last({str(other)!r})
assert alone != other
assert last(path) == alone
""",
    )


def test_a_failing_run_does_not_end_in_silence(fmu):
    """`fmpy simulate` must not exit with 0 and a short result."""
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            "from fmpy.cli import main; main()",
            "--start-values",
            *("solver.preset", "1", "solver.method", "3", "solver.alpha_m", "0.08"),
            "--output-variables",
            "phi",
            "--",
            "simulate",
            str(fmu),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "diverged" in done.stderr
