"""What the native FMU offers to masters of coupled systems: derivatives of outputs, directional
derivatives, steps that end early, parameters that change, energies of a step; and the way back by
states after each of them."""

from xml.etree.ElementTree import fromstring

import fmpy
import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import CouplingOptions, Simulation

from rotor_fmu.fmi.packing.archive import contents_of

from ..fmu.instance import Machine
from ..fmu.skins import Discarded, Extracted, Native, Refused

H = 0.002
NAMES = ("disc[3].x", "disc[3].y", "phi", "w", "tau", "bearing[2].fn")


@pytest.fixture(scope="module")
def extracted(fmu):
    return Extracted(fmu)


class Host:
    """An instance with its variables by name."""

    def __init__(self, extracted, values):
        self.of, self.t = extracted, 0.0
        self.fmu = Native(extracted).put(values).initialize()

    def put(self, values):
        self.fmu.put(values)

    def get(self, *names):
        return self.fmu.get("Real", [self.of.refs[name] for name in names])

    def step(self, h=H):
        self.fmu.step(self.t, h)
        self.t += h


def test_output_derivatives_are_the_simulations(extracted, fmu):
    simulation = Simulation(rig(), choose(), speed=400.0)
    instance = Machine(fmu, str(extracted.folder))
    instance.start(speed=400.0)
    for i in range(5):
        instance.step(H)
        simulation.advance((i + 1) * H, 400.0)
    refs = [extracted.refs[name] for name in NAMES]
    at = [simulation.names.index(name) for name in NAMES]
    seen = simulation.derivatives()
    for order in (1, 2):
        values = instance.fmu.getRealOutputDerivatives(refs, [order] * len(refs))
        assert (np.array(values) == seen[order - 1, at]).all()
    with pytest.raises(fmpy.fmi1.FMICallException):
        instance.fmu.getRealOutputDerivatives(refs, [3] * len(refs))
    with pytest.raises(fmpy.fmi1.FMICallException):
        instance.fmu.getRealOutputDerivatives([extracted.refs["speed"]], [1])
    before = instance.read()
    instance.step(H)
    simulation.advance(6 * H, 400.0)
    assert (instance.read() != before).any()
    for name in NAMES:
        assert instance.read([name])[0] == simulation.read(name)
    instance.close()


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_description_says_so(make, fmi):
    root = fromstring(contents_of(make(fmi=fmi))["modelDescription.xml"])
    assert root.find("CoSimulation").get("maxOutputDerivativeOrder") == "2"
    variables = {v.get("name"): v for v in root.find("ModelVariables")}
    assert variables["bearing[1].clearance"].get("variability") == "tunable"
    assert variables["bearing[1].k"].get("variability") == "fixed"


def test_fmi_3_has_them_too(make):
    instance = Machine(make(fmi=3))
    instance.fmu.setBoolean([instance.refs["solver.sensitivities"]], [True])
    instance.start(speed=400.0)
    on = CouplingOptions(has_sensitivities=True)
    simulation = Simulation(rig(), choose(), speed=400.0, coupling=on)
    for i in range(3):
        instance.step(H)
        simulation.advance((i + 1) * H, 400.0)
    refs = [instance.refs[name] for name in NAMES]
    at = [simulation.names.index(name) for name in NAMES]
    values = instance.fmu.getOutputDerivatives(refs, [2] * len(refs))
    assert (np.array(values) == simulation.derivatives()[1, at]).all()
    known = [instance.refs[name] for name in ("speed", "disc[2].fy")]
    values = instance.fmu.getDirectionalDerivative(refs, known, [2.0, -3.0])
    expected = 2.0 * simulation.sensitivities(0) - 3.0 * simulation.sensitivities(4)
    assert (np.array(values) == expected[at]).all()
    instance.close()


