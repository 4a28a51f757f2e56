"""What hosts do with the native FMU: rightly, wrongly, often, and at the same time."""

import ctypes
import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from urllib.parse import quote

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.log import with_code

from ..fmu.instance import Machine
from ..fmu.masters import NEEDS_COMPILER
from ..fmu.skins import LOGGER
from ..parts.films import film
from ..parts.test_linear_bearing import FLEXIBLE, TABLE

H = 0.004
ERROR = 3
CO_SIMULATION = 1
FILM_TABLE = film(1, speed=[50.0, 400.0], viscosity=[0.05, 0.02]) + film(3)


@pytest.fixture(scope="module")
def folder(fmu, tmp_path_factory):
    """The FMU in a folder whose name is hard to spell in a URI."""
    return Path(fmpy.extract(str(fmu), str(tmp_path_factory.mktemp("a folder, 50% é #1"))))


class Library:
    """The C functions themselves."""

    def __init__(self, folder):
        self.c = ctypes.CDLL(str(folder / "binaries" / "linux64" / "RotorBearingNative.so"))
        self.c.fmi2Instantiate.restype = ctypes.c_void_p
        self.resources = f"file://{quote(str(folder))}/resources".encode()
        self.description = fmpy.read_model_description(str(folder))
        self.guid = self.description.guid.encode()

    def instantiate(self, kind=CO_SIMULATION, guid=None, resources=None, callbacks=None):
        m = self.c.fmi2Instantiate(
            b"rotor", kind, guid or self.guid, resources or self.resources, callbacks, 0, 1
        )
        return m and ctypes.c_void_p(m)

    def ready(self):
        m = self.instantiate()
        zero = ctypes.c_double(0.0)
        assert self.c.fmi2SetupExperiment(m, 0, zero, zero, 0, zero) == 0
        assert self.c.fmi2EnterInitializationMode(m) == 0
        assert self.c.fmi2ExitInitializationMode(m) == 0
        return m


@pytest.fixture(scope="module")
def library(folder):
    return Library(folder)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_description_is_valid(make, fmi):
    assert validate_fmu(str(make(fmi=fmi))) == []


def test_it_runs_from_a_folder_whose_name_is_escaped(library):
    m = library.instantiate()
    assert m
    library.c.fmi2FreeInstance(m)


def test_a_stranger_is_not_instantiated(library, tmp_path, capfd):
    (tmp_path / "machine.table").mkdir()
    for wrong, words in (
        ({"guid": b"{another}"}, "the GUID is not this FMU's"),
        ({"kind": 0}, "rotor: error: instantiate: the FMU is for co-simulation alone"),
        ({"resources": b"file:///nowhere"}, "/nowhere/machine.table: cannot be read"),
        ({"resources": b"file://%b" % bytes(tmp_path)}, "machine.table: cannot be read"),
        ({"resources": b"file:///" + 1000 * b"x"}, "xxx: cannot be read"),
    ):
        assert not library.instantiate(**wrong)
        assert words in capfd.readouterr().err


def test_a_table_that_is_damaged_is_refused(library, folder, tmp_path, capfd):
    table = (folder / "resources" / "machine.table").read_bytes()
    for damaged in (table[:-8], b"", table[:8] + b"x" * 16 + table[24:]):
        (tmp_path / "machine.table").write_bytes(damaged)
        assert not library.instantiate(resources=f"file://{tmp_path}".encode())
        assert "machine.table: " in capfd.readouterr().err


def test_null_is_refused_wherever_it_is_given(library):
    m, c = library.ready(), library.c
    vr = (ctypes.c_uint * 1)(0)
    size = ctypes.c_size_t(1)
    for call in (
        lambda: c.fmi2GetReal(None, vr, size, None),
        lambda: c.fmi2GetReal(m, None, size, None),
        lambda: c.fmi2SetReal(m, vr, size, None),
        lambda: c.fmi2DoStep(None, ctypes.c_double(0), ctypes.c_double(1), 1),
        lambda: c.fmi2GetFMUstate(m, None),
        lambda: c.fmi2SetFMUstate(m, None),
        lambda: c.fmi2SerializeFMUstate(m, None, None, size),
        lambda: c.fmi2DeSerializeFMUstate(m, None, size, None),
        lambda: c.fmi2SetRealInputDerivatives(m, vr, size, None, None),
        lambda: c.fmi2Terminate(None),
        lambda: c.fmi2Reset(None),
    ):
        assert call() == ERROR
    c.fmi2FreeInstance(None)
    c.fmi2FreeInstance(m)


