"""Derivatives of inputs, by FMI 2.0's functions: every continuous input takes the first one."""

import math
from xml.etree.ElementTree import fromstring

import fmpy
import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.packing.archive import contents_of
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

from ..parts.machines import FLEXIBLE
from .skins import Extracted, Native, Refused

H = 0.01
PORTS = ("disc[1]", "disc[2]", "disc[3]", "coupling")


@pytest.fixture(scope="module")
def extracted(native_fmu):
    return Extracted(native_fmu)


@pytest.fixture
def new(extracted):
    """Makes instances, and gives references of variables."""

    def make(*names):
        fmu = Native(extracted)
        return fmu, *(extracted.refs[name] for name in names)

    return make


def test_a_step_with_them_is_the_simulations_bit_for_bit(new, extracted):
    fmu, speed, fx, fy = new("speed", "disc[2].fx", "disc[2].fy")
    fmu.initialize()
    simulation = Simulation(rig(), choose(), speed=400.0)
    rates = np.zeros(len(PORTS), dtype=complex)
    for i in range(20):
        loads = np.zeros(len(PORTS), dtype=complex)
        loads[1], rates[1] = complex(3.0 * i, -i), complex(300.0, -100.0 * i)
        fmu.set("Real", [speed, fx, fy], [400.0 - i, 3.0 * i, -float(i)])
        fmu.slopes([fx, speed, fy], [300.0, -100.0, -100.0 * i])
        fmu.step(i * H, H)
        simulation.advance(i * H + H, 400.0 - i, loads, rate=-100.0, load_rates=rates)
    for name in ("disc[3].x", "disc[3].y", "phi", "tau", "energy.external_work"):
        assert fmu.get("Real", [extracted.refs[name]]) == [simulation.read(name)], name


def test_they_hold_for_the_next_step_alone(new):
    """Afterwards the load stays and the speed goes on as its last two values say."""
    ends = []
    for is_told_again in (False, True):
        fmu, fx, seen = new("disc[2].fx", "disc[3].x")
        fmu.initialize()
        fmu.slopes([fx], [500.0])
        fmu.step(0.0, H)
        if is_told_again:
            fmu.slopes([fx], [0.0])
        fmu.step(H, H)
        ends.append(fmu.get("Real", [seen]))
    assert ends[0] == ends[1]


@pytest.mark.parametrize("phase", ["instantiated", "initializing", "stepping"])
def test_they_are_taken_before_the_first_step_too(new, phase):
    fmu, speed, phi = new("speed", "phi")
    if phase == "instantiated":
        fmu.slopes([speed], [-1000.0])
    fmu.setup()
    fmu.enter()
    if phase == "initializing":
        fmu.slopes([speed], [-1000.0])
    fmu.exit()
    if phase == "stepping":
        fmu.slopes([speed], [-1000.0])
    fmu.step(0.0, 0.1)
    assert fmu.get("Real", [phi])[0] == pytest.approx(400 * 0.1 - 500 * 0.1**2, rel=1e-12)


@pytest.mark.parametrize("is_read_before", [False, True])
def test_the_motion_at_the_start_has_them(new, is_read_before):
    fmu, speed, rate = new("speed", "a")
    fmu.setup()
    fmu.enter()
    if is_read_before:
        assert fmu.get("Real", [rate]) == [0.0]
    fmu.slopes([speed], [-1000.0])
    assert fmu.get("Real", [rate]) == [-1000.0]


def test_after_the_end_they_are_refused(new):
    fmu, speed = new("speed")
    fmu.initialize()
    fmu.terminate()
    with pytest.raises(Refused, match=r"setRealInputDerivatives: the simulation was terminated"):
        fmu.slopes([speed], [1.0])


