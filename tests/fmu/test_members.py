"""Several FMUs of both versions of FMI under one master, and their variables of all types."""

import re
import signal
import sys
import zipfile
from contextlib import suppress

import fmpy
import numpy as np
import pytest
from rotor_fmu.model.simulation import RotorWarning

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import CoupledRun, coupled
from rotor_fmu.cosimulation.member import EndedEarly, Member
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

from .test_coupling import SOURCE, changed

HEAD = SOURCE[: SOURCE.index("VARIABLES = (")]
WHEEL = (
    HEAD
    + """
VARIABLES = (
    ("J", "parameter", "kg.m2", 0.1, 1e-6, "inertia"),
    ("start", "parameter", "rad", 0.0, None, "angle at the start"),
    ("tau", "input", "N.m", 0.0, None, "torque"),
    ("phi", "output", "rad", None, None, "angle"),
    ("w", "output", "rad/s", None, None, "speed"),
    BEGUN,
)
CONNECTIONS = INITIAL = ()
class Wheel(TableSlave):
    VARIABLES = VARIABLES
    def begin(self):
        self.phi = self.start
    def step(self, t, h):
        self.phi += h * self.w
        self.w += h * self.tau / self.J
"""
)
SPRING = (
    HEAD
    + """
VARIABLES = (
    ("k", "parameter", "N.m/rad", 20.0, 0.0, "stiffness"),
    ("a", "input", "rad", 0.0, None, "angle of one end"),
    ("b", "input", "rad", 0.0, None, "angle of the other end"),
    ("tau_a", "output", "N.m", None, None, "torque on one end"),
    ("tau_b", "output", "N.m", None, None, "torque on the other end"),
    BEGUN,
)
CONNECTIONS = INITIAL = ()
class Spring(TableSlave):
    VARIABLES = VARIABLES
    def begin(self):
        pass
    def step(self, t, h):
        self.tau_b = self.k * (self.a - self.b)
        self.tau_a = -self.tau_b
"""
)


def built(folder, name, text):
    """The FMU of a source."""
    folder.mkdir(exist_ok=True)
    source = folder / name
    source.write_text(text)
    return Coupling(source).build(folder)


