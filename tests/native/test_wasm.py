"""The solver as WebAssembly gives the native library's numbers, bit for bit, for every example."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.library.build import library
from rotor_fmu.library.platforms import WASM
from rotor_fmu.live import live_page
from rotor_fmu.machine_file.loading import load_rotor

from .wasm import Native, Wasmtime, rows_of

NODE = shutil.which("node")
EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*/*.toml"))
MACHINES = [file for file in EXAMPLES if file.parent.name != "studies"]
SCRIPTS = Path(live_page.__file__).parent / "template"
# a run-down of half a second, what rubs changed
COURSE = {"course.from": 400.0, "course.to": 395.0, "course.rate": 10.0}


def run_in_node(machine, values, folder):
    """Rows, the plan and the reason of an early end, of the page's own scripts."""
    (folder / "data.json").write_text(json.dumps(live_page.page_data(machine)))
    (folder / "values.json").write_text(json.dumps(values))
    (folder / "wasm").write_bytes(library(WASM).read_bytes())
    (folder / "table").write_bytes(live_page.solver_table(machine))
    scripts = [SCRIPTS / name for name in ("solver.js", "plan.js")]
    command = [NODE, Path(__file__).with_name("page_run.mjs"), folder, *scripts]
    subprocess.run(command, check=True, capture_output=True, text=True)
    plan = json.loads((folder / "plan.json").read_text())
    data = (folder / "rows").read_bytes() if (folder / "rows").exists() else b""
    rows = np.frombuffer(data).reshape(-1, 1 + len(plan["record"]))
    return rows, plan, (folder / "end").read_text()


def changed(machine):
    """Values of the page's controls: a tenth less clearance and friction, a load."""
    values = dict(COURSE) | {"solver.tolerance": 1e-2, "shaft.rotating_damping": 0}
    for v in machine.table:
        if v.causality == "parameter" and v.name.endswith((".clearance", ".mu")):
            values[v.name] = 0.9 * v.start
    loads = [v.name for v in machine.table if v.causality == "input" and v.name != "speed"]
    return values | dict.fromkeys(loads[:1], 20.0)


@pytest.fixture(params=MACHINES, ids=lambda file: f"{file.parent.name}-{file.stem}")
def machine(request):
    return machine_of(load_rotor(request.param)[0])


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_v8_wasmtime_and_the_processor_agree_in_every_bit(machine, tmp_path):
    rows, plan, failure = run_in_node(machine, changed(machine), tmp_path)
    assert failure == ""
    assert len(rows) == plan["rows"] == 501
    table = live_page.solver_table(machine)
    native = rows_of(Native(table), plan)
    assert native.tobytes() == rows.tobytes()
    moved = native[:, 1:].std(axis=0)
    assert (moved > 0).any()
    pytest.importorskip("wasmtime", reason="wasmtime is not installed")
    assert rows_of(Wasmtime(table), plan).tobytes() == rows.tobytes()


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_what_the_machine_cannot_be_is_said_in_the_fmus_words(tmp_path):
    rows, _, failure = run_in_node(machine_of(), {"bearing[1].clearance": -1e-5}, tmp_path)
    assert len(rows) == 0
    assert failure == "bearing[1].clearance = -1e-05 m: must be > 0 and finite"


@pytest.mark.skipif(NODE is None, reason="node is not installed")
@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"course.rate": 0.0}, "rate of the speed: must be > 0"),
        ({"course.to": 400.0}, "the run takes no time"),
        ({"course.hold": -1.0}, "time at the last speed: must be >= 0"),
        ({"course.samples": 1.0}, "samples a turn: must be >= 4"),
        ({"course.rate": 1e-3}, "at most 400000 are drawn"),
    ],
)
def test_a_course_of_the_speed_that_cannot_be_is_refused(tmp_path, values, said):
    with pytest.raises(subprocess.CalledProcessError) as error:
        run_in_node(machine_of(), values, tmp_path)
    assert said in error.value.stderr


@pytest.mark.skipif(NODE is None, reason="node is not installed")
def test_a_run_at_rest_has_the_points_of_one_at_the_machines_own_speed(tmp_path):
    """No turn tells how fine: a fall into a bearing has none either."""
    at_rest = {"course.from": 0.0, "course.to": 0.0, "course.hold": 0.5}
    rows, plan, _ = run_in_node(machine_of(), at_rest, tmp_path)
    assert len(rows) == plan["rows"] == 501


def test_the_module_asks_its_host_for_little_and_is_small():
    """What it imports is what the page provides."""
    wasmtime = pytest.importorskip("wasmtime", reason="wasmtime is not installed")
    content = library(WASM).read_bytes()
    module = wasmtime.Module(wasmtime.Engine(), content)
    assert {each.module for each in module.imports} == {"page", "wasi_snapshot_preview1"}
    assert len(content) < 1_100_000
