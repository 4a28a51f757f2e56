"""The native FMU of FMI 3.0 by its C functions: wrong calls, messages, terminals."""

import ctypes
import platform
import subprocess
import zipfile
from pathlib import Path

import fmpy
import pytest
from lxml import etree
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.fmi.packing.archive import contents_of

from ..fmu.masters import COMPILER, NEEDS_COMPILER
from .fmi3 import DISCARD, ERROR, ONE, ZERO, H, Library

# Those with nothing but the instance, and what is left of the standard where there is one variable.
NOT_OFFERED = (
    *("EnterEventMode", "EnterStepMode", "EnterConfigurationMode", "ExitConfigurationMode"),
    *("EnterContinuousTimeMode", "EvaluateDiscreteStates"),
)
NO_TYPES = (
    *("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "Int64", "UInt64", "String"),
    "Clock",
)


@pytest.fixture(scope="module")
def fmu(make):
    return make(fmi=3)


@pytest.fixture(scope="module")
def library(fmu, tmp_path_factory):
    folder = tmp_path_factory.mktemp("folder of FMI 3")
    fmpy.extract(str(fmu), str(folder))
    return Library(Path(folder))


def test_a_stranger_is_not_instantiated(library):
    assert not library.instantiate(token=b"{another}")
    assert "the GUID is not this FMU's" in library.heard[-1][2]
    assert not library.instantiate(resources=b"/nowhere/")
    assert "/nowhere/machine.table: cannot be read" in library.heard[-1][2]
    common = b"rotor", library.token, library.resources, False, True, None, library.log
    for kind, more in (("ModelExchange", ()), ("ScheduledExecution", (None, None, None))):
        assert not getattr(library.c, f"fmi3Instantiate{kind}")(*common, *more)
        assert library.heard.pop()[2] == "instantiate: the FMU is for co-simulation alone"


def test_what_an_experiment_cannot_be_is_said_of_the_call_of_fmi_3(library):
    m, nan = library.instantiate(), ctypes.c_double(float("nan"))
    enter = library.c.fmi3EnterInitializationMode
    for given, why in (
        ((False, ZERO, nan, False, ZERO), "start time = nan: must be finite"),
        ((False, ZERO, ZERO, True, nan), "stop time = nan s: must not lie before"),
        ((True, nan, ZERO, False, ZERO), "tolerance = nan: must be at least"),
    ):
        assert enter(m, *given) == ERROR
        assert library.heard[-1][2].startswith(f"enterInitializationMode: {why}")
    assert enter(m, False, ZERO, ZERO, True, ctypes.c_double(0.001)) == 0
    assert enter(m, False, ZERO, ZERO, False, ZERO) == ERROR
    assert library.heard[-1][2] == "enterInitializationMode: the initialization has begun"
    assert library.c.fmi3ExitInitializationMode(m) == 0
    assert library.step(m) == ERROR
    assert library.heard[-1][2] == "doStep to 0.004 s: past the stop time, 0.001 s"
    library.c.fmi3FreeInstance(m)


def test_calls_out_of_order_are_refused_with_a_sentence(library):
    m = library.instantiate()
    library.heard.clear()
    for call, why in (
        (lambda: library.step(m), "doStep: the initialization has not begun"),
        (lambda: library.c.fmi3ExitInitializationMode(m), "the initialization has not begun"),
        (lambda: library.c.fmi3Terminate(m), "the initialization has not begun"),
        (lambda: library.enter(m), None),
        (lambda: library.enter(m), "the initialization has begun"),
        (lambda: library.step(m), "the initialization has not ended"),
        (lambda: library.c.fmi3ExitInitializationMode(m), None),
        (lambda: library.enter(m), "the initialization has ended"),
        (lambda: library.step(m), None),
        (lambda: library.c.fmi3Terminate(m), None),
        (lambda: library.step(m), "the simulation was terminated"),
        (lambda: library.c.fmi3Reset(m), None),
        (lambda: library.step(m), "the initialization has not begun"),
    ):
        assert call() == (ERROR if why else 0)
        assert not why or why in library.heard[-1][2]
    library.c.fmi3FreeInstance(m)


def test_null_and_wrong_references_are_refused(library):
    m, c = library.ready(), library.c
    vr, value = (ctypes.c_uint32 * 1)(99999), (ctypes.c_double * 1)(1.0)
    for call in (
        lambda: c.fmi3GetFloat64(None, vr, ONE, value, ONE),
        lambda: c.fmi3GetFloat64(m, None, ONE, value, ONE),
        lambda: c.fmi3GetFloat64(m, vr, ONE, None, ONE),
        lambda: c.fmi3GetFloat64(m, vr, ONE, value, ONE),
        lambda: c.fmi3SetFloat64(m, vr, ONE, value, ONE),
        lambda: c.fmi3GetFMUState(m, None),
        lambda: c.fmi3SetFMUState(m, None),
        lambda: c.fmi3SerializeFMUState(m, None, None, ONE),
        lambda: c.fmi3DeserializeFMUState(m, None, ONE, None),
        lambda: c.fmi3Reset(None),
    ):
        assert call() == ERROR
    c.fmi3FreeInstance(None)
    c.fmi3FreeInstance(m)


def test_what_is_not_offered_is_refused_by_its_name(library):
    m = library.ready()
    for name in NOT_OFFERED:
        assert getattr(library.c, f"fmi3{name}")(m) == ERROR
        assert library.heard[-1][2] == f"{name}: is not offered"
    vr = (ctypes.c_uint32 * 1)(0)
    for name in NO_TYPES:
        for way in ("Get", "Set"):
            function = getattr(library.c, f"fmi3{way}{name}")
            assert function(m, vr, ONE, (ctypes.c_uint64 * 1)(), ONE) == ERROR
            assert "speed: is of type Float64" in library.heard[-1][2]
    library.c.fmi3FreeInstance(m)


def test_messages_come_by_category_and_only_where_logging_is_on(library):
    for is_logging, category, count in (
        (False, None, 0),
        (True, None, 1),
        (True, b"logStatusWarning", 0),
        (True, b"logStatusError", 1),
    ):
        m = library.ready(is_logging=is_logging)
        if category:
            # one by one, from all of them on
            library.c.fmi3SetDebugLogging(m, True, ctypes.c_size_t(0), None)
            for each in (b"logAll", b"logStatusError", b"logStatusWarning"):
                one = (ctypes.c_char_p * 1)(each)
                assert library.c.fmi3SetDebugLogging(m, False, ONE, one) == 0
            library.c.fmi3SetDebugLogging(m, False, ctypes.c_size_t(0), None)
            names = (ctypes.c_char_p * 1)(category)
            assert library.c.fmi3SetDebugLogging(m, True, ONE, names) == 0
        assert library.c.fmi3DoStep(m, ZERO, ZERO, True, None, None, None, None) == ERROR
        assert [entry[:2] for entry in library.heard] == [(ERROR, "logStatusError")] * count
        library.c.fmi3FreeInstance(m)


def test_a_category_that_is_switched_off_leaves_the_others_on(library):
    m = library.ready()
    for category, count in ((b"logStatusWarning", 1), (b"logStatusError", 1)):
        assert library.c.fmi3SetDebugLogging(m, False, ONE, (ctypes.c_char_p * 1)(category)) == 0
        assert library.c.fmi3DoStep(m, ZERO, ZERO, True, None, None, None, None) == ERROR
        assert len(library.heard) == count
    library.c.fmi3FreeInstance(m)


def test_who_wants_an_event_mode_is_refused(library):
    assert not library.instantiate(has_events=True)
    assert library.heard[-1][2] == "instantiate: the event mode is asked for, and there is none"


def test_a_variable_is_read_as_its_own_type_alone(library, fmu):
    """FMI 3.0 knows no other way, where masters of FMI 2.0 read every output as a Real."""
    m = library.ready()
    refs = {v.name: v.valueReference for v in fmpy.read_model_description(str(fmu)).modelVariables}
    for name, kind, call in (
        ("solver.preset", "Enumeration", "Int64"),
        ("solver.steps", "Int32", "Int32"),
        ("bearing[1].contact", "Boolean", "Boolean"),
    ):
        vr, value = (ctypes.c_uint32 * 1)(refs[name]), (ctypes.c_double * 1)()
        assert library.c.fmi3GetFloat64(m, vr, ONE, value, ONE) == ERROR
        assert library.heard[-1][2] == f"getFloat64: {name}: is of type {kind}"
        assert getattr(library.c, f"fmi3Get{call}")(m, vr, ONE, value, ONE) == 0
    library.c.fmi3FreeInstance(m)


def limited(library, fmu, **options):
    """An instance whose steps end after 60 iterations."""
    refs = {v.name: v.valueReference for v in fmpy.read_model_description(str(fmu)).modelVariables}
    m = library.instantiate(**options)
    vr = (ctypes.c_uint32 * 1)(refs["solver.max_iterations"])
    assert library.c.fmi3SetInt32(m, vr, ONE, (ctypes.c_int32 * 1)(60), ONE) == 0
    assert library.enter(m) == 0
    assert library.c.fmi3ExitInitializationMode(m) == 0
    return m, refs


def step(library, m, t, h):
    """Status, whether it returned early, and the time reached."""
    flags, reached = [ctypes.c_bool() for _ in range(3)], ctypes.c_double()
    status = library.c.fmi3DoStep(
        m, ctypes.c_double(t), ctypes.c_double(h), True, *map(ctypes.byref, flags),
        ctypes.byref(reached),
    )  # fmt: skip
    assert not flags[0].value
    assert not flags[1].value
    return status, flags[2].value, reached.value


def value_of(library, m, reference):
    value = (ctypes.c_double * 1)()
    assert library.c.fmi3GetFloat64(m, (ctypes.c_uint32 * 1)(reference), ONE, value, ONE) == 0
    return value[0]


def test_a_step_past_its_iterations_returns_early_where_that_is_allowed(library, fmu):
    m, refs = limited(library, fmu, may_return=True)
    t, returns = 0.0, 0
    while t < 0.02:
        status, is_early, reached = step(library, m, t, 0.02 - t)
        assert status == 0
        assert reached > t
        t, returns = reached, returns + is_early
    assert returns > 1
    assert value_of(library, m, refs["phi"]) == pytest.approx(400 * 0.02, rel=1e-9)
    library.c.fmi3FreeInstance(m)


def test_where_it_is_not_allowed_it_is_discarded_and_nothing_has_changed(library, fmu):
    m, refs = limited(library, fmu)
    before = value_of(library, m, refs["phi"])
    assert step(library, m, 0.0, 0.02) == (DISCARD, False, 0.0)
    assert library.heard[-1][:2] == (DISCARD, "logStatusDiscard")
    assert "stopped after 60 iterations (solver.max_iterations)" in library.heard[-1][2]
    assert value_of(library, m, refs["phi"]) == before
    for i in range(20):
        assert step(library, m, i * 5e-4, 5e-4)[0] == 0
    assert value_of(library, m, refs["phi"]) == pytest.approx(400 * 0.01, rel=1e-9)
    library.c.fmi3FreeInstance(m)


def test_the_description_says_what_outputs_depend_on_at_the_start(fmu):
    """CasADi stops where it is not said."""
    root = etree.fromstring(contents_of(fmu)["modelDescription.xml"])
    assert root.find("CoSimulation").get("mightReturnEarlyFromDoStep") == "true"
    given = {v.get("valueReference") for v in root.find("ModelVariables") if v.get("start")}
    unknowns = root.findall("ModelStructure/InitialUnknown")
    assert len(unknowns) == len(root.findall("ModelStructure/Output"))
    for unknown in unknowns:
        assert set(unknown.get("dependencies").split()) == given


def test_its_icon_is_there_and_its_terminals_are_of_variables(fmu):
    with zipfile.ZipFile(fmu) as archive:
        root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        assert archive.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")
    names = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables}
    members = {m.get("variableName") for m in root.iter("TerminalMemberVariable")}
    assert members
    assert members <= names


