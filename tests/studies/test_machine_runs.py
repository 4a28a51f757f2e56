"""Runs of a machine as rows: what is kept of them, and that a row can be run again."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig_toml
from scipy.signal import lsim

from rotor_fmu import studies
from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.machine_studies.metric import Metric
from rotor_fmu.machine_studies.run_excitation import Excitation, Samples, Window
from rotor_fmu.machine_studies.run_kinds import CONSTANT, STEPS
from rotor_fmu.machine_studies.run_metrics import KINDS, cell
from rotor_fmu.runs.recording import load_recording
from rotor_fmu.studies.runner import run_study

from .functions import conducted, here, quiet

RIG = """
[run]
kind = "run-down"
from = 210
to = 160
rate = 25
[set]
"solver.tolerance" = 1e-2
[vary]
clearance = { names = "bearing[*].clearance", values = [40e-6, 60e-6] }
[keep]
X = { peak = "disc[3].x_amp" }
loss_1 = { dissipated = "bearing[1]" }
loss_2 = { dissipated = "bearing[2]" }
loss = { last = "energy.friction_loss" }
touching = { contact = "bearing[1]" }
over_speed = { amplitude = "disc[3].x_amp", bins = { from = 150, to = 220, count = 7 } }
at_190 = { value = "disc[3].x_amp", speed = 190 }
"1x at 190" = { order = 1, speed = 190, of = "disc[3].x" }
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    """A study's file, its folder and its rows."""
    folder = tmp_path_factory.mktemp("rig")
    return conducted(RIG, folder)


def test_friction_at_each_contact_adds_up_to_the_ledger(rig):
    _, _, data = rig
    assert (data.loss_1 + data.loss_2).values == pytest.approx(data.loss.values, rel=1e-4)


def test_friction_at_turning_races_adds_up_to_the_ledger(tmp_path):
    _, _, data = conducted(
        f'{COMPRESSOR}[run]\nkind = "drop"\nspeed = 500\nstop = 0.03\n'
        '[vary]\n"solver.tolerance" = { values = [1e-3] }\n[keep]\n'
        'one = { dissipated = "touchdown_bearing[1]" }\n'
        'other = { dissipated = "touchdown_bearing[2]" }\n'
        'loss = { last = "energy.friction_loss" }\n',
        tmp_path,
    )
    assert data.loss.values > 1
    assert (data.one + data.other).values == pytest.approx(data.loss.values, rel=1e-2)


def test_kept_amplitudes_agree_with_one_another(rig):
    _, _, data = rig
    assert data.over_speed.max("over_speed speed").values == pytest.approx(data.X.values)
    assert data["1x at 190"].values == pytest.approx(data.at_190.values, rel=0.1)
    assert (data.touching.values > 0).all()
    assert (data.touching.values <= 2.0).all()


def test_columns_say_what_they_are_with_the_options_they_have(rig):
    _, _, data = rig
    assert data.at_190.long_name == (
        "value when the speed first passes 190 rad/s, of disc[3].x_amp"
    )
    assert data["1x at 190"].long_name.startswith("amplitude of order 1 where 190 rad/s is first")
    assert (data.at_190.units, data.loss_1.units, data.clearance.units) == ("m", "J", "m")


def test_a_selected_run_is_the_run_of_its_row_with_all_its_signals(rig, process):
    path, out, data = rig
    run_id = str(data.id.values[1])
    assert process("study", str(path), "--out", str(out), "--select", run_id).returncode == 0
    recording = load_recording(out / "runs" / run_id / "recording.npz")
    touching = np.trapezoid(recording.columns["bearing[1].contact"], recording.t)
    assert touching == data.touching.values[1]
    assert recording.about["parameters"]["bearing[2].clearance"] == 60e-6
    assert {"phi", "w", "disc[3].x", "bearing[1].fn"} <= set(recording.columns)
    summary = json.loads((out / "runs" / run_id / "summary.json").read_text())
    assert summary["run"] == 1
    assert summary["status"] == "ok"


def test_a_run_is_not_selected_into_the_folder_of_another_study(rig, process):
    path, out, data = rig
    other = path.with_name("other.toml")
    other.write_text(RIG.replace("rate = 25", "rate = 26"))
    done = process("study", str(other), "--out", str(out), "--select", "1")
    assert done.returncode == 2
    assert "holds another study" in done.stderr
    assert {folder.name for folder in out.glob("runs/*")} <= set(data.id.values)


