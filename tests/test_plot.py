"""`rotor-fmu plot`: a picture a kind, and one line for what cannot be drawn."""

import numpy as np
import pytest
from typer.testing import CliRunner

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.look.reading import read_run
from rotor_fmu.report.figures import KINDS
from rotor_fmu.runs.recording import Recording


def recorded(stop=6.0, step=1e-3, **about):
    """A run-down with orders in closed form, a contact and two sinks."""
    t = np.arange(0.0, stop, step)
    phi = 300.0 * t - 10.0 * t**2
    z = 40e-6 * np.exp(1j * (phi - 0.6)) + 10e-6 * np.exp(-1j * phi)
    columns = {"phi": phi, "w": 300.0 - 20.0 * t}
    for name, of in (("disc[1]", z), ("disc[2]", 2 * z), ("bearing[1]", 0.5 * z)):
        columns |= {f"{name}.x": of.real, f"{name}.y": of.imag}
    columns["bearing[1].psi"] = np.mod(np.angle(z), 2 * np.pi)
    columns["bearing[1].fn"] = np.where(z.real > 0, 5.0, 0.0)
    columns["energy.friction_loss"] = 2.0 * t
    columns["energy.structure_loss"] = 0.5 * t
    units = dict.fromkeys(columns, "m") | {"phi": "rad", "w": "rad/s"}
    return Recording(t, columns, units, {"machine": "closed form", "status": "ok", **about})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("run")
    recorded(parameters={"bearing[1].clearance": 5e-5}).save(path / "recording.npz")
    return path


def plot(*arguments):
    return CliRunner().invoke(app, ["plot", *map(str, arguments)])


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_drawn_into_the_runs_folder(kind, folder):
    found = plot(kind, folder)
    assert found.exit_code == 0, found.output
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
        (("orbit", ".", "--speed", "-1"), "--speed -1 Hz: must be > 0"),
    ],
)
def test_bad_input_is_one_line_that_says_what_is_allowed(arguments, sentence, tmp_path):
    arguments = [str(tmp_path) if a == "." else a for a in arguments]
    found = plot(*arguments)
    assert isinstance(found.exception, InputError)
    assert sentence in str(found.exception)


def test_a_place_that_the_recording_has_not_is_told_its_nearest(folder):
    found = plot("bode", folder, "--place", "disk[2]")
    assert "--place disk[2]: the recording has no such place; did you mean disc[2]?" in str(
        found.exception
    )


def test_a_run_of_less_than_a_block_of_turns_says_how_many_it_has(tmp_path):
    recorded(stop=0.05).save(tmp_path / "recording.npz")
    assert "holds 2 whole turns of the shaft; 4 are needed" in str(plot("bode", tmp_path).exception)
