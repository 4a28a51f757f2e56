"""What a host does to the FMU: many instances, failures, calls at the wrong time.

Everything that might crash runs in a process of its own, and a crash shows in its exit status.
"""

import json
import subprocess
import sys
import zipfile
from types import SimpleNamespace

import fmpy
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.fmi.packing.archive import contents_of
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build, package_name

from ..processes import run_anew, run_python

PRELUDE = """
import json, sys, fmpy, shutil
path = sys.argv[1]
folder = fmpy.extract(path)
description = fmpy.read_model_description(folder)
refs = {v.name: v.valueReference for v in description.modelVariables}
log = []
def logger(environment, name, status, category, message):
    log.append((status, message.decode()))
def resident():  # kB, 0 where there is no /proc
    try:
        with open("/proc/self/statm") as file:
            return 4 * int(file.read().split()[1])
    except FileNotFoundError:
        return 0
def new():
    options = dict(fmi_type="CoSimulation", debug_logging=True, logger=logger)
    return fmpy.instantiate_fmu(folder, description, **options)
def start(instance, **values):
    instance.setupExperiment(startTime=0.0)
    for name, value in values.items():
        name = name.replace("__1__", "[1].").replace("__", ".")
        instance.setReal([refs[name]], [value])
    instance.enterInitializationMode()
    instance.exitInitializationMode()
    return instance
def show(**seen):
    print(json.dumps(seen), flush=True)
"""


def in_a_process(fmu, script, environment=None, seconds=1200, arguments=(), is_anew=False):
    """What a script shows at last by `show`, as an object; fails on a crash or an error. is_anew:
    in a process that has imported nothing, as one with an environment of its own is."""
    program = (PRELUDE + script, fmu, *arguments)
    if environment or is_anew:
        done = run_anew(*program, seconds=seconds, **(environment or {}))
    else:
        done = run_python(*program, seconds=seconds)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}\n{done.stderr}"
    return SimpleNamespace(**json.loads(done.stdout.splitlines()[-1]))


TRAJECTORY = """
STEPS, H = 20, 0.004
def begin(i):
    return start(new(), speed=100.0 + 3 * i, bearing__1__clearance=(40 + i % 20) * 1e-6)
def look(instance):
    return instance.getReal([refs[name] for name in ("phi", "tau", "disc[3].x", "disc[3].y")])
def run(instance, steps=STEPS):
    seen = []
    for k in range(steps):
        instance.doStep(k * H, H)
        seen.append(look(instance))
    return seen
"""


@pytest.mark.slow  # a few are stepped from threads below
def test_a_hundred_instances_each_give_the_result_they_give_alone(fmu):
    seen = in_a_process(
        fmu,
        TRAJECTORY
        + """
alone = {}
for i in range(0, 100, 4):
    instance = begin(i)
    alone[i] = run(instance)
    instance.terminate()
    instance.freeInstance()
before = resident()
together = [begin(i) for i in range(100)]
seen = [[] for _ in together]
for k in range(STEPS):
    for i, instance in enumerate(together):
        instance.doStep(k * H, H)
        seen[i].append(look(instance))
grown = resident() - before
for instance in together:
    instance.terminate()
    instance.freeInstance()
show(alone=alone, together=seen, grown=grown)
""",
    )
    assert len(seen.alone) == 25
    assert {i: seen.together[int(i)] for i in seen.alone} == seen.alone
    assert len({str(one) for one in seen.together}) == 100
    assert seen.grown < 100_000, "kB: a hundred took 23 MB"


def test_instances_stepped_from_several_threads_give_what_they_give_alone(fmu):
    seen = in_a_process(
        fmu,
        TRAJECTORY
        + """
from concurrent.futures import ThreadPoolExecutor
STEPS = 200
alone = [run(begin(i), STEPS) for i in range(8)]
instances = [begin(i) for i in range(8)]
with ThreadPoolExecutor(4) as pool:
    stepped = list(pool.map(lambda instance: run(instance, STEPS), instances))
    # made, initialized and stepped in a thread each
    made = list(pool.map(lambda i: run(begin(i), STEPS), range(8)))
show(alone=alone, stepped=stepped, made=made)
""",
    )
    assert len({str(one) for one in seen.alone}) == 8
    assert seen.stepped == seen.alone
    assert seen.made == seen.alone


def test_a_run_goes_on_after_its_extraction_folder_is_deleted(fmu):
    seen = in_a_process(
        fmu,
        """
results = []
for i in range(3):
    folder = fmpy.extract(path)
    r = fmpy.simulate_fmu(folder, stop_time=0.2, output=["disc[3].x"])
    results.append(r["disc[3].x"].tolist())
    shutil.rmtree(folder)
folder = fmpy.extract(path)
instance = start(new())
instance.doStep(0.0, 0.1)
first = instance.getReal([refs["disc[3].x"]])
shutil.rmtree(folder)
instance.reset()
start_again = instance.setupExperiment, instance.enterInitializationMode
for call in (*start_again, instance.exitInitializationMode):
    call()
instance.doStep(0.0, 0.1)
show(results=results, first=first, after=instance.getReal([refs["disc[3].x"]]))
""",
    )
    assert seen.results == [seen.results[0]] * 3
    assert len(seen.results[0]) > 1
    assert seen.after == seen.first


