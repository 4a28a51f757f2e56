"""`python -m papers.ishikawa_koguchi`: tables, logs, pictures, and what it refuses."""

import csv
import json
import re

import pytest
import typer
from matplotlib.image import imread
from PIL import Image
from typer.testing import CliRunner

from papers.ishikawa_koguchi import __main__ as impact_command
from papers.ishikawa_koguchi import bars_cases
from papers.ishikawa_koguchi.impact.ratchet import ratchet_toml
from papers.ishikawa_koguchi.impact.stepping.failures import ImpactError
from rotor_fmu.errors import InputError, RunFailed

app = typer.Typer(rich_markup_mode=None, add_completion=False)
app.add_typer(impact_command.app, name="impact")


def call(*arguments):
    result = CliRunner().invoke(app, ["impact", *(str(argument) for argument in arguments)])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.output


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def assert_drawn(path):
    pixels = imread(path)
    assert pixels.shape[0] > 150
    assert pixels[..., :3].std() > 0.05


@pytest.fixture(scope="module")
def bars(tmp_path_factory):
    """On bars of one element across, in which the wave is the same, by the scheme of the log alone
    and without pictures."""
    out = tmp_path_factory.mktemp("bars")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bars_cases, "save", lambda figure, path: path.touch())
        patch.setattr(impact_command, "PAPER_BARS", ("transient-fidelity",))
        status, text = call("bars", "--elements", 40, 1, "--out", out)
    assert status == 0
    return out, text


@pytest.mark.usefixtures("drawn")
@pytest.mark.slow
def test_bars_give_paper_bs_figures_and_a_table_of_errors(tmp_path):
    status, text = call("bars", "--out", tmp_path)
    assert status == 0
    out = tmp_path
    rows = rows_of(out / "bars.csv")
    assert len(rows) == 5 * 2 * 2 + 1
    coarse = next(row for row in rows if row["label"] == "hht=0.5" and row["dt"] == "0.0008")
    assert float(coarse["rms"]) == pytest.approx(0.231, abs=1e-3)
    pictures = {*(f"figure_{number}" for number in range(3, 8)), "energy", "momentum"}
    pictures |= {f"{name}_opening_0.02" for name in pictures}
    assert {path.stem for path in out.glob("*.png")} == pictures
    for name in pictures:
        assert_drawn(out / f"{name}.png")
    assert max(map(len, text.splitlines())) < 200
    assert "newmark: does not damp the fastest oscillations" in text
    assert "leaves 3 times faster" in text


def test_the_status_log_of_figure_8_is_printed_and_kept(bars):
    out, text = bars
    log = (out / "figure_8_status.txt").read_text(encoding="utf-8").splitlines()
    assert len(log) == 10
    assert log[4].split("\t") == ["1", "201", "2", "0", "1", "1", "0.0100", "0.0100", "4.000e-007"]
    assert "4.000e-007" in text


def test_a_users_own_bars(tmp_path):
    arguments = ["--scheme", "hht=alpha=-0.3", "--dt", 4e-4, "--opening", 0.005]
    status, _ = call(
        "bars", *arguments, "--impact", "current-time", "--mass", "consistent", "--out", tmp_path
    )
    assert status == 0
    (row,) = rows_of(tmp_path / "bars.csv")
    assert row["label"] == "hht=alpha=-0.3, current-time"
    assert row["cutbacks"] == "0"
    pictures = sorted(path.name for path in tmp_path.glob("tip_velocity*.png"))
    assert pictures == ["tip_velocity_hht_alpha_-0.3_current-time_opening_0.005.png"]


def test_json_has_the_tables_rows_and_what_is_to_be_said_of_the_schemes(tmp_path):
    arguments = ["--scheme", "newmark", "--dt", 8e-4, "--opening", 0.01, "--out", tmp_path]
    status, text = call("bars", *arguments, "--json", "--quiet")
    output = json.loads(text)
    (row,) = rows_of(tmp_path / "bars.csv")
    assert (status, output["status"], output["out"]) == (0, "ok", str(tmp_path))
    assert {name: str(value) for name, value in output["rows"][0].items()} == row
    assert "does not damp the fastest oscillations" in output["remarks"]["newmark"]


