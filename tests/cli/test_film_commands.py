"""The linear commands on machines in films: what is linearized, where, and from which speed on."""

import json
import math
from importlib import import_module

import numpy as np
import pytest
from rotor_fmu.model import linear
from rotor_fmu.model.machine.toml import rig

from rotor_fmu.cli import linear as cli_linear
from rotor_fmu.linear import answers
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.machine_report.report_page import ReportOptions, machine_report
from rotor_fmu.operating_speeds import operating_speeds

from ..known import EXAMPLES

OIL_FILM = EXAMPLES / "oil_film" / "rotor.toml"
TURBOCHARGER = EXAMPLES / "turbocharger" / "rotor.toml"
PNG = b"\x89PNG"


@pytest.mark.usefixtures("drawn")
def test_a_bearing_is_told_with_a_table_that_the_linear_commands_take(command, tmp_path):
    table = tmp_path / "linear.toml"
    said = command(
        "bearing", "--rotor", str(OIL_FILM), "--speed", "300:900:4", "--table", str(table)
    )
    assert "journal_bearing[1]: a mass of" in said
    assert (tmp_path / "out" / "bearing.png").read_bytes().startswith(PNG)
    values = json.loads((tmp_path / "out" / "bearing.json").read_text())
    assert max(values["plane_error"]) < 0.03
    # the machine with its films, and with what was written in their place, at a speed of the table
    machine = OIL_FILM.read_text().split("[[journal_bearing]]")[0]
    written = table.read_text()
    linear = machine + written + written.replace("z = 0.0", "z = 0.5")
    (tmp_path / "replaced.toml").write_text(linear)
    roots = [answers.modes(path, 500.0) for path in (OIL_FILM, tmp_path / "replaced.toml")]
    np.testing.assert_allclose(roots[1].damped[:4], roots[0].damped[:4], rtol=2e-4)


def test_a_rotor_that_turns_backwards_has_its_critical_speeds_and_threshold_mirrored():
    """They are looked for from the slowest speed on, and excited at a frequency above 0."""
    ahead, back = (
        answers.campbell(OIL_FILM, np.linspace(*ends, 6), count=4)
        for ends in ((300.0, 1500.0), (-1500.0, -300.0))
    )
    assert back.threshold == pytest.approx(-ahead.threshold, rel=1e-9)
    said = ahead.table().title.partition("; ")[2]
    assert said.startswith("unstable above ")
    assert back.table().title.endswith(said)
    circles = [
        sorted(
            line.get_xydata()[0].tolist()
            for line in of.figure().axes[0].lines
            if line.get_marker() == "o"
        )
        for of in (ahead, back)
    ]
    assert circles[0]
    np.testing.assert_allclose([[-x, y] for x, y in circles[1]][::-1], circles[0], rtol=1e-6)


def test_the_linear_commands_name_the_films(command):
    said = command("modes", "--rotor", str(OIL_FILM), "--speed", "400")
    assert "where its journal rests at that speed: journal_bearing[1], journal_bearing[2]" in said
    assert "in the middle of its clearance, since at standstill it carries nothing: journal" in (
        command("modes", "--rotor", str(OIL_FILM), "--speed", "0")
    )
    rings = "at that speed: floating_ring_bearing[1], floating_ring_bearing[2]"
    assert rings in command("modes", "--rotor", str(TURBOCHARGER), "--speed", "60000rpm")


@pytest.mark.parametrize("more", [["modes"], ["frequency-response", "--force", "1"]])
def test_a_machine_that_oil_films_hold_is_looked_at_at_its_rated_speed(more, command):
    """In the middle of their clearances films have a damping that no speed of the machine has."""
    files = "--rotor", str(OIL_FILM)
    assert command(*more, *files) == command(*more, *files, "--speed", "740")


def test_a_machine_that_oil_films_hold_is_at_rest_at_its_rated_speed():
    """At standstill none carries it; its weight is borne whatever the speed."""
    rated = answers.static(OIL_FILM)
    assert rated.speed > 0.0
    weight = load_rotor(OIL_FILM)[1].gravity * (4.0 + 0.5 * math.pi / 4 * 0.02**2 * 7850.0)
    assert -rated.load_y.sum() == pytest.approx(weight, rel=1e-9)
    assert answers.static(rig()).speed == 0.0
    with pytest.raises(ValueError, match="not held"):
        answers.static(OIL_FILM, 0.0)


def test_a_machine_that_more_than_oil_films_holds_is_looked_at_at_its_rated_speed(tmp_path):
    """At standstill its journals lie on the walls behind their films."""
    rotor = tmp_path / "rotor.toml"
    support = "[[support]]\nz = 0.25\nstiffness = 1e5\ndamping = 10.0\n"
    rotor.write_text(f"{OIL_FILM.read_text()}\n{support}{support.replace('0.25', '0.375')}")
    assert answers.static(rotor, 0.0).load_y[-1] < 0.0
    rated = operating_speeds(load_rotor(rotor)[1]).rated
    assert (answers.modes(rotor).speed, answers.static(rotor).speed) == (rated, rated)


