"""A motor on a flexible coupling drives the rotor, each an FMU of its own."""

import json
import math
import runpy
import shutil
import subprocess
import sys
import tempfile

import numpy as np
import pytest
from rotor_fmu.examples import copy_system_files, example_folder
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.structure.assembly import assemble

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import CoupledRun
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

from ..processes import interrupted
from .coupled import last_row, through_libcosim

FOLDER = example_folder("drive_train")
COUPLING = Coupling(example_folder("drive_train") / "drive_train.py")
_EXAMPLE = runpy.run_path(str(FOLDER / "run_up.py"))
couple, hz_of, mean_load, orders, peak_hz = (
    _EXAMPLE[name] for name in ("couple", "hz_of", "mean_load", "orders", "peak_hz")
)
CONTINUATIONS, SMALL, STUDIED, STUDY_STOP, TARGET = (
    _EXAMPLE[name] for name in ("CONTINUATIONS", "SMALL", "STUDIED", "STUDY_STOP", "TARGET")
)


@pytest.fixture(scope="module")
def drive_fmu(tmp_path_factory):
    return COUPLING.build(tmp_path_factory.mktemp("drive"))


@pytest.fixture(scope="module")
def system(tmp_path_factory, drive_fmu, fmu):
    """The example's folder with both FMUs in it, as the script leaves it."""
    folder = tmp_path_factory.mktemp("system")
    copy_system_files(FOLDER, folder)
    shutil.copy(drive_fmu, folder)
    shutil.copy(fmu, folder)
    return folder


@pytest.fixture
def motor():
    """A drive train without FMU, with values given by name."""
    DriveTrain = runpy.run_path(str(FOLDER / "drive_train.py"))["DriveTrain"]

    def make(**values):
        train = DriveTrain(instance_name="drive")
        for name, value in values.items():
            assert hasattr(train, name)
            setattr(train, name, value)
        train.exit_initialization_mode()
        return train

    return make


def test_the_coupling_twists_as_two_masses_on_a_spring_do(motor):
    """A motor at its limit from standstill: twist = T J / (J_m + J) / k (1 - cos(w t))."""
    train = motor(c=0.0, tau_max=0.1, kp=1e3, h=1e-4)
    train.w_ref = 10.0
    J_motor, J, k = train.J_motor, train.J_rotor, train.k
    omega = math.sqrt(k * (1 / J_motor + 1 / J))
    for i in range(100):
        train.do_step(i * 1e-3, 1e-3)
        t = (i + 1) * 1e-3
        twist = 0.1 * J / (J_motor + J) / k * (1 - math.cos(omega * t))
        assert train.phi_motor - train.phi == pytest.approx(twist, abs=1e-8)
        assert train.tau_motor == 0.1


def test_what_the_motor_does_is_stored_lost_or_passed_on(motor):
    train = motor(tau_load=0.02, w_start=50.0, h=1e-4)
    start = 0.5 * (train.J_motor + train.J_rotor) * 50.0**2
    for i in range(500):
        train.tau_load = 0.02 + 0.01 * math.sin(i / 5)
        train.do_step(i * 2e-3, 2e-3)
    motors = 0.5 * train.J_motor * train.w_motor**2
    twist = 0.5 * train.k * (train.phi_motor - train.phi) ** 2
    begun = 0.5 * train.J_motor * 50.0**2
    assert train.work_motor == pytest.approx(
        motors - begun + twist + train.loss + train.work_out, rel=1e-8
    )
    assert motors + 0.5 * train.J_rotor * train.w**2 > start + 1.0


def test_the_controller_reaches_its_target_within_the_torque_limit(motor):
    train = motor(w_target=30.0, tau_load=0.02, tau_max=0.15)
    highest = 0.0
    for i in range(3000):
        train.do_step(i * 2e-3, 2e-3)
        assert abs(train.tau_motor) <= 0.15
        highest = max(highest, train.w)
    assert train.w == pytest.approx(30.0, abs=0.01)
    assert train.tau_motor == pytest.approx(0.02, rel=0.01)
    assert highest < 31.0


