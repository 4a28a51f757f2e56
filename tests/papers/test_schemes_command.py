"""`python -m papers.integrators schemes`: tables, answers, pictures, and what it refuses."""

import csv
import math
from itertools import pairwise

import pytest
import typer
from matplotlib.image import imread
from rotor_fmu.model import settings
from rotor_fmu.model.settings.table import IN_STAGES
from typer.testing import CliRunner

from papers.integrators import members, schemes_command, spectral
from papers.integrators import schemes_figures as spectral_figures

app = typer.Typer(rich_markup_mode=None, add_completion=False)
app.command()(schemes_command.schemes)


def call(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.exit_code, result.output


@pytest.fixture(scope="module")
def survey(tmp_path_factory):
    out = tmp_path_factory.mktemp("schemes")
    status, text = call("--out", out)
    assert status == 0
    return out, text


def test_without_arguments_the_table_is_paper_bs_figure_1(survey):
    _, text = survey
    for number in ("0.318310", "0.551329", "0.778442", "0.707107", "0.904762", "37.4517"):
        assert number in text
    assert "central-difference: unstable above dt/T = 0.31831." in text
    assert "least spectral radius 0.58914 at dt/T = 5.97" in text


def test_csv_has_every_number_of_the_tables(survey):
    out, _ = survey
    with (out / "schemes.csv").open(encoding="utf-8") as file:
        rows = {row["scheme"]: row for row in csv.DictReader(file)}
    assert list(rows) == list(schemes_command.FIGURE_1)
    assert float(rows["central-difference"]["stable_to"]) == pytest.approx(1 / math.pi)
    moderate = rows["moderate-dissipation"]
    assert float(moderate["beta"]) == pytest.approx(0.5)
    assert float(moderate["rho_at_0.3"]) == pytest.approx(0.945869, abs=1e-6)
    assert float(moderate["rebound"]) == pytest.approx(1)
    assert rows["wilson=1.4"]["theta"] == "1.4"


@pytest.mark.usefixtures("drawn")
def test_three_pictures_are_drawn(survey):
    out, _ = survey
    names = {"figure_1_spectral_radius.png", "numerical_damping.png", "period_elongation.png"}
    assert {path.name for path in out.glob("*.png")} == names
    for name in names:
        pixels = imread(out / name)
        assert pixels.shape[0] > 500
        assert pixels[..., :3].std() > 0.05


def test_pictures_show_each_methods_curve_named_in_the_margin():
    methods = dict(map(schemes_command.parse_scheme, ("newmark", "hht=0.5", "houbolt")))
    figure = spectral_figures.spectral_radius(methods, 0.0, 0.2)
    (axes,) = figure.axes
    curves = [line for line in axes.lines if len(line.get_xdata()) > 100]
    for line, method in zip(curves, methods.values(), strict=True):
        x, y = line.get_data()
        assert y[300] == spectral.spectral_radius(method, 2 * math.pi * x[300])
    heights = sorted(text.get_position()[1] for text in axes.texts if text.get_text() in methods)
    assert len(heights) == 3
    assert all(above - below > 0.04 for below, above in pairwise(heights))


@pytest.mark.parametrize("name", [name for name in settings.METHODS if name != IN_STAGES])
def test_every_scheme_that_turns_the_rotor_has_the_same_name_here(name):
    values = {"alpha_f": 0.3, "alpha_m": 0.1, "rho": 0.4, "beta": 0.3, "gamma": 0.5}
    taken = {key: values[key] for key in settings.METHODS[name]}
    text = ",".join(f"{key}={value}" for key, value in taken.items())
    _, method = schemes_command.parse_scheme(f"{name}={text}" if text else name)
    numbers = settings.Settings(method=name, **taken).numbers
    assert method._asdict() == {key: numbers[key] for key in method._fields}


def test_both_papers_signs_and_abaqus_name_the_same_scheme():
    def parse(text):
        return schemes_command.parse_scheme(text)[1]

    paper_a = parse("generalized-alpha=0.1,0.08")
    assert paper_a == members.generalized_alpha(alpha_f=0.1, alpha_m=0.08)
    assert parse("generalized-alpha=alpha_B=0.08,alpha_H=0.1") == paper_a
    assert parse("hht=alpha=-0.05") == parse("hht=0.05") == parse("transient-fidelity")
    assert parse("hht=alpha=-0.5,beta=0.5625,gamma=1.0") == members.hht(0.5)
    assert parse("newmark=gamma=0.52") == members.newmark(0.25, 0.52)
    assert parse("moderate-dissipation") == members.hht(math.sqrt(2) - 1)


def test_a_users_own_frequency_and_step_are_answered_in_sentences(tmp_path):
    status, text = call(
        *("--frequency", 29.4, "--step", 0.004, "--out", tmp_path),
        *("--scheme", "hht=0.1", "--scheme", "newmark", "--scheme", "wbz=0.08"),
    )
    assert status == 0
    assert "dt/T = 0.1176, 8.5 steps a period" in text
    assert "hht=0.1: stable, spectral radius 0.997743. It adds 0.32221 % of critical" in text
    lost = 100 * (1 - math.exp(-2 * math.pi * 0.00322205))
    assert f"A free vibration loses {lost:.4g} % of its amplitude a period." in text
    assert "The period is 5.38 % too long." in text
    assert "newmark: stable, spectral radius 1. It adds no damping." in text
    assert "wbz=0.08: UNSTABLE, spectral radius 1.00209. It takes away 0.29295 %" in text
    with (tmp_path / "schemes.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["is_stable"] for row in rows] == ["True", "True", "False"]
    assert float(rows[0]["elongation"]) == pytest.approx(0.05380, abs=1e-5)


def test_a_step_past_the_stability_limit_is_told_with_the_longest_that_is_not(tmp_path):
    status, text = call(
        *("--frequency", 50, "--step", 0.01, "--damping", 0.02, "--out", tmp_path),
        *("--scheme", "central-difference", "--scheme", "newmark"),
    )
    assert status == 0
    assert "central-difference: UNSTABLE" in text
    assert "(stable up to a step of 0.006366 s)" in text
    assert "Nothing oscillates any more: all its roots are real." in text
    assert "11.81 % is right" in text


def test_unstable_and_inconsistent_parameters_are_computed_and_flagged(tmp_path):
    arguments = ("wbz=0.08", "hht=-0.05", "newmark=0.25,0.52", "newmark=0.5,0.5")
    status, text = call(*(f"--scheme={text}" for text in arguments), "--out", tmp_path)
    assert status == 0
    assert "wbz=0.08: unstable at any step." in text
    assert "hht=-0.05: unstable at any step; alpha_f has the opposite sign of Abaqus'" in text
    assert "first order: gamma is not 1/2 - alpha_m + alpha_f" in text
    assert "newmark=0.5,0.5: does not damp the fastest oscillations; meets the energy-" in text
    assert "1.17391" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--scheme", "euler"], "--scheme euler: 'euler': must be one of newmark, hht, wbz,"),
        (["--scheme", "hht"], "--scheme hht: needs alpha_f: hht=ALPHA_F"),
        (["--scheme", "hht=some"], "alpha_f = 'some': must be a number"),
        (["--scheme", "hht=0.1,0.2,0.6,1"], "cannot take '1'; it takes alpha_f, beta, gamma"),
        (["--scheme", "hht=rho=0.1"], "cannot take 'rho=0.1'; it takes alpha_f, beta, gamma"),
        (["--scheme", "hht=0.1,alpha=-0.1"], "alpha_f is given twice"),
        (["--scheme", "hht=1"], "alpha_f = 1: must be at least -1 and below 1"),
        (["--scheme", "newmark=0,0.5"], "beta = 0: must be above 0 in an implicit step"),
        (["--scheme", "houbolt=2"], "cannot take '2'; it takes no parameters"),
        (["--frequency", "30"], "--frequency: needs --step too"),
        (["--step", "0.1"], "--step: needs --frequency too"),
        (["--frequency", "0", "--step", "1"], "--frequency 0: must be > 0 and finite"),
        (["--frequency", "1e9", "--step", "1"], "= 1e+09: must lie between 1e-09 and 10000"),
        (["--damping", "1"], "--damping 1: must be at least 0 and below 1"),
    ],
)
def test_bad_input_ends_with_one_line_and_status_2(arguments, message, tmp_path):
    status, text = call(*arguments, "--out", tmp_path / "none")
    assert status == 2
    assert message in text.splitlines()[-1]
    assert not (tmp_path / "none").exists()


def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    status, text = call("--out", tmp_path / "file")
    assert status == 2
    assert "cannot be written to" in text.splitlines()[-1]
