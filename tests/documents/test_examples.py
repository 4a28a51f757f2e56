"""The examples do what their pages say."""

import json
import math
import re
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml

from rotor_fmu.cli import app
from rotor_fmu.operating_speeds import operating_speeds

EXAMPLES = Path(__file__).parents[2] / "examples"


def script(folder, name):
    """What a script of the examples defines."""
    return runpy.run_path(str(EXAMPLES / folder / name))


SCRIPTS = [file for file in EXAMPLES.glob("*/*.py") if "script_arguments(" in file.read_text()]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_a_script_called_wrongly_says_how_it_is_called(path, monkeypatch, capsys):
    for arguments in (["--help"], ["a", "b", "c"]):
        monkeypatch.setattr("sys.argv", [str(path), *arguments])
        with pytest.raises(SystemExit) as ended:
            runpy.run_path(str(path), run_name="__main__")
        assert ended.value.code == 2
        usage = capsys.readouterr().err
        assert re.fullmatch(rf"usage: python {path.name} .*FOLDER .*\n", usage)


def test_the_folder_of_a_scripts_pictures_is_made_or_refused(tmp_path, monkeypatch, capsys):
    path = EXAMPLES / "drop" / "drop.py"
    here = runpy.run_path(str(path))
    monkeypatch.setitem(sys.modules, "__main__", SimpleNamespace(__doc__=here["__doc__"]))
    monkeypatch.setattr("sys.argv", [str(path), str(tmp_path / "new")])
    assert here["script_arguments"]() == [str(tmp_path / "new")]
    assert (tmp_path / "new").is_dir()
    (tmp_path / "new" / "file").touch()
    monkeypatch.setattr("sys.argv", [str(path), str(tmp_path / "new" / "file")])
    with pytest.raises(SystemExit) as ended:
        here["script_arguments"]()
    assert ended.value.code == 2
    assert re.fullmatch(r"FOLDER .*file: cannot be written to: .*\n", capsys.readouterr().err)


@pytest.mark.parametrize(
    ("name", "speed"),  # [rad/s], as in the README
    [("drop/compressor", 1000.0), ("rolling_bearing/rotor", 40 * math.pi)],
)
def test_an_example_with_a_speed_of_its_own_is_run_at_it_by_every_command(name, speed):
    machine = parse_rotor((EXAMPLES / f"{name}.toml").read_text())
    assert operating_speeds(machine).rated == pytest.approx(speed, rel=1e-6)


# --- drop ---


@pytest.fixture(scope="module")
def dropped():
    return script("drop", "drop.py")


def test_the_dropped_compressor_touches_after_the_time_of_free_fall(dropped):
    free_fall = math.sqrt(2 * dropped["CLEARANCE"] / 9.81)
    assert dropped["first_contact"]() == pytest.approx(free_fall, rel=0.01)


def test_friction_speeds_the_races_up_and_the_ledger_of_the_drop_closes(dropped):
    output = dropped["run"](duration=0.1, every=1e-3)
    for k in (1, 2):
        race = output[f"touchdown_bearing[{k}].race"]
        assert (race[output["t"] < 0.007] == 0).all()
        # friction under half the weight, less the drag: 0.15 * 131 N * 0.03 m - 0.02 N.m
        assert race[-1] == pytest.approx((0.1 - 0.0071) * 0.57 / 1.5e-4, rel=0.15)
    lost = sum(value[-1] for name, value in output.items() if name.endswith("_loss"))
    assert abs(output["energy.residual"][-1]) < 1e-4 * lost


# --- jeffcott_rub ---


@pytest.fixture(scope="module")
def jeffcott():
    return script("jeffcott_rub", "jeffcott_rub.py")


def test_the_rubbing_jeffcott_rotor_whirls_as_the_closed_form_says(jeffcott):
    (_, radius), (_, further) = jeffcott["sweep"](1.2, 1.4, 2)
    assert radius == pytest.approx(1.296981, rel=1e-3)
    assert further == pytest.approx(1.580638, rel=1e-3)


def test_stepped_down_the_jeffcott_rotor_is_free_where_stepped_up_it_rubs(jeffcott):
    assert jeffcott["sweep"](2.4, 1.8, 4)[-1, 1] == pytest.approx(jeffcott["free"](1.8), rel=1e-3)
    assert jeffcott["sweep"](1.6, 1.8, 5)[-1, 1] == pytest.approx(2.777077, rel=1e-3)


# --- from_ross ---

FROM_ROSS = EXAMPLES / "from_ross"
ROSS_SAYS = json.loads((EXAMPLES.parent / "tests/reference/ross_answers.json").read_text())


@pytest.fixture(scope="module")
def from_ross():
    return script("from_ross", "run_up.py")


