"""FMI's rules, on an instance of either skin: what a host may call when, and with what."""

import math
import re

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import PRESETS
from rotor_fmu.model.simulation import Simulation

from .rig_host import AT, TABLE, H
from .skins import Refused

# --- types and value references ----------------------------------------------------------------


@pytest.mark.parametrize("kind", ["Real", "Integer", "Boolean", "String"])
@pytest.mark.parametrize("reference", [9999, -1, 2**31])
def test_a_value_reference_that_is_not_there_is_refused(started, kind, reference):
    with pytest.raises(Refused, match=f"^get{kind}: value reference {reference % 2**32}: there"):
        started.fmu.get(kind, [AT["speed"]] * (kind == "Real") + [reference])
    with pytest.raises(Refused, match=f"^set{kind}: value reference {reference % 2**32}: there"):
        started.fmu.set(kind, [reference], [1])


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("speed", "Integer"),
        ("speed", "Boolean"),
        ("speed", "String"),
        ("solver.preset", "Real"),
        ("solver.preset", "Boolean"),
        ("shaft.rotating_damping", "Integer"),
        ("phi", "String"),
    ],
)
def test_a_variable_of_another_type_is_refused(new, name, kind):
    host = new()
    before = host.fmu.state()
    with pytest.raises(Refused, match=r"^set\w+: .*: is of type"):
        host.fmu.set(kind, [AT[name]], [0.9])
    assert host.fmu.state() == before
    if kind != "Real":
        with pytest.raises(Refused, match=r"^get\w+: .*: is of type"):
            host.fmu.get(kind, [AT[name]])


def test_every_number_can_be_read_as_a_real(started):
    """As CoFMPy reads all outputs."""
    for name in ("solver.preset", "solver.steps", "bearing[1].contact", "shaft.rotating_damping"):
        assert started.fmu.get("Real", [AT[name]]) == [started.get(name)]


def test_no_values_are_a_call_like_any_other(started):
    assert started.fmu.get("String", []) == []
    started.fmu.set("Real", [], [])


@pytest.mark.parametrize(
    "refused",
    [("phi", 1.0), ("gravity", 1.0), ("disc[1].fx", math.nan), ("disc[1].fx", -math.inf)],
)
def test_a_set_of_several_values_is_done_whole_or_not_at_all(started, refused):
    name, value = refused
    before = started.fmu.state()
    with pytest.raises(Refused, match=name.split("[")[0]):
        started.fmu.set("Real", [AT["speed"], AT[name]], [300.0, value])
    assert started.fmu.state() == before
    assert started.get("speed") == 400.0


# --- phases ------------------------------------------------------------------------------------


def test_without_setup_an_instance_starts_at_0_and_has_no_end(new):
    host = new().initialize().steps(0.0, 3)
    assert host.get("phi") == pytest.approx(3 * H * 400)


CALLS = {
    "setup": lambda fmu: fmu.setup(0.0, None, None),
    "enter": lambda fmu: fmu.enter(),
    "exit": lambda fmu: fmu.exit(),
    "terminate": lambda fmu: fmu.terminate(),
    "step": lambda fmu: fmu.step(0.0, H),
    "set input": lambda fmu: fmu.set("Real", [AT["speed"]], [400.0]),
    "set parameter": lambda fmu: fmu.set("Real", [AT["gravity"]], [9.81]),
    "get parameter": lambda fmu: fmu.get("Real", [AT["gravity"]]),
    "get output": lambda fmu: fmu.get("Real", [AT["phi"]]),
    "get state": lambda fmu: fmu.state(),
    "set state": lambda fmu: fmu.restore(fmu.state()),
}
# What FMI 2.0.4 allows in its states, section 4.2.4; settable values are readable everywhere.
ALLOWED = {
    "instantiated": "setup enter set-input set-parameter get-parameter get-state set-state",
    "initializing": "exit set-input set-parameter get-parameter get-output get-state set-state",
    "stepping": "terminate step set-input get-parameter get-output get-state set-state",
    "failed": "terminate get-parameter get-output get-state set-state",
    "terminated": "get-parameter get-output get-state set-state",
}


def in_phase(new, phase):
    """An instance in the phase named."""
    host = new("paper")
    if phase == "instantiated":
        return host
    if phase == "failed":
        host.set("bearing[1].mu", 1e6)
        host.set("speed", 300.0)
    host.fmu.enter()
    if phase == "initializing":
        return host
    host.fmu.exit()
    if phase == "failed":
        with pytest.raises(Refused):
            host.fmu.step(0.0, 2.0)
    elif phase == "terminated":
        host.fmu.terminate()
    return host


@pytest.mark.parametrize("phase", ALLOWED)
def test_the_calls_that_a_phase_allows_are_those_of_the_standard(new, phase):
    allowed = [name.replace("-", " ") for name in ALLOWED[phase].split()]
    for name, call in CALLS.items():
        fmu = in_phase(new, phase).fmu
        if name in allowed:
            call(fmu)
            continue
        before = fmu.state()
        with pytest.raises(Refused) as refused:
            call(fmu)
        assert len(str(refused.value).splitlines()) == 1
        assert fmu.state() == before


def test_a_state_from_before_the_end_brings_a_terminated_instance_back(started):
    state = started.fmu.state()
    once = started.steps(0.0, 3).get("disc[3].y")
    started.fmu.terminate()
    with pytest.raises(Refused, match="terminated; reset the FMU, or set a state from before"):
        started.fmu.step(3 * H, H)
    started.fmu.restore(state)
    assert started.steps(0.0, 3).get("disc[3].y") == once


# --- values ------------------------------------------------------------------------------------