@pytest.fixture(scope="module")
def native_3(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmi3")
    return build_native(folder, machine_of(), fmi=3, platforms=["linux64"])


@pytest.fixture(scope="module")
def motor(tmp_path_factory):
    return built(tmp_path_factory.mktemp("motor"), "steady_motor.py", SOURCE)


def test_three_fmus_exchange_what_they_had_at_the_last_point(tmp_path):
    """Two wheels on a spring, as the three recurrences have it."""
    wheel, spring = built(tmp_path, "wheel.py", WHEEL), built(tmp_path, "spring.py", SPRING)
    pairs = [
        ("left.phi", "spring.a"),
        ("right.phi", "spring.b"),
        ("spring.tau_a", "left.tau"),
        ("spring.tau_b", "right.tau"),
    ]
    given = {"left": {"J": 0.2, "start": 0.01}, "spring": {"k": 30.0}}
    fmus = {"left": wheel, "spring": spring, "right": wheel}
    initial = [("left.J", "right.J"), ("right.J", "left.J")]  # the first of them is first
    with coupled(fmus, pairs, initial, given, {"left": ["w"]}, stop=0.5) as opened:
        run = opened.run(1e-2)
    phi, w, tau = np.array([0.01, 0.0]), np.zeros(2), np.zeros(2)
    for n in range(51):
        assert [run[fmu]["phi"][n] for fmu in ("left", "right")] == pytest.approx(phi, rel=1e-12)
        assert run["left"]["w"][n] == pytest.approx(w[0], rel=1e-12)
        force = 30.0 * (phi[0] - phi[1]) * np.array([-1.0, 1.0])
        phi, w, tau = phi + 1e-2 * w, w + 1e-2 * tau / 0.2, force
    assert abs(w[0]) > 0.01
    assert {fmu: sorted(run[fmu]) for fmu in fmus} == {
        "left": ["phi", "w"],
        "spring": ["tau_a", "tau_b"],
        "right": ["phi"],
    }


def test_a_rotor_is_the_same_in_both_versions_of_fmi_and_beside_others(motor, fmu, native_3):
    pairs = [("motor.w", "python.speed"), ("motor.w", "native.speed"), ("native.tau", "motor.tau")]
    initial = [("motor.w_start", "python.speed"), ("motor.w_start", "native.speed")]
    seen = ["disc[3].x", "energy.residual", "solver.steps", "bearing[1].fn"]
    rotors = {"python": fmu, "native": native_3}
    given = {name: {"solver.preset": 3, "solver.h": 1e-4} for name in rotors}
    fmus, recorded = {"motor": motor, **rotors}, dict.fromkeys(rotors, seen)
    with coupled(fmus, pairs, initial, given, recorded, stop=0.05) as opened:
        run = opened.run(1e-3)
    for name in seen:
        assert (run["python"][name] == run["native"][name]).all(), name
    assert run["native"]["solver.steps"][-1] > 50
    assert np.ptp(run["native"]["disc[3].x"]) > 0


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("solver.preset", 2.5, r"solver\.preset = 2\.5: must be one of 0 robust, 1 paper, 2 "),
        ("solver.preset", "robust", r"solver\.preset = 'robust': must be one of 0 robust, 1 paper"),
        ("solver.preset", float("nan"), r"solver\.preset = nan: must be one of 0 robust, 1 paper"),
        ("solver.preset", True, r"solver\.preset = True: must be one of 0 robust, 1 paper"),
        ("speed_continuation", 2, "speed_continuation = 2: must be one of 0 linear, 1 hold$"),
        (
            "solver.newton_limit",
            2.5,
            r"solver\.newton_limit = 2\.5: must be an integer of type Int",
        ),
        (
            "solver.max_iterations",
            2**31,
            r"solver\.max_iterations = 2\.14748e\+09: must be an integer",
        ),
        ("limit.contact", "yes", r"limit\.contact = 'yes': must be one of 0 false, 1 true$"),
        ("solver.tolerance", True, r"solver\.tolerance = True: must be a number$"),
    ],
)
def test_a_value_of_another_type_is_refused(fmu, native_3, version, name, value, expected):
    """`int` of it would be another value, and be set."""
    with pytest.raises(InputError, match=rf"\.fmu: {expected}"):
        Member(fmu if version == 2 else native_3, {name: value}, [])


@pytest.mark.parametrize("version", [2, 3])
def test_variables_of_all_types_are_set_and_read_as_numbers(fmu, native_3, version):
    given = {
        "limit.contact": True,
        "solver.method": np.array(2),
        "solver.newton_limit": 7,
        "gravity": 3.0,
    }
    with Member(fmu if version == 2 else native_3, given, []) as member:
        assert member.get(given) == {name: float(value) for name, value in given.items()}


def test_a_tunable_parameter_is_connected_and_so_is_an_integer_without_unit(motor, native_3):
    pairs = [("motor.begun", "rotor.bearing[1].mu"), ("rotor.solver.steps", "motor.tau")]
    recorded = {"rotor": ["bearing[1].mu"], "motor": ["tau"]}
    fmus = {"motor": motor, "rotor": native_3}
    with coupled(fmus, pairs, recorded=recorded, stop=3e-3) as opened, pytest.warns(RotorWarning):
        run = opened.run(1e-3)
    assert run["rotor"]["bearing[1].mu"].tolist() == [0.05, 1.0, 1.0, 1.0]
    assert run["motor"]["tau"].tolist() == [0.0, *run["rotor"]["solver.steps"][:-1]]
    assert run["rotor"]["solver.steps"][1] > 0


def test_an_fmu_that_cannot_be_coupled_is_refused(fmu, tmp_path, monkeypatch):
    other = tmp_path / "Other.fmu"
    with zipfile.ZipFile(fmu) as whole, zipfile.ZipFile(other, "w") as archive:
        text = whole.read("modelDescription.xml").decode()
        kind = '<ModelExchange modelIdentifier="a"/>'
        archive.writestr("modelDescription.xml", re.sub(r"<CoSimulation.*?/>", kind, text))
    with pytest.raises(InputError, match=r"Other\.fmu: must be an FMU for co-simulation$"):
        Member(other, {}, [])
    old = fmpy.read_model_description(str(fmu))
    old.fmiVersion = "1.0"
    monkeypatch.setattr(fmpy, "read_model_description", lambda name: old)
    expected = r"\.fmu: is of FMI 1\.0; must be of FMI 2\.0 or 3\.0$"
    with pytest.raises(InputError, match=expected):
        Member(fmu, {}, [])