@pytest.mark.parametrize("speed", [300.0, -300.0])
@pytest.mark.parametrize("table", [TABLE, FILM_TABLE], ids=["linear", "film"])
def test_a_speed_beyond_a_bearings_table_is_said_once_as_in_python(make, capfd, table, speed):
    fmu = make(toml=FLEXIBLE + table)
    machine = Machine(fmu).start(speed=speed)
    machine.step(1e-4)
    before = capfd.readouterr().err.splitlines()
    machine.set(speed=speed + math.copysign(200.0, speed))
    for _ in range(3):
        machine.step(1e-4)
    said = capfd.readouterr().err.splitlines()
    machine.close()
    expected = []
    simulation = Simulation(parse_rotor(FLEXIBLE + table), speed=speed, warn=expected.append)
    for i in range(1, 5):
        simulation.advance(1e-4 * i, speed if i == 1 else speed + math.copysign(200.0, speed))
    assert sum("lies outside its table" in text for text in expected) == 1
    assert [line.partition("warning: ")[2] for line in before + said] == [
        with_code(text, text.code) for text in expected
    ]


def test_with_its_derivative_a_ramp_of_the_speed_is_exact_at_any_step(fmu):
    """Over steps of 50 ms the angle is the integral; without the derivative the first is not."""
    rate, h = -100.0, 0.05
    angles = []
    for is_told in (True, False):
        machine = Machine(fmu).start(speed=300.0)
        for i in range(4):
            speed = 300.0 + rate * i * h
            machine.set(speed=speed)
            if is_told:
                machine.fmu.setRealInputDerivatives([machine.refs["speed"]], [1], [rate])
            machine.step(h)
        angles.append(machine.read(["phi"])[0])
        machine.close()
    exact = 300.0 * 4 * h + 0.5 * rate * (4 * h) ** 2
    assert angles[0] == pytest.approx(exact, rel=1e-14)
    assert angles[1] != pytest.approx(exact, rel=1e-4)


def test_messages_come_by_category_and_only_where_logging_is_on(fmu):
    received = []

    def listen(environment, name, status, category, message):
        received.append((status, category.decode(), message.decode()))

    folder = fmpy.extract(str(fmu))
    description = fmpy.read_model_description(folder)
    for is_on, categories, expected in (
        (False, None, []),
        (True, None, [ERROR]),
        (True, [b"logStatusWarning"], []),
        (True, [b"logStatusError"], [ERROR]),
        (False, [b"logStatusError"], [ERROR]),
    ):
        received.clear()
        machine = fmpy.instantiate_fmu(
            folder, description, "CoSimulation", logger=listen, debug_logging=is_on
        )
        if categories:
            names = (ctypes.c_char_p * len(categories))(*categories)
            machine.fmi2SetDebugLogging(machine.component, 1, len(categories), names)
        with pytest.raises(fmpy.fmi1.FMICallException):
            machine.doStep(0.0, H)
        assert [status for status, _, _ in received] == expected
        # which switches all of it off, whatever is named
        machine.fmi2SetDebugLogging(
            machine.component, 0, 1, (ctypes.c_char_p * 1)(b"logStatusWarning")
        )
        with pytest.raises(fmpy.fmi1.FMICallException):
            machine.doStep(0.0, H)
        assert [status for status, _, _ in received] == expected
        machine.freeInstance()


def test_a_category_that_is_unknown_is_named(library, capfd):
    m = library.instantiate()
    for names, words in (
        ((ctypes.c_char_p * 1)(b"logEvents"), "logEvents: no category has that name"),
        (None, "NULL: no category has that name"),
    ):
        assert library.c.fmi2SetDebugLogging(m, 1, ctypes.c_size_t(1), names) == ERROR
        assert words in capfd.readouterr().err
    library.c.fmi2FreeInstance(m)


def test_a_hash_reaches_the_hosts_logger_as_two_and_the_terminal_as_it_is(library, capfd):
    """In FMI's messages it stands before references to variables."""
    heard = []
    logger = LOGGER(lambda *logged: heard.append(logged[-1].decode()))
    callbacks = (ctypes.c_void_p * 5)(ctypes.cast(logger, ctypes.c_void_p).value)
    assert not library.instantiate(resources=b"file:///of%20job%20%2312", callbacks=callbacks)
    assert heard == ["/of job ##12/machine.table: cannot be read"]
    assert "error: /of job #12/machine.table: cannot be read\n" in capfd.readouterr().err
    names = (ctypes.c_char_p * 1)(b"#" * 900)
    m = library.instantiate(callbacks=callbacks)
    assert library.c.fmi2SetDebugLogging(m, 1, ctypes.c_size_t(1), names) == ERROR
    said = capfd.readouterr().err.partition("error: ")[2].rstrip()
    assert heard[-1] == said.replace("#", "##")
    library.c.fmi2FreeInstance(m)


