"""The native FMU computes what the model in Python computes, bit for bit."""

from importlib.resources import files
from xml.etree.ElementTree import fromstring
from zipfile import ZipFile

import fmpy
import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.settings import METHODS, choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation, StepFailure

from rotor_fmu.fmi.log import with_code
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.runs.job import prepare
from rotor_fmu.runs.run_down import run_fmu

from ..fmu.instance import Machine, observed

H = 0.004
# A disc on linear supports and a stator without friction, which makes no whirl grow: other sizes of
# everything than the rig's.
OTHER = """
name = "on supports"
gravity = 9.81
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.1, 0.25, 0.4]
diameters = [0.012, 0.01, 0.012]
eta_v = 1e-5
mass_damping = 2.0
[[disc]]
node = 2
diameter = 0.1
width = 0.02
e = 20e-6
[[support]]
node = 1
stiffness = 1e6
damping = 50.0
[[support]]
node = 4
stiffness = 2e6
damping = 50.0
[[contact]]
node = 3
journal_radius = 6e-3
clearance = 40e-6
mu = 0.0
k = 1e7
[[unbalance]]
node = 3
amount = 1e-5
phase = 1.0
"""


def run_both(machine, simulation, speeds):
    """All Reals of both after every step, which has its speed at the beginning."""
    for speed in speeds:
        t = machine.t
        machine.set(speed=speed)
        machine.step(H)
        simulation.advance(t + H, speed)
        yield machine.read(), observed(simulation, machine.computed)


EXAMPLES = [
    files("rotor_fmu.examples") / folder / name
    for folder, name in (
        ("drop", "compressor.toml"),
        ("from_ross", "rubbing.toml"),
        ("jeffcott_rub", "jeffcott.toml"),
        ("magnetic_bearing", "compressor.toml"),
        ("newkirk", "rotor.toml"),
        ("paper_rig", "rig.toml"),
        ("studies", "whip.toml"),
    )
]


@pytest.mark.filterwarnings("ignore::rotor_fmu.model.simulation.RotorWarning")
@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: f"{file.parent.name}/{file.name}")
def test_every_example_runs_as_the_simulation_bit_for_bit(make, file):
    toml, rotor = load_rotor(file)
    machine = Machine(make(toml=toml)).start(speed=400.0)
    simulation = Simulation(rotor, speed=400.0)
    before = observed(simulation, machine.computed)
    for seen, expected in run_both(machine, simulation, [400 - 2 * i for i in range(30)]):
        assert (seen == expected).all()
    assert (expected != before).any()


STICKING = OTHER.replace("mu = 0.0", "mu = 0.2\nk_t = 1e7\nc_t = 50.0")


@pytest.mark.filterwarnings("ignore::rotor_fmu.model.simulation.RotorWarning")
@pytest.mark.parametrize(
    "toml", [rig_toml(), OTHER, STICKING], ids=["rig", "on supports", "sticking"]
)
def test_it_starts_and_runs_as_the_simulation_bit_for_bit(make, toml):
    machine = Machine(make(toml=toml)).start(speed=400.0)
    simulation = Simulation(parse_rotor(toml), speed=400.0)
    assert (machine.read() == observed(simulation, machine.computed)).all()
    for seen, expected in run_both(machine, simulation, [400 - 2 * i for i in range(60)]):
        assert (seen == expected).all()
    assert simulation.read("w") != 400.0


@pytest.mark.parametrize("preset", ["robust", "paper", "paper-adaptive", "moderate"])
def test_so_it_does_with_every_preset(fmu, preset):
    at = ["robust", "paper", "paper-adaptive", "moderate", "controlled"].index(preset)
    machine = Machine(fmu).start({"solver.preset": at}, speed=400.0)
    simulation = Simulation(rig(), choose(preset), speed=400.0)
    for seen, expected in run_both(machine, simulation, [400.0] * 20):
        assert (seen == expected).all()


RADAU = {"solver.method": 1 + list(METHODS).index("radau5")}


@pytest.mark.filterwarnings("ignore::rotor_fmu.model.simulation.RotorWarning")
@pytest.mark.parametrize(
    "file", [EXAMPLES[0], EXAMPLES[4], EXAMPLES[5]], ids=lambda file: file.name
)
def test_so_it_does_in_stages(make, file):
    toml, rotor = load_rotor(file)
    machine = Machine(make(toml=toml)).start(RADAU, speed=400.0)
    simulation = Simulation(rotor, choose(method="radau5"), speed=400.0)
    for seen, expected in run_both(machine, simulation, [400 - 2 * i for i in range(30)]):
        assert (seen == expected).all()
    assert simulation.read("solver.newton") > 0