def test_a_penalty_takes_the_place_of_the_hard_contact(tmp_path):
    arguments = ["--scheme", "moderate-dissipation", "--dt", 8e-4, "--opening", 0.01]
    assert call("bars", *arguments, "--penalty", 20, "--out", tmp_path)[0] == 0
    (soft,) = rows_of(tmp_path / "bars.csv")
    assert call("bars", *arguments, "--out", tmp_path)[0] == 0
    (hard,) = rows_of(tmp_path / "bars.csv")
    assert float(soft["rms"]) != pytest.approx(float(hard["rms"]), rel=0.02)


def test_an_unstable_scheme_is_flagged_computed_and_caught(tmp_path):
    with pytest.raises(RunFailed, match=r"diverged at t = \S+ s, increment \d+, energy \S+ J"):
        call("bars", "--scheme", "wbz=0.3", "--dt", 8e-4, "--opening", 0.01, "--out", tmp_path)
    (row,) = rows_of(tmp_path / "bars.csv")
    assert row["status"].startswith("diverged at")
    assert row["rms"] == ""


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["bars", "--dt", 0], "--dt 0 s: must be > 0"),
        (["bars", "--dt", "nan"], "--dt nan s: must be > 0"),
        (["bars", "--density", -1], "density = -1: must be > 0"),
        (["bars", "--elements", 0, 4], "nx = 0 elements: must be at least 1"),
        (["bars", "--scheme", "newmark=0,0.5"], "beta = 0: must be above 0"),
        (["bars", "--scheme", "wilson=1.4"], "not of the generalized-alpha family"),
        (["bars", "--impact", "maybe"], "--impact maybe: must be one of no, average-time"),
        (["bars", "--mass", "heavy"], "--mass heavy: must be one of lumped, consistent"),
        (["bars", "--opening", -1], "opening = -1 m: must be >= 0"),
        (["bars", "--penalty", 0], "penalty = 0 N/m: must be > 0"),
        (["bars", "--penalty", 1e4, "--impact", "average-time"], "needs --impact no"),
        (["ratchet", "--dt", -1], "--dt -1 s: must be > 0"),
        (["ratchet", "--cap", 0], "--cap 0 increments: must be > 0"),
        (["ratchet", "--geometry", "nowhere.toml"], "--geometry nowhere.toml: cannot be read"),
        (["bearings", "--stop", 0], "--stop 0 s: must be > 0"),
        (["bearings", "--speed", "inf"], "--speed inf: must be finite"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_written(arguments, message, tmp_path):
    out = tmp_path / "out"
    with pytest.raises((InputError, ImpactError), match=re.escape(message)):
        call(*arguments, "--out", out)
    assert not out.exists()


@pytest.mark.usefixtures("drawn")
@pytest.mark.slow
def test_a_ratchet_of_ones_own_is_drawn_and_moves(tmp_path):
    geometry = tmp_path / "small.toml"
    text = ratchet_toml().replace("[20, 4]", "[10, 2]").replace("torque = 2.0", "torque = 8.0")
    geometry.write_text(text, encoding="utf-8")
    arguments = ["--geometry", geometry, "--dt", 5e-5, "--stop", 0.007, "--cap", 200]
    status, text = call("ratchet", *arguments, "--out", tmp_path)
    assert status == 0
    rows = {row["label"]: row for row in rows_of(tmp_path / "ratchet.csv")}
    moderate = rows["moderate-dissipation"]
    assert float(moderate["slope"]) == pytest.approx(-8.2 / 7.66e-4, rel=0.01)
    assert float(moderate["t_reversal"]) == pytest.approx(6.1, rel=0.03)
    for name in ("figure_10_wheel.png", "figure_12_shaking.png", "ratchet.png"):
        assert_drawn(tmp_path / name)
    with Image.open(tmp_path / "ratchet.gif") as movie:
        assert movie.n_frames > 20
    assert not list(tmp_path.glob("*.part*"))


def test_the_rotors_bearings_are_tried_with_each_impact_option(tmp_path):
    arguments = ["--scheme", "moderate-dissipation", "--dt", 1e-3, "--stop", 0.03, "--cap", 500]
    status, _ = call("bearings", *arguments, "--out", tmp_path)
    assert status == 0
    rows = rows_of(tmp_path / "bearings.csv")
    assert len(rows) == 2 + 2 * 3
    plain = [row for row in rows if row["label"] == "moderate-dissipation"]
    assert {row["status"] for row in plain} == {"done"}
    head, _, *lines = (tmp_path / "outcomes.md").read_text(encoding="utf-8").splitlines()
    assert head.count("damped: ") == 6
    assert [line.split(" | ")[0] for line in lines] == ["| moderate-dissipation, 1 ms"]
