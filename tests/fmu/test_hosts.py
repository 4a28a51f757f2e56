"""Hosts, run for real: FMPy's command line and notebook, libcosim, CoFMPy.

docs/reference/hosts.md lists them.

A host with a master of its own couples the rotor with a motor and must give what the plain master
in coupled.py gives.
"""

import csv
import importlib.util
import json
import zipfile

import fmpy
import pytest

import rotor_fmu as rf

from ..processes import run_python
from .coupled import COUNTED, SEEN, STEPS, H, march

FMPY = "from fmpy.cli import main; main()"
PYTHONFMU = "from runpy import run_module; run_module('pythonfmu', run_name='__main__')"


def needs(module, install):
    """Skips where a host is not installed."""
    missing = importlib.util.find_spec(module) is None
    return pytest.mark.skipif(missing, reason=f"{module} is not installed: {install}")


def run(program, *arguments, cwd=None):
    done = run_python(program, *arguments, cwd=cwd)
    assert done.returncode == 0, f"exit {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done


@pytest.fixture(scope="session")
def motor(tmp_path_factory):
    folder = tmp_path_factory.mktemp("motor")
    script = __file__.replace("test_hosts.py", "motor.py")
    run(PYTHONFMU, "build", "-f", script, "-d", folder, "--handle-state")
    return folder / "Motor.fmu"


def test_fmpy_info_shows_what_it_is(fmu):
    shown = run(FMPY, "info", fmu).stdout
    for text in ("zigulic2003", "Stop Time          2.0", "speed", "rad/s", "bearing[2].psi"):
        assert text in shown


def test_fmpy_simulate_gives_what_its_api_gives(fmu, tmp_path):
    table = tmp_path / "out.csv"
    settings = ("--stop-time", "0.4", "--output-interval", "0.004", "--output-file", table)
    run(FMPY, "simulate", fmu, *settings, "--start-values", "speed", "300")
    result = fmpy.simulate_fmu(
        str(fmu), stop_time=0.4, output_interval=0.004, start_values={"speed": 300.0}
    )
    with table.open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == [*result.dtype.names]
    assert len(rows) == 102
    for name in ("time", "phi", "tau", "disc[3].x", "bearing[2].psi"):
        column = [float(row[rows[0].index(name)]) for row in rows[1:]]
        assert column == pytest.approx(result[name].tolist(), rel=1e-9), name


def test_fmpy_simulate_follows_a_file_and_names_a_start_value_that_is_none_if_it_validates(
    fmu, tmp_path
):
    (tmp_path / "in.csv").write_text("time,speed\n0,300\n0.02,310\n")
    call = ("simulate", fmu, "--stop-time", "0.02", "--output-interval", "0.01")
    files = ("--input-file", "in.csv", "--output-file", "out.csv")
    shown = ("--output-variables", "w", "solver.preset")
    values = ("--start-values", "solver.preset", "5", "bearing[1].my", "0.1")
    run(FMPY, *call, *files, *shown, *values, cwd=tmp_path)
    with (tmp_path / "out.csv").open() as file:
        rows = list(csv.DictReader(file))
    # held in the first interval, which has none before it, then continued
    assert [float(row["w"]) for row in rows] == [300.0, 300.0, 310.0]
    assert {row["solver.preset"] for row in rows} == {"5"}
    done = run_python(FMPY, *call, "--validate", *values)
    assert done.returncode != 0
    assert "could not be set: bearing[1].my" in done.stderr


@pytest.mark.slow
@needs("nbclient", "pip install nbclient ipykernel")
@needs("ipykernel", "pip install nbclient ipykernel")
@needs("plotly", "pip install plotly")
def test_the_notebook_that_fmpy_makes_runs_from_top_to_bottom(fmu, tmp_path):
    import nbformat
    from nbclient import NotebookClient

    (tmp_path / fmu.name).write_bytes(fmu.read_bytes())
    run(FMPY, "create-jupyter-notebook", fmu.name, cwd=tmp_path)
    notebook = nbformat.read(tmp_path / "RotorBearing.ipynb", as_version=4)
    folder = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, kernel_name="python3", resources=folder, timeout=1200).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.execution_count for cell in code)
    outputs = [output for cell in code for output in cell.outputs]
    assert not [output for output in outputs if output.output_type == "error"]
    (plot,) = (o.data["application/vnd.plotly.v1+json"] for o in outputs if "data" in o)
    assert {"phi", "tau", "disc[3].x"} <= {curve["name"] for curve in plot["data"]}


# --- libcosim ------------------------------------------------------------------------------------

