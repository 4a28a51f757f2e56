"""The native FMU looks for growing whirls as the model in Python does: it keeps its steps short
enough to see them, or says what they hide, and names the one that took a machine apart."""

import re
import tomllib
from itertools import pairwise

import fmpy
import numpy as np
import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation, StepFailure
from rotor_fmu.model.stability import survey_block
from rotor_fmu.model.stability.eigenvalues import eigenvalues

from rotor_fmu.fmi.log import with_code
from rotor_fmu.machine_file.loading import machine_text

from ..fmu.instance import Machine, observed
from ..growing_whirls import found_last
from ..parts.test_linear_bearing import FLEXIBLE
from ..validation.whip import OVERHUNG

H = 0.004
PRESETS = ["robust", "paper", "paper-adaptive", "moderate", "controlled"]
# The overhung machine with a bearing that its parameters make: Black's coefficient of friction is
# passed or not.
CALM = {"bearing[1].mu": 0.02}
# Held by two bearings whose damping does not turn, while the shaft's does.
HELD = """
[[linear_bearing]]
node = 1
kxx = 1e6
kyy = 1e6
kxy = {across}
kyx = -{across}
cxx = 10.0
cyy = 10.0
[[linear_bearing]]
node = 3
kxx = 1e6
kyy = 1e6
cxx = 10.0
cyy = 10.0
"""
TURNING = FLEXIBLE.replace("[shaft]", "[shaft]\neta_v = 1e-3\nrotating_damping = true")


@pytest.fixture(scope="module")
def overhung(make):
    return make(toml=OVERHUNG.read_text(encoding="utf-8"))


def output(capfd):
    """What stands on standard error, without the instance's name."""
    return [line.partition(": ")[2] for line in capfd.readouterr().err.splitlines()]


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("values", [{}, CALM], ids=["whipping", "calm"])
def test_it_warns_of_hidden_whirls_and_steps_as_the_simulation_does(
    overhung, capfd, preset, values
):
    machine = Machine(overhung).start(
        {"solver.preset": PRESETS.index(preset)}, **values, speed=400.0
    )
    said = []
    rotor = parse_rotor(OVERHUNG.read_text(encoding="utf-8")).with_values(values)
    simulation = Simulation(rotor, choose(preset), speed=400.0, warn=said.append)
    for _ in range(25):
        machine.step(H)
        simulation.advance(machine.t, 400.0)
        assert (machine.read() == observed(simulation, machine.computed)).all()
    machine.close()
    assert output(capfd) == [f"warning: {with_code(text, text.code)}" for text in said]
    is_hidden = bool(said) and "hide an instability" in said[0]
    assert is_hidden == (preset != "controlled" and not values)


def test_it_names_the_whirl_that_took_the_machine_apart(overhung, capfd):
    machine = Machine(overhung)
    with pytest.raises(fmpy.fmi1.FMICallException):
        machine.start({"solver.preset": 0}, **{"solver.h": 1.2e-5}, speed=400.0).step(5.0)
    rotor = parse_rotor(OVERHUNG.read_text(encoding="utf-8"))
    with pytest.raises(StepFailure, match="diverged by an instability of the machine") as failure:
        Simulation(rotor, choose("robust", h=1.2e-5), speed=400.0).advance(5.0, 400.0)
    assert output(capfd) == [f"error: {failure.value}"]
    machine.close()


def test_it_warns_of_a_machine_that_is_unstable_at_rest(make, capfd):
    toml = FLEXIBLE + HELD.format(across=2e5)
    machine = Machine(make(toml=toml)).start(speed=300.0)
    said = []
    Simulation(parse_rotor(toml), speed=300.0, warn=said.append)
    assert any("unstable at rest" in text for text in said)
    assert output(capfd) == [f"warning: {with_code(text, text.code)}" for text in said]
    machine.close()


def test_a_speed_that_passes_the_surveyed_ones_is_looked_at_anew(make, capfd):
    """Internal damping makes a shaft whirl above its critical speed alone."""
    toml = TURNING + HELD.format(across=0.0)
    settings = {"solver.preset": 0}, {"solver.h": 0.01}
    machine = Machine(make(toml=toml)).start(settings[0], speed=0.0, **settings[1])
    said = []
    simulation = Simulation(
        parse_rotor(toml), choose("robust", h=0.01), speed=0.0, warn=said.append
    )
    assert said == []
    for speed in (0.0, 300.0, 1000.0, 3000.0):
        machine.set(speed=speed)
        machine.step(1e-4)
        simulation.advance(machine.t, speed)
    assert "with no contacts a forward whirl" in said[0]
    assert output(capfd) == [f"warning: {with_code(text, text.code)}" for text in said]
    machine.close()


def test_a_state_from_before_goes_on_with_the_steps_that_it_had(overhung):
    """The bound on the step is the state's, whatever the speed at which it is restored."""
    machine = Machine(overhung).start(speed=400.0)
    machine.step(H)
    machine.set(speed=100.0)
    machine.step(H)
    state = machine.fmu.getFMUstate()
    machine.step(H)
    expected = machine.read()
    other = Machine(overhung).start(speed=100.0)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(machine.fmu.serializeFMUstate(state)))
    other.t = machine.t - H
    other.step(H)
    assert (other.read() == expected).all()