@pytest.mark.parametrize(
    ("parameters", "message"),
    [({"k": -1.0}, "k = -1 N.m/rad: must be >= 0"), ({"kp": math.nan}, "kp = nan")],
)
def test_an_impossible_drive_train_is_refused(drive_fmu, fmu, parameters, message):
    with pytest.raises(RunFailed, match=message):
        couple(drive_fmu, fmu, 0.1, 1e-3, parameters, {})


@pytest.mark.parametrize(
    ("parameters", "recorded", "message"),
    [
        ({"rotor": {"tol": 1.0}}, {}, r"RotorBearingNative\.fmu: tol: unknown name"),
        ({}, {"rotor": ["taue"]}, r"RotorBearingNative\.fmu: taue: unknown name; did you mean tau"),
        ({"rotr": {}}, {}, r"^parameters: rotr: unknown name; did you mean rotor"),
        ({}, {"drive": []}, r"^recorded: drive: unknown name; known: partner, rotor$"),
    ],
)
def test_what_cannot_be_coupled_is_named(drive_fmu, native_fmu, parameters, recorded, message):
    fmus = {"partner": drive_fmu, "rotor": native_fmu}
    with pytest.raises(InputError, match=message):
        COUPLING.run(fmus, 0.01, 1e-3, parameters, recorded)


