"""Initial values of connections: an input begins with what its output has at the start."""

import re
import warnings

import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.model.simulation import RotorWarning

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import CoupledRun, coupled
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import InputError

from .test_members import HEAD, built

LINE = (
    HEAD
    + """
VARIABLES = (
    ("u", "input", "1", 7.0, None, "input"),
    ("k", "parameter", "1", 1.0, None, "slope"),
    ("c", "parameter", "1", 0.0, None, "value at 0"),
    ("y", "output", "1", None, None, "output"),
    BEGUN,
)
CONNECTIONS = INITIAL = ()
class Line(TableSlave):
    VARIABLES = VARIABLES
    def begin(self):
        self.y = self.c + self.k * self.u
    def step(self, t, h):
        self.begin()
"""
)


@pytest.fixture(scope="module")
def line(tmp_path_factory):
    return built(tmp_path_factory.mktemp("line"), "line.py", LINE)


def run_lines(line, pairs, parameters, initial=()):
    """Of lines by name, connected by their letters: `ab` is from a to b."""
    fmus = dict.fromkeys(parameters, line)
    connections, first = (
        [(f"{one}.y", f"{other}.u") for one, other in of] for of in (pairs, initial)
    )
    recorded = {name: ["u", "y"] for name in fmus}
    with coupled(fmus, connections, first, parameters, recorded, stop=0.2) as opened:
        return opened.run(0.1)


def test_a_rotor_begins_at_the_speed_of_its_drive_without_initial_pairs(native_fmu, tmp_path):
    """It began at its start value, 400 rad/s, was braked to 150 within the first step, and gave
    656 J back."""
    motor = Coupling(example_folder("drive_train") / "drive_train.py").build(tmp_path)
    fmus = {"motor": motor, "rotor": native_fmu}
    pairs = [("rotor.tau_load", "motor.tau_load"), ("motor.w", "rotor.speed")]
    given, seen = {"motor": {"w_start": 150.0, "w_target": 150.0}}, ["energy.drive_work", "w"]
    runs = []
    for initial in ((), [("motor.w_start", "rotor.speed")]):
        with coupled(fmus, pairs, initial, given, {"rotor": seen}, stop=0.01) as opened:
            runs.append(opened.run(0.002))
    for name in seen:
        assert (runs[0]["rotor"][name] == runs[1]["rotor"][name]).all(), name
    assert runs[0]["rotor"]["w"][0] == 150.0
    assert abs(runs[0]["rotor"]["energy.drive_work"]).max() < 0.1


@pytest.mark.parametrize("pairs", [("ab", "bc", "cd"), ("cd", "bc", "ab")])
def test_the_initial_values_of_a_chain_settle_in_whatever_order_it_is_given(line, pairs):
    slopes = {"a": {"k": 0.0, "c": 3.0}, "b": {"k": 2.0}, "c": {"k": -1.0}, "d": {"c": 1.0}}
    run = run_lines(line, pairs, slopes)
    assert [run[name]["y"].tolist() for name in "abcd"] == [[y] * 3 for y in (3.0, 6.0, -6.0, -5.0)]
    assert run.status == "ok"


def test_the_initial_values_of_a_loop_settle_where_it_weakens_what_goes_around(line):
    run = run_lines(line, ("ab", "ba"), {"a": {"k": 0.5, "c": 1.0}, "b": {"k": -0.8}})
    expected = 1.0 / (1.0 + 0.5 * 0.8)  # y = 1 - 0.4 y
    assert run["a"]["y"] == pytest.approx([expected] * 3, rel=1e-8)
    assert run.status == "ok"
    growing = {"a": {"k": -2.0, "c": 1.0}, "b": {}}
    said = r"^a\.y, b\.u: the initial values do not settle, \S+ is the last; give b\.u one in param"
    with pytest.raises(InputError, match=said):
        run_lines(line, ("ab", "ba"), growing)
    growing["a"]["u"] = 1.0 / 3.0  # y = 1 - 2 y
    run = run_lines(line, ("ab", "ba"), growing)
    assert run["a"]["y"] == pytest.approx([1.0 / 3.0] * 3, rel=1e-12)
    assert run.status == "ok"


@pytest.mark.parametrize("is_pair", [False, True])
def test_an_input_that_is_given_another_value_keeps_it_and_its_jump_is_said(
    line, tmp_path, is_pair
):
    given = {"a": {"k": 0.0, "c": 3.0}, "b": {} if is_pair else {"u": 5.0}, "c": {"k": 0, "c": 5.0}}
    said = "b.u = 5 at the start, where a.y = 3: it jumps in the first step"
    with pytest.warns(RotorWarning, match=f"^{re.escape(said)}$"):
        run = run_lines(line, ("ab",), given, ("cb",) if is_pair else ())
    assert run["b"]["u"].tolist() == [5.0, 3.0, 3.0]
    assert (run.status, run.messages) == ("doubtful: start-jump", (said,))
    run.save(tmp_path / "run.npz")
    assert CoupledRun.load(tmp_path / "run.npz").messages == (said,)
    given["a"]["c"] = 5.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = run_lines(line, ("ab",), given, ("cb",) if is_pair else ())
    assert (run.status, run.messages) == ("ok", ())


@pytest.mark.parametrize("kind", ["fmu", "native_fmu"])
def test_values_that_are_replaced_before_the_start_are_not_warned_of(request, kind):
    """What a host reads in the initialization is of the values then, and no more is said; what it
    comes to later is."""
    given = {"speed": 30e3, "solver.adaptive": 1, "solver.tolerance": 1e-4}
    with Member(request.getfixturevalue(kind), given, []) as rotor:
        rotor.get(["tau_load"])
        rotor.set({"speed": 100.0, "solver.adaptive": 3})
        rotor.begin()
        rotor.step(0.0, 1e-3)
        assert rotor.messages == []
        rotor.set({"speed": 30e3})
        rotor.step(1e-3, 1e-3)
        assert "burst-speed" in [message.code for message in rotor.messages]
    with Member(request.getfixturevalue(kind), given, []) as rotor:
        rotor.get(["tau_load"])
        rotor.begin()
        assert [message.code for message in rotor.messages] == ["idle-setting", "burst-speed"]