def test_an_array_and_a_text_are_no_single_numbers(native_3, monkeypatch):
    with Member(native_3, {}, []) as member:
        variable = member.variable("w")
        monkeypatch.setattr(variable, "type", "String")
        with pytest.raises(InputError, match=r"\.fmu: w: is a String; must be a number$"):
            member.get(["w"])
        with pytest.raises(InputError, match=r"\.fmu: w = 3\.0: String; must be a text$"):
            member.set({"w": 3.0})
        monkeypatch.setattr(variable, "dimensions", [3])
        with pytest.raises(InputError, match=r"\.fmu: w: is an array; must be a single value$"):
            member.variable("w")


@pytest.mark.parametrize(
    ("kind", "least", "most"),
    [("Int8", -128, 127), ("UInt8", 0, 255), ("UInt16", 0, 65535), ("Int32", -(2**31), 2**31 - 1)],
)
def test_an_integer_of_fmi_3_is_within_its_type(native_3, monkeypatch, kind, least, most):
    """Another would wrap around: 300 would be set as 44."""
    member = Member(native_3, {}, [])
    monkeypatch.setattr(member.variable("solver.newton_limit"), "type", kind)
    for value in (least, most):
        assert member._typed("solver.newton_limit", value) == value
    for value in (least - 1, most + 1):
        with pytest.raises(InputError, match=rf": must be an integer of type {kind}$"):
            member._typed("solver.newton_limit", value)


def test_a_message_that_all_is_well_is_no_reason_for_a_failure(native_3, monkeypatch):
    def fails(t, h):
        member._log(None, 0, b"logAll", b"as it should be")
        raise fmpy.fmi1.FMICallException("fmi3DoStep", 3)

    with Member(native_3, {}, []) as member:
        monkeypatch.setattr(member._fmu, "doStep", fails)
        with pytest.raises(RunFailed, match="fmi3DoStep failed with status 3"):
            member.step(0.0, 1.0)


def test_an_fmu_that_discards_a_step_or_asks_to_end_the_simulation_has_not_failed(
    native_3, monkeypatch
):
    def discards(t, h):
        raise fmpy.fmi1.FMICallException("fmi3DoStep", 2)

    for step, reason in (
        (lambda t, h: (False, True, False, 0.5), r"asks to end the simulation at t = 0\.5 s$"),
        (discards, r"fmi3DoStep failed with status 2 \(discard\)\.$"),
    ):
        with Member(native_3, {}, []) as member:
            member.begin()
            monkeypatch.setattr(member._fmu, "doStep", step)
            with pytest.raises(EndedEarly, match=rf"\.fmu: {reason}"):
                member.step(0.0, 1.0)


def test_a_rotor_that_comes_upon_a_limit_ends_the_run_before_it(motor, native_fmu, native_3):
    """In both versions of FMI at the same point, with the reason, and terminated as any other."""

    def run_to(limit, rotor):
        fmus, pairs = {"motor": motor, "rotor": rotor}, [("motor.w", "rotor.speed")]
        initial, seen = [("motor.w_start", "rotor.speed")], {"rotor": ["disc[2].y"]}
        given = {"rotor": {"limit.displacement": limit}, "motor": {"w_start": 180.0, "rate": 0.0}}
        with coupled(fmus, pairs, initial, given, seen, stop=0.1) as opened:
            return opened.run(1e-3)

    free = run_to(0.0, native_fmu)
    limit = 0.98 * np.abs(free["rotor"]["disc[2].y"]).max()
    ended = [run_to(limit, rotor) for rotor in (native_fmu, native_3)]
    n = len(ended[0].t)
    assert (free.status, len(free.t)) == ("ok", 101)
    assert 2 < n < 101
    for run in ended:
        assert run.status.startswith("failed: rotor: RotorBearingNative.fmu: ")
        assert "limit.displacement" in run.status
        assert (run.t == free.t[:n]).all()
        assert (run["rotor"]["disc[2].y"] == free["rotor"]["disc[2].y"][:n]).all()
    assert np.abs(ended[0]["rotor"]["disc[2].y"]).max() <= limit


