"""`rotor-fmu response` and `rf.response` with what cannot be, and what they write."""

import json
import re
from itertools import cycle
from pathlib import Path

import pytest
from rotor_fmu.model.periodic import laws, queries
from rotor_fmu.model.periodic.starting_points import Persistence
from rotor_fmu.model.simulation import StepFailure

import rotor_fmu as rf
from rotor_fmu.plotting import figure_style

from .machines import jeffcott

JEFFCOTT = Path(rf.__file__).parents[1] / "examples" / "jeffcott_rub" / "jeffcott.toml"
COMMAND = "from rotor_fmu.cli import main; main()"
WHOLE = r", in which a deviation grows (\S+) times"
A_TURN = r": gone to a motion that near, since a deviation grows (\S+) times a turn"


def test_the_command_writes_curve_and_picture(process, tmp_path):
    given = ("--rotor", str(JEFFCOTT), "--speed", "130:220", "--out", str(tmp_path))
    done = process("response", *given, "--step", "1", "--json")
    assert done.returncode == 0, done.stderr
    output = json.loads(done.stdout)
    assert output["parameter"] == "speed"
    assert output == json.loads((tmp_path / "response.json").read_text())
    assert (tmp_path / "response.png").exists()
    (fold,) = [b for b in output["bifurcations"] if b["kind"] == "fold"]
    assert fold["branch"] == 1
    assert fold["multiplier"] == pytest.approx([1.0, 0.0], abs=1e-3)


@pytest.mark.parametrize("compiles", [True, False])
def test_that_the_laws_are_compiled_first_is_said(process, monkeypatch, compiles):
    monkeypatch.setattr(laws, "waits_for_compiler", lambda: compiles)
    done = process("response", "--rotor", str(JEFFCOTT), "--speed", "100:110")
    assert done.returncode == 0
    assert done.stdout.splitlines()[0].endswith("; no bifurcation")
    assert "crossing multiplier" not in done.stdout
    said = "response: compiling the laws of all parts, once on this machine"
    assert (said in done.stderr.splitlines()) == compiles


@pytest.mark.usefixtures("drawn")
def test_a_curve_of_folds_is_drawn_and_said(process, tmp_path):
    given = ("--rotor", str(JEFFCOTT), "--speed", "130:220", "--step", "1")
    second = ("--fold-over", "contact[1].mu=0.04:0.06")
    done = process("response", *given, *second, "--out", str(tmp_path))
    assert done.returncode == 0, done.stderr
    said = r"Folds over contact\[1\].mu: \d+ points from 0.04 to 0.06, end of the range to end of"
    assert re.search(said, done.stdout)
    assert (tmp_path / "response_folds.png").stat().st_size > 10_000
    found = json.loads((tmp_path / "response.json").read_text())["folds"]
    assert found["second"][0] == 0.04
    assert found["first"] == sorted(found["first"], reverse=True)


def test_a_check_of_whirl_is_refused_before_it_is_computed(process, tmp_path):
    asked = ("--speed", "8", "--over", "contact[1].mu=0.05:0.5", "--whirl", "--check")
    done = process("response", "--rotor", str(JEFFCOTT), *asked, "--out", "out")
    assert done.returncode == 2
    assert "--check" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_curve_whose_check_fails_in_time_is_written_and_why_is_said(
    process, tmp_path, monkeypatch
):
    def fails(*_):
        raise StepFailure("step at t = 0.1 s failed")

    monkeypatch.setattr(queries, "integrate_from_orbit", fails)
    asked = ("--speed", "100:110", "--check", "--out", "out")
    done = process("response", "--rotor", str(JEFFCOTT), *asked)
    assert done.returncode == 0, done.stderr
    assert "step at t = 0.1 s failed" in done.stdout
    assert json.loads((tmp_path / "out" / "response.json").read_text())["check"] == []


def test_an_unstable_motion_on_which_the_integrator_stays_says_how_slowly_it_is_left(
    process, monkeypatch
):
    """Or that it has been left, for another one as near as that."""
    reasons = {5: WHOLE, 50: A_TURN}
    turns = cycle(reasons)
    monkeypatch.setattr(
        queries, "integrate_from_orbit", lambda *_: Persistence(next(turns), 1e-7, True)
    )
    asked = ("--speed", "135:150", "--step", "1", "--check")
    done = process("response", "--rotor", str(JEFFCOTT), *asked)
    lines = [line for line in done.stdout.splitlines() if "stays" in line]
    said = []
    for line in lines:
        count = int(re.search(r"after (\d+) turns", line)[1])
        grows = re.search(f"after {count} turns{reasons[count]}$", line)
        assert bool(grows) == ("unstable" in line)
        assert not grows or 1 < float(grows[1]) < 1e6
        said.append((count, bool(grows)))
    assert {*said} == {(5, True), (50, True), (5, False), (50, False)}


