"""The FMU's WebAssembly component: its place in the archive, interfaces, numbers and calls."""

import json
import re
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.library import component as making
from rotor_fmu.library.platforms import COMPONENT

from .wasm import Native, rows_of

wasmtime = pytest.importorskip("wasmtime", reason="wasmtime is not installed")
from .component import BINARY, JCO, NEEDED, NODE, Component, rows_through, table_of  # noqa: E402

TYPES = (
    *("float32", "float64", "int8", "int16", "int32", "int64"),
    *("uint8", "uint16", "uint32", "uint64", "boolean", "string", "binary", "clock"),
)


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    folder = tmp_path_factory.mktemp("component")
    return build_native(folder, machine_of(), fmi=3, platforms=["linux64", COMPONENT.name])


@pytest.fixture(scope="module")
def rig(fmu):
    return Component(fmu)


@pytest.fixture
def instance(rig):
    result = rig.instantiate()
    rig.heard.clear()
    yield result
    result.drop()


def run_down(rig):
    """A plan of half a second: the rotor rubs in its bearings, and there is a load."""
    described = [name for name in rig.references if name.startswith(("disc", "bearing", "phi"))]
    real = re.compile(r"phi|disc\[\d\]\.[xy]|bearing\[\d\]\.(fn|psi)")
    record = [rig.references[name] for name in described if real.fullmatch(name)]
    load = {"reference": rig.references["disc[3].fx"], "kind": "Real", "value": 20.0}
    preset = {"reference": rig.references["solver.preset"], "kind": "Integer", "value": 1}
    return {
        "values": [{"reference": 0, "kind": "Real", "value": 400.0}, load, preset],
        "drive": rig.references["speed"],
        "legs": [{"steps": 500, "step": 1e-3, "from": 400.0, "rate": -10.0}],
        "record": record,
    }


@NEEDED
def test_in_wasmtime_a_rub_has_the_native_librarys_bits(fmu, rig, instance):
    plan = run_down(rig)
    rows = rows_through(instance, plan)
    native = rows_of(Native(table_of(fmu)), plan)
    assert len(rows) == 501
    assert (native[:, 1:].std(axis=0) > 0).all()
    force = 1 + plan["record"].index(rig.references["bearing[1].fn"])
    assert native[:, force].max() > 0
    assert rows.tobytes() == native.tobytes()


@NEEDED
@pytest.mark.slow
def test_in_node_it_has_them_too(fmu, rig, tmp_path):
    plan = run_down(rig)
    (tmp_path / "plan.json").write_text(json.dumps(plan | {"token": rig.token}))
    (tmp_path / "package.json").write_text('{"type": "module"}')
    (tmp_path / "logger.js").write_text("export const logMessage = () => {};")
    with zipfile.ZipFile(fmu) as archive:
        (tmp_path / "component.wasm").write_bytes(archive.read(BINARY))
    command = [JCO, "transpile", "component.wasm", "-o", ".", "--map"]
    command.append("fmi:fmi3/callbacks=./logger.js")
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    script = Path(__file__).with_name("component_run.mjs")
    subprocess.run([NODE, script, tmp_path], check=True, capture_output=True)
    native = rows_of(Native(table_of(fmu)), plan)
    assert (tmp_path / "rows").read_bytes() == native.tobytes()


@NEEDED
@pytest.mark.slow
def test_another_machine_needs_no_tool_and_has_its_own_numbers(tmp_path, monkeypatch):
    """What a machine is lies in the component's memory, not in its code."""
    monkeypatch.setattr(making, "_tools", lambda: pytest.fail("the component is made again"))
    toml = (Path(__file__).parents[2] / "examples" / "drop" / "compressor.toml").read_text()
    fmu = build_native(tmp_path, machine_of(toml), fmi=3, platforms=[COMPONENT.name])
    machine = Component(fmu)
    described = fmpy.read_model_description(str(fmu)).modelVariables
    record = [
        v.valueReference for v in described if v.causality == "output" and v.type == "Float64"
    ]
    speed = described[0].start
    plan = {
        "values": [],
        "drive": machine.references["speed"],
        "legs": [{"steps": 200, "step": 1e-3, "from": float(speed), "rate": -10.0}],
        "record": record,
    }
    rows = rows_through(machine.instantiate(), plan)
    assert (rows[:, 1:].std(axis=0) > 0).any()
    assert rows.tobytes() == rows_of(Native(table_of(fmu)), plan).tobytes()


