"""Runs of a machine as rows: what is kept of them, and that a row can be run again."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu import studies
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.machine_studies.metric import Metric
from rotor_fmu.machine_studies.run_excitation import Excitation, Samples, Window
from rotor_fmu.machine_studies.run_kinds import CONSTANT, STEPS
from rotor_fmu.machine_studies.run_metrics import KINDS, cell
from rotor_fmu.report.criticals import criticals_of
from rotor_fmu.runs.recording import load_recording
from rotor_fmu.studies.runner import run_study

from .functions import conducted, here, quiet

EXAMPLES = Path(__file__).parents[2] / "examples"
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


def test_a_switch_that_is_varied_does_what_it_does_where_it_is_fixed(tmp_path_factory):
    def peaks(tables):
        ramp = '[run]\nkind = "run-up"\nfrom = 60\nto = 70\nrate = 25\n'
        kept = '\n[keep]\nX = { peak = "disc[3].x_amp" }\n'
        return conducted(ramp + tables + kept, tmp_path_factory.mktemp("switch"))[2].X.values

    switch, other = '"shaft.rotating_damping"', '[vary]\n"shaft.mass_damping" = { values = [0.0] }'
    off, on = peaks(f"[vary]\n{switch} = {{ values = [false, true] }}")
    assert off != on
    assert [off] == peaks(f"[set]\n{switch} = false\n{other}")
    assert [on] == peaks(f"[set]\n{switch} = true\n{other}")


def test_the_page_of_a_selected_run_has_the_critical_speeds_of_its_switch(tmp_path):
    def criticals(table, value, values):
        path = tmp_path / "study.toml"
        path.write_text(RIG.replace(table, f'{table}\n"shaft.rotating_damping" = {value}'))
        return criticals_of(read_study(path).model.record(values).named("switched")).hz

    found = criticals("[vary]", "{ values = [true] }", {"shaft.rotating_damping": 1.0})
    assert found == criticals("[set]", "true", {}) != ()


def test_friction_at_turning_races_adds_up_to_the_ledger(tmp_path):
    _, _, data = conducted(
        'machine = "drop/compressor.toml"\n[run]\nkind = "drop"\nspeed = 500\nstop = 0.03\n'
        '[vary]\n"solver.tolerance" = { values = [1e-3] }\n[keep]\n'
        'one = { dissipated = "touchdown_bearing[1]" }\n'
        'other = { dissipated = "touchdown_bearing[2]" }\n'
        'loss = { last = "energy.friction_loss" }\n',
        tmp_path,
    )
    assert data.loss.values > 1
    assert (data.one + data.other).values == pytest.approx(data.loss.values, rel=1e-2)


def test_friction_at_a_worn_wall_adds_up_to_the_ledger(tmp_path):
    # along a wall that recedes from the circle a journal slides by much of its radial motion
    whip = (EXAMPLES / "studies" / "whip.toml").read_text(encoding="utf-8")
    worn = whip.replace("v_s = 1e-4", "v_s = 1e-4\nwear = 1e-3\nwear_power = 4.0")
    (tmp_path / "worn.toml").write_text(worn, encoding="utf-8")
    (tmp_path / "push.csv").write_text(
        "time,speed,disc.fx,disc.fy\n0,10,0,-150\n0.05,10,150,0\n0.1,10,0,0\n1,10,0,0\n",
        encoding="utf-8",
    )
    _, _, data = conducted(
        'machine = "worn.toml"\n[run]\nkind = "signals"\nfile = "push.csv"\nstop = 1\n'
        'step = 2e-3\n[vary]\n"contact[1].mu" = { values = [0.2] }\n[keep]\n'
        'one = { dissipated = "contact[1]" }\nloss = { last = "energy.friction_loss" }\n',
        tmp_path,
    )
    assert data.loss.values > 0.5
    assert data.one.values == pytest.approx(data.loss.values, rel=1e-3)


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
    assert data["1x at 190"].long_name.endswith("passed, 0-p, of disc[3].x")
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
    law = 'distribution = "normal", mean = -1e-6, std = 1e-8'
    path.write_text(
        RIG.replace("values = [40e-6, 60e-6]", law) + '[design]\nkind = "random"\nsize = 1\n'
    )
    said = input_error("study", str(path), "--out", str(tmp_path / "out"), "--select", "0")
    assert "clearance" in said
    assert list(tmp_path.iterdir()) == [path]


def test_a_machine_that_cannot_be_is_a_failed_row_with_its_reason(tmp_path):
    path = tmp_path / "study.toml"
    law = 'distribution = "normal", mean = -1e-6, std = 1e-8'
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
    jumps = [Metric("q", KINDS["jump"], "d.x", (("way", way),)) for way in ("up", "down")]
    assert [cell(jump, seen, steps) for jump in jumps] == [sense * 2.5, sense * 1.5]
    for jump, way in zip(jumps, ("up", "down"), strict=True):  # on the way up it falls
        assert jump.column("m", None).text.endswith(f"of the mean of d.x on the way {way}")


@pytest.mark.parametrize("per_turn", [8, 256])
def test_peak_rms_mean_and_whirl_of_a_circle(per_turn):
    circle = {"d.x": lambda a: 2 * np.cos(-a), "d.y": lambda a: 2 * np.sin(-a)}
    seen = [window(circle, per_turn=per_turn)]
    assert cell(Metric("q", KINDS["whirl"], "d"), seen, HELD) == pytest.approx(-10.0)
    assert cell(Metric("q", KINDS["peak"], "d.x"), seen, HELD) == pytest.approx(2.0)
    assert cell(Metric("q", KINDS["rms"], "d.x"), seen, HELD) == pytest.approx(math.sqrt(2))
    assert cell(Metric("q", KINDS["mean"], "d.r"), seen, HELD) == pytest.approx(2.0)