def test_directional_derivatives_are_the_simulations_and_come_back_with_a_state(fmu, extracted):
    instance = Machine(fmu, str(extracted.folder))
    instance.fmu.setBoolean([extracted.refs["solver.sensitivities"]], [True])
    instance.start(speed=400.0)
    on = CouplingOptions(has_sensitivities=True)
    simulation = Simulation(rig(), choose(), speed=400.0, coupling=on)
    for i in range(4):
        instance.step(H)
        simulation.advance((i + 1) * H, 400.0)
    unknown = [extracted.refs[name] for name in NAMES]
    known = [extracted.refs[name] for name in ("speed", "disc[2].fy")]
    at = [simulation.names.index(name) for name in NAMES]
    expected = 2.0 * simulation.sensitivities(0)[at] - 3.0 * simulation.sensitivities(4)[at]

    def seen():
        return np.array(instance.fmu.getDirectionalDerivative(unknown, known, [2.0, -3.0]))

    assert (seen() == expected).all()
    assert instance.read(["disc[2].dx_dfx"]) == simulation.read("disc[2].dx_dfx") != 0.0
    state = instance.fmu.getFMUstate()
    there = instance.read()
    content = instance.fmu.serializeFMUstate(state)
    instance.step(H)
    after, after_seen = instance.read(), seen()
    instance.fmu.setFMUstate(state)
    instance.t -= H
    assert (instance.read() == there).all()
    assert (seen() == expected).all()
    instance.step(H)
    assert (instance.read() == after).all()
    assert (seen() == after_seen).all()
    other = Machine(fmu, str(extracted.folder)).start(speed=400.0)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(content))
    assert (other.read() == there).all()
    assert (
        np.array(other.fmu.getDirectionalDerivative(unknown, known, [2.0, -3.0])) == expected
    ).all()
    instance.close()
    other.close()


def test_before_the_first_step_a_torque_passes_straight_through(make):
    host = Host(Extracted(make(is_free=True)), {"solver.sensitivities": True})
    refs = [host.of.refs[name] for name in ("tau", "tau_load")]
    assert host.fmu.directional(refs, [host.of.refs["tau_drive"]], [1.0]) == [1.0, 1.0]
    names = ("dtau_ddrive", "dtau_load_ddrive")
    assert host.get(*names) == [1.0, 1.0]
    host.fmu.restore(host.fmu.state())
    assert host.get(*names) == [1.0, 1.0]


def test_without_being_asked_for_they_are_refused(extracted):
    host = Host(extracted, {})
    host.step()
    with pytest.raises(Refused, match=r"solver\.sensitivities: a fixed parameter"):
        host.put({"solver.sensitivities": True})


@pytest.mark.parametrize(
    ("known", "sentence"),
    [
        ("gravity", "gravity: is not an input"),
        (None, "value reference 99999: there is none; they go to"),
    ],
)
def test_sensitivities_to_what_is_no_input_are_refused_by_name(extracted, known, sentence):
    host = Host(extracted, {"solver.sensitivities": True})
    host.step()
    with pytest.raises(Refused, match=f"^getDirectionalDerivative: {sentence}"):
        host.fmu.directional([extracted.refs["w"]], [extracted.refs.get(known, 99999)], [1.0])


@pytest.mark.parametrize("name", ["limit.displacement", "limit.force"])
def test_a_limit_discards_a_step_at_the_last_successful_time(extracted, name):
    host = Host(extracted, {"speed": 200.0})
    largest = 0.0
    while host.t < 0.2:
        host.step()
        values = host.get(*(f"disc[{i}].{axis}" for i in (1, 2, 3) for axis in "xy"))
        moved = max(abs(complex(*values[i : i + 2])) for i in (0, 2, 4))
        force = max(host.get("bearing[1].fn", "bearing[2].fn"))
        largest = max(largest, moved if name == "limit.displacement" else force)
    host = Host(extracted, {"speed": 200.0, name: 0.6 * largest})
    start = host.fmu.state()
    with pytest.raises(Discarded, match=rf"the next step passes {name} = "):
        host.fmu.step(0.0, 0.2)
    reached = host.fmu.last_successful_time
    assert 0.0 < reached < 0.2
    read = host.get(*NAMES)
    host.fmu.step(reached, 1e-6)  # on from there: it is said once
    host.fmu.restore(start)
    with pytest.raises(Discarded):
        host.fmu.step(0.0, 0.2)
    assert host.fmu.last_successful_time == reached
    assert host.get(*NAMES) == read


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (
            {"limit.displacement": 1e-6},
            r"limit\.displacement = 1e-06 m: must be above .* m, the value at",
        ),
        ({"limit.force": 1e-3}, r"limit\.force = 0\.001 N: must be above .* N, the value at"),
        ({"limit.force": -1.0}, r"limit\.force = -1 N: must be >= 0"),
    ],
)
def test_an_impossible_limit_is_refused(extracted, values, sentence):
    fmu = Native(extracted).put(values)
    with pytest.raises(Refused, match=sentence):
        fmu.initialize()