OSP = f"""<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <BaseStepSize>{H}</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>
    <Simulator name="rotor" source="RotorBearing.fmu">
      <InitialValues>
        <InitialValue variable="speed"><Real value="150"/></InitialValue>
        <InitialValue variable="PARAMETER"><Real value="VALUE"/></InitialValue>
      </InitialValues>
    </Simulator>
    <Simulator name="motor" source="Motor.fmu"/>
  </Simulators>
  <Connections>
    <VariableConnection>
      <Variable simulator="motor" name="w"/>
      <Variable simulator="rotor" name="speed"/>
    </VariableConnection>
    <VariableConnection>
      <Variable simulator="rotor" name="tau"/>
      <Variable simulator="motor" name="tau"/>
    </VariableConnection>
  </Connections>
</OspSystemStructure>
"""
SSD = f"""<?xml version="1.0" encoding="UTF-8"?>
<ssd:SystemStructureDescription name="drive" version="1.0"
    xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"
    xmlns:osp="http://opensimulationplatform.com/SSP/OSPAnnotations">
  <ssd:System name="drive">
    <ssd:Elements>
      <ssd:Component name="rotor" source="resources/RotorBearing.fmu">
        <ssd:Connectors>
          <ssd:Connector name="speed" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="tau" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
        <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
          <ssv:ParameterSet version="1.0" name="start"><ssv:Parameters>
            <ssv:Parameter name="speed"><ssv:Real value="150"/></ssv:Parameter>
            <ssv:Parameter name="PARAMETER"><ssv:Real value="VALUE"/></ssv:Parameter>
          </ssv:Parameters></ssv:ParameterSet>
        </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
      </ssd:Component>
      <ssd:Component name="motor" source="resources/Motor.fmu">
        <ssd:Connectors>
          <ssd:Connector name="tau" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="w" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startElement="motor" startConnector="w" endElement="rotor"
        endConnector="speed"/>
      <ssd:Connection startElement="rotor" startConnector="tau" endElement="motor"
        endConnector="tau"/>
    </ssd:Connections>
  </ssd:System>
  <ssd:DefaultExperiment><ssd:Annotations><ssc:Annotation type="com.opensimulationplatform">
    <osp:Algorithm><osp:FixedStepAlgorithm baseStepSize="{H}"/></osp:Algorithm>
  </ssc:Annotation></ssd:Annotations></ssd:DefaultExperiment>
</ssd:SystemStructureDescription>
"""
LIBCOSIM = """
import json, sys
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
how, path, steps, names = json.loads(sys.argv[1])
execution = getattr(CosimExecution, how)(path)
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
rotor = execution.slave_index_from_instance_name("rotor")
refs = {v.name.decode(): v.reference for v in execution.slave_variables(rotor)}
rows = []
for _ in range(steps):
    if not execution.step():
        sys.exit("libcosim: a step failed")
    rows.append(observer.last_real_values(rotor, [refs[name] for name in names]))
with open("rows.json", "w") as file:
    json.dump(rows, file)
"""


def system(form, folder, fmu, motor, parameter="gravity", value=9.81):
    """Write a system file of either form; the constructor it takes and the file."""
    if form == "OSP":
        file = folder / "OspSystemStructure.xml"
        file.write_text(OSP.replace("PARAMETER", parameter).replace("VALUE", repr(value)))
        for part in (fmu, motor):
            (folder / part.name).write_bytes(part.read_bytes())
        return "from_osp_config_file", str(file)
    file = folder / "drive.ssp"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(
            "SystemStructure.ssd", SSD.replace("PARAMETER", parameter).replace("VALUE", repr(value))
        )
        for part in (fmu, motor):
            archive.write(part, f"resources/{part.name}")
    return "from_ssp_file", str(file)


@pytest.fixture(scope="module")
def begun(tmp_path_factory):
    """With the preset that libcosim, which leaves enumerations out, cannot set."""
    folder = tmp_path_factory.mktemp("begun")
    return rf.build_fmu(rf.load(), folder, parameters={"solver.preset": "paper"})


@needs("libcosimpy", "pip install libcosimpy")
@pytest.mark.parametrize("form", ["OSP", "SSP"])
def test_libcosim_gives_what_a_plain_master_gives(fmu, begun, motor, tmp_path, form):
    how = system(form, tmp_path, begun, motor)
    run(LIBCOSIM, json.dumps([*how, STEPS, SEEN]), cwd=tmp_path)
    seen = json.loads((tmp_path / "rows.json").read_text())
    preset = {"solver.preset": 1}
    expected = march(
        *(fmu, motor, ("rotor", "motor"), "jacobi"),
        steps=COUNTED,
        settings=preset,
        is_told_at_start=True,
    )
    assert seen == expected


