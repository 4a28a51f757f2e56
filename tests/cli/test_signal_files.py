"""Signals from a file drive a run: what they may say, and the line where they cannot be."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.message_templates import Message
from rotor_fmu.model.quantities import LARGEST

import rotor_fmu as rf
from rotor_fmu.fmi.interface import interface
from rotor_fmu.run_status import NOT_CONFIRMED
from rotor_fmu.runs.input_signals import Ramp, Signals, make_signals, read_signals
from rotor_fmu.runs.job import difference, prepare
from rotor_fmu.runs.recording import Recording
from rotor_fmu.runs.run_down import Run
from rotor_fmu.runs.verify_run import apart_from_fmu, doubted


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "is empty"),
        ("time\n", "has no rows"),
        ("speed\n400\n", "column 'time' is missing"),
        ("time,spede\n0,400\n", "column 'spede' is unknown; did you mean speed"),
        ("t,speed\n0,400\n", "column 't' is unknown; known are time, speed, disc[1].fx, "),
        ("time,bearing[1].mu\n0,1\n", "column 'bearing[1].mu' is unknown; known are"),
        ("time,speed [rpm\n0,1\n", "column 'speed [rpm' is unknown; did you mean speed"),
        ("time,speed [mph]\n0,4\n", "column 'speed [mph]': must be a speed of rotation, in"),
        ("time,speed [2 rpm]\n0,4\n", "'speed [2 rpm]': the unit '2 rpm' is unknown; must be"),
        ("time,speed []\n0,4\n", "column 'speed []': must be a speed of rotation, in rad/s"),
        ("# by hand\ntime,speed\n\n0,4\n1,x\n", "line 5: speed = x: must be a finite number"),
        ("time,speed,speed\n0,1,2\n", "column 'speed' is given twice"),
        ("time,speed\n0,400\n1,\n", "line 3: speed = (nothing): must be a finite number"),
        ("time,speed\n0,nan\n", "line 2: speed = nan: must be a finite number"),
        ("time,speed\n0,400\n1\n", "line 3: 1 values, 2 are needed"),
        ("time,speed\n0,400\n0,300\n", "line 3: time = 0 s after 0 s: must increase"),
        ("time,speed\n0,four\n", "line 2: speed = four"),
        ("time,speed\n0,400\n1,-1.1e30\n", "speed = -1.1e+30 rad/s: must not exceed 1e+30 in size"),
        ("time,speed\n0,400\n", "signals.csv: ends at 0 s; give the end of the run as --stop"),
    ],
)
def test_bad_signals_are_refused_in_one_line(input_error, tmp_path, text, expected):
    (tmp_path / "signals.csv").write_text(text)
    assert expected in input_error("run-down", "--input", "signals.csv")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--input", "signals.csv", "--set", "speed=5"], "--set speed: signals.csv gives it too"),
        (["--input", "signals.csv", "--from", "9"], "--from: --input signals.csv gives the speed"),
        (["--set", "speed=5", "--rate", "9"], "--rate: --set speed gives the speed too"),
    ],
)
def test_a_speed_is_given_in_one_way(input_error, tmp_path, arguments, expected):
    (tmp_path / "signals.csv").write_text("time,speed\n0,400\n1,390\n")
    assert expected in input_error("run-down", *arguments)


@pytest.mark.parametrize(
    ("speed", "load", "expected"),
    [
        (1e155, 0.0, "speed = 1e+155 rad/s"),
        (([0.0, 1.0], [100.0, -1.1e30]), 0.0, "speed = -1.1e+30 rad/s"),
        (100.0, -1.1e30, "disc[1].fx = -1.1e+30 N"),
    ],
)
def test_python_refuses_the_sizes_that_an_fmu_refuses(speed, load, expected):
    """Whose rule has one home: `tests/fmu/test_rules.py` has the FMU's."""
    with pytest.raises(rf.InputError) as refused:
        rf.simulate(rf.load(), speed=speed, loads={"disc[1].fx": load}, stop=1.0)
    assert str(refused.value) == f"{expected}: must not exceed {LARGEST:g} in size"


def test_signals_from_a_file_drive_the_run(process, tmp_path):
    (tmp_path / "signals.csv").write_text("time,speed,disc[2].fy\n0,100,5\n1,120,5\n")
    done = process(
        *("run-down", "--input", "signals.csv", "--stop", "1", "--direct", "--out", "."),
    )
    assert done.returncode == 0, done.stderr
    header, *rows = (tmp_path / "run_down.csv").read_text().splitlines()
    last = dict(zip(header.split(","), map(float, rows[-1].split(",")), strict=True))
    assert last["w [rad/s]"] == pytest.approx(120)
    assert last["phi [rad]"] == pytest.approx(110)
    assert last["energy.external_work [J]"] != 0