def test_a_refused_parameter_leaves_no_folder_behind(native_fmu, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(RunFailed, match="limit = -5: must be"):
        Member(native_fmu, {"solver.newton_limit": -5}, []).__enter__()
    assert not [*tmp_path.iterdir()]


def test_an_infinite_load_ends_the_step_with_a_message(drive_fmu):
    with Member(drive_fmu, {}, []) as drive:
        drive.begin()
        drive.set({"tau_load": math.inf})
        with pytest.raises(RunFailed, match=r"tau_load = inf N\.m: must be a finite number"):
            drive.step(0.0, 1e-3)


def test_the_system_files_start_what_the_models_are(fmu, drive_fmu):
    """Their numbers: the rig's moment of inertia, its torque at rest, and one step in all three."""
    inertia = {v.name: v.start for v in COUPLING.variables}["J_rotor"]
    assert inertia == pytest.approx(assemble(rig()).numbers[0].inertia, rel=1e-12)
    given = json.loads((FOLDER / "cofmpy.json").read_text())["fmus"][0]["initialization"]
    with Member(fmu, {"speed": 0.0}, []) as rotor:
        at_rest = rotor.get(["tau_load"])["tau_load"]
    assert given["tau_load"] == pytest.approx(at_rest, rel=1e-12)
    lever = abs(sum(assemble(rig()).unbalance)) * 9.81
    assert at_rest == pytest.approx(lever, rel=1e-3)


@pytest.fixture(scope="module")
def through_fmpy(drive_fmu, fmu):
    return couple(drive_fmu, fmu, 1.0, 0.002, {}, {})


def test_a_run_is_read_as_it_was_written(through_fmpy, tmp_path):
    through_fmpy.save(tmp_path / "run.npz")
    read = CoupledRun.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(read.t, through_fmpy.t)
    for side in ("partner", "rotor"):
        assert read[side].keys() == through_fmpy[side].keys()
        for name, column in through_fmpy[side].items():
            np.testing.assert_array_equal(read[side][name], column)


@pytest.mark.parametrize(
    "file", ["OspSystemStructure.xml", pytest.param("SystemStructure.ssd", marks=pytest.mark.slow)]
)
def test_libcosim_gives_the_same_from_the_system_files(system, through_fmpy, file):
    shown = ("drive.w", "drive.tau_motor", "rotor.tau_load", "rotor.disc[3].x_amp")
    row = through_libcosim(system, file, 1.0, shown)
    assert row["time"] == 1.0
    for name in shown:
        side, _, variable = name.partition(".")
        output = through_fmpy[side.replace("drive", "partner")][variable][-1]
        assert row[name] == pytest.approx(output, rel=1e-9), name


def test_the_rotor_starts_at_the_speed_of_the_drive_in_a_master_that_connects_outputs_at_once(
    system, tmp_path
):
    text = (system / "OspSystemStructure.xml").read_text()
    still = 'variable="w_start"><Real value="0.0"'
    assert still in text
    (tmp_path / "OspSystemStructure.xml").write_text(text.replace(still, still[:-4] + '150.0"'))
    for file in (*system.glob("*.fmu"), system / "with_libcosim.py"):
        shutil.copy(file, tmp_path)
    shown = ("drive.w", "rotor.tau_load", "rotor.energy.drive_work")
    row = through_libcosim(tmp_path, "OspSystemStructure.xml", 0.1, shown)
    fmus = {"partner": system / "DriveTrain.fmu", "rotor": system / "RotorBearing.fmu"}
    given, seen = {"partner": {"w_start": 150.0}}, {"rotor": ["energy.drive_work"]}
    run = COUPLING.run(fmus, 0.1, 0.002, given, seen)
    for name in shown:
        side, _, variable = name.partition(".")
        output = run[side.replace("drive", "partner")][variable][-1]
        assert row[name] == pytest.approx(output, rel=1e-9), name


@pytest.mark.slow  # as libcosim does, and test_hosts has CoFMPy run
def test_cofmpy_gives_the_same_from_its_system_file(system, through_fmpy):
    pytest.importorskip("cofmupy", reason="pip install --no-deps cofmupy: it pins old versions")
    row = last_row(system / "with_cofmpy.py", "1")
    assert row["drive.w"] == pytest.approx(through_fmpy["partner"]["w"][-1], rel=1e-9)
    assert row["rotor.tau_load"] == pytest.approx(through_fmpy["rotor"]["tau_load"][-1], rel=1e-9)


@pytest.mark.slow  # test_hosts has it give what a plain master gives
def test_cofmpys_gauss_seidel_differs_by_the_communication_step_only(system, through_fmpy):
    pytest.importorskip("cofmupy", reason="pip install --no-deps cofmupy: it pins old versions")
    row = last_row(system / "with_cofmpy.py", "1", "gauss_seidel")
    assert row["drive.w"] == pytest.approx(through_fmpy["partner"]["w"][-1], rel=1e-3)


@pytest.mark.parametrize(
    ("continuation", "order"),
    [pytest.param(CONTINUATIONS[0], 1, marks=pytest.mark.slow), (CONTINUATIONS[1], 2)],
)
def test_the_energy_lost_between_the_fmus_falls_with_the_step(drive_fmu, fmu, continuation, order):
    drive = {"continuation": float(CONTINUATIONS.index(continuation))}
    runs = [
        couple(drive_fmu, fmu, STUDY_STOP, h, drive, {"solver.tolerance": 1e-4}) for h in STUDIED
    ]
    assert orders(runs) == pytest.approx([order] * 3, abs=0.1)
    power = runs[-1]["partner"]["tau_coupling"] * runs[-1]["partner"]["w"]
    taken = runs[-1]["rotor"]["tau"] * runs[-1]["partner"]["w"]
    assert np.abs(power - taken).max() < 0.005 * np.abs(taken).max()


def test_a_rotor_much_heavier_than_the_motor_leaves_the_loop_stable(drive_fmu, fmu):
    """With J a in the torque that goes around, J > J_motor would blow up within a few steps."""
    run = couple(drive_fmu, fmu, 2.0, 0.01, {"J_motor": 1e-4, "k": 40.0, "ramp": 15.0}, {})
    assert run["rotor"]["J"][0] > 90 * 1e-4
    assert run["partner"]["w"][-1] == pytest.approx(30.0, rel=0.02)


@pytest.mark.slow  # tests/studies/test_examples has one hang below the resonances
def test_a_motor_just_too_weak_hangs_at_the_horizontal_resonance(drive_fmu, fmu):
    """Just below it still speeds up, above it slows down again: it cannot get through."""
    rates = []
    for hz in (26.5, 29.0):
        start = {"tau_max": SMALL, "w_start": 2 * math.pi * hz}
        run = couple(drive_fmu, fmu, 8.0, 0.002, start, {})
        late = run.t > 3.0  # when the start's transient is over
        rates.append(np.polyfit(run.t[late], hz_of(run)[late], 1)[0])
        assert run["rotor"]["disc[3].x_amp"][-1] > 300e-6
    assert rates[0] > 0.01
    assert rates[1] < -0.01


@pytest.mark.slow  # as one does in tests/studies/test_examples
def test_ample_torque_passes_both_resonances(drive_fmu, fmu):
    run = couple(drive_fmu, fmu, 12.0, 0.002, {"w_start": 130.0}, {})
    assert run["partner"]["w"][-1] == pytest.approx(250.0, rel=0.01)
    assert 26 < peak_hz(run, "x") < 29 < peak_hz(run, "y") < 33
    hz, torque = mean_load(run)
    assert np.interp(40, hz, torque) < SMALL < torque.max() < run["partner"]["tau_motor"].max()


@pytest.mark.usefixtures("drawn")
@pytest.mark.slow
def test_the_script_leaves_pictures_and_a_summary(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["run_up.py", "--out", str(tmp_path)])
    with pytest.raises(SystemExit) as end:
        _EXAMPLE["main"]()
    assert end.value.code == 0
    report = json.loads((tmp_path / "summary.json").read_text())
    assert report["ample"]["end_hz"] == pytest.approx(TARGET / (2 * math.pi), rel=1e-3)
    assert 26 < report["small"]["end_hz"] < 29
    assert abs(report["small"]["end_acceleration_hz_per_s"]) < 0.03
    for picture in ("run_up.png", "power.png"):
        assert (tmp_path / picture).stat().st_size > 10_000
    assert "hang" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--small", "0.3"), "--small 0.3 N.m: must be below --ample = 0.2 N.m"),
        (("--ample", "nan"), "--ample nan N.m: must be > 0"),
        (("--step", "1"), "--step 1 s: must lie between 0.0001 and 0.02"),
        (("--out", "/dev/null/x"), "--out /dev/null/x: cannot be written to"),
    ],
)
def test_what_the_script_cannot_do_it_says_in_one_line(input_error_of, arguments, message):
    assert input_error_of(_EXAMPLE["main"])(*arguments).startswith(f"rotor-fmu: {message}")


