"""What reaches an FMU from outside and is wrong: states of others, steps without end,
libraries with the same names. In a process of its own where it might crash."""

import ctypes
import math
import re
import subprocess
import tempfile
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.quantities import QuantityError

from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.runs.job import prepare
from rotor_fmu.runs.run_down import run_fmu

from ..processes import run_python
from .masters import COMPILER, NEEDS_COMPILER
from .skins import DISCARD, SKINS, Discarded, Extracted, Native, Refused

H = 0.02
FATAL = 4  # of FMI's statuses; what pythonfmu makes of every error


@pytest.fixture(params=SKINS)
def skin(request):
    return request.param


@pytest.fixture
def new(skin, extracted):
    """An instance of either skin that is not initialized, and references by name."""
    return SKINS[skin](extracted[skin]), extracted[skin].refs


# --- tolerances, and steps without end -----------------------------------------------------------


@pytest.mark.parametrize("tolerance", [1e-300, 1e-12])
def test_a_tolerance_below_the_floor_is_refused_as_a_parameter(new, tolerance):
    fmu, refs = new
    fmu.set("Real", [refs["solver.tolerance"]], [tolerance])
    with pytest.raises(Refused, match=r"solver\.tolerance = .*: must be at least 1e-09 and"):
        fmu.initialize()


def test_of_the_experiment_the_floor_is_taken_with_a_warning(new):
    fmu, _ = new
    fmu.initialize(tolerance=1e-300)
    (said,) = fmu.warnings
    assert said == "setupExperiment: tolerance = 1e-300: 1e-09 is taken, the least that can be held"


def limited(new, count=60):
    """An instance whose steps end after so many iterations."""
    fmu, refs = new
    fmu.set("Integer", [refs["solver.max_iterations"]], [count])
    return fmu.initialize(), refs


def test_a_step_past_its_iterations_is_discarded_where_the_state_is_kept(new, skin):
    """A master goes back to it, and on in shorter steps."""
    fmu, refs = limited(new)
    state = fmu.state()
    with pytest.raises(Discarded, match=r"stopped after 60 iterations \(solver.max_iterations\)"):
        fmu.step(0.0, 1.0)
    if skin == "native":
        assert 0.0 < fmu.last_successful_time < 1.0
    fmu.restore(state)
    for i in range(20):
        fmu.step(i * 5e-4, 5e-4)
    assert fmu.get("Real", [refs["phi"]])[0] == pytest.approx(400.0 * 0.01, rel=1e-9)


def test_where_it_is_not_kept_pythonfmus_discard_would_end_a_run_in_silence(extracted):
    fmu, _ = limited((SKINS["python"](extracted["python"]), extracted["python"].refs))
    fmu.state()
    fmu.step(0.0, 5e-4)  # the state kept before is not that of the next step
    with pytest.raises(Refused, match="stopped after 60 iterations"):
        fmu.step(5e-4, 1.0)