def test_the_imported_machine_is_what_the_command_makes_of_the_file_from_ross(tmp_path):
    out = tmp_path / "imported.toml"
    app(
        ["import-ross", str(FROM_ROSS / "on_pedestals.json"), "--out", str(out)],
        standalone_mode=False,
    )
    texts = [file.read_text(encoding="utf-8") for file in (out, FROM_ROSS / "imported.toml")]
    # numbers that the import calculates may differ in their last digit
    made, there = (re.sub(r"\d+(\.\d+)?(e[-+]?\d+)?", "NUMBER", text) for text in texts)
    assert made == there
    made, there = (parse_rotor(text) for text in texts)
    speed = 200.0
    np.testing.assert_allclose(modes(made, speed).natural, modes(there, speed).natural, rtol=1e-9)


@pytest.mark.parametrize("file", ["imported.toml", "rubbing.toml"])
def test_modes_of_the_imported_machine_are_those_of_ross(from_ross, file):
    rotor = from_ross["machine"](file)
    for speed, output in ROSS_SAYS["on_pedestals.json"]["modal"].items():
        result = modes(rotor, float(speed), count=10, contacts="open")
        np.testing.assert_allclose(result.natural, output["natural"], rtol=1e-6)
        np.testing.assert_allclose(result.log_dec, output["log_dec"], rtol=1e-6)


def test_the_seals_added_to_the_rotor_from_ross_hold_it_back(from_ross):
    rotor, run_up = from_ross["machine"]("rubbing.toml"), from_ross["run_up"]
    rubs = run_up(rotor, "disc.y", "contact[1].fn", duration=1.0)
    free = run_up(from_ross["without_contacts"](rotor), "disc.y", duration=1.0)
    assert rubs["contact[1].fn"].max() > 0
    assert np.ptp(rubs["disc.y"]) < 0.9 * np.ptp(free["disc.y"])


# --- paper_rig ---


def test_the_rigs_file_is_the_machine_that_commands_take_by_themselves():
    assert (EXAMPLES / "paper_rig" / "rig.toml").read_text(encoding="utf-8") == rig_toml()


def test_the_rig_runs_down_through_both_peaks_of_the_converged_run():
    rig = script("paper_rig", "run_down.py")
    output = rig["run"](stop=26.0)
    # fixed steps of 0.1 ms: 393.0 um at 27.64 Hz, 442.2 um at 31.40 Hz
    for name, size, hz in ((rig["NAMES"][0], 393.0e-6, 27.64), (rig["NAMES"][1], 442.2e-6, 31.40)):
        assert rig["peak"](output, name) == pytest.approx((size, hz), rel=0.01)


# --- rolling bearing ---


def test_a_damaged_race_shows_at_the_frequency_at_which_balls_pass():
    example = script("rolling_bearing", "rolling_bearing.py")
    machine = example["rotor"]()
    orders, damaged = example["spectrum"](machine)
    _, sound = example["spectrum"](example["rotor"](0.0))
    for k in range(1, 5):
        at = np.argmin(np.abs(orders - k * example["passing"](machine)))
        assert damaged[at - 1 : at + 2].max() > 5.0 * sound[at - 1 : at + 2].max()


# --- heat of a rub ---


@pytest.mark.slow  # tests/parts/test_bow_growth has Kellenberger's closed form
def test_a_hot_spot_spirals_outwards_below_the_critical_speed_and_inwards_above():
    example = script("newkirk", "newkirk.py")
    machine = example["rotor"]()
    root = abs(example["critical"](machine))
    for s, is_growing in ((0.8, False), (0.97, True), (1.05, False)):
        history = example["run"](machine, s * root, 34.0, 5.0)
        seen = example["rate"](history)
        closed = example["expected"](machine, np.array([s * root]))[0]
        assert (seen.real > 0.0) == is_growing
        # the ring is beside the disc and damps, which the closed form of one mass leaves out
        assert seen == pytest.approx(closed, rel=0.3)
        assert seen.imag < 0.0
    grown = example["run"](machine, 0.97 * root, 124.0, 60.0).vibration
    assert abs(grown[-1]) > 1.5 * abs(grown[0])


# --- oil film ---


@pytest.mark.slow
def test_a_rotor_in_oil_films_whirls_past_its_threshold_and_stays_at_its_natural_frequency():
    example = script("oil_film", "oil_film.py")
    history = example["run"](low=800.0, high=1000.0, seconds=2.0)
    _, frequency, rows = example["spectra"](history, lines=4)
    whirl = frequency[np.argmax(rows[-1])]
    # below half the speed, 79 Hz, near the shaft's own frequency on pinned journals
    lowest = math.sqrt(48 * 2.1e11 * math.pi / 64 * 0.02**4 / 0.5**3 / 4.6) / (2 * math.pi)
    assert whirl == pytest.approx(lowest, rel=0.08)
    assert np.abs(history["journal"][-500:]).max() > 0.9 * example["CLEARANCE"]
    assert abs(history["residual"][0]) < 1e-4 * history["lost"][0]