def test_a_state_made_of_bytes_is_written_wherever_the_host_points(library):
    """What the pointer held before, garbage or another state, is the host's."""
    m = library.ready()
    assert library.step(m) == 0
    state, size = ctypes.c_void_p(), ctypes.c_size_t()
    assert library.c.fmi3GetFMUState(m, ctypes.byref(state)) == 0
    assert library.c.fmi3SerializedFMUStateSize(m, state, ctypes.byref(size)) == 0
    content = (ctypes.c_uint8 * size.value)()
    assert library.c.fmi3SerializeFMUState(m, state, content, size) == 0
    copies = [ctypes.c_void_p(0xDEADBEEF), ctypes.c_void_p(state.value)]
    for copy in copies:
        assert library.c.fmi3DeserializeFMUState(m, content, size, ctypes.byref(copy)) == 0
        assert copy.value not in (0xDEADBEEF, state.value)
    for each in (*copies, state):
        assert library.c.fmi3SetFMUState(m, each) == 0
        assert library.c.fmi3FreeFMUState(m, ctypes.byref(each)) == 0
    library.c.fmi3FreeInstance(m)


def test_a_step_that_may_return_early_does_so_without_a_warning(library, make, capfd):
    folder = Path(fmpy.extract(str(make(fmi=3, toml=rig_toml() + "[start]\nx = 0.0\n"))))
    description = fmpy.read_model_description(str(folder))
    refs = {v.name: v.valueReference for v in description.modelVariables}
    dropped = Library(folder)
    vr, on = (ctypes.c_uint32 * 1)(refs["limit.contact"]), (ctypes.c_bool * 1)(True)
    early, reached = ctypes.c_bool(), ctypes.c_double()
    states = []
    for may_return in (True, False):
        m = dropped.instantiate(may_return=may_return)
        assert dropped.c.fmi3SetBoolean(m, vr, ONE, on, ONE) == 0
        assert dropped.enter(m) == 0
        assert dropped.c.fmi3ExitInitializationMode(m) == 0
        if states:  # of a host that allows it: this one does not
            assert dropped.c.fmi3SetFMUState(m, states[0]) == 0
        else:
            states.append(ctypes.c_void_p())
            assert dropped.c.fmi3GetFMUState(m, ctypes.byref(states[0])) == 0
        step = ctypes.c_double(0.5)
        arguments = (True, None, None, ctypes.byref(early), ctypes.byref(reached))
        assert dropped.c.fmi3DoStep(m, ZERO, step, *arguments) == 0
        assert early.value == may_return
        assert (reached.value < 0.5) == may_return
        assert {status for status, *_ in dropped.heard} == ({0} if may_return else set())
        dropped.heard.clear()
    assert "closed" not in capfd.readouterr().err


