"""Answers say where a table over the speed ends before a speed that they are about: from there on
its values are those of its end."""

import warnings

import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.simulation import RotorWarning

import rotor_fmu as rf
from rotor_fmu.linear.where_linearized import where_beyond_ranges
from rotor_fmu.machine_report.report_page import ReportOptions, machine_report

from ..toml_text import table

SHAFT = table("material", young=2e11, density=7800.0) + table("[section]", length=0.5, outer=0.05)
UNBALANCE = table("[unbalance]", node=1, amount=1e-5)
VARIED = {"speed": [100.0, 300.0], "kxx": [1e7, 2e7], "kyy": [1e7, 2e7]}
MACHINE = SHAFT + UNBALANCE
MACHINE += "".join(
    table("[linear_bearing]", node=node, **VARIED, cxx=1e3, cyy=1e3) for node in (1, 2)
)
LOOP = table("[loop]", sensor=1, magnet=1, kp=1.0, kd=0.0, force_per_current=1.0)
FILM = {"journal_radius": 0.02, "length": 0.02, "clearance": 4e-5, "viscosity": [0.02, 0.01]}
FILMS = "".join(
    table("[journal_bearing]", node=node, **FILM, speed=[100.0, 300.0], short=True)
    for node in (1, 2)
)


def named(speed, part="linear_bearing[1]"):
    return f"{part}: speed {speed} rad/s lies outside its table, 100 to 300 rad/s"


@pytest.mark.parametrize(
    ("arguments", "outside"),
    [
        (["modes", "--speed", "200"], []),
        pytest.param(["modes", "--speed", "400"], ["400"], marks=pytest.mark.slow),
        (["campbell", "--speed", "0:400:5"], ["0", "400"]),
        pytest.param(["unbalance", "--speed", "200:500:5"], ["500"], marks=pytest.mark.slow),
        (["unbalance", "--speed", "200:300:5", "--rated", "190"], []),
        (["unbalance", "--speed", "200:300:5", "--rated", "220"], ["330"]),
        (["static"], ["0"]),
        (["critical-map", "--stiffness", "1e7:1e8:3", "--count", "1"], ["1803"]),
        pytest.param(
            ["frequency-response", "--speed", "400", "--force", "1"],
            ["400"],
            marks=pytest.mark.slow,
        ),
        (["frequency-response", "--speed", "400", "--loop", "loops.toml"], ["400"]),
    ],
)
def test_linear_answers_outside_of_a_table_over_the_speed_say_so(
    command, tmp_path, monkeypatch, arguments, outside
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loops.toml").write_text(LOOP)
    (tmp_path / "tables.toml").write_text(MACHINE)
    said = command(*arguments, "--rotor", "tables.toml", "--out", str(tmp_path))
    assert said.count("linear_bearing[1]: speed") == len(outside)
    assert all(named(speed) in said for speed in outside)


@pytest.mark.parametrize(
    ("load", "parts"),
    [
        (["--load", "10"], ["journal_bearing[1]"]),
        ([], ["journal_bearing[1]", "journal_bearing[2]"]),
    ],
)
def test_a_bearing_alone_says_it_of_its_own_table_and_of_those_that_decide_its_load(
    command, tmp_path, load, parts
):
    (tmp_path / "films.toml").write_text(SHAFT + FILMS)
    said = command(
        "bearing", "--rotor", str(tmp_path / "films.toml"), "--speed", "200:400:3", *load
    )
    assert [line for line in said.splitlines() if "lies outside" in line] == [
        f"{named('400', part)}; from there on its viscosity is that of the end" for part in parts
    ]


def test_a_table_for_either_sense_of_rotation_is_left_between_both():
    """Of speeds from -200 to 200 rad/s it has all but the slow ones."""
    (first, second) = where_beyond_ranges(parse_rotor(SHAFT + FILMS), [-200.0, 0.0, 200.0])
    assert first.startswith(named("0", "journal_bearing[1]"))
    assert second.startswith(named("0", "journal_bearing[2]"))


@pytest.mark.usefixtures("conclusions_alone")
def test_a_report_says_it_up_to_the_trip_speed():
    operation = table("operation", trip_speed=400.0)
    html = machine_report(parse_rotor(MACHINE + operation), ReportOptions(190.0, 190.0)).html
    assert named("400") in html


@pytest.mark.parametrize(
    ("analysis", "arguments", "outside"),
    [
        ("modes", [200.0], []),
        ("modes", [400.0], ["400"]),
        ("campbell", [[200.0, 400.0]], ["400"]),
        ("unbalance_response", [[200.0, 400.0]], ["400"]),
        ("unbalance_check", [190.0, 220.0, [1]], ["330"]),
        ("critical_map", [[1e7, 1e8]], ["2.57e+04"]),
        ("stability", [400.0], ["400"]),
        ("stability", [400.0, 2], ["400"]),
        ("frequency_response", [[50.0], 1, [1]], ["0"]),
        ("static", [], ["0"]),
    ],
)
def test_python_warns_of_it(analysis, arguments, outside):
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        getattr(rf.parse(MACHINE), analysis)(*arguments)
    said = [str(w.message) for w in issued if "linear_bearing[1]" in str(w.message)]
    assert [s.split(";")[0] for s in said] == [named(speed) for speed in outside]
    assert all((w.category, w.filename) == (RotorWarning, __file__) for w in issued)


@pytest.mark.parametrize(("level", "is_said"), [("1", False), ("2", True)])
def test_level_1_says_nothing_of_the_tables_of_seals_which_it_leaves_out(
    command, tmp_path, level, is_said
):
    alike = {"kxx": 1e7, "kyy": 1e7, "cxx": 1e3, "cyy": 1e3}
    bearings = (table("[linear_bearing]", node=node, **alike) for node in (1, 2))
    seal = table("[seal]", node=1, **alike | {"speed": [100.0, 300.0], "kxx": [0.0, 1e3]})
    file = tmp_path / "sealed.toml"
    file.write_text(SHAFT + "".join(bearings) + seal)
    said = command("stability", "--rotor", str(file), "--rated", "400", "--level", level)
    assert ("seal[1]: speed 400 rad/s lies outside its table" in said) == is_said