# --- squeeze film ---


@pytest.mark.slow  # as tests/parts/test_squeeze_film_damper has one
def test_a_rotor_on_dampers_jumps_where_the_closed_form_folds():
    """A little beyond each fold, since the speed does not wait there; on either side the orbit is
    the closed form's."""
    example = script("squeeze_film", "squeeze_film.py")
    rising, falling = example["closed_form"](np.array(example["folds"]()))[0][1]
    up = example["sweep"](1.2, 1.7, seconds=30.0)[60:]
    down = example["sweep"](1.7, 1.2, seconds=30.0)[60:]
    for swept, fold, beyond, flanks in ((up, rising, 1, (0, 1)), (down, falling, -1, (1, 0))):
        jump = swept[np.argmax(np.abs(np.diff(swept[:, 1]))), 0]
        assert 0.0 <= beyond * (jump - fold) < 0.03 * fold
        for (speed, orbit), flank in zip((swept[0], swept[-1]), flanks, strict=True):
            expected = example["closed_form"](np.array([orbit]))[0][flank, 0]
            assert speed == pytest.approx(expected, rel=5e-3)


# --- a gear's pinion ---


def test_the_pinion_whirls_under_a_small_part_of_its_load_alone():
    """In its operating range at 5 % of it, above that range at 8 %, nowhere at full load."""
    example = script("gear_pinion", "load.py")
    low, high = example["OPERATING"]
    assert example["threshold"](0.02) == pytest.approx(11049 * example["RPM"], rel=1e-3)
    assert example["threshold"](0.05) < low < high < example["threshold"](0.08)
    assert math.isnan(example["threshold"](1.0))


# --- tilting pads ---


def test_the_compressor_whips_in_plain_bearings_alone():
    """From the README's 7080 rpm on, and to below that running down."""
    example = script("tilting_pads", "whip.py")
    rpm, speeds = example["RPM"], np.linspace(6800, 7400, 3) * example["RPM"]
    plain, tilting = (
        example["machine"](bearings).campbell(speeds, count=4) for bearings in ("plain", "tilting")
    )
    assert plain.threshold == pytest.approx(7080 * rpm, rel=1e-3)
    assert tilting.threshold is None


@pytest.mark.slow  # as the whip of the rotor in oil films
def test_the_whip_begins_above_the_threshold_and_ends_below():
    example = script("tilting_pads", "whip.py")
    rpm, fast = example["RPM"], example["FAST"]
    up = example["sweep"]("plain", 7000 * rpm, 9000 * rpm, 1.6)
    down = example["sweep"]("plain", fast, 6000 * rpm, 3.2)
    at = [np.interp(7500 * rpm, *(v[np.argsort(run.speed)] for v in run)) for run in (up, down)]
    assert at[0] < 5e-6 < 1e-4 < at[1]
    assert up.amplitude.max() > 1e-4
    assert down.amplitude[-1] < 1e-5


# --- turbocharger ---


@pytest.mark.parametrize(
    ("speed", "film"), [pytest.param(2500.0, "inner", marks=pytest.mark.slow), (12500.0, "outer")]
)
def test_the_turbocharger_whirls_in_its_inner_films_and_later_in_an_outer_one(speed, film):
    """Far above its own weight at a fraction of the mean speed of the film's surfaces: below half,
    as shaft and films hold it back, of an outer one at half."""
    example = script("turbocharger", "turbocharger.py")
    history = example["run"](speed, speed + 100.0, 0.3)
    z = history["compressor"][-1500:]
    frequency = np.fft.fftfreq(1500, example["EVERY"])
    size = np.abs(np.fft.fft((z - z.mean()) * np.hanning(1500)))
    turning = history["w"][-1] / (2 * math.pi)
    below = (frequency > 0.0) & (frequency < 0.9 * turning)
    whirl = frequency[below][np.argmax(size[below])]
    assert size[below].max() > 3.0 * size[np.argmin(np.abs(frequency - turning))]
    ring = history["floating_ring_bearing[1].ring_speed"][-1] / (2 * math.pi)
    if film == "inner":
        assert 0.7 * 0.5 * (turning + ring) < whirl < 0.5 * (turning + ring)
    else:
        assert whirl == pytest.approx(0.5 * ring, abs=7.0)  # a line of the spectrum
    assert abs(history["residual"][0]) < 1e-4 * history["lost"][0]