def test_a_curve_whose_check_is_stopped_is_written(process, tmp_path, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(queries, "integrate_from_orbit", stopped)
    asked = ("--speed", "100:110", "--check", "--out", "out")
    done = process("response", "--rotor", str(JEFFCOTT), *asked)
    assert done.returncode == 130
    assert {"response.json", "response.png", "response.html"} <= {
        path.name for path in (tmp_path / "out").iterdir()
    }


def test_a_curve_whose_picture_is_stopped_has_its_numbers(process, tmp_path, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(figure_style, "save", stopped)
    asked = ("--speed", "100:110", "--out", "out")
    done = process("response", "--rotor", str(JEFFCOTT), *asked)
    assert done.returncode == 130
    assert done.stderr.splitlines()[-1].startswith("rotor-fmu: stopped")
    assert json.loads((tmp_path / "out" / "response.json").read_text())["branches"]


def test_a_curve_without_a_fold_is_written_and_that_it_has_none_is_said(process, tmp_path):
    second = ("--fold-over", "contact[1].mu=0.01:0.1")
    asked = ("--rotor", str(JEFFCOTT), "--speed", "100:110", *second, "--out", "out")
    done = process("response", *asked)
    assert done.returncode == 0
    assert "--fold-over contact[1].mu: the curve has no smooth fold" in done.stdout.splitlines()
    written = json.loads((tmp_path / "out" / "response.json").read_text())
    assert written["folds"]["first"] == []
    assert written["bifurcations"] == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--speed", "200"), "--speed 200: must be FROM:TO"),
        (("--speed", "-5:200"), "--speed -5:200 rad/s: must not pass through 0"),
        (("--speed", "0:200"), "--speed 0 rad/s: must be at least 1e-06 rad/s in size"),
        (("--speed", "100", "--over", "contact[1].mu"), "must be NAME=FROM:TO"),
        (
            ("--speed", "100", "--over", "contact[1].nu=0:1"),
            "--over contact[1].nu: unknown name; did you mean contact[1].mu",
        ),
        (("--speed", "100", "--over", "contact[1].mu=-1:1"), "contact[1].mu = -1"),
        (("--fold-over", "contact[1].nu=0:1"), "--fold-over contact[1].nu: unknown name; did you"),
        (("--fold-over", "contact[1].mu=1:2"), "contact[1].mu = 1:2: must hold the machine's own"),
        (("--fold-over", "contact[1].mu=-1:1"), "contact[1].mu = -1"),
        (
            ("--speed", "100", "--over=contact[1].mu=0:1", "--fold-over=contact[1].mu=0:1"),
            "contact[1].mu: must be another quantity than the one of the curve",
        ),
        (("--set", "contact[1].mu=0.1", "--set", "contact[1].mu=0.2"), "mu: is given twice"),
        (("--set", "shaft.rotating_damping=on"), "--set shaft.rotating_damping = on: must be true"),
        (("--load", "disc.fx=1", "--load", "disc.fx = 2"), "--load disc.fx: is given twice"),
        (
            ("--speed", "100", "--over=contact[1].mu=0:1", "--set=contact[1].mu=0.5"),
            "contact[1].mu: is varied; it cannot be given one value too",
        ),
        (
            ("--speed=9", "--set=contact[1].exponent=1.5", "--over=contact[1].k=1N/m:2N/m"),
            "--over contact[1].k = 1N/m:2N/m: must be in N/m^1.5",
        ),
        (("--speed", "nan:100"), "--speed nan:100: FROM must be a finite number, not nan"),
        (("--speed", "100rpm:1e999rpm"), "TO must be a finite number, not 1e999rpm"),
        (("--speed", "100:"), "--speed 100:: must be FROM:TO\n"),
        (("--speed", "1e-300:1e-299"), "--speed 1e-300 rad/s: must be at least 1e-06 rad/s"),
        (("--whirl", "--branches"), "--branches: not with whirl"),
        (("--period", "0"), "--period 0: must be"),
        (("--share", "2"), "--share 2: must be"),
        (("--load", "disc=3"), "--load: 'disc' is not a force on a port; there is none"),
        (
            ("--speed", "50:400", "--seed", "1000"),
            "--seed 159.15 Hz: must be from 7.9577 Hz to 63.662 Hz",
        ),
        (("--seed", "3 mm"), "--seed 3 mm: must be a speed of rotation, in rad/s"),
        # of 1 % of paper A's machine: from an eighth of twice its lowest natural frequency
        (
            ("--seed", "9000rpm", "--units", "rpm"),
            "--seed 9000 rpm: must be from 238.73 rpm to 1909.9 rpm",
        ),
    ],
)
def test_what_cannot_be_is_one_line_with_status_2(process, tmp_path, arguments, words):
    out = str(tmp_path / "out")
    done = process("response", "--rotor", str(JEFFCOTT), "--out", out, *arguments)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_speeds_outside_a_table_are_refused():
    table = "[[seal]]\nnode = 2\nspeed = [10.0, 100.0]\nkxx = [1.0, 2.0]\nkyy = 1.0\n"
    machine = rf.parse(jeffcott().toml + table + "cxx = 0.0\ncyy = 0.0\n")
    with pytest.raises(rf.InputError) as refused:
        rf.response(machine, speed=(50.0, 120.0))
    where = "seal[1]: speed 120 rad/s lies outside its table, 10 to 100 rad/s; from there on"
    held = f"{where} its coefficients are those of the end"
    assert str(refused.value) == f"{held}; no periodic response is computed there"


def test_a_machine_that_nothing_holds_is_refused():
    machine = rf.parse(
        "[material]\nyoung = 2.1e11\ndensity = 7800.0\n[shaft]\nnodes = [0.0, 0.2, 0.4]\n"
        "diameters = [0.02, 0.02]\n"
    )
    with pytest.raises(rf.InputError, match="not held"):
        rf.response(machine, speed=(50.0, 120.0))


def test_a_branch_of_too_few_harmonics_says_so_and_keeps_what_it_has():
    result = rf.response(rf.load(), speed=(150.0, 160.0), harmonics=12, step=0.3, stability=False)
    assert any("more than 12 harmonics" in note for note in result.notes)
    assert len(result.points) > 5