@pytest.mark.slow
def test_ctrl_c_ends_the_script_in_one_line(tmp_path):
    process = subprocess.Popen(
        [sys.executable, FOLDER / "run_up.py"],
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    runs = tmp_path / "out" / "drive_train" / "runs"
    status, errors = interrupted(process, runs.exists)
    assert status == 130
    assert errors.strip().splitlines()[-1].startswith("rotor-fmu: stopped")
    assert not list(tmp_path.rglob("*.part*"))


def test_a_rotor_says_nothing_of_a_speed_at_which_the_drive_does_not_start_it(drive_fmu, tmp_path):
    """It was asked for its inertia before it had the drive's speed, and said that it is unstable at
    its own start value, 740 rad/s."""
    machine = machine_of((FOLDER.parent / "oil_film" / "rotor.toml").read_text())
    fmus = {"partner": drive_fmu, "rotor": build_native(tmp_path, machine, platforms=["linux64"])}
    for speed, said in ((300.0, []), (740.0, ["unstable"])):
        with COUPLING.open(fmus, 0.01, {"partner": {"w_start": speed}}) as opened:
            opened.run(0.002)
        assert [message.code for message in opened.messages] == said


def test_the_picture_of_the_run_ups_claims_nothing_of_motors_that_it_does_not_know():
    """Of a small motor that passes it said "hangs", of an ample one that does not, "passes"; the
    label of the one was outside of the picture, of the other, in that of the axis."""
    t = np.linspace(0.0, 10.0, 5001)

    def run_up(rate):
        w = rate * t
        phi, none = 0.5 * rate * t**2, np.zeros_like(t)
        rotor = {"J": none + 0.01, "energy.drive_work": 0.005 * w**2 + 0.02 * phi}
        rotor |= {f"disc[3].{axis}_amp": none for axis in "xy"}
        return CoupledRun(t, {"partner": {"w": w, "phi": phi}, "rotor": rotor})

    for ample, small in ((10.0, 0.1), (40.0, 40.0)):
        runs = {"ample": run_up(ample), "small": run_up(small)}
        figure = _EXAMPLE["run_up_figure"](runs, 0.06, 0.018)
        top, low = ([of.get_text() for of in axes.get_legend().get_texts()] for axes in figure.axes)
        assert top[:2] == ["motor with 60 N mm", "motor with 18 N mm"]
        assert low[-1] == f"where it is after 10 s: {10.0 * small / (2 * math.pi):.1f} Hz"
        assert not any(axes.texts for axes in figure.axes)
        assert figure.axes[0].get_title(loc="left") == "Run-up by two motors"