def test_two_rotors_in_one_process_do_not_meet(fmu, tmp_path):
    other = build(tmp_path, machine_of(rig_toml().replace("diameter = 0.12", "diameter = 0.11")))
    seen = in_a_process(
        fmu,
        f"""
def last(which):
    return fmpy.simulate_fmu(which, stop_time=0.2, output=["disc[3].y"])["disc[3].y"].tolist()
show(alone=last(path), other=last({str(other)!r}), again=last(path))
""",
    )
    assert seen.other != seen.alone
    assert seen.again == seen.alone


def test_two_versions_of_the_code_in_one_process_do_not_meet(fmu, tmp_path):
    newer = another_version(fmu, tmp_path / "newer.fmu")
    seen = in_a_process(
        fmu,
        f"""
def last(which):
    return fmpy.simulate_fmu(which, stop_time=0.05, output=["disc[3].y"])["disc[3].y"].tolist()
newer = {str(newer)!r}
show(seen=[last(path), last(newer), last(path), last(newer)])
""",
    ).seen
    first = seen[0]
    assert any(first)
    doubled = [2 * y for y in first]
    assert seen == [first, doubled, first, doubled]


def another_version(fmu, target):
    """A copy of the FMU whose code, under another name, gives all values doubled."""
    name = package_name()
    other = name[:-4] + "beef"
    assert other != name
    plain = "return room.values.tolist()"
    doubled = "return [2 * value for value in room.values]"
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as sink:
        for entry in source.namelist():
            data = source.read(entry)
            if entry.endswith("/slave.py"):
                assert data.count(plain.encode()) == 1
                data = data.replace(plain.encode(), doubled.encode())
            if entry.endswith("slavemodule.txt"):
                data = data.replace(name.encode(), other.encode())
            sink.writestr(entry.replace(name, other), data)
    return target


@pytest.fixture(scope="module")
def foreign(tmp_path_factory):
    """An FMU of somebody else's, which bundles a package `model` as well."""
    folder = tmp_path_factory.mktemp("foreign")
    package = folder / "model"
    package.mkdir()
    (package / "__init__.py").write_text("GAIN = 7.0\n")
    (package / "simulation.py").write_text("def reply(u):\n    return 7.0 * u\n")
    script = folder / "foreign.py"
    script.write_text(
        "from pythonfmu import Fmi2Causality, Fmi2Slave, Real\n"
        "from model import GAIN\n"
        "from model.simulation import reply\n"
        "class Foreign(Fmi2Slave):\n"
        "    def __init__(self, **kwargs):\n"
        "        super().__init__(**kwargs)\n"
        "        self.y = GAIN\n"
        "        self.register_variable(Real('y', causality=Fmi2Causality.output))\n"
        "    def do_step(self, t, h):\n"
        "        self.y = reply(t + h)\n"
        "        return True\n"
    )
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", script, "-d", folder, package]
    subprocess.run(command, check=True, cwd=folder, capture_output=True)
    return folder / "Foreign.fmu"


def test_an_fmu_that_is_built_where_another_has_run_is_the_same(fmu, tmp_path):
    """The copy of pythonfmu that an FMU leaves in its host holds no libraries, and is deleted."""
    seen = in_a_process(
        fmu,
        """
fmpy.simulate_fmu(path, stop_time=0.01)
wrapper = sys.modules["pythonfmu"].__file__
from pathlib import Path
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build
build(Path(sys.argv[2]), machine_of())
show(wrapper=wrapper)
""",
        arguments=[str(tmp_path)],
    )
    assert "resources" in seen.wrapper
    assert contents_of(tmp_path / fmu.name) == contents_of(fmu)


@pytest.mark.parametrize(
    "order", ["foreign first", pytest.param("foreign last", marks=pytest.mark.slow)]
)
def test_a_foreign_fmu_with_a_package_of_the_same_name_is_not_met(fmu, foreign, order):
    seen = in_a_process(
        fmu,
        f"""
def ours():
    return fmpy.simulate_fmu(path, stop_time=0.2, output=["disc[3].y"])["disc[3].y"].tolist()
def theirs():
    result = fmpy.simulate_fmu({str(foreign)!r}, stop_time=1.0, output_interval=0.5)
    return result["y"].tolist()
first, second = (theirs, ours) if {order!r} == "foreign first" else (ours, theirs)
show(seen=[first(), second(), theirs(), ours()])
# at exit the other FMU's wrapper frees its state twice, and may abort: not what is asked here
import os
os._exit(0)
""",
    ).seen
    expected = fmpy.simulate_fmu(str(fmu), stop_time=0.2, output=["disc[3].y"])[
        "disc[3].y"
    ].tolist()
    reply = [7.0, 3.5, 7.0]
    begun = [reply, expected] if order == "foreign first" else [expected, reply]
    assert seen == [*begun, reply, expected]


def test_a_failing_run_does_not_end_in_silence(fmu):
    """`fmpy simulate` must not exit with 0 and a short result."""
    start = ("solver.preset", "1", "solver.method", "3", "solver.alpha_m", "0.08")
    shown = ("--output-variables", "phi", "--", "simulate", fmu)
    done = run_python("from fmpy.cli import main; main()", "--start-values", *start, *shown)
    assert done.returncode != 0
    assert "diverged" in done.stderr