@NEEDS_COMPILER
@pytest.mark.skipif(platform.machine() != "x86_64", reason="sets the flags of x86-64")
def test_the_arithmetic_that_a_host_has_chosen_changes_no_bit_and_stays(fmu, tmp_path):
    """Rounding upwards, denormals as 0, traps: as hosts for real time and of Fortran have it."""
    source = tmp_path / "flags.c"
    source.write_text(
        "#include <xmmintrin.h>\n"
        "unsigned get(void) { return _mm_getcsr(); }\n"
        "void set(unsigned flags) { _mm_setcsr(flags); }\n"
    )
    subprocess.run([COMPILER, "-shared", "-fPIC", "-o", tmp_path / "f.so", source], check=True)
    flags = ctypes.CDLL(str(tmp_path / "f.so"))
    library = Library(Path(fmpy.extract(str(fmu))))
    results = []
    for chosen in (0x1F80, 0x1F80 | 0x8040 | 0x4000, 0x1D80):
        m = library.ready()
        for i in range(20):
            t = ctypes.c_double(4e-3 * i)
            flags.set(chosen)
            status = library.c.fmi3DoStep(m, t, H, True, None, None, None, None)
            left = flags.get()
            flags.set(0x1F80)
            assert status == 0
            assert left & ~0x3F == chosen
        state, size = ctypes.c_void_p(), ctypes.c_size_t()
        assert library.c.fmi3GetFMUState(m, ctypes.byref(state)) == 0
        assert library.c.fmi3SerializedFMUStateSize(m, state, ctypes.byref(size)) == 0
        content = (ctypes.c_uint8 * size.value)()
        assert library.c.fmi3SerializeFMUState(m, state, content, size) == 0
        results.append(bytes(content))
        library.c.fmi3FreeInstance(m)
    assert results[1] == results[0]
    assert results[2] == results[0]
    m, nan = library.instantiate(), ctypes.c_double(float("nan"))
    for given in ((True, nan, ZERO, False, ZERO), (False, ZERO, ZERO, True, nan)):
        flags.set(0x1F00)  # a NaN that is compared traps
        status = library.c.fmi3EnterInitializationMode(m, *given)
        flags.set(0x1F80)
        assert status == ERROR
    library.c.fmi3FreeInstance(m)