def test_loads_of_the_initialization_are_there_at_the_start(new):
    """The torque of the start feels the acceleration that a load gives an eccentric disc."""
    host = new()
    host.fmu.enter()
    unloaded = host.get("tau")
    host.set("disc[2].fx", 5.0)
    host.set("disc[2].fy", -30.0)
    loads = np.array([0, 5.0 - 30.0j, 0, 0])
    assert host.get("tau") == Simulation(rig(), speed=400.0, loads=loads).read("tau")
    assert abs(host.get("tau") - unloaded) > 1e-4


@pytest.mark.parametrize("order", [1, -1])
def test_parameters_that_go_together_are_taken_together(new, order):
    host = new()
    for name, value in [("shaft.eta_h", 0.01), ("shaft.rotating_damping", True)][::order]:
        host.set(name, value)
    assert host.start().get("shaft.eta_h") == 0.01


def test_one_of_them_alone_is_refused_by_its_name_and_can_be_mended(new):
    host = new()
    host.set("shaft.eta_h", 0.01)
    host.fmu.enter()
    with pytest.raises(Refused, match=r"shaft\.eta_h = 0\.01: must be 0 unless"):
        host.fmu.exit()
    host.set("shaft.rotating_damping", True)
    host.fmu.exit()


@pytest.mark.parametrize(
    ("name", "value"), [("speed", 1e155), ("disc[1].fx", -1.1e30), ("gravity", 1e300)]
)
def test_a_number_whose_products_overflow_is_refused(new, name, value):
    host = new()
    host.fmu.enter()
    before = host.fmu.state()
    shown = re.escape(f"{name} = {value:.17g}: must not exceed 1e+30 in size")
    with pytest.raises(Refused, match=f"^{shown}$"):
        host.set(name, value)
    assert host.fmu.state() == before
    host.set(name, math.copysign(1e30, value))


@pytest.mark.parametrize("name", ["speed", "disc[1].fx"])
def test_all_that_is_computed_can_be_read_after_the_worst_failure(started, name):
    started.steps(0.0, 1)
    reals = [i for i, v in enumerate(TABLE) if v.is_observed and v.kind == "Real"]
    moved = started.get("disc[3].x")
    started.set(name, 1e30)
    with pytest.raises(Refused, match=r"diverged|did not converge"):
        started.fmu.step(H, 1e-6)
    assert started.get("disc[3].x") == moved
    assert np.isfinite(started.fmu.get("Real", reals)).all()


# --- settings of the solver --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("solver.tolerance", 5.0, r"^solver\.tolerance = 5: must be at least 1e-09 and at most 1$"),
        ("solver.tolerance", -1e-3, r"^solver\.tolerance = -0\.001: must be at least 1e-09 and"),
        ("solver.h_max", 5.0, r"^solver\.h_max = 5 s: must be > 0 and at most 1 s$"),
        ("solver.rho", 2.0, r"^solver\.rho = 2"),
        ("solver.alpha_f", 0.1, r"^solver\.alpha_f = 0\.1: not a parameter of chung-hulbert"),
    ],
)
def test_a_setting_that_cannot_be_is_refused_by_its_parameters_name(new, name, value, sentence):
    host = new()
    host.set(name, value)
    with pytest.raises(Refused, match=sentence):
        host.start()


@pytest.mark.parametrize("tolerance", [0.0, 5.0, math.nan])
def test_a_tolerance_of_the_experiment_that_cannot_be_is_refused_at_once(new, tolerance):
    with pytest.raises(Refused, match=r"setupExperiment: tolerance = .* at most 1"):
        new().fmu.setup(0.0, None, tolerance)


@pytest.mark.parametrize(
    ("preset", "name", "value", "mode"),
    [
        ("robust", "solver.tolerance", 1e-4, "fixed"),
        ("robust", "solver.h_min", 1e-4, "fixed"),
        ("paper-adaptive", "solver.tolerance", 1e-4, "adaptive"),
        ("paper-adaptive", "solver.atol", 1e-4, "adaptive with the norm increment"),
        ("controlled", "solver.eps_min", 0.1, "controlled"),
        ("controlled", "solver.norm", 2, "controlled"),
    ],
)
def test_a_setting_without_effect_is_said_once(new, preset, name, value, mode):
    host = new(preset)
    host.set(name, value)
    host.fmu.enter()
    for _ in range(2):  # the model is built anew each time
        host.set("gravity", 9.0)
        host.get("phi")
    assert host.warnings == []  # the values may yet be others
    host.fmu.exit()
    (warning,) = host.warnings
    assert warning.startswith(f"{name} = ")
    assert f"has no effect in the mode {mode}" in warning


@pytest.mark.parametrize("preset", PRESETS)
def test_all_start_values_set_change_nothing_and_are_not_spoken_of(new, preset):
    plain, host = new(preset), new(preset)
    for variable in TABLE:
        if variable.start is not None and variable.name != "solver.preset":
            host.set(variable.name, variable.start)
    for each in (plain, host):
        each.start(tolerance=1e-4).steps(0.0, 2, 0.02)
    assert host.get("disc[3].y") == plain.get("disc[3].y")
    assert host.fmu.heard == plain.fmu.heard
    assert not [text for _, text in host.fmu.heard if "no effect" in text]


def test_the_tolerance_of_a_host_counts_unless_the_fmu_has_its_own(new):
    def steps(own, tolerance):
        host = new()
        host.set("solver.tolerance", own)
        return host.start(tolerance=tolerance).steps(0.0, 2).get("solver.steps")

    assert steps(0.0, 1e-4) == steps(1e-4, 1e-2) == steps(1e-4, None) > steps(0.0, 1e-3)