def test_a_folder_holds_a_run_or_a_study(rig, process, tmp_path):
    path, out, _ = rig
    (tmp_path / "recording.npz").touch()
    for arguments, kind in (
        (["study", str(path), "--out", str(tmp_path)], "run"),
        (["run-down", "--direct", "--stop", "0.01", "--out", str(out)], "study"),
    ):
        before = {file: file.stat().st_mtime_ns for file in Path(arguments[-1]).rglob("*")}
        done = process(*arguments)
        assert done.returncode == 2
        assert f"--out {arguments[-1]}: holds a {kind}, beside which" in done.stderr
        after = {file: file.stat().st_mtime_ns for file in Path(arguments[-1]).rglob("*")}
        assert after == before


def test_a_run_that_cannot_be_selected_leaves_no_folder(tmp_path, input_error):
    path = tmp_path / "study.toml"
    law = 'distribution = "uniform", low = -1e-6, high = -1e-7'
    path.write_text(
        RIG.replace("values = [40e-6, 60e-6]", law) + '[design]\nkind = "random"\nsize = 1\n'
    )
    said = input_error("study", str(path), "--out", str(tmp_path / "out"), "--select", "0")
    assert "clearance" in said
    assert list(tmp_path.iterdir()) == [path]


def test_a_machine_that_cannot_be_is_a_failed_row_with_its_reason(tmp_path):
    path = tmp_path / "study.toml"
    law = 'distribution = "uniform", low = -1e-6, high = -1e-7'
    path.write_text(
        RIG.replace("values = [40e-6, 60e-6]", law) + '[design]\nkind = "random"\nsize = 1\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    (status,) = studies.open(tmp_path / "out").status.values
    assert status.startswith("failed: bearing[")
    assert status.endswith(" m: must be > 0 and finite") or "must be > 0" in status


HELD = Excitation(CONSTANT, {"speed": 10.0, "turns": 8.0, "per_turn": 32.0, "measure": 0.0})


def window(values, turns=8, per_turn=32):
    """A window at a held speed of functions of the angle."""
    angle = 2 * math.pi * np.arange(turns * per_turn + 1) / per_turn
    seen = Samples(angle / 10.0, {name: f(angle) for name, f in values.items()})
    later = Samples(seen.t[1:], {name: column[1:] for name, column in seen.columns.items()})
    return Window(seen, later, 10.0, per_turn)


WHIRL = {
    "d.x": lambda a: 0.5 + 3 * np.cos(a) + np.cos(0.5 * a) + 0.25 * np.cos(2 * a),
    "d.y": lambda a: 3 * np.sin(a) - np.sin(0.5 * a) + 0.25 * np.sin(2 * a),
}


@pytest.mark.parametrize(("order", "amplitude"), [(1, 3), (0.5, 1), (2, 0.25), (3, 0)])
def test_orders_are_told_apart(order, amplitude):
    metric = Metric("q", KINDS["order"], "d.x", (("order", order),))
    assert cell(metric, [window(WHIRL)], HELD) == pytest.approx(amplitude, abs=1e-12)


def test_the_full_spectrum_tells_forward_from_backward_whirl():
    metric = Metric("q", KINDS["spectrum"], "d", (("orders", 3),))
    lines = np.array(cell(metric, [window(WHIRL)], HELD))
    at = {float(order): lines[i] for i, order in enumerate(np.arange(-24, 25) / 8)}
    assert at[1.0] == pytest.approx(3)
    assert at[-0.5] == pytest.approx(1)
    assert at[2.0] == pytest.approx(0.25)
    assert at[0.5] == pytest.approx(0, abs=1e-12)


def test_poincare_points_are_those_at_the_mark():
    points = cell(Metric("q", KINDS["poincare"], "d.x"), [window(WHIRL)], HELD)
    # half an order: two points, in turns
    assert points == pytest.approx([0.5 + 3 - 1 + 0.25, 0.5 + 3 + 1 + 0.25] * 4)


@pytest.mark.parametrize("sense", [1, -1])
def test_the_jump_on_the_way_down_is_not_taken_for_the_larger_one_on_the_way_up(sense):
    """A hysteresis loop: off the upper branch at 2.5 going up, back onto it at 1.5 going down,
    whichever way the rotor turns."""
    speeds, upper = [1.0, 2.0, 3.0, 2.0, 1.0], [True, True, False, False, True]
    seen = [
        window({"d.x": lambda a, r=speed if is_up else 0.5: r + 0 * a})._replace(
            speed=sense * speed
        )
        for speed, is_up in zip(speeds, upper, strict=True)
    ]
    steps = Excitation(STEPS, {**HELD.numbers, "from": 1.0, "to": 3.0, "count": 3.0, "back": 1.0})
    up, down = (
        cell(Metric("q", KINDS["jump"], "d.x", (("way", way),)), seen, steps)
        for way in ("up", "down")
    )
    assert (up, down) == (sense * 2.5, sense * 1.5)


@pytest.mark.parametrize("per_turn", [8, 256])
def test_peak_rms_mean_and_whirl_of_a_circle(per_turn):
    circle = {"d.x": lambda a: 2 * np.cos(-a), "d.y": lambda a: 2 * np.sin(-a)}
    seen = [window(circle, per_turn=per_turn)]
    assert cell(Metric("q", KINDS["whirl"], "d"), seen, HELD) == pytest.approx(-10.0)
    assert cell(Metric("q", KINDS["peak"], "d.x"), seen, HELD) == pytest.approx(2.0)
    assert cell(Metric("q", KINDS["rms"], "d.x"), seen, HELD) == pytest.approx(math.sqrt(2))
    assert cell(Metric("q", KINDS["mean"], "d.r"), seen, HELD) == pytest.approx(2.0)


JEFFCOTT = 'machine = "jeffcott_rub/jeffcott.toml"\n'
DRIVE_TRAIN = 'module = "rotor_fmu.examples.drive_train.study"\n'
COMPRESSOR = 'machine = "drop/compressor.toml"\n'
# head, [run], an output and its value at the end
RUNS = {
    "run-up": (JEFFCOTT, "from = 50\nto = 60\nrate = 100", "w", 60.0),
    "run-down": (JEFFCOTT, "from = 60\nto = 50\nrate = 100", "w", 50.0),
    "up-and-down": (JEFFCOTT, "from = 50\nto = 60\nrate = 100\nstep = 1e-3", "w", 50.0),
    "constant": (JEFFCOTT, "speed = 50\nsettle = 0\nturns = 1", "w", 50.0),
    "steps": (JEFFCOTT, "from = 50\nto = 60\ncount = 2\nsettle = 0\nturns = 1", "w", 60.0),
    "signals": (JEFFCOTT, 'file = "speed.csv"\nstop = 0.1', "w", 52.0),
    # free fall for 5 ms: g t^2 / 2
    "drop": (COMPRESSOR, "speed = 100\nstop = 5e-3", "touchdown_bearing[1].y", -1.226e-4),
    "motor": ("", "torque = 5\ntarget = 20\nramp = 100\nstop = 1\nfrom = 10", "w", 20.0),
    "drive-train": (
        DRIVE_TRAIN,
        "torque = 5\ntarget = 20\nramp = 20\nstop = 3\nfrom = 10",
        "w",
        20.0,
    ),
}


@pytest.mark.parametrize("kind", RUNS)
def test_every_kind_of_run_ends_where_it_is_told_to(tmp_path, kind):
    head, run, output, end = RUNS[kind]
    (tmp_path / "speed.csv").write_text("time,speed\n0,50\n1,70\n")
    path = tmp_path / "study.toml"
    path.write_text(
        f'{head}[run]\nkind = "{kind}"\n{run}\n[vary]\n"solver.tolerance" = {{ values = [1e-3] }}\n'
        f'[keep]\nend = {{ last = "{output}" }}\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    assert data.status.values.tolist() == ["ok"]
    assert float(data.end.values.ravel()[-1]) == pytest.approx(end, rel=2e-2)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("run-down", {"from": 130.0, "to": 0.0, "rate": 4.0}),
        ("run-up", {"from": 0.0, "to": 110.0, "rate": 3.0}),
        ("up-and-down", {"from": 0.0, "to": 110.0, "rate": 3.0}),
        ("motor", {"target": 90.0, "ramp": 3.0}),
        ("drive-train", {"target": 90.0, "ramp": 3.0}),
    ],
)
def test_a_run_is_that_of_the_machines_own_speeds(tmp_path, kind, expected):
    (tmp_path / "machine.toml").write_text(
        rig_toml().partition("[operation]")[0]
        + "[operation]\nrated_speed = 90.0\nmaximum_continuous_speed = 110.0\ntrip_speed = 130.0\n"
        + "run_up_rate = 3.0\nrun_down_rate = 4.0\n\n[material]"
        + rig_toml().partition("[material]")[2]
    )
    path = tmp_path / "study.toml"
    needed = "torque = 1\nstop = 1\n" if "target" in expected else ""
    head = DRIVE_TRAIN if kind == "drive-train" else ""
    path.write_text(
        f'{head}machine = "machine.toml"\n[run]\nkind = "{kind}"\n{needed}'
        '[vary]\n"solver.tolerance" = { values = [1e-3] }\n[keep]\nend = { last = "w" }\n'
    )
    numbers = read_study(path).model.how.numbers
    assert {name: numbers[name] for name in expected} == expected