def test_an_impedance_below_zero_is_refused(make):
    fmu = Native(Extracted(make(is_free=True))).put({"tau_impedance": -0.5})
    with pytest.raises(Refused, match=r"tau_impedance = -0\.5 N\.m\.s/rad: must be >= 0"):
        fmu.initialize()


DROPPED = rig_toml() + "[start]\nx = 0.0\ny = 0.0\n"


def test_fmi_3_returns_early_where_a_contact_closes(make):
    instance = Machine(make(fmi=3, toml=DROPPED))
    instance.close()
    instance.fmu = fmpy.fmi3.FMU3Slave(
        guid=instance.description.guid,
        unzipDirectory=instance.folder,
        modelIdentifier=instance.description.coSimulation.modelIdentifier,
        instanceName="early",
    )
    instance.fmu.instantiate(earlyReturnAllowed=True)
    instance.fmu.setBoolean([instance.refs["limit.contact"]], [True])
    instance.start(speed=50.0)
    start = instance.fmu.getFMUState()
    _, _, is_early, reached = instance.fmu.doStep(0.0, 1.0)
    assert is_early
    assert 0.0 < reached < 1.0
    forces = instance.read(["bearing[1].fn", "bearing[2].fn"])
    assert (forces > 0.0).any()
    there, closed = instance.read(), instance.fmu.getFMUState()
    _, _, is_early, later = instance.fmu.doStep(reached, 1.0 - reached)
    assert is_early
    assert later > reached
    after = instance.read()
    instance.fmu.setFMUState(start)
    assert instance.fmu.doStep(0.0, 1.0)[2:] == (True, reached)
    assert (instance.read() == there).all()
    instance.fmu.setFMUState(closed)
    assert instance.fmu.doStep(reached, 1.0 - reached)[2:] == (True, later)
    assert (instance.read() == after).all()
    instance.close()


def test_a_parameter_that_may_change_does_so_between_two_steps(extracted):
    host = Host(extracted, {"speed": 200.0, "solver.tolerance": 1e-6})
    for _ in range(20):
        host.step()
    state = host.fmu.state()
    before = dict(
        zip(("work", "residual"), host.get("energy.external_work", "energy.residual"), strict=True)
    )
    mean = {}
    for mu in (0.05, 0.2):
        host.fmu.restore(state)
        host.t = 20 * H
        host.put({"bearing[1].mu": mu, "bearing[2].mu": mu})
        torque = []
        for _ in range(50):
            host.step()
            torque += host.get("tau")
        mean[mu] = np.mean(torque)
    assert mean[0.2] > 2.0 * mean[0.05]
    # a smaller clearance compresses the contact, which the ledger counts
    host.fmu.restore(state)
    host.t = 20 * H
    host.put({"bearing[1].clearance": 48e-6})
    again = host.fmu.state()
    host.step()
    work, residual = host.get("energy.external_work", "energy.residual")
    assert work > before["work"]
    assert abs(residual - before["residual"]) < 0.05 * (work - before["work"])
    read = host.get(*NAMES)
    host.fmu.restore(again)
    host.fmu.step(20 * H, H)
    assert host.get(*NAMES) == read


def test_one_that_cannot_be_changes_nothing_of_all(extracted):
    host = Host(extracted, {"speed": 200.0})
    host.step()
    before = host.fmu.state()
    refs = [extracted.refs[f"bearing[{i}].clearance"] for i in (1, 2)]
    with pytest.raises(Refused, match=r"bearing\[2\]\.clearance = -1e-05 m: must be > 0"):
        host.fmu.set("Real", refs, [40e-6, -1e-5])
    assert host.fmu.state() == before
    with pytest.raises(Refused, match="a fixed parameter cannot be set"):
        host.put({"bearing[1].k": 1e7})


def test_a_run_tuned_at_its_start_is_that_of_the_machine_with_the_value(extracted):
    host, other = (
        Host(extracted, {"speed": 200.0}),
        Host(extracted, {"speed": 200.0, "disc[1].phase": 1.0}),
    )
    host.put({"disc[1].phase": 1.0})
    for _ in range(5):
        host.step()
        other.step()
    names = ("disc[1].x", "disc[1].y", "disc[3].x")
    assert host.get(*names) == pytest.approx(other.get(*names), rel=1e-4)
