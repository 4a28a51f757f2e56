"""A run held against the same run, finer: what is confirmed, and what is not."""

import json
import math
import re
from importlib import import_module

import pytest
from rotor_fmu.model.settings import PRESETS, choose
from rotor_fmu.model.simulation import RotorWarning

import rotor_fmu as rf
from rotor_fmu import studies
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.runs.run_down import Run
from rotor_fmu.runs.verify_run import CONFIRMED, NOT_CONFIRMED, SENSITIVE, compare
from rotor_fmu.studies.runner import run_study

from ..studies.functions import here, quiet
from ..toml_text import table

RAMP = ([0.0, 0.5], [220.0, 215.0])


def test_steps_that_end_on_another_solution_are_not_confirmed():
    with (
        pytest.warns(RotorWarning, match="too coarse in contact"),
        pytest.warns(RotorWarning, match=r"not confirmed: the same run with solver\.h = 0\.002"),
    ):
        run = rf.simulate(rf.load(), speed=RAMP, preset="paper", verify=True)
    assert run.codes == ("too-coarse-in-contact", "not-confirmed")
    assert run.verification["conclusion"] == NOT_CONFIRMED
    assert run.status == "doubtful: too-coarse-in-contact, not-confirmed"
    assert run.verification["finer"] == {"solver.h": 0.002}


def test_a_tolerance_is_confirmed_by_a_tenth_of_it_and_both_stand_side_by_side():
    run = rf.simulate(rf.load(), speed=RAMP, tolerance=1e-3, verify=True)
    finer = rf.simulate(rf.load(), speed=RAMP, tolerance=1e-4)
    assert run.verification["conclusion"] == CONFIRMED
    assert run.status == run.verification["finer_status"] == "ok"
    for rows, own, other in (
        (run.verification["peaks"], max, max),
        (run.verification["final"], lambda column: column[-1], lambda column: column[-1]),
    ):
        assert rows
        for row in rows:
            assert row["value"] == own(run.points.columns[row["name"]])
            assert row["finer"] == other(finer.points.columns[row["name"]])
    assert rf.simulate(rf.load(), speed=RAMP).verification is None


LENGTH = 1.0  # of the shaft [m]


def ended_at(x, amplitude, scale=1.0):
    """A run of a part that ends there."""
    columns = {"a.x_amp": [0.5, amplitude], "a.y_amp": [0.5, 0.1], "a.x": [0.0, x], "a.y": [0.0, 0]}
    columns = {name: [scale * value for value in column] for name, column in columns.items()}
    return Run([0.0, 1.0], columns, "ok", (), 0.0)


@pytest.mark.parametrize(
    ("x", "amplitude", "expected"),
    [
        (1.0, 1.0, CONFIRMED),
        (1.05, 1.01, CONFIRMED),
        (0.0, 1.01, SENSITIVE),
        (1.0, 1.05, NOT_CONFIRMED),
        (1.0, math.nan, NOT_CONFIRMED),
    ],
)
def test_what_follows_from_two_runs(x, amplitude, expected):
    for scale in (1.0, 1e-5):
        one, other = ended_at(1.0, 1.0, scale), ended_at(x, amplitude, scale)
        assert compare(one, other, choose(), LENGTH).conclusion == expected


def test_a_part_that_hardly_moves_is_confirmed():
    one, other = (ended_at(x, x, 1e-10) for x in (1.0, 1.3))
    assert compare(one, other, choose(), LENGTH).conclusion == CONFIRMED


def test_the_command_tells_it_in_words_and_in_the_summary(tmp_path, command):
    words = command("run-down", "--direct", "--verify", "--stop", "0.2")
    figures = json.loads((tmp_path / "out" / "summary.json").read_text())["verification"]
    assert f"{figures['conclusion']}, by the same run with solver.tolerance = 0.0001: ok" in words
    assert "disc[3].x_amp, largest" in words
    assert "finer run" in (tmp_path / "out" / "report.html").read_text()


def test_it_is_told_in_the_units_chosen(tmp_path, command):
    words = command("run-down", "--direct", "--verify", "--units", "mil", "--stop", "0.2")
    figures = json.loads((tmp_path / "out" / "summary.json").read_text())["verification"]
    largest = figures["peaks"][0]
    mils = [f"{largest[of] / 25.4e-6:.5g}" for of in ("value", "finer")]
    row = re.search(rf"{re.escape(largest['name'])}, largest (.*)", words)[1]
    assert row.split()[:2] == mils
    assert "this run [mil]  finer run [mil]  difference [%]" in words
    page = (tmp_path / "out" / "report.html").read_text()
    assert '<th scope="col">finer run [mil]</th>' in page
    assert f">{largest['name']}, largest</td><td>{mils[0]}</td><td>{mils[1]}</td>" in page


def test_a_tolerance_that_has_no_tenth_is_refused_before_anything_is_run(refusal):
    said = refusal("run-down", "--verify", "--set", "solver.tolerance=2e-9", "--stop", "1")
    assert re.search(r"a finer run .*: solver.tolerance = 2e-10: must be", said)


def test_so_does_the_python_interface(monkeypatch):
    monkeypatch.setattr(import_module("rotor_fmu.api.simulate"), "run_recorded", pytest.fail)
    with pytest.raises(rf.InputError, match=r"a finer run .*: solver.tolerance = 2e-10: must be"):
        rf.simulate(rf.load(), speed=RAMP, tolerance=2e-9, verify=True)


CHOICES = [list(PRESETS).index(name) for name in ("controlled", "paper")]
STUDY = f"""
machine = "rig"
verify = true
[run]
kind = "run-down"
from = 220
to = 215
rate = 10
[vary]
"solver.preset" = {{ values = {CHOICES} }}
[keep]
X = {{ peak = "disc[3].x" }}
"""


def test_a_study_says_how_far_each_run_is_from_a_finer_one(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    near, far = data.verification.values
    assert near < 0.01 < 0.05 < far
    assert list(data.status.values) == ["ok", "doubtful: too-coarse-in-contact, not-confirmed"]


STILL = (
    table("material", young=2.1e11, density=7800.0)
    + table("shaft", nodes=[0.0, 0.5, 1.0], diameters=[0.05, 0.05], eta_v=2e-4)
    + table("[disc]", node=2, diameter=0.3, width=0.05, e=1e-5)
    + "".join(table("[support]", node=n, stiffness=1e7, damping=1e4) for n in (1, 3))
)


def test_a_part_of_a_motion_that_is_none_does_not_make_a_run_of_a_study_doubtful(tmp_path):
    (tmp_path / "still.toml").write_text(STILL)
    path = tmp_path / "study.toml"
    path.write_text(
        """
machine = "still.toml"
verify = true
[run]
kind = "constant"
speed = 100
settle = 2
turns = 16
per_turn = 64
[vary]
"disc[1].e" = { values = [1e-5] }
[keep]
whole = { order = 1, of = "disc[1].x" }
half = { order = 0.5, of = "disc[1].x" }
turned = { whirl = "disc[1]" }
"""
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    assert 0 < data.half.values[0] < 1e-8 < 1e-6 < data.whole.values[0]
    assert 0 < abs(data.turned.values[0]) < 1e-2  # of an orbit beside the axis; the shaft's is 100
    assert list(data.status.values) == ["ok"]


def test_a_study_verifies_or_not(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY.replace("true", '"yes"'))
    with pytest.raises(rf.InputError, match="verify = 'yes': must be true or false"):
        read_study(path)