@NEEDED
def test_a_stranger_and_who_wants_events_get_no_instance(rig):
    for options, why in (
        ({"token": "{another}"}, "instantiate: the GUID is not this FMU's"),
        ({"has_events": True}, "instantiate: the event mode is asked for, and there is none"),
    ):
        rig.heard.clear()
        assert rig.instantiate(**options) is None
        assert rig.heard == [("rotor", "error", "logStatusError", why)]


@NEEDED
def test_messages_come_where_logging_is_on_and_by_category(rig):
    said = ("rotor", "error", "logStatusError", "doStep: the initialization has not begun")
    for is_logging, categories, heard in (
        (False, None, []),
        (True, None, [said]),
        (True, ["logStatusWarning"], []),
        (True, ["logStatusError"], [said]),
    ):
        instance = rig.instantiate(is_logging=is_logging)
        if categories:
            assert instance.call("set-debug-logging", False, []) == "ok"
            assert instance.call("set-debug-logging", True, categories) == "ok"
        rig.heard.clear()
        assert instance.call("do-step", 0.0, 1e-3, True) == "error"
        assert rig.heard == heard
        assert instance.call("set-debug-logging", True, ["nonsense"]) == "error"
        instance.drop()


@NEEDED
def test_a_state_leads_to_the_same_bits_and_a_damaged_one_is_refused(rig, instance):
    instance.start()
    outputs = run_down(rig)["record"]

    def go_on(begin=50):
        for i in range(begin, begin + 50):
            instance.call("set-float64", [rig.references["speed"]], [400.0 - 10.0 * i * 1e-3])
            assert instance.call("do-step", i * 1e-3, 1e-3, True) != "error"
        return instance.call("get-float64", outputs)

    before = go_on(0)
    state, after = instance.call("get-fmu-state"), go_on()
    assert after != before
    assert instance.call("set-fmu-state", state) == "ok"
    assert instance.call("get-float64", outputs) == before
    assert go_on() == after
    other = rig.instantiate()
    assert other.call("set-fmu-state", state) == "ok"
    assert other.call("get-float64", outputs) == before
    other.drop()
    damaged = bytearray(state)
    damaged[-1] ^= 1
    assert instance.call("set-fmu-state", bytes(damaged)) == "error"
    assert rig.heard[-1][-1] == "the FMU state is truncated or corrupted"
    assert instance.call("get-float64", outputs) == after


def limited(rig, **options):
    """An instance whose steps end after 60 iterations."""
    result = rig.instantiate(**options)
    limit = rig.references["solver.max_iterations"]
    assert result.call("set-int32", [limit], [60]) == "ok"
    assert result.call("get-int32", [limit]) == [60]
    return result.start()


@NEEDED
def test_a_step_returns_early_where_that_is_allowed(rig):
    instance = limited(rig, may_return=True)
    t, returns = 0.0, 0
    while t < 0.02:
        done = instance.call("do-step", t, 0.02 - t, True)
        assert not getattr(done, "event-handling-needed")
        assert not getattr(done, "terminate-simulation")
        reached, is_early = getattr(done, "last-successful-time"), getattr(done, "early-return")
        assert reached > t
        assert is_early == (reached < 0.02)
        t, returns = reached, returns + is_early
    assert returns > 1
    (angle,) = instance.call("get-float64", [rig.references["phi"]])
    assert angle == pytest.approx(400 * 0.02, rel=1e-9)
    instance.drop()


@NEEDED
def test_where_it_is_not_allowed_the_step_is_discarded_and_nothing_has_changed(rig):
    instance = limited(rig)
    outputs = run_down(rig)["record"]
    before = instance.call("get-float64", outputs)
    assert instance.call("do-step", 0.0, 0.02, True) == "discard"
    assert rig.heard[-1][1:3] == ("discard", "logStatusDiscard")
    assert instance.call("get-float64", outputs) == before
    assert instance.call("do-step", 0.0, 5e-4, True) not in ("error", "discard")
    instance.drop()