@needs("libcosimpy", "pip install libcosimpy")
@pytest.mark.parametrize(
    ("parameter", "value", "reason"),
    [
        ("gravity", -1.0, "gravity = -1 m/s2: must be >= 0"),
        ("disc[1].e", 1.0, "the solution diverged"),
    ],
)
def test_libcosim_does_not_end_in_silence_when_the_rotor_fails(
    begun, motor, tmp_path, parameter, value, reason
):
    """At a step it says so to its caller; an initialization that is refused ends its process."""
    how = system("OSP", tmp_path, begun, motor, parameter, value)
    done = run_python(LIBCOSIM, json.dumps([*how, STEPS, SEEN]), cwd=tmp_path)
    assert done.returncode != 0
    assert not (tmp_path / "rows.json").exists()
    (said,) = (line for line in done.stderr.splitlines() if line.startswith("rotor: error: "))
    assert reason in said
    if value > 0:
        assert done.returncode == 1
        assert "libcosim: a step failed" in done.stderr


# --- CoFMPy --------------------------------------------------------------------------------------

COFMPY = """
import json, sys
from cofmupy import Coordinator
from cofmupy.wrappers import FmuXHandler
configs, steps, h, names = json.loads(sys.argv[1])
# CoFMPy 1.0.0 compares the FMUs' default steps, which are text in an FMPy newer than its own
FmuXHandler.default_step_size = property(lambda self: None, lambda self, value: None)
for name, config in configs.items():
    with open("system.json", "w") as file:
        json.dump(config, file)
    coordinator = Coordinator()
    coordinator.start("system.json")
    rows = []
    for _ in range(steps):
        coordinator.do_step(h)
        rows.append([coordinator.get_variable(("rotor", name))[0] for name in names])
    (order,) = coordinator.master.sequence_order
    with open(f"{name}.json", "w") as file:
        json.dump([list(order), rows], file)
"""
CHAIN = [
    {"source": {"id": "motor", "variable": "w"}, "target": {"id": "rotor", "variable": "speed"}},
    {"source": {"id": "rotor", "variable": "tau"}, "target": {"id": "motor", "variable": "tau"}},
]


WITH_COFMPY = needs(
    "cofmupy",
    "pip install --no-deps cofmupy==1.0.0 (it asks for an FMPy older than this project's)",
)


ALGORITHMS = {
    "Jacobi": ("jacobi", 1),
    "Gauss-Seidel": ("gauss_seidel", 1),
    "Jacobi, iterated with rollback": ("jacobi", 10),
    "Gauss-Seidel, iterated with rollback": ("gauss_seidel", 10),
}
FAILING = {"disc[1].e": 1.0}


@pytest.fixture(scope="module")
def cofmpys_results(fmu, motor, tmp_path_factory):
    """Every algorithm, and last a rotor that fails, in one process: its end, and the folder in
    which what the rotor shows is left in NAME.json."""
    folder = tmp_path_factory.mktemp("cofmpy")
    asked = [(name, *how, {}) for name, how in ALGORITHMS.items()]
    configs = {
        name: {
            "root": "",
            "cosim_method": algorithm,
            "iterative": iterations > 1,
            "fmus": [
                {"id": "rotor", "path": str(fmu), "initialization": {"speed": 150.0, **inputs}},
                {"id": "motor", "path": str(motor)},
            ],
            "connections": CHAIN,
        }
        for name, algorithm, iterations, inputs in (*asked, ("failing", "jacobi", 1, FAILING))
    }
    return run_python(COFMPY, json.dumps([configs, STEPS, H, SEEN]), cwd=folder), folder


@WITH_COFMPY
@pytest.mark.parametrize("name", ALGORITHMS)
def test_cofmpy_gives_what_a_plain_master_gives(fmu, motor, cofmpys_results, name):
    done, folder = cofmpys_results
    file = folder / f"{name}.json"
    assert file.exists(), done.stderr
    order, seen = json.loads(file.read_text())
    assert seen == march(fmu, motor, order, *ALGORITHMS[name])


@WITH_COFMPY
def test_cofmpy_does_not_end_in_silence_when_the_rotor_fails(cofmpys_results):
    done, folder = cofmpys_results
    assert done.returncode == 1
    assert not (folder / "failing.json").exists()
    assert "RotorBearing.fmu: error: t = " in done.stderr
