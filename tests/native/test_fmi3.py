"""The native FMU of FMI 3.0 by its C functions: wrong calls, messages, terminals."""

import ctypes
import zipfile
from pathlib import Path

import fmpy
import pytest
from lxml import etree

ERROR = 3
Log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
ZERO, H = ctypes.c_double(0.0), ctypes.c_double(0.004)
ONE = ctypes.c_size_t(1)
NOTHING = ctypes.c_void_p()
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


class Library:
    """The C functions, and what the FMU told its host."""

    def __init__(self, folder):
        file = folder / "binaries" / "x86_64-linux" / "RotorBearingNative.so"
        self.c = ctypes.CDLL(str(file))
        self.c.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
        self.resources = f"{folder}/resources/".encode()
        self.token = fmpy.read_model_description(str(folder)).guid.encode()
        self.heard = []
        self._log = Log(lambda _, status, category, text: self._hear(status, category, text))

    def _hear(self, status, category, text):
        self.heard.append((status, category.decode(), text.decode()))

    def instantiate(self, is_logging=True, token=None, resources=None):
        found = self.c.fmi3InstantiateCoSimulation(
            b"rotor",
            token or self.token,
            resources or self.resources,
            *(False, is_logging, False, False, None, ctypes.c_size_t(0), None, self._log, None),
        )
        return found and ctypes.c_void_p(found)

    def enter(self, m):
        return self.c.fmi3EnterInitializationMode(m, False, ZERO, ZERO, False, ZERO)

    def step(self, m):
        return self.c.fmi3DoStep(m, ZERO, H, True, None, None, None, None)

    def ready(self, **options):
        m = self.instantiate(**options)
        assert self.enter(m) == 0
        assert self.c.fmi3ExitInitializationMode(m) == 0
        self.heard.clear()
        return m


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
            library.c.fmi3SetDebugLogging(m, False, ctypes.c_size_t(0), None)
            names = (ctypes.c_char_p * 1)(category)
            assert library.c.fmi3SetDebugLogging(m, True, ONE, names) == 0
        assert library.c.fmi3DoStep(m, ZERO, ZERO, True, None, None, None, None) == ERROR
        assert [entry[:2] for entry in library.heard] == [(ERROR, "logStatusError")] * count
        library.c.fmi3FreeInstance(m)


def test_its_terminals_are_valid_and_its_icon_is_there(fmu):
    schema = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
    with zipfile.ZipFile(fmu) as archive:
        root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        assert archive.read("terminalsAndIcons/icon.png").startswith(b"\x89PNG")
    etree.XMLSchema(etree.parse(str(schema))).assertValid(root)
    assert root.get("fmiVersion") == "3.0"
    names = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables}
    members = {m.get("variableName") for m in root.iter("TerminalMemberVariable")}
    assert members
    assert members <= names