def test_loads_of_a_file_are_linear_between_its_points_whatever_the_step(tmp_path):
    """Of which the longest holds almost three periods; SciPy's exact answer of a linear system."""
    t = np.linspace(0.0, 0.2, 201)
    lines = [f"{a!r},10,{5 * math.sin(300 * a)!r}\n" for a in t.tolist()]
    (tmp_path / "loads.csv").write_text("time,speed,disc.fx\n" + "".join(lines))
    path = tmp_path / "study.toml"
    path.write_text(
        'machine = "studies/whip.toml"\n[run]\nkind = "signals"\nfile = "loads.csv"\nstop = 0.2\n'
        '[set]\n"solver.tolerance" = 1e-5\n[vary]\n"run.step" = { values = [0.06, 4e-3, 5e-4] }\n'
        '[keep]\nx = { last = "disc.x" }\npeak = { peak = "disc.x" }\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    assert data.status.values.tolist() == ["ok"] * 3
    grid = np.linspace(0.0, 0.2, 20_001)
    _, x, _ = lsim(([1.0], [1.0, 10.0, 1e4]), np.interp(grid, t, 5 * np.sin(300 * t)), grid)
    largest = np.abs(x).max()
    assert data.peak.values == pytest.approx([largest] * 3, rel=1e-3)
    assert data.x.values == pytest.approx([x[-1]] * 3, abs=1e-3 * largest)


@pytest.mark.parametrize("way", ["run-up", "up-and-down"])
def test_the_speed_of_a_ramp_goes_on_during_a_kick(tmp_path, way):
    path = tmp_path / "study.toml"
    path.write_text(
        f'machine = "studies/whip.toml"\n[run]\nkind = "{way}"\nfrom = 10\nto = 20\nrate = 20\n'
        'kick = { port = "disc", force = 1, rate = 100, duration = 0.25 }\n'
        '[vary]\n"contact[1].mu" = { values = [0.1] }\n[keep]\nx = { peak = "disc.x" }\n'
    )
    seen = read_study(path).model.record({})
    assert seen.columns["w"] == pytest.approx(20 - 20 * np.abs(seen.t - 0.5))
    assert np.abs(seen.columns["disc.x"]).max() > 1e-4


@pytest.mark.parametrize(
    ("run", "expected"),
    [
        ("run-up\nfrom = 10\nto = 20\nrate = 100", "kick duration = 0.1 s: must be below the 0.1"),
        ("drop\nspeed = 10\nstop = 1", "run drop: has no kick"),
        ("motor\ntorque = 1\nstop = 1", "run motor: has no kick"),
    ],
)
def test_a_kick_that_a_run_does_not_have_is_refused(tmp_path, run, expected):
    path = tmp_path / "study.toml"
    kind, _, numbers = run.partition("\n")
    path.write_text(
        f'machine = "studies/whip.toml"\n[run]\nkind = "{kind}"\n{numbers}\n'
        'kick = { port = "disc", force = 1, rate = 1, duration = 0.1 }\n'
        '[vary]\n"contact[1].mu" = { values = [0.1] }\n[keep]\nx = { peak = "disc.x" }\n'
    )
    with pytest.raises(InputError, match=expected):
        read_study(path)


@pytest.mark.parametrize("rate", [0.0, 200.0, -200.0])
def test_a_kick_moves_the_rotor_that_would_rest_and_turns_as_it_is_told_to(tmp_path, rate):
    """A force F exp(i rate t) on 1 kg for 1 ms, then a swing of 100 rad/s until 10 ms after."""
    path = tmp_path / "study.toml"
    path.write_text(
        'machine = "studies/whip.toml"\n[run]\nkind = "constant"\nspeed = 10\n'
        "settle = 0\nmeasure = 0.01\n"
        f'kick = {{ port = "disc", force = 5.0, rate = {rate}, duration = 0.001 }}\n'
        '[vary]\n"contact[1].mu" = { values = [0.1] }\n'
        '[keep]\nx = { last = "disc.x" }\ny = { last = "disc.y" }\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    impulse = 5e-3 * np.exp(0.5e-3j * rate)
    expected = impulse / 100 * math.sin(100 * 10.5e-3) * math.exp(-5 * 10.5e-3)
    assert complex(data.x.values[0], data.y.values[0]) == pytest.approx(expected, rel=0.03)