@pytest.fixture
def with_seal(tmp_path):
    """The machine in two films, with seals that have some stiffness at standstill too, too little
    to keep its journals off the bearings."""
    seals = "".join(
        f"[[seal]]\nnode = {node}\nkxx = 2e4\nkyy = 2e4\ncxx = 10.0\ncyy = 10.0\n"
        for node in (3, 5)
    )
    rotor = tmp_path / "rotor.toml"
    rotor.write_text(f"{OIL_FILM.read_text()}\n{seals}".replace("k = 1e8", ""))
    return rotor


def test_a_machine_that_seals_do_not_lift_is_at_rest_at_its_rated_speed(with_seal):
    assert answers.static(with_seal).speed == operating_speeds(load_rotor(with_seal)[1]).rated
    with pytest.raises(ValueError, match=r"its film carries nothing.*; give a speed above 0"):
        answers.static(with_seal, 0.0)


@pytest.mark.slow
@pytest.mark.usefixtures("coarse_report")
def test_the_report_has_the_machine_at_rest_at_the_speed_that_was_asked(with_seal):
    report = machine_report(load_rotor(with_seal)[1], ReportOptions(300.0, 400.0))
    assert "At rest, 63.662 Hz (400 rad/s)" in report.html
    assert "oil films, each linearized where its journal rests at that speed" in report.html


@pytest.mark.usefixtures("without_peaks")
@pytest.mark.parametrize(
    "shape",
    [
        pytest.param("", marks=pytest.mark.slow),
        'offset = 1.0\npads = [1.5708, 4.71239]\narc = 2.8\nrupture = "guembel"\n',
    ],
)
def test_the_usual_speeds_begin_where_the_films_carry_the_machine(
    command, tmp_path, monkeypatch, shape
):
    """Slower, a film without a contact behind it would be thinner than its roughness. Where they
    begin does not depend on how many they are."""
    monkeypatch.setattr(cli_linear, "_SPEEDS", 5)
    monkeypatch.setattr(import_module("rotor_fmu.model.linear.unbalance_check"), "SPEEDS", 5)
    rotor = tmp_path / "rotor.toml"
    rotor.write_text(OIL_FILM.read_text().replace("k = 1e8", "").replace("mu = 0.1", shape))
    for name in ("campbell",) if shape else ("campbell", "unbalance"):
        command(name, "--rotor", str(rotor))
        speeds = json.loads((tmp_path / "out" / f"{name}.json").read_text())["speeds"]
        assert 0.0 < speeds[0] < 0.2 * speeds[-1]
        with pytest.raises(ValueError, match=r"no equilibrium|no static equilibrium"):
            answers.unbalance_response(rotor, [0.5 * speeds[0]])
    assert linear.lowest_speed(load_rotor(OIL_FILM)[1], 1000.0) == 0.0
    assert linear.lowest_speed(rig(), 1000.0) == 0.0


def test_a_place_that_is_not_there_is_named_before_a_missing_equilibrium(refusal, tmp_path):
    rotor = tmp_path / "rotor.toml"
    rotor.write_text(OIL_FILM.read_text().replace("k = 1e8", "").replace("mu = 0.1", ""))
    for force, message in (("nowhere", "--force nowhere"), ("1", "no equilibrium")):
        arguments = ("--rotor", str(rotor), "--force", force, "--speed", "1")
        assert message in refusal("frequency-response", *arguments)


@pytest.mark.usefixtures("without_peaks")
def test_the_response_to_unbalance_begins_at_standstill_on_oil_films_too(command):
    said = command("unbalance", "--rotor", str(OIL_FILM), "--speed", "0:200:3", "--node", "3")
    assert "contacts open" in said
    assert "unstable" not in said
    result = answers.unbalance_response(OIL_FILM, [0.0, 1.0, 200.0])
    assert not result.x[0].any()
    assert not result.load_x[0].any()
    # as the square of the speed, while the film's stiffness hardly counts beside the shaft's
    assert 0.0 < np.abs(result.x[1]).max() < 1e-2 * np.abs(result.x[2]).max()


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (
            ["--speed", "300", "--bearing", "bearing[9]"],
            "bearing[9]: must be one of journal_bearing",
        ),
        (["--speed", "300", "--load", "-1"], "--load -1: must be > 0"),
        (["--speed", "slow"], "--speed slow: must be a number"),
    ],
)
def test_impossible_bearings_are_refused(refusal, arguments, expected):
    assert expected in refusal("bearing", "--rotor", str(OIL_FILM), *arguments)


def test_a_load_past_the_film_is_refused_with_what_it_carries(command, tmp_path):
    text = OIL_FILM.read_text().replace("k = 1e8", "")
    (tmp_path / "open.toml").write_text(text)
    with pytest.raises(ValueError, match=r"its load is 1e\+05 N, and its film carries [\d.]+ N"):
        command(
            "bearing", "--rotor", str(tmp_path / "open.toml"), "--speed", "300", "--load", "1e5"
        )