def test_the_host_keeps_its_callbacks_no_longer_than_the_call(library):
    heard = []
    logger = LOGGER(lambda *logged: heard.append(logged[-1].decode()))
    callbacks = (ctypes.c_void_p * 5)(ctypes.cast(logger, ctypes.c_void_p).value)
    m = library.instantiate(callbacks=callbacks)
    callbacks[0] = None
    assert library.c.fmi2Terminate(m) == ERROR
    assert heard == ["terminate: the initialization has not begun"]
    library.c.fmi2FreeInstance(m)


def _run(machine):
    machine.start(speed=300.0)
    for _ in range(50):
        machine.step(H)
    return machine.read()


def test_a_hundred_instances_in_eight_threads_run_as_one_alone(fmu):
    folder = fmpy.extract(str(fmu))
    alone = _run(Machine(fmu, folder))
    machines = [Machine(fmu, folder) for _ in range(100)]
    with ThreadPoolExecutor(8) as threads:
        for values in threads.map(_run, machines):
            assert (values == alone).all()
    for machine in machines:
        machine.close()


@NEEDS_COMPILER
def test_a_c_host_without_any_environment_gets_the_numbers_that_fmpy_gets(c_host, fmu):
    calls = ["instantiate", "real speed 300", "setup 0", "enter", "exit"]
    for i in range(25):
        calls += [f"step {i * H!r} {H!r}", "get disc[3].x"]
    done = c_host.tell([*calls, "terminate", "free"])
    assert (done.status, done.stderr) == (0, "")
    machine = Machine(fmu).start(speed=300.0)
    expected = []
    for i in range(25):
        machine.t = i * H
        machine.step(H)
        expected.append(machine.read(["disc[3].x"])[0])
    assert [answer.value for answer in done.named("get")] == expected
    machine.close()


def test_it_loads_nothing_of_python(folder):
    """In a process whose Python cannot import this project or numba."""
    script = (
        "import ctypes, sys\n"
        f"c = ctypes.CDLL({str(folder / 'binaries/linux64/RotorBearingNative.so')!r})\n"
        "c.fmi2GetVersion.restype = ctypes.c_char_p\n"
        "print(c.fmi2GetVersion().decode(), 'numba' in sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["2.0", "False"]


def test_a_state_of_fmi_3_goes_on_bit_for_bit(make):
    machine = Machine(make(fmi=3)).start(speed=300.0)
    machine.step(H)
    state, t = machine.fmu.getFMUState(), machine.t
    data = machine.fmu.serializeFMUState(state)
    machine.step(H)
    first = machine.read()
    machine.fmu.setFMUState(machine.fmu.deserializeFMUState(data))
    machine.t = t
    machine.step(H)
    assert (machine.read() == first).all()
    assert np.isfinite(first).all()
    machine.close()


@pytest.mark.skipif(not Path("/proc/self/statm").is_file(), reason="needs Linux's /proc")
@pytest.mark.parametrize("count", [1000, pytest.param(10_000, marks=pytest.mark.slow)])
def test_instances_one_after_another_leave_no_memory_behind(library, count):
    # what is there now: a process's largest memory begins with that of its parent's
    def pages():
        return int(Path("/proc/self/statm").read_text().split()[1])

    def cycle(count):
        for _ in range(count):
            library.c.fmi2FreeInstance(library.ready())

    cycle(count // 10)
    before = pages()
    cycle(count)
    assert pages() - before < 256  # of 4 kB, where one instance has 70 kB


@pytest.mark.parametrize("value", [-1, 2])
def test_a_boolean_is_true_unless_it_is_0(library, value):
    """As languages have it whose true is -1."""
    refs = {v.name: v.valueReference for v in library.description.modelVariables}
    m = library.instantiate()
    vr = (ctypes.c_uint * 1)(refs["limit.contact"])
    given, read = (ctypes.c_int * 1)(value), (ctypes.c_int * 1)()
    one = ctypes.c_size_t(1)
    assert library.c.fmi2SetBoolean(m, vr, one, given) == 0
    assert library.c.fmi2GetBoolean(m, vr, one, read) == 0
    assert read[0] == 1
    library.c.fmi2FreeInstance(m)