def test_a_state_knows_by_which_contacts_the_machine_lay_at_rest(make):
    """Of a machine that lies in its touchdown bearings: at speeds not surveyed before, an instance
    that was never at this rest takes the steps of the one that was."""
    fmu = make(toml=machine_text("", example_folder("magnetic_bearing") / "compressor.toml"))

    def run_up(machine):
        for k in range(20):
            machine.set(speed=50.0 + 40.0 * k)
            machine.step(1e-3)
        return machine.read()

    machine = Machine(fmu).start(speed=50.0)
    machine.step(1e-3)
    state = machine.fmu.serializeFMUstate(machine.fmu.getFMUstate())
    expected = run_up(machine)
    other = Machine(fmu)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(state))
    other.t = 1e-3
    assert (run_up(other) == expected).all()


@pytest.mark.parametrize("modes", [2, 10])
def test_built_with_component_modes_it_runs_as_the_simulation_with_them(make, modes):
    machine = Machine(make(reduction=modes)).start(speed=300.0)
    simulation = Simulation(rig(), choose("controlled", reduction=modes), speed=300.0)
    for _ in range(10):
        machine.step(H)
        simulation.advance(machine.t, 300.0)
        assert (machine.read() == observed(simulation, machine.computed)).all()
    machine.close()


def test_component_modes_too_few_for_the_speed_are_said_as_the_simulation_says_them(make, capfd):
    machine = Machine(make(reduction=1)).start(speed=300.0)
    said = []
    simulation = Simulation(rig(), choose("controlled", reduction=1), speed=300.0, warn=said.append)
    for speed in (300.0, 750.0, 850.0):
        machine.set(speed=speed)
        machine.step(1e-4)
        simulation.advance(machine.t, speed)
    assert "solver.reduction = 1 is too coarse: mode 3 of the shaft" in said[0]
    assert output(capfd) == [f"warning: {with_code(text, text.code)}" for text in said]
    machine.close()


def test_another_number_of_modes_is_refused_in_one_sentence(fmu, capfd):
    machine = Machine(fmu)
    with pytest.raises(fmpy.fmi1.FMICallException):
        machine.start({"solver.reduction": 4}, speed=400.0)
    assert output(capfd) == [
        "error: solver.reduction = 4: this FMU has 0; build one with --reduction 4"
    ]
    machine.close()


@pytest.mark.parametrize("n", [1, 2, 3, 17, 72])
def test_the_eigenvalues_are_those_of_lapack(n):
    draw = np.random.default_rng(n)
    for _ in range(5):
        A = draw.normal(size=(n, n)) * 10.0 ** draw.integers(-3, 4, size=(n, 1))
        re, im = np.empty(n), np.empty(n)
        eigenvalues(A.copy(), re, im)
        expected = np.linalg.eigvals(A)
        distance = np.abs((re + 1j * im)[:, None] - expected)
        assert distance.min(axis=0).max() < 1e-12 * np.abs(expected).max()
        assert distance.min(axis=1).max() < 1e-12 * np.abs(expected).max()


def finer(toml, times):
    """A machine's text with so many elements for each, at whose first ones the parts stay."""
    shaft = tomllib.loads(toml)["shaft"]
    nodes = [
        a + (b - a) * i / times for a, b in pairwise(shaft["nodes"]) for i in range(times)
    ] + shaft["nodes"][-1:]
    diameters = [d for d in shaft["diameters"] for _ in range(times)]
    toml = re.sub(r"nodes = .*", f"nodes = {nodes}", toml)
    toml = re.sub(r"diameters = .*", f"diameters = {diameters}", toml)
    return re.sub(
        r"(?m)^node = (\d+)", lambda result: f"node = {(int(result[1]) - 1) * times + 1}", toml
    )


def test_a_long_shaft_is_surveyed_by_its_modes(make, monkeypatch):
    """Of 82 dofs the survey takes a basis; the roots are those of all dofs, the steps those of the
    native FMU."""
    toml = finer(OVERHUNG.read_text(encoding="utf-8"), 8)
    coarse = Simulation(parse_rotor(toml), speed=400.0)
    machine = Machine(make(toml=toml)).start(speed=400.0)
    for _ in range(3):
        machine.step(H)
        coarse.advance(machine.t, 400.0)
        assert (machine.read() == observed(coarse, machine.computed)).all()
    machine.close()
    monkeypatch.setattr(survey_block, "MOST_DOFS", 100)
    whole = Simulation(parse_rotor(toml), speed=400.0)
    bases = [simulation._run.survey.basis.shape[1] for simulation in (coarse, whole)]
    assert len(coarse.structure.static_load) == 82
    assert 0 < bases[0] < 30
    assert bases[1] == 0
    for few, all_of_them in zip(found_last(coarse), found_last(whole), strict=True):
        assert few.root == pytest.approx(all_of_them.root, rel=2e-4)
        assert few.is_backward == all_of_them.is_backward
