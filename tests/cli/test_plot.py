"""`rotor-fmu plot`: a picture a kind, and one line for what cannot be drawn."""

import numpy as np
import pytest
from typer.testing import CliRunner

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.run_pictures.signal_plots import KINDS, orbit
from rotor_fmu.run_pictures.view import View
from rotor_fmu.runs.recording import Recording
from rotor_fmu.saved_results import read_run
from rotor_fmu.vibration import full_spectrum

from ..recordings import recorded


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("run")
    recorded(parameters={"bearing[1].clearance": 5e-5}).save(path / "recording.npz")
    return path


def plot(*arguments):
    return CliRunner().invoke(app, ["plot", *map(str, arguments)])


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_drawn_into_the_runs_folder(kind, folder):
    result = plot(kind, folder)
    assert result.exit_code == 0, result.output
    assert (folder / f"{kind}.png").exists()


@pytest.mark.usefixtures("drawn")
def test_a_picture_is_a_png(folder):
    assert plot("bode", folder).exit_code == 0
    assert (folder / "bode.png").read_bytes().startswith(b"\x89PNG")


def test_the_place_that_moves_most_is_taken_unless_one_is_named(folder):
    run = read_run(folder)
    assert run.place().name == "disc[2]"
    assert run.place("bearing[1]").clearance == 5e-5
    assert run.contact().label == "bearing 1"


def test_a_centerline_is_of_a_place_in_a_clearance_unless_one_is_named(folder):
    run = read_run(folder)
    labels = [
        KINDS["centerline"](View(run, name)).axes[0].get_xlabel() for name in (None, "disc[2]")
    ]
    assert [label.split(" of ")[1].split(" [")[0] for label in labels] == ["bearing 1", "disc 2"]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("bodde", "."), "centerline; did you mean bode?"),
        (("bode", "nowhere"), "nowhere: is not there"),
        (("bode", "."), "holds no recording.npz"),
        (("orbit", ".", "--speed", "0"), "--speed 0: must not be 0"),
        (("bode", ".", "--speed", "30Hz"), "speed: changes no plot bode, only orbit, spectrum"),
        (("orbit", ".", "--pp"), "is_pp: changes no plot orbit, only bode, polar, cascade, sp"),
        (("energy", ".", "--place", "disc[2]"), "place: changes no plot energy, only bode, p"),
    ],
)
def test_bad_input_is_one_line_that_says_what_is_allowed(arguments, sentence, tmp_path):
    arguments = [str(tmp_path) if a == "." else a for a in arguments]
    result = plot(*arguments)
    assert isinstance(result.exception, InputError)
    assert sentence in str(result.exception)


def test_an_orbit_has_four_turns_about_its_time_with_their_marks():
    """1x of 80 um forward and 20 um backward: at every mark the same place."""
    figure = orbit(View(recorded(), "disc[2]", time=3.0))
    path, marks, rest = figure.axes[0].lines
    expected = 80 * np.exp(-0.6j) + 20
    assert marks.get_xdata() == pytest.approx(np.full(4, expected.real), rel=1e-3)
    assert marks.get_ydata() == pytest.approx(np.full(4, expected.imag), rel=1e-3)
    assert rest.get_xdata()[0] == pytest.approx(expected.real)
    # 240 rad/s at 3 s
    assert len(path.get_xdata()) == pytest.approx(4 * 2 * np.pi / 240 / 1e-3, abs=2)
    assert path.get_label() == "4 turns at 38.19 Hz"


def test_an_orbit_of_few_steps_a_turn_shows_the_steps():
    run = recorded(step=4e-3)
    path, rest = orbit(View(run, "disc[2]", time=6.0)).axes[0].lines
    assert "its corners the steps, 9 a turn" in path.get_label()
    assert path.get_xdata()[-1] == pytest.approx(1e6 * run.columns["disc[2].x"][-1], abs=60)
    assert rest.get_label() == "rest"


def test_an_orbit_of_a_shaft_that_stands_is_all_that_was_recorded():
    t = np.linspace(0.0, 1.0, 50)
    columns = {"phi": 0 * t, "w": 0 * t, "disc.x": 1e-6 * t, "disc.y": -1e-6 * t}
    path, _ = orbit(View(Recording(t, columns, {}, {}), time=1.0)).axes[0].lines
    assert path.get_xdata() == pytest.approx(t)


def test_a_place_that_the_recording_has_not_is_told_its_nearest(folder):
    # the end of the command puts the option in the place of the argument of Python
    no_such = "the recording has no such place"
    said = str(plot("bode", folder, "--place", "disk[2]").exception)
    assert said == f"place = disk[2]: {no_such}; did you mean disc[2], disc[1]?"
    said = str(plot("bode", folder, "--place", "quux").exception)
    assert said == f"place = quux: {no_such}; known: bearing[1], disc[1], disc[2]"


@pytest.mark.parametrize("rate", [0.0, -20.0])
def test_what_a_run_begins_with_is_not_its_largest_1x(rate):
    """100 times the steady 1x at the start, which has decayed by a billion at the end."""
    run = recorded(rate=rate)
    swells = 1 + 100 * np.exp(-10 * run.t) + 3 * np.exp(-((run.t - 3) ** 2)) * (rate != 0)
    for axis in "xy":
        run.columns[f"disc[2].{axis}"] *= swells
    view = View(run, "disc[2]")
    assert view.speed == pytest.approx(300 + 3 * rate, abs=2)
    assert view.turns(4).end == pytest.approx(6 if rate == 0 else 3, abs=0.1)
    amplitude = full_spectrum(*view.signal, view.speed).amplitude.max()
    assert amplitude == pytest.approx(80e-6 if rate == 0 else 4 * 80e-6, rel=0.01)


def test_the_shell_completes_the_places_of_the_run(folder):
    words = f"plot orbit {folder} --place dis"
    given = {
        "_ROTOR_FMU_COMPLETE": "complete_bash",
        "COMP_WORDS": f"rotor-fmu {words}",
        "COMP_CWORD": "5",
    }
    result = CliRunner().invoke(app, [], prog_name="rotor-fmu", env=given)
    assert result.output.split() == ["disc[1]", "disc[2]"]


@pytest.mark.parametrize("kind", ["orbit", "spectrum"])
def test_a_speed_that_the_run_never_had_is_refused_with_those_that_it_had(folder, kind):
    said = str(plot(kind, folder, "--speed", "60Hz").exception)
    assert said == "speed = 60 Hz (376.991 rad/s): the run turns between 28.651 and 47.746 Hz"
    assert plot(kind, folder, "--speed", "300.01").exit_code == 0


@pytest.mark.parametrize("kind", ["orbit", "spectrum"])
def test_a_run_without_a_row_has_no_turn_at_any_speed(tmp_path, kind):
    recorded(stop=0.0).save(tmp_path / "recording.npz")
    for speed in ([], ["--speed", "60Hz"]):
        said = str(plot(kind, tmp_path, *speed).exception)
        assert "the signal holds 0 whole turns of the shaft" in said


@pytest.mark.parametrize(("kind", "needed"), [("bode", 4), ("spectrum", 16), ("cascade", 17)])
def test_a_run_of_less_than_a_block_of_turns_says_how_many_it_has(tmp_path, kind, needed):
    recorded(stop=0.05).save(tmp_path / "recording.npz")
    said = f"holds 2 whole turns of the shaft; needed: {needed}"
    assert said in str(plot(kind, tmp_path).exception)


def test_an_orbit_shows_the_turns_that_there_are(tmp_path):
    recorded(stop=0.05).save(tmp_path / "recording.npz")
    assert plot("orbit", tmp_path).exit_code == 0