def test_a_file_without_a_speed_leaves_it_to_the_ramp(process, tmp_path):
    (tmp_path / "loads.csv").write_text("time,disc[2].fy\n0,0\n0.3,5\n")
    ramp = ("--from", "120", "--to", "110", "--rate", "50", "--stop", "0.4")
    done = process("run-down", "--input", "loads.csv", *ramp, "--direct", "--out", ".")
    assert done.returncode == 0, done.stderr
    signals = make_signals(
        interface(rig()),
        0.4,
        {},
        Ramp(120.0, 110.0, 50.0),
        read_signals(tmp_path / "loads.csv", interface(rig())),
    )
    assert [signals.at("disc[2].fy", t) for t in (0.15, 0.3, 0.4)] == pytest.approx([2.5, 5, 5])
    header, *rows = (tmp_path / "run_down.csv").read_text().splitlines()
    run = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    t, w = run[:, 0], run[:, header.split(",").index("w [rad/s]")]
    np.testing.assert_allclose(w, np.maximum(120 - 50 * t, 110), rtol=1e-8)


@pytest.mark.parametrize(
    ("times", "rate"),
    [((0, 2), 5.0), ((3, 5), 0.0), ((-4, -2), 0.0), ((-1, 1), 5.0)],
)
def test_a_speed_does_not_change_before_the_first_time_that_is_given(tmp_path, times, rate):
    """Nor after the last; what is held until then begins without a rate."""
    rows = "".join(f"{t},{100 + 10 * i}\n" for i, t in enumerate(times))
    (tmp_path / "in.csv").write_text(f"time,speed\n{rows}")
    assert read_signals(tmp_path / "in.csv", interface(rig())).first_rate == rate


def test_an_fmu_follows_a_steady_change_of_speed_under_constant_loads():
    ramp = Ramp(400.0, 380.0, 10.0).signals(2.0)
    assert ramp.is_held(2.0)  # to its end, where it bends
    assert ramp.is_held(1.0)
    assert not ramp.is_held(3.0)
    for load, is_held in (([1.0, 1.0], True), ([0.0, 1.0], False)):
        columns = {"disc[1].fx": np.array(load)}
        assert Signals(ramp.t, columns | dict(ramp.values)).is_held(1.0) == is_held


def test_runs_differ_at_their_ends_by_a_share_of_each_column():
    def run(t, **columns):
        return Run(np.array(t), {n: np.array(c) for n, c in columns.items()}, "ok", (), 0.0)

    driven = run([0.0, 1.0], x=[-4.0, 2.0], y=[0.0, 0.0])
    assert difference(driven, run([0.0, 1.0], x=[3.0, 1.0], y=[0.0, 0.0])) == 0.25
    assert difference(driven, run([0.0], x=[-4.0], y=[0.0])) == math.inf
    assert difference(run([], x=[], y=[]), run([0.0], x=[-4.0], y=[0.0])) == 0.0
    counted = {"x": [4.0], "solver.rejected": [21.0]}
    assert (
        difference(run([0.0], **counted), run([0.0], **counted | {"solver.rejected": [17.0]}))
        == 0.0
    )


def test_signals_in_other_units_and_spelling_are_the_same_signals(tmp_path):
    (tmp_path / "one.csv").write_text("time,speed,disc[1].fx\n0.25,300,0\n1.5,30,44.482216152605\n")
    other = "# by hand\ntime [ms];speed [rpm];disc[1].fx [lbf]\n250;{};0\n\n1500;{};10\n"
    first, second = (f"{v * 30 / math.pi:.17g}".replace(".", ",") for v in (300, 30))
    (tmp_path / "other.csv").write_text(other.format(first, second))
    one, two = (
        read_signals(tmp_path / f"{name}.csv", interface(rig())) for name in ("one", "other")
    )
    np.testing.assert_allclose(two.t, one.t, rtol=1e-12)
    for name in ("speed", "disc[1].fx"):
        np.testing.assert_allclose(two.values[name], one.values[name], rtol=1e-12)