def test_each_fmu_is_told_the_end_and_the_tolerance_of_the_run(motor, fmu, native_3):
    pairs, rotors = [("motor.w", "python.speed")], {"python": fmu, "native": native_3}
    fmus, recorded = {"motor": motor, **rotors}, {name: ["solver.steps"] for name in rotors}
    steps = []
    for tolerance in (None, 1e-6):
        with coupled(fmus, pairs, recorded=recorded, stop=5e-3, tolerance=tolerance) as opened:
            run = opened.run(1e-3)
            for name in rotors:
                with pytest.raises(RunFailed, match=r"past the stop time, 0\.005 s"):
                    opened.members[name].step(5e-3, 1e-3)
        steps.append([run[name]["solver.steps"][-1] for name in rotors])
    assert min(steps[1]) > 2 * max(steps[0])


def test_a_name_that_no_fmu_has_is_refused_before_any_is_loaded(motor, native_3, monkeypatch):
    def loads(*arguments):
        raise AssertionError

    monkeypatch.setattr(Member, "_instantiate", loads)
    fmus, pairs = {"motor": motor, "rotor": native_3}, [("motor.w", "rotor.speed")]
    for given, expected in (
        ({"recorded": {"rotor": ["disc[3].q"]}}, r"Native\.fmu: disc\[3\]\.q: unknown name"),
        ({"recorded": {"motr": ["w"]}}, "^recorded: motr: unknown name; did you mean motor"),
        ({"parameters": {"motor": {"ratte": 1.0}}}, r"SteadyMotor\.fmu: ratte: unknown name"),
        ({"initial": [("motor.w", "rotor.q")]}, r"Native\.fmu: q: unknown name"),
        ({"tolerance": -1.0}, "^tolerance = -1: must be > 0 and finite$"),
    ):
        with pytest.raises(InputError, match=expected), coupled(fmus, pairs, stop=1.0, **given):
            pass


def test_a_run_that_is_through_terminates_its_fmus(fmu, tmp_path):
    mark = tmp_path / "terminated"
    end = f"    def terminate(self):\n        open({str(mark)!r}, 'x').close()\n"
    partner, search_path = built(tmp_path, "steady_motor.py", SOURCE + end), [*sys.path]
    with Member(partner, {}, []):
        pass
    with suppress(ZeroDivisionError), Member(partner, {}, []) as member:
        member.begin()
        1 / 0  # noqa: B018
    assert not mark.exists()  # the one had not begun, the other has failed
    assert sys.path == search_path
    with Member(partner, {}, []) as member:
        member.begin()
    assert mark.exists()


def test_ctrl_c_in_a_step_of_an_fmu_is_no_error_of_the_fmu(fmu, tmp_path):
    pressed = "self.work += 1\n        import signal; signal.raise_signal(signal.SIGINT)"
    coupling = Coupling(changed(tmp_path, "self.work += self.tau * self.w * h", pressed))
    partner, seen = coupling.build(tmp_path), []
    with pytest.raises(KeyboardInterrupt):
        coupling.run({"partner": partner, "rotor": fmu}, 0.1, 1e-3, progress=seen.append)
    assert seen == [0.0, 1e-3]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_run_is_saved_whole_or_not_at_all_with_names_of_any_kind(tmp_path, monkeypatch):
    run = CoupledRun(np.arange(2.0), {"rotor": {"disc [m] x": np.ones(2)}, "t": {"w": np.zeros(2)}})
    run.save(tmp_path / "run.npz")
    read = CoupledRun.load(tmp_path / "run.npz")
    assert (read.t == run.t).all()
    assert {fmu: [*read[fmu]] for fmu in read.values} == {"rotor": ["disc [m] x"], "t": ["w"]}
    before = (tmp_path / "run.npz").read_bytes()

    def fails(part, **columns):
        part.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed", fails)
    with pytest.raises(OSError, match="No space left"):
        run.save(tmp_path / "run.npz")
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [before]