def test_so_it_does_with_every_parameter_changed(fmu):
    """Slightly, all at once, the rest under loads and the damping that turns included."""
    rotor = rig()
    changed = {
        name: 1.01 * of.value + (of.value == 0) * 1e-4
        for name, of in rotor.parameters().items()
        if not of.quantity.is_switch
    }
    machine = Machine(fmu)
    machine.fmu.setBoolean([machine.refs["shaft.rotating_damping"]], [True])
    machine.start(speed=100.0, speed_rate=3.0, **changed, **{"disc[2].fy": -5.0})
    simulation = Simulation(
        rotor.with_values(changed | {"shaft.rotating_damping": True}),
        speed=100.0,
        rate=3.0,
        loads=np.array([0, -5j, 0, 0]),
    )
    assert (machine.read() == observed(simulation, machine.computed)).all()
    for _ in range(10):
        machine.step(H)
        simulation.advance(machine.t, 100.0, np.array([0, -5j, 0, 0]))
        assert (machine.read() == observed(simulation, machine.computed)).all()


@pytest.mark.parametrize(("choices", "settings"), [({}, {}), (RADAU, {"method": "radau5"})])
def test_so_it_does_driven_by_a_torque(make, choices, settings):
    machine = Machine(make(is_free=True)).start(choices, w_start=200.0, tau_drive=0.1)
    simulation = Simulation(rig(), choose(**settings), speed=200.0, drive_torque=0.1)
    for _ in range(20):
        machine.step(H)
        simulation.advance(machine.t, 0.1)
        assert (machine.read() == observed(simulation, machine.computed)).all()


@pytest.mark.parametrize(
    ("choices", "values"),
    [
        ({}, {"gravity": 1e12}),
        ({}, {"gravity": 1e5}),
        ({"solver.preset": 1}, {"bearing[1].mu": 1000.0}),
        ({"solver.preset": 1, "solver.method": 3}, {"solver.alpha_m": 0.08}),
    ],
)
def test_a_run_that_cannot_be_ends_with_the_same_sentence(fmu, capfd, choices, values):
    machine = Machine(fmu)
    with pytest.raises(fmpy.fmi1.FMICallException):
        machine.start(choices, **values, speed=400.0).step(2.0)
    settings = choose("paper" if choices else "controlled")
    if "solver.method" in choices:
        settings = choose("paper", method="wbz", alpha_m=0.08)
    rotor = rig().with_values({n: v for n, v in values.items() if "solver" not in n})
    warnings = []
    with pytest.raises((EquilibriumError, StepFailure)) as failure:
        Simulation(rotor, settings, speed=400.0, warn=warnings.append).advance(2.0, 400.0)
    output = [f"warning: {with_code(text, text.code)}" for text in warnings]
    printed = capfd.readouterr().err.splitlines()
    assert [line.partition(": ")[2] for line in printed] == [*output, f"error: {failure.value}"]


@pytest.mark.slow
def test_so_it_does_over_the_whole_run_down(fmu):
    machine = Machine(fmu).start(speed=400.0)
    simulation = Simulation(rig(), speed=400.0)
    for seen, expected in run_both(machine, simulation, [400 - 10 * H * i for i in range(10_000)]):
        assert (seen == expected).all()
    assert simulation.read("w") < 0.1


def test_both_versions_of_fmi_give_the_same_bits(make):
    machines = [Machine(make(fmi=fmi)).start(speed=300.0) for fmi in (2, 3)]
    for _ in range(20):
        for machine in machines:
            machine.step(H)
        one, other = (machine.read() for machine in machines)
        assert (one == other).all()


def test_of_both_versions_of_fmi_python_hears_the_same_warnings_and_failures(make):
    sets = ["solver.preset=paper", "solver.method=wbz", "solver.alpha_m=0.08"]
    job = prepare(None, None, sets, None, 1.0, 0.004)
    one, other = (run_fmu(make(fmi=fmi), job) for fmi in (2, 3))
    assert (other.status, other.messages) == (one.status, one.messages)
    assert "the solution diverged" in one.status
    assert len(one.messages) > 1


@pytest.mark.parametrize("is_free", [False, True])
def test_its_variables_are_those_of_the_fmu_in_python(make, tmp_path, is_free):
    described = [
        fromstring(ZipFile(fmu).read("modelDescription.xml"))
        for fmu in (make(is_free=is_free), build(tmp_path, machine_of(is_free=is_free)))
    ]
    one, other = (
        [(e.attrib, e[0].tag, _numbers(e[0].attrib)) for e in root.find("ModelVariables")]
        for root in described
    )
    assert one == other
    assert described[0].find("CoSimulation").get("needsExecutionTool") == "false"


def _numbers(attributes):
    """0, 0.0 and 0e0 are the same start."""
    start = attributes.get("start", "true")
    is_number = start not in ("true", "false")
    return attributes | ({"start": float(start)} if is_number else {})