@pytest.mark.parametrize("way", ["run-down", pytest.param("run-up", marks=pytest.mark.slow)])
def test_a_run_ends_with_its_signals_unless_a_stop_is_given(process, tmp_path, way):
    """Signals of loads alone too, whose speed is the start value."""
    for header, first in (("speed", 100), ("disc[2].fy", 0)):
        (tmp_path / "in.csv").write_text(f"time,{header}\n0,{first}\n0.013,{first + 1}\n")
        done = process(way, "--input", "in.csv", "--direct", "--out", ".")
        assert done.returncode == 0, done.stderr
        assert "The run was to end at 0.013 s, the last time of in.csv." in done.stdout
        summary = json.loads((tmp_path / "summary.json").read_text())
        assert (summary["stop_s"], summary["stop_by"]) == (0.013, "the last time of in.csv")
        rows = (tmp_path / f"{way.replace('-', '_')}.csv").read_text().splitlines()
        assert float(rows[-1].split(",")[0]) == pytest.approx(0.013, rel=1e-9)


def test_signals_that_end_before_the_run_are_said_to_be_held(process, tmp_path):
    (tmp_path / "signals.csv").write_text("time,speed\n0,100\n0.01,100\n")
    done = process(
        *("run-down", "--input", "signals.csv", "--stop", "0.02", "--direct", "--out", "."),
    )
    assert done.returncode == 0, done.stderr
    assert (
        "signals.csv ends at 0.01 s; its last values are held until --stop = 0.02 s" in done.stderr
    )


@pytest.mark.parametrize(
    ("first", "expected"),
    [
        ("-1", "begins at -1 s; a run begins at 0 s, and what lies before is left out"),
        ("0", ""),
        ("0.005", "begins at 0.005 s; its first values are held from 0 s until then"),
    ],
)
def test_signals_that_do_not_begin_with_the_run_are_said_to(tmp_path, capsys, first, expected):
    file = tmp_path / "signals.csv"
    file.write_text(f"time,speed\n{first},100\n0.01,100\n")
    prepare(None, None, [], file, None, None)
    said = f"rotor-fmu: warning: {file} {expected}\n" if expected else ""
    assert capsys.readouterr().err == said


def test_a_run_under_loads_over_time_is_the_exact_one_whatever_its_step(process, tmp_path):
    """The FMU holds its loads over a step: it is driven beside, and where its amplitudes are others
    that is said. With the shorter step it ends elsewhere, but moves as far within 2 %."""
    t = np.linspace(0.0, 0.2, 101)
    rows = np.column_stack([t, np.full(101, 150.0), 30 * np.cos(180 * t), 30 * np.sin(180 * t)])
    text = "time,speed,disc[2].fx,disc[2].fy\n" + "".join(
        ",".join(map(repr, row)) + "\n" for row in rows.tolist()
    )
    (tmp_path / "loads.csv").write_text(text)
    ends = []
    for step in ("0.004", "0.001"):
        given = ("--input", "loads.csv", "--stop", "0.2", "--step", step, "--out", ".")
        done = process("run-down", *given)
        assert done.returncode == 0, done.stderr
        is_said = "the FMU, which holds its inputs over a communication step, gives " in done.stderr
        assert is_said == (step == "0.004")
        names, *_, last = (tmp_path / "run_down.csv").read_text().splitlines()
        ends.append(float(last.split(",")[names.split(",").index("disc[3].x [m]")]))
        assert json.loads((tmp_path / "summary.json").read_text())["recorded_apart"] > 1e-3
    assert ends[0] == pytest.approx(ends[1], rel=2e-3)


@pytest.mark.parametrize(
    ("share", "doubt"), [(1.01, ""), (1.05, "gives disc.x_amp = 10.5 um at most, ")]
)
def test_a_run_whose_amplitudes_the_fmu_does_not_confirm_is_doubtful(share, doubt):
    """Not one that ends elsewhere, as a chaotic rub does which moves as far."""
    t, job = np.array([0.0, 1.0]), prepare(None, None, [], None, 1.0, None)
    ends = {"disc.x": 8e-6, "disc.y": 0.0, "disc.x_amp": 1e-5, "disc.y_amp": 1e-5}
    columns = {name: np.full(2, end) for name, end in ends.items()}
    recorded = Run(t, columns, "ok", (), 0.0)
    driven = replace(recorded, columns={n: share * of for n, of in columns.items()})
    driven.columns["disc.x"][:] = -8e-6
    said = apart_from_fmu(job, driven, recorded)
    assert said == (f"{doubt}without it 10 um" if doubt else "")
    about = {"status": "ok", "messages": [], "codes": []}
    recording = Recording(t, columns, {}, about)
    run, recording = doubted(driven, recording, Message(f"not confirmed: {said}", NOT_CONFIRMED))
    assert run.status == recording.about["status"] == "doubtful: not-confirmed"
    assert recording.about["codes"] == [NOT_CONFIRMED]
