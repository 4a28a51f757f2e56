"""A compressor on magnetic bearings: rotor and control, each an FMU of its own."""

import json
import math
import runpy
import shutil
import sys

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.examples import copy_system_files, example_folder
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import RunFailed
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build

from .coupled import through_libcosim

FOLDER = example_folder("magnetic_bearing")
COUPLING = Coupling(example_folder("magnetic_bearing") / "magnetic_bearing.py")
_EXAMPLE = runpy.run_path(str(FOLDER / "lift_and_drop.py"))
couple, rotor_in, work_lost = (_EXAMPLE[name] for name in ("couple", "rotor_in", "work_lost"))
STEP = 1e-4
TOML = (FOLDER / "compressor.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def control(tmp_path_factory):
    return COUPLING.build(tmp_path_factory.mktemp("control"))


@pytest.fixture(scope="module")
def compressor(tmp_path_factory):
    return rotor_in(tmp_path_factory.mktemp("compressor"))


@pytest.fixture(scope="module")
def dropped(control, compressor):
    """Lifted at 1000 rad/s, switched off at 0.3 s, left to itself until 0.4 s."""
    values = {"t_off": 0.3, "w_target": 1000.0, "t_run": 0.0}
    return couple(control, compressor, 0.4, STEP, values, {"w_start": 1000.0})


# --- the control alone ---


def test_an_amplifier_follows_at_its_limit_and_then_exponentially():
    follow = runpy.run_path(str(FOLDER / "magnetic_bearing.py"))["follow"]
    T, fastest, n = 1e-4, 7000.0, 20000
    i, h = 0.3, 1e-3 / n
    for _ in range(n):
        rate = np.clip((3.0 - i) / T, -fastest, fastest)
        i += h * rate
    assert follow(0.3, 3.0, 1e-3, T, fastest) == pytest.approx(i, abs=1e-5)
    assert follow(0.3, 3.0, 1e-4, T, fastest) == pytest.approx(1.0, rel=1e-12)
    assert follow(0.3, 3.0, 1.0, T, 0.0) == 0.3


def test_a_journal_beyond_the_gap_is_refused_and_the_control_goes_on(control):
    with Member(control, {}, []) as member:
        member.begin()
        member.set({"left_dx": 1e-3})
        with pytest.raises(RunFailed, match=r"left_dx = 0\.001 m: must be smaller than the gap"):
            member.step(0.0, STEP)
        member.set({"left_dx": 0.0})
        member.step(0.0, STEP)
        assert member.get(["kp"]) == {"kp": 12000.0}


@pytest.mark.parametrize(
    ("parameters", "message"),
    [({"kp": -1.0}, "kp = -1 A/m: must be >= 0"), ({"gap": math.nan}, "gap = nan m: must be")],
)
def test_an_impossible_control_is_refused(control, compressor, parameters, message):
    with pytest.raises(RunFailed, match=message):
        couple(control, compressor, 0.01, STEP, parameters, {})


# --- both coupled ---


def test_the_magnets_lift_the_rotor_and_bear_its_weight(dropped):
    before = dropped.t < 0.3
    assert dropped["rotor"]["left_sensor.y"][0] < -250e-6
    height = dropped["rotor"]["left_magnet.y"][before][-500:]
    assert abs(height.mean()) < 5e-6
    lifting = sum(
        dropped["partner"][f"{side}_fy"][before][-500:].mean() for side in ("left", "right")
    )
    weight = abs(LinearMachine(parse_rotor(TOML)).structure.static_load[::2].sum())
    assert lifting == pytest.approx(weight, rel=0.02)


def test_at_the_limit_a_coil_carries_twice_the_bias_and_never_less_than_nothing(dropped):
    for coil in ("left_ixa", "left_ixb", "left_iya", "left_iyb"):
        assert dropped["partner"][coil].min() >= 0.0
        assert dropped["partner"][coil].max() <= 6.0
    assert dropped["partner"]["left_iya"].max() > 5.7
    rate = np.abs(np.diff(dropped["partner"]["left_iya"])).max() / STEP
    assert rate == pytest.approx(150.0 / 0.022, rel=1e-9)


def test_the_work_of_held_forces_is_the_same_on_both_sides(dropped):
    largest = np.abs(dropped["partner"]["work"]).max()
    assert largest > 0.05
    assert np.abs(work_lost(dropped)).max() < 0.01 * largest


def test_switched_off_the_rotor_falls_and_the_races_catch_it(dropped):
    t, rotor = dropped.t - 0.3, dropped["rotor"]
    touches = (t > 0) & (rotor["touchdown_bearing[1].fn"] > 0)
    free_fall = math.sqrt(2 * 0.25e-3 / 9.81)
    # the magnets let go within 0.5 ms
    assert free_fall < t[touches][0] < free_fall + 1e-3
    for k in (1, 2):
        radius = np.hypot(*(rotor[f"touchdown_bearing[{k}].{axis}"] for axis in "xy"))
        assert radius.max() < 0.27e-3
        assert rotor[f"touchdown_bearing[{k}].race"][-1] > 200.0
    went = {name: values[-1] - values[t < 0][-1] for name, values in rotor.items()}
    lost = sum(change for name, change in went.items() if name.endswith("_loss"))
    assert lost > 50.0
    assert abs(went["energy.residual"]) < 1e-4 * lost


# --- the sampled loop against its eigenvalues ---


def loop(rotor, sensors, step, speed=0.0):
    """Eigenvalues s [1/s] of rotor and control about the middle, as the sampled system that they
    are; sensors: nodes of the left and the right one."""
    value = {v.name: v.start for v in COUPLING.variables}
    linear = LinearMachine(rotor, "open").at_zero_load(speed)
    M, D, K = (matrix.toarray() for matrix in (linear.M, linear.D, linear.K))
    has_mass = np.flatnonzero(np.abs(M).sum(axis=1) > 0)
    M, D, K = (matrix[np.ix_(has_mass, has_mass)] for matrix in (M, D, K))
    squared, modes = scipy.linalg.eigh((K + K.T) / 2, M)
    modes = modes[:, squared < (2 * math.pi * 4000.0) ** 2]
    r = modes.shape[1]

    def rows(nodes):
        places = [4 * (node - 1) + axis for node in nodes for axis in (0, 1)]
        return np.hstack([modes[np.searchsorted(has_mass, places)], np.zeros((4, r))])

    S, N = rows(sensors), rows((5, 11))
    A = np.block([[np.zeros((r, r)), np.eye(r)], [-modes.T @ K @ modes, -modes.T @ D @ modes]])
    B = np.vstack([np.zeros((r, 4)), N[:, :r].T])
    held = np.block([[A, B], [np.zeros((4, 2 * r + 4))]])
    over = scipy.linalg.expm(held * step)[: 2 * r]
    force_i = 4 * value["K"] * value["i_bias"] / value["gap"] ** 2
    force_d = 4 * value["K"] * value["i_bias"] ** 2 / value["gap"] ** 3
    low = 1 - math.exp(-2 * math.pi * value["f_filter"] * step)
    lag = math.exp(-step / value["T"])
    # of every axis: force held, low pass, integral, current
    one, n = np.eye(4), 2 * r
    f, s, w, i = (slice(n + 4 * k, n + 4 * k + 4) for k in range(4))
    Z = np.zeros((n + 16, n + 16))
    Z[:n, : n + 4] = over
    Z[s, :n], Z[s, s] = low * S, (1 - low) * one
    Z[w, :n], Z[w, w] = value["ki"] * step * S, one
    change = Z[s].copy()
    change[:, s] -= one
    asked = -(value["kp"] * Z[s] + value["kd"] / step * change + Z[w])
    Z[i] = (1 - lag) * asked
    Z[i, i] += lag * one
    Z[f] = force_i * Z[i]
    Z[f, :n] += force_d * N
    return np.log(np.linalg.eigvals(Z).astype(complex)) / step


def whirling_up(result):
    """The least damped oscillation among eigenvalues."""
    return max(result[result.imag > 100.0], key=lambda s: s.real)


def seen(control, folder, toml, step, stop):
    """Rate [1/s] and frequency [rad/s] of the bending that a start beside the middle leaves."""
    fmu = build(folder, machine_of(f"{toml}\n[start]\nx = 2e-5\n", is_free=True))
    values = {"t_lift": 0.0, "t_off": 10.0, "t_run": 10.0}
    settings = {"gravity": 0.0, "solver.preset": 0, "solver.h": 2e-5}
    rotor = couple(control, fmu, stop, step, values, settings)["rotor"]
    # the part that no rigid body has in symmetric bearings
    x = sum(rotor[f"{k}_sensor.x"] - rotor[f"{k}_magnet.x"] for k in ("left", "right"))
    x = x[len(x) // 3 :]
    # a damped oscillation in three samples: x[n + k] = a x[n] + b x[n - k]
    k = 5
    (a, b), *_ = np.linalg.lstsq(np.column_stack([x[k:-k], x[: -2 * k]]), x[2 * k :], rcond=None)
    s = np.log(complex(np.roots([1.0, -a, -b])[0])) / (k * step)
    return s.real, abs(s.imag)


@pytest.mark.parametrize(
    ("sensors", "grows"),
    [pytest.param((4, 12), False, marks=pytest.mark.slow), ((7, 9), True)],
    ids=["beside", "beyond the node"],
)
def test_the_bending_mode_is_damped_or_driven_as_the_sampled_loop_says(
    control, tmp_path, sensors, grows
):
    rotor = parse_rotor(TOML)
    moved = TOML
    for name, node in zip(("left", "right"), sensors, strict=True):
        before = {"left": 0.12, "right": 0.78}[name]
        moved = moved.replace(
            f'name = "{name}_sensor"\nz = {before}',
            f'name = "{name}_sensor"\nz = {rotor.nodes[node - 1]:.6g}',
        )
    output = whirling_up(loop(rotor, sensors, STEP))
    assert (output.real > 0) == grows
    rate, omega = seen(control, tmp_path, moved, STEP, 0.1 if grows else 0.3)
    assert omega == pytest.approx(output.imag, rel=1e-3)
    assert rate == pytest.approx(output.real, rel=5e-3)


def test_a_controller_too_slow_drives_the_third_bending_mode():
    rotor = parse_rotor(TOML)
    for speed in (0.0, 1400.0):
        assert whirling_up(loop(rotor, (4, 12), 1.5e-4, speed)).real < 0
        slow = whirling_up(loop(rotor, (4, 12), 2e-4, speed))
        assert slow.real > 0
        assert 850 < slow.imag / (2 * math.pi) < 1000


# --- other hosts, and the command ---


@pytest.fixture(scope="module")
def through_fmpy(control, compressor):
    return couple(control, compressor, 0.3, STEP, {}, {})


@pytest.mark.parametrize(
    "file", [pytest.param("OspSystemStructure.xml", marks=pytest.mark.slow), "SystemStructure.ssd"]
)
def test_libcosim_gives_the_same_from_the_system_files(
    tmp_path, control, compressor, through_fmpy, file
):
    copy_system_files(FOLDER, tmp_path)
    for fmu in (control, compressor):
        shutil.copy(fmu, tmp_path)
    shown = ("control.left_fy", "control.tau", "rotor.w", "rotor.left_sensor.y")
    row = through_libcosim(tmp_path, file, 0.3, shown)
    assert row["rotor.w"] > 30.0
    for name in shown:
        side, _, variable = name.partition(".")
        output = through_fmpy[side.replace("control", "partner")][variable][-1]
        assert row[name] == pytest.approx(output, rel=1e-7, abs=1e-12), name


@pytest.mark.usefixtures("drawn")
@pytest.mark.slow
def test_the_script_leaves_pictures_and_a_summary(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["lift_and_drop.py", "--out", str(tmp_path)])
    with pytest.raises(SystemExit) as end:
        _EXAMPLE["main"]()
    assert end.value.code == 0
    report = json.loads((tmp_path / "summary.json").read_text())
    bending = loop(parse_rotor(TOML), (4, 12), STEP, 1070.0).imag
    forward = bending[(bending > 900.0) & (bending < 1200.0)].max()
    # passed at 500 rad/s2 it peaks late
    assert 1.0 < report["peak_rad_per_s"] / forward < 1.06
    assert 0.006 < report["first_contact_s"] < 0.009
    # journal and race roll, the race being wider by the clearance
    rolls = report["end_speed_rad_per_s"] * 0.03 / 0.03025
    assert report["race_speed_rad_per_s"] == pytest.approx(rolls, rel=1e-3)
    assert abs(report["ledger_open_by_J"]) < 1e-4 * report["lost_in_the_drop_J"]
    for picture in ("run_up.png", "orbit.png", "drop.png"):
        assert (tmp_path / picture).stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--step", "0.001"), "--step 0.001 s: must lie between 1e-05 and 0.00015"),
        (("--speed", "nan"), "--speed nan rad/s: must be > 0"),
        (("--out", "/dev/null/x"), "--out /dev/null/x: cannot be written to"),
    ],
)
def test_what_the_script_cannot_do_it_says_in_one_line(input_error_of, arguments, message):
    assert input_error_of(_EXAMPLE["main"])(*arguments).startswith(f"rotor-fmu: {message}")
