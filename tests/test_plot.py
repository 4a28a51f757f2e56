"""`rotor-fmu plot`: a picture a kind, and one line for what cannot be drawn."""

import pytest
from typer.testing import CliRunner

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.plotting.signal_plots import KINDS
from rotor_fmu.saved_results.folders import read_run

from .recordings import recorded


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
    assert (folder / f"{kind}.png").read_bytes().startswith(b"\x89PNG")


def test_the_place_that_moves_most_is_taken_unless_one_is_named(folder):
    run = read_run(folder)
    assert run.place().name == "disc[2]"
    assert run.place("bearing[1]").clearance == 5e-5
    assert run.touch().label == "bearing 1"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("bodde", "."), "KIND bodde: did you mean bode?"),
        (("bode", "nowhere"), "nowhere: is not there"),
        (("bode", "."), "holds no recording.npz"),
        (("orbit", ".", "--speed", "0"), "--speed 0: must not be 0"),
    ],
)
def test_bad_input_is_one_line_that_says_what_is_allowed(arguments, sentence, tmp_path):
    arguments = [str(tmp_path) if a == "." else a for a in arguments]
    result = plot(*arguments)
    assert isinstance(result.exception, InputError)
    assert sentence in str(result.exception)


def test_a_place_that_the_recording_has_not_is_told_its_nearest(folder):
    result = plot("bode", folder, "--place", "disk[2]")
    assert "--place disk[2]: the recording has no such place; did you mean disc[2]?" in str(
        result.exception
    )


def test_a_run_of_less_than_a_block_of_turns_says_how_many_it_has(tmp_path):
    recorded(stop=0.05).save(tmp_path / "recording.npz")
    assert "holds 2 whole turns of the shaft; 4 are needed" in str(plot("bode", tmp_path).exception)
