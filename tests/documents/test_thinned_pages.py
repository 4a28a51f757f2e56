"""What the page of a run of many turns, or of a study, still shows, of which it holds a part."""

import numpy as np
import pytest

from rotor_fmu.files import write_text
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.report.criticals import criticals_of
from rotor_fmu.report.run_data import run_data, signal_data
from rotor_fmu.report.run_page import runs_page
from rotor_fmu.report.study_page import study_page
from rotor_fmu.runs.recording import Recording
from rotor_fmu.saved_results import read_study

from ..cli.test_linear_commands import ROSS
from ..recordings import recorded, write_study
from .browser import Page
from .test_report import unpacked


@pytest.fixture(scope="module")
def many_turns():
    """3999 turns with a motion that repeats every second one, and a touch in one of them."""
    phi = np.arange(3999 * 20 + 1) * (2 * np.pi / 20)
    z = 1e-5 * np.exp(1j * phi) + 4e-6 * np.exp(0.5j * phi)
    columns = {"phi": phi, "w": np.full(len(phi), 100.0)}
    columns |= {"disc[1].x": z.real, "disc[1].y": z.imag}
    force = np.where(np.arange(len(phi)) == 1001 * 20 + 7, 239.0, 0.0)
    columns |= {"bearing[1].psi": 0 * phi, "bearing[1].fn": force}
    return run_data(Recording(phi / 100.0, columns, {}, {}))


def test_a_motion_of_two_turns_has_both_its_points_in_the_section(many_turns):
    points = unpacked(many_turns["places"][0]["points"]["re"])
    assert len(points) == len(unpacked(many_turns["turns"]["t"])) <= 2000
    assert np.abs(points - 14.0).min() < 0.01
    assert np.abs(points - 6.0).min() < 0.01


def test_the_largest_force_of_a_single_turn_is_shown(many_turns):
    assert unpacked(many_turns["touches"][0]["peak"]).max() == pytest.approx(239.0, rel=1e-6)


def test_a_page_of_many_places_says_how_many_it_shows_and_has_the_speed_and_all_forces():
    run = recorded()
    moved = {
        f"disc[{n}].{axis}": n * run.columns[f"disc[1].{axis}"]
        for n in range(1, 26)
        for axis in "xy"
    }
    run = Recording(run.t, {**run.columns, **moved}, {}, run.about, "many")
    said = "the pictures are of the 12 of 26 places that move most; the tables have all"
    assert said in runs_page([run], [{}])
    assert "places that move most" not in runs_page([recorded().named("few")], [{}])
    names = [signal["name"] for signal in signal_data(run)["signals"]]
    assert names[0] == "disc[25].x"
    assert names[-2:] == ["bearing[1].fn", "w"]
    assert len(names) == 40


@pytest.mark.parametrize(
    ("speed", "begins"),
    [(-150.0, "Linear critical speeds"), (-400.0, "The lowest 6 linear critical speeds")],
)
def test_critical_speeds_that_are_not_all_shown_are_said_to_be_the_lowest(speed, begins):
    """Of a rotor that is braked through rest: two in each sense, or four."""
    text = load_rotor(ROSS / "under_tension.toml")[0]
    found = criticals_of(recorded(speed=speed, rate=-speed / 3.0, toml=text).named("braked"))
    assert found.sentence.startswith(begins)


def test_a_studys_page_without_room_for_lists_names_them(tmp_path, monkeypatch):
    write_study(tmp_path)
    said = "Without amplitude: there are no values, or more than the page has room for."
    assert said not in study_page(*read_study(tmp_path))
    monkeypatch.setattr("rotor_fmu.report.study_page._MOST_OF_CURVES", 100)
    assert said in study_page(*read_study(tmp_path))


def test_the_rounding_of_a_constant_signal_is_not_drawn_over_the_whole_height(silent, tmp_path):
    run = recorded()
    for name in [name for name in run.columns if name.startswith(("disc", "bearing"))]:
        run.columns.pop(name)
    run.columns["w"] = 250.0 * (1.0 + 1e-14 * np.sin(run.t * 1e3))
    write_text(runs_page([run.named("constant")], [{}]), tmp_path / "constant.html")
    page = Page(silent, tmp_path / "constant.html")
    shown = page.run("return [time.heights.start, time.heights.end]")
    assert shown[1] - shown[0] > 0.5 * abs(shown[0])
