"""The settings of the page on which a machine runs: from a file, a recorded run, an address."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from typer.testing import CliRunner

from rotor_fmu.files import write_text
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.live.controls import MOST_ROWS, course, groups, settings_of_run
from rotor_fmu.live.live_page import solver_page, solver_table

from ..recordings import recorded
from .live import LivePage
from .wasm import Native, rows_of


def test_the_value_shown_of_the_machine_file_is_that_of_the_machine_file(silent, tmp_path):
    text = rig_toml().replace("clearance = 50e-6", "clearance = 33.3333333333e-6")
    file = tmp_path / "thirds.html"
    write_text(solver_page(machine_of(text)), file)
    page = LivePage(silent, file).ended()
    page.run("byName.get('bearing[1].clearance').input.id = 'typed'")
    shown = page.find("typed").get_property("value")
    for value in ("40", shown):
        page.set("typed", value, "change")
    assert "bearing[1].clearance" not in page.run("return values")


def test_a_run_that_cannot_begin_is_not_called_running(silent, rig):
    page = LivePage(silent, rig, "#solver.method=99").ended()
    assert page.text("state").startswith("Ended early after ")
    page = LivePage(silent, rig, "#solver.method=1.5")
    assert page.notices() == ["solver.method: must be an integer"]
    assert page.text("state") == "Not run."


def test_every_kind_of_control_reaches_the_fmu(silent, rig):
    page = LivePage(silent, rig).ended()
    page.run("field('auto').checked = false")
    typed = {
        "shaft.eta_h": "0.001",
        "shaft.eta_v": "1e-6",  # with the damping of the rig, which turns, it whirls itself apart
        "solver.preset": "3",
        "disc[2].phase": "90",
        "disc[1].fy": "-5",
    }
    for name, value in typed.items():
        page.set(page.run("return byName.get(arguments[0]).input.id", name), value, "change")
    page.run("byName.get('shaft.rotating_damping').input.click()")
    page.find("run").click()
    page.ended(2)
    given = page.run("return now.given")
    short = {"course.to": 395, "bearing[1].mu": 0.04}  # and the rate, which is the rig's
    phase = given.pop("disc[2].phase")
    assert phase == pytest.approx(np.pi / 2)
    assert given == short | {
        **{"shaft.eta_h": 0.001, "shaft.eta_v": 1e-6, "shaft.rotating_damping": 1},
        **{"disc[1].fy": -5, "solver.preset": 3},
    }
    native = rows_of(Native(solver_table(machine_of())), page.run("return now.plan"))
    lines = list(csv.reader(page.run("return csv(now)").splitlines()))
    assert np.array(lines[1:], float).tobytes() == native.tobytes()


def test_the_page_of_a_recorded_run_begins_with_its_settings(silent, tmp_path):
    from rotor_fmu.cli import app

    sets = ("--set", "bearing[2].mu=0.02", "--set", "solver.tolerance=1e-2")
    run, live = str(tmp_path / "run"), tmp_path / "live.html"
    CliRunner().invoke(app, ["run-down", "--direct", "--stop", "1", *sets, "--out", run])
    CliRunner().invoke(app, ["report", run, "--live", "--out", str(live)])
    page = LivePage(silent, live, "").ended()
    given = page.run("return now.given")
    assert given.pop("course.rate") == pytest.approx(10.0)
    assert given.pop("course.to") == pytest.approx(390.0)
    assert given == {"bearing[2].mu": 0.02, "solver.tolerance": 0.01}
    end = page.run("return [now.t[now.n - 1], column(now, 'disc[3].x')[now.n - 1]]")
    rows = list(csv.DictReader((tmp_path / "run" / "run_down.csv").open()))
    assert end[0] == pytest.approx(float(rows[-1]["time [s]"]))
    # other communication points, the same motion within the tolerance
    assert end[1] == pytest.approx(float(rows[-1]["disc[3].x [m]"]), abs=2e-6)


def test_a_link_to_the_machine_files_settings_holds_against_those_of_a_recorded_run(
    silent, tmp_path
):
    given = {"bearing[2].mu": 0.02, "course.to": 395.0}
    write_text(solver_page(machine_of(), given), tmp_path / "live.html")
    page = LivePage(silent, tmp_path / "live.html", "").ended()
    assert page.run("return values") == given
    page.run("field('auto').checked = false")
    page.find("reset").click()
    page.find("link").click()
    linked = page.run("return location.href").removeprefix((tmp_path / "live.html").as_uri())
    page = LivePage(silent, tmp_path / "live.html", linked)
    assert page.run("return values") == {}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["a", "b", "--live"], "a page on which a machine runs is of one run"),
        (["a", "--live"], "its speed does not change at one rate"),
        (["c", "--live"], "c: disc[1].fy changes from 0 to 10 N; a page holds its loads"),
    ],
)
def test_a_run_that_no_page_repeats_is_refused(tmp_path, monkeypatch, arguments, said):
    from rotor_fmu.cli import app

    monkeypatch.chdir(tmp_path)
    (tmp_path / "bent.csv").write_text("time,speed\n0,400\n0.2,390\n0.5,400\n")
    (tmp_path / "load.csv").write_text("time,speed,disc[1].fy\n0,400,0\n0.5,395,10\n")
    for out, signals in (("a", "bent"), ("b", "bent"), ("c", "load")):
        call = ["run-down", "--direct", "--input", f"{signals}.csv", "--stop", "0.5", "--out", out]
        assert CliRunner().invoke(app, call).exit_code == 0
    done = CliRunner().invoke(app, ["report", *arguments])
    assert said in str(done.exception)
    assert not (tmp_path / "report.html").exists()


def test_the_points_of_a_run_that_is_too_long_are_said_in_few_digits(silent, rig):
    page = LivePage(silent, rig).ended()
    for values, points in (
        ({"course.to": 1e31, "course.rate": 1e30}, "2e+32"),  # 1.9999999999999997e+32
        ({"course.from": 0.0, "course.hold": 400.009}, "400010"),  # 1 ms apart
    ):
        said = f"try {{ planOf(data, {values}) }} catch (error) {{ return error.message }}"
        assert f"would have {points} points" in page.run(said)


def test_a_slider_holds_an_angle_of_more_than_half_a_turn():
    """Written from 0 to 360 degrees, as phases are."""
    for phase in (1.5 * math.pi, -4.0, math.pi):
        toml = rig_toml().replace("[[disc]]\n", f"[[disc]]\nphase = {phase}\n", 1)
        sliders = {c["name"]: c["slider"] for g in groups(machine_of(toml)) for c in g["controls"]}
        slider = sliders["disc[2].phase"]
        assert slider["low"] <= phase <= slider["high"]
        assert slider["high"] - slider["low"] == pytest.approx(2.0 * math.pi)


def test_a_slider_holds_what_the_file_says_and_goes_from_there_as_far_as_a_machine_may():
    machine = machine_of()
    controls = [c for group in groups(machine) for c in group["controls"]]
    sliders = {c["name"]: c["slider"] for c in controls}
    for control in controls:
        if slider := control["slider"]:
            assert slider["low"] <= control["start"] <= slider["high"]
            assert slider["low"] < slider["high"]
    expected = {
        "bearing[1].clearance": (5e-6, 5e-4, True),  # of 50 um, which must be > 0
        "bearing[1].mu": (0.0, 0.2, False),  # of 0.05
        "disc[2].e": (0.0, 3.2e-4, False),  # of 80 um
        "disc[2].phase": (-math.pi, math.pi, False),
        "disc[1].fx": (-60.0, 60.0, False),  # the rotor weighs 55.3 N
    }
    for name, (low, high, log) in expected.items():
        assert sliders[name] == {"low": pytest.approx(low), "high": pytest.approx(high), "log": log}
    (phase,) = [c for c in controls if c["name"] == "disc[2].phase"]
    assert (phase["unit"], phase["factor"]) == ("°", pytest.approx(180.0 / math.pi))
    assert {"loads", "bearing 1", "disc 2", "machine"} <= {
        group["title"] for group in groups(machine)
    }
    # nothing to compare with, and how the solver works
    assert sliders["shaft.eta_h"] is sliders["solver.tolerance"] is None
    assert "speed" not in sliders
    (_, _, rate, hold, _) = course(machine.rotor)["controls"]
    assert rate["slider"] == {"low": 1.0, "high": 100.0, "log": True}
    assert hold["slider"] is None


@pytest.mark.parametrize(
    ("rate", "ramp"),
    [(0.0, {"to": 300.0, "hold": 5.999}), (-20.0, {"to": 180.02, "rate": 20.0})],
)
def test_a_page_repeats_what_was_set_in_a_run_and_the_course_of_its_speed(rate, ramp):
    machine = machine_of()
    given = {"bearing[1].mu": 0.05, "bearing[2].mu": 0.02, "solver.reduction": 3.0}
    run = recorded(rate=rate, parameters=given, loads={"disc[1].fy": [-20.0, -20.0]})
    expected = {"bearing[2].mu": 0.02, "disc[1].fy": -20.0, "course.from": 300.0}
    expected |= {f"course.{name}": value for name, value in ramp.items()}
    assert settings_of_run(run, machine) == pytest.approx(expected)


def test_a_page_repeats_a_run_up_with_a_hold_at_its_end():
    run = recorded(rate=20.0)
    t = np.append(run.t, np.linspace(run.t[-1], run.t[-1] + 2.0, 1001)[1:])
    columns = {name: np.pad(of, (0, 1000), "edge") for name, of in run.columns.items()}
    course = settings_of_run(replace(run, t=t, columns=columns), machine_of())
    expected = {"from": run.w[0], "to": run.w[-1], "rate": 20.0, "hold": 2.0}
    assert course == pytest.approx({f"course.{name}": value for name, value in expected.items()})


@pytest.mark.parametrize("rate", [0.1, 50.0])
def test_a_machine_that_runs_down_for_an_hour_has_no_more_points_than_there_may_be(rate):
    """A turbogenerator loses a revolution a minute each second: the page would open refused."""
    rig = parse_rotor(rig_toml())
    rotor = replace(rig, operation=replace(rig.operation, trip_speed=400.0, run_down_rate=rate))
    chosen = {control["name"]: control["start"] for control in course(rotor)["controls"]}
    ramp = chosen["course.from"] / chosen["course.rate"]
    step = math.tau / chosen["course.from"] / chosen["course.samples"] / math.sqrt(2)
    assert ramp / step <= MOST_ROWS * (1 + 1e-9)
    assert chosen["course.rate"] >= rate
    assert rate < 50 or chosen["course.rate"] == rate