@NEEDED
def test_types_without_variables_are_refused_and_nothing_asked_for_is_nothing(rig, instance):
    instance.start()
    values = {"float64": [400.0], "boolean": [True], "clock": [True], "string": ["a"]}
    values |= {"binary": [b"a"], "float32": [1.0], "uint8": b"a"}
    for name in TYPES:
        rig.heard.clear()
        status = instance.call(f"set-{name}", [0], values.get(name, [1]))
        assert status == ("ok" if name == "float64" else "error"), name
        if name != "float64":
            assert instance.call(f"get-{name}", [0]) == "error"
            assert all(each[-1].endswith("speed: is of type Float64") for each in rig.heard)
            assert len(rig.heard) == 2
        assert not instance.call(f"get-{name}", [])
    contact = rig.references["bearing[1].contact"]
    assert instance.call("get-boolean", [contact, contact]) in ([False, False], [True, True])
    assert instance.call("get-float64", [99999]) == "error"
    assert "getFloat64: value reference 99999: there is none" in rig.heard[-1][-1]
    assert instance.call("set-float64", [0, 0], [1.0]) == "error"
    assert rig.heard[-1][-1] == "setFloat64: 1 values for 2 variables"


@NEEDED
@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        *((f"{way}-{mode}-mode", ()) for way in ("enter", "exit") for mode in ("configuration",)),
        *((f"enter-{mode}-mode", ()) for mode in ("event", "step")),
        ("evaluate-discrete-states", ()),
        ("update-discrete-states", ()),
        ("get-number-of-variable-dependencies", (1,)),
        ("get-variable-dependencies", (1,)),
        ("get-adjoint-derivative", ([1], [0], [1.0])),
        *((f"get-{of}-{as_}", ([1],)) for of in ("interval", "shift")
          for as_ in ("decimal", "fraction")),
        *((f"set-{of}-decimal", ([1], [1.0])) for of in ("interval", "shift")),
        *((f"set-{of}-fraction", ([1], [])) for of in ("interval", "shift")),
    ],
)  # fmt: skip
def test_what_is_not_offered_is_refused_by_its_name(rig, instance, name, arguments):
    assert instance.call(name, *arguments) == "error"
    called = "".join(word.capitalize() for word in name.split("-"))
    assert rig.heard[-1][-1] == f"{called}: is not offered"


@NEEDED
def test_derivatives_are_those_of_differences(rig, instance):
    sensitive = rig.references["solver.sensitivities"]
    assert instance.call("set-boolean", [sensitive], [True]) == "ok"
    instance.start()
    angle, x, load = (rig.references[name] for name in ("phi", "disc[3].x", "disc[3].fx"))
    instance.call("do-step", 0.0, 1e-3, True)
    speed, acceleration = instance.call("get-output-derivatives", [(angle, 1), (angle, 2)])
    assert speed == pytest.approx(400.0, rel=1e-9)
    assert acceleration == pytest.approx(0.0, abs=1e-6 * 400.0)
    state = instance.call("get-fmu-state")
    (slope,) = instance.call("get-output-derivatives", [(x, 1)])
    assert instance.call("get-output-derivatives", [(x, 3)]) == "error"

    def after(force):
        instance.call("set-fmu-state", state)
        instance.call("set-float64", [load], [force])
        instance.call("do-step", 1e-3, 1e-4, True)
        return instance.call("get-float64", [x])[0]

    step = 1.0
    difference = (after(step) - after(-step)) / (2 * step)
    after(0.0)
    (derivative,) = instance.call("get-directional-derivative", [x], [load], [1.0])
    assert derivative == pytest.approx(difference, rel=1e-2)
    assert instance.call("get-directional-derivative", [x], [load], []) == "error"
    assert np.isfinite(slope)


@NEEDED
def test_calls_take_no_memory_for_good(fmu):
    """A state is 15 kB: what is not given back would fill 3 MB in 100 calls."""
    bounded = Component(fmu, most_memory=3_000_000)
    instance = bounded.instantiate().start()
    for _ in range(150):
        state = instance.call("get-fmu-state")
        assert instance.call("set-fmu-state", state) == "ok"
    assert len(state) > 10_000
    for _ in range(100):
        bounded.instantiate().drop()