@pytest.mark.parametrize(("is_kept", "status"), [(True, DISCARD), (False, FATAL)])
def test_the_wrapper_makes_a_discard_of_it_and_of_an_error_its_fatal(extracted, is_kept, status):
    of = extracted["python"]
    fmu = FMU2Slave(
        guid=of.description.guid,
        unzipDirectory=str(of.folder),
        modelIdentifier=of.description.coSimulation.modelIdentifier,
        instanceName="wrapped",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.setInteger([of.refs["solver.max_iterations"]], [60])
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    state = fmu.getFMUState() if is_kept else None
    with pytest.raises(fmpy.fmi1.FMICallException) as failed:
        fmu.doStep(0.0, 1.0)
    assert failed.value.status == status
    if is_kept:
        fmu.setFMUState(state)
        fmu.freeFMUState(state)
        fmu.doStep(0.0, 5e-4)
        assert fmu.getReal([of.refs["phi"]])[0] == pytest.approx(400.0 * 5e-4, rel=1e-9)
    fmu.freeInstance()


def test_a_master_can_go_on_from_the_time_reached(extracted):
    fmu, refs = limited((Native(extracted["native"]), extracted["native"].refs))
    t, stops = 0.0, 0
    while t < H:
        try:
            fmu.step(t, H - t)
        except Discarded:
            assert fmu.last_successful_time > t
            t, stops = fmu.last_successful_time, stops + 1
        else:
            t = H
    assert stops > 1
    assert fmu.get("Real", [refs["phi"]])[0] == pytest.approx(400.0 * H, rel=1e-9)


def test_one_that_repeats_the_step_is_told_why_it_cannot(extracted):
    """As FMPy does, which then ends with an error and not with half of a result."""
    fmu, _ = limited((Native(extracted["native"]), extracted["native"].refs))
    with pytest.raises(Discarded):
        fmu.step(0.0, H)
    with pytest.raises(Refused, match=r"without gap or overlap; the last one ended early: t = "):
        fmu.step(0.0, H)


@pytest.mark.parametrize("kind", SKINS)
def test_fmpy_ends_with_an_error(kind, extracted):
    with pytest.raises(fmpy.fmi1.FMICallException):
        fmpy.simulate_fmu(
            str(extracted[kind].folder),
            stop_time=1.0,
            output_interval=0.1,
            start_values={"solver.max_iterations": 60},
        )


def test_its_date_is_the_hosts(extracted):
    fmu, _ = limited((Native(extracted["native"]), extracted["native"].refs))
    other = Native(extracted["native"])
    other.set("Integer", [extracted["native"].refs["solver.max_iterations"]], [60])
    other.initialize(start=1000.0)
    with pytest.raises(Discarded) as here:
        fmu.step(0.0, H)
    with pytest.raises(Discarded) as there:
        other.step(1000.0, H)
    assert str(there.value) == f"{here.value} (t from the start, 1000 s)"
    assert other.last_successful_time == pytest.approx(1000 + fmu.last_successful_time, abs=1e-9)


# --- states of others ----------------------------------------------------------------------------


def test_a_state_of_another_machine_is_refused_as_it_is_too(extracted, tmp_path):
    """Not the serialized one alone."""
    other = build_native(
        tmp_path,
        machine_of(rig_toml().replace("diameter = 0.12", "diameter = 0.11")),
        platforms=["linux64"],
    )
    mine, theirs = Native(extracted["native"]).initialize(), Native(Extracted(other)).initialize()
    state = ctypes.c_void_p()
    theirs._call("GetFMUstate", ctypes.byref(state))
    before = mine.state()
    with pytest.raises(Refused, match="comes from another build of this FMU"):
        mine._call("SetFMUstate", state)
    assert mine.state() == before
    # a state's memory is used again, whoever it was of
    mine._call("GetFMUstate", ctypes.byref(state))
    mine._call("SetFMUstate", state)
    assert mine.state() == before


# --- other libraries -----------------------------------------------------------------------------

SAME_NAMES = """
int rotor_start(void) { return 77; }
int rotor_advance(void) { return 77; }
int rotor_survey(void) { return 77; }
int rotor_refresh_outputs(void) { return 77; }
int fmi2Reset(void) { return 4; }
"""


@NEEDS_COMPILER
@pytest.mark.parametrize("kind", SKINS)
def test_a_library_with_the_same_names_that_all_can_see_does_no_harm(kind, extracted, tmp_path):
    (tmp_path / "same.c").write_text(SAME_NAMES)
    shared = tmp_path / "libsame.so"
    subprocess.run([COMPILER, "-shared", "-fPIC", "-o", shared, tmp_path / "same.c"], check=True)
    script = (
        "import ctypes, sys, fmpy\n"
        "ctypes.CDLL(sys.argv[1], mode=ctypes.RTLD_GLOBAL)\n"
        "print(fmpy.simulate_fmu(sys.argv[2], stop_time=0.1, output=['disc[3].x'])[-1][1].hex())\n"
    )
    alone = fmpy.simulate_fmu(str(extracted[kind].folder), stop_time=0.1, output=["disc[3].x"])
    done = run_python(script, shared, extracted[kind].folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [float(alone[-1][1]).hex()]


# --- names ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_free", [False, True])
def test_no_part_may_be_called_as_a_variable_that_is_there(is_free):
    for variable in interface(rig(), is_free):
        if "." in variable.name:
            continue
        port = f'[[port]]\nnode = 3\nname = "{variable.name}"\n'
        with pytest.raises(QuantityError, match=f"name = {variable.name}: is reserved"):
            parse_rotor(rig_toml() + port)
    assert math.isfinite(parse_rotor(rig_toml() + '[[port]]\nnode = 3\nname = "v"\n').length)


@pytest.mark.parametrize("name", ["\N{LATIN SMALL LETTER U WITH DIAERESIS}", "100%", "a+b"])
def test_an_fmu_in_python_is_not_loaded_from_a_path_from_which_it_would_end_the_process(
    fmu, tmp_path, monkeypatch, name
):
    folder = tmp_path / name
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    for of, call in ((fmpy, "instantiate_fmu"), (fmpy.fmi2.FMU2Slave, "__init__")):
        monkeypatch.setattr(of, call, lambda *_, **__: pytest.fail("was loaded"))
    said = re.escape(str(folder)) + ".*: an FMU in Python is run from a path of plain letters"
    with pytest.raises(InputError, match=said):
        Member(fmu, {}, []).__enter__()
    with pytest.raises(InputError, match=said):
        run_fmu(fmu, prepare(None, None, (), None, 0.01, None))
    assert list(folder.iterdir()) == []


def test_an_archive_that_is_damaged_is_said_and_leaves_no_folder(tmp_path, native_fmu, monkeypatch):
    content = bytearray(native_fmu.read_bytes())
    with zipfile.ZipFile(native_fmu) as archive:
        entry = max(archive.infolist(), key=lambda entry: entry.compress_size)
    content[entry.header_offset + entry.compress_size // 2] ^= 0xFF
    damaged = tmp_path / "Damaged.fmu"
    damaged.write_bytes(content)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    said = r"Damaged\.fmu: is not an FMU that can be read: .*binaries/"
    with pytest.raises(InputError, match=said):
        Member(damaged, {}, []).__enter__()
    assert list(tmp_path.iterdir()) == [damaged]


def test_a_library_that_cannot_be_loaded_leaves_the_process_where_it_was(tmp_path, native_fmu):
    """FMPy stayed in the folder, which is gone: no path of the user's was found any more."""
    damaged = tmp_path / "Damaged.fmu"
    with zipfile.ZipFile(native_fmu) as whole, zipfile.ZipFile(damaged, "w") as archive:
        for entry in whole.infolist():
            is_library = entry.filename.startswith("binaries/")
            archive.writestr(entry, b"no library" if is_library else whole.read(entry))
    before = Path.cwd()
    with pytest.raises(RunFailed, match="Failed to load shared library"):
        Member(damaged, {}, []).__enter__()
    assert Path.cwd() == before
    with pytest.raises(RunFailed, match="Failed to load shared library"):
        run_fmu(damaged, prepare(None, None, (), None, 0.01, None))
    assert Path.cwd() == before