@pytest.mark.parametrize(
    ("name", "order", "value", "sentence"),
    [
        ("disc[3].x", 1, 1.0, r"disc\[3\]\.x: is not an input"),
        ("gravity", 1, 1.0, "gravity: is not an input"),
        ("disc[1].fy", 2, 1.0, r"disc\[1\]\.fy: order 2: must be 1"),
        ("disc[1].fy", 0, 1.0, r"disc\[1\]\.fy: order 0: must be 1"),
        ("disc[1].fy", 1, math.nan, r"disc\[1\]\.fy = nan: must be a finite number"),
        ("disc[1].fy", 1, -1e31, r"disc\[1\]\.fy = -.*: must not exceed 1e\+30 in size"),
    ],
)
def test_of_several_all_are_taken_or_none(new, name, order, value, sentence):
    fmu, speed, other = new("speed", name)
    fmu.initialize()
    before = fmu.state()
    with pytest.raises(Refused, match=f"^setRealInputDerivatives: {sentence}"):
        fmu.slopes([speed, other], [-1000.0, value], [1, order])
    assert fmu.state() == before
    with pytest.raises(Refused, match="value reference 99999: there is none"):
        fmu.slopes([speed, 99999], [-1000.0, 1.0])
    assert fmu.state() == before


def test_a_state_holds_what_was_set_for_the_next_step(new):
    fmu, fx, seen = new("disc[2].fx", "disc[3].x")
    fmu.initialize()
    fmu.slopes([fx], [2e4])
    state = fmu.state()
    fmu.step(0.0, H)
    once = fmu.get("Real", [seen])
    other, *_ = new()
    other.restore(state)
    other.step(0.0, H)
    assert other.get("Real", [seen]) == once
    fmu.restore(state)
    fmu.slopes([fx], [0.0])
    fmu.step(0.0, H)
    assert fmu.get("Real", [seen]) != once


def can_interpolate(fmu):
    root = fromstring(contents_of(fmu)["modelDescription.xml"])
    return root.find("CoSimulation").get("canInterpolateInputs")


def test_the_description_says_who_takes_them(fmu, native_fmu, tmp_path):
    """The wrapper of pythonfmu refuses them before it asks the slave; FMI 3.0 has none."""
    assert can_interpolate(native_fmu) == "true"
    assert (
        can_interpolate(build_native(tmp_path, machine_of(is_free=True), platforms=["linux64"]))
        == "true"
    )
    assert can_interpolate(fmu) == "false"
    assert (
        can_interpolate(build_native(tmp_path, machine_of(), fmi=3, platforms=["linux64"])) is None
    )
    folder = fmpy.extract(str(fmu))
    described = fmpy.read_model_description(folder)
    instance = fmpy.instantiate_fmu(folder, described, "CoSimulation")
    with pytest.raises(fmpy.fmi1.FMICallException):
        instance.setRealInputDerivatives([0], [1], [1.0])
    instance.freeInstance()


@pytest.mark.parametrize("is_free", [False, True])
def test_a_base_and_a_torque_take_them_too(tmp_path, is_free):
    toml = FLEXIBLE + "[base]\n"
    fmu = build_native(tmp_path, machine_of(toml, is_free), platforms=["linux64"])
    extracted = Extracted(fmu)
    instance = Native(extracted)
    drive = "tau_drive" if is_free else "speed"
    names = (drive, "base.ax", "base.ay")
    refs = [extracted.refs[name] for name in names]
    if is_free:
        instance.set("Real", [extracted.refs["w_start"]], [100.0])
    instance.set("Real", refs[:1], [0.0 if is_free else 100.0])
    instance.initialize()
    options = {"drive_torque": 0.0} if is_free else {}
    rotor = parse_rotor(toml)
    simulation = Simulation(rotor, choose(), speed=100.0, **options)
    places = len(simulation.structure.load_dof)
    loads, rates = np.zeros(places, dtype=complex), np.zeros(places, dtype=complex)
    at = int(np.flatnonzero(simulation.structure.load_dof < 0)[0])
    loads[at], rates[at] = 0.0, 30.0 - 20.0j
    value, rate = (0.01, 0.5) if is_free else (100.0, -7.0)
    instance.set("Real", refs, [value, 0.0, 0.0])
    instance.slopes(refs, [rate, 30.0, -20.0])
    instance.step(0.0, H)
    simulation.advance(H, value, loads, rate=rate, load_rates=rates)
    for name in ("w", "phi", "energy.external_work", "energy.residual"):
        assert instance.get("Real", [extracted.refs[name]]) == [simulation.read(name)], name
    assert simulation.read("energy.external_work") != 0.0
