"""The survey of integrators: its grid and table, what the rows say, the page made of them."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from papers.integrators.__main__ import app
from papers.integrators.members import MODERATE_DISSIPATION, chung_hulbert, hht, newmark, wbz
from papers.integrators.survey import planted, rotor, survey_command
from papers.integrators.survey.findings import Findings, safe_schemes
from papers.integrators.survey.grid import (
    TABLE,
    Experiment,
    jobs_of,
    read_table,
    run_grid,
    write_table,
)
from papers.integrators.survey.sources import closure
from rotor_fmu.errors import run

from ..processes import interrupted

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "docs" / "data" / "integrators.csv.gz"
SCHEMES = {"newmark": newmark(), "chung-hulbert=0.2": chung_hulbert(0.2)}


@pytest.fixture
def input_error(input_error_of):
    """The one line that a refused command prints."""
    return input_error_of(lambda: run(app))


def counted(scheme, h, case, folder):
    """A run that leaves a trace of itself, and fails while the file `broken` is there."""
    if case == 1 and (folder / "broken").exists():
        raise ArithmeticError("broken")
    with (folder / "runs").open("a") as file:
        file.write("x")
    return {"status": "ok", "error": h * (case + 1) / 3, "steps": 7.0}


def counting(version="1", **changes):
    quantities = {
        "name": "counting",
        "steps": (1e-3, 1e-4),
        "cases": ("a", "b"),
        "version": lambda: version,
        "run": counted,
        "prepare": lambda folder: (folder / "prepared").touch(),
    }
    return Experiment(**(quantities | changes))


def runs(out):
    return sum(len(path.read_text()) for path in out.rglob("runs"))


def test_rows_are_keyed_by_all_that_determines_them_and_not_by_the_name_of_the_scheme():
    def keys(experiment, schemes):
        return {job.key for job in jobs_of([experiment], schemes)}

    first = keys(counting(), {"newmark": newmark()})
    assert len(first) == 4
    assert first == keys(counting(), {"average-acceleration": newmark()})
    assert not first & keys(counting(), {"newmark": hht(0.05)})
    assert not first & keys(counting("2"), {"newmark": newmark()})
    assert not first & keys(counting(steps=(2e-3,)), {"newmark": newmark()})
    assert not first & keys(counting(cases=("c",)), {"newmark": newmark()})
    assert not first & keys(counting(name="other"), {"newmark": newmark()})


def test_a_survey_that_was_stopped_goes_on_where_it_was(tmp_path):
    store = tmp_path / "reference"
    experiment = counting()

    def broken(is_broken):
        (folder,) = store.iterdir()
        (folder / "broken").touch() if is_broken else (folder / "broken").unlink()

    first = run_grid([replace(experiment, cases=("a",))], {"newmark": newmark()}, tmp_path, 1)
    assert len(first) == runs(tmp_path) == 2
    broken(True)
    with pytest.raises(ArithmeticError):
        run_grid([experiment], SCHEMES, tmp_path, 1)
    finished = runs(tmp_path)
    assert finished == 4
    assert len(read_table(tmp_path / TABLE)) == finished
    broken(False)
    rows = run_grid([experiment], SCHEMES, tmp_path, 1)
    assert len(rows) == runs(tmp_path) == 8
    assert run_grid([experiment], SCHEMES, tmp_path, 1) == read_in_order(rows, tmp_path)
    assert runs(tmp_path) == 8


def read_in_order(rows, out):
    """The rows as they come back from the table."""
    stored = {(row["key"], row["scheme"]): row for row in read_table(out / TABLE)}
    return [stored[row["key"], row["scheme"]] for row in rows]


def test_rows_of_other_code_leave_the_table_and_are_not_lost(tmp_path):
    run_grid([counting()], SCHEMES, tmp_path, 1)
    run_grid([counting("2", cases=("a",))], SCHEMES, tmp_path, 1)
    stored, stale = (read_table(tmp_path / name) for name in (TABLE, "stale.csv"))
    assert len(stale) == 4
    assert {row["case"] for row in stale} == {"a"}
    assert len(stored) == 8  # those of case b have no successor yet


def test_two_names_of_one_scheme_are_run_once(tmp_path):
    schemes = {"hht=0.3333333333333333": hht(1 / 3), "chung-hulbert=0.5": chung_hulbert(0.5)}
    rows = run_grid([counting()], schemes, tmp_path, 1)
    assert runs(tmp_path) == 4
    assert [row["scheme"] for row in rows].count("chung-hulbert=0.5") == 4
    assert len(rows) == len(read_table(tmp_path / TABLE)) == 8
    assert run_grid([counting()], schemes, tmp_path, 1) == read_in_order(rows, tmp_path)
    assert runs(tmp_path) == 4


@pytest.mark.parametrize("name", ["table.csv", "table.csv.gz"])
def test_a_table_comes_back_as_it_was_and_equal_rows_give_equal_bytes(tmp_path, name):
    rows = run_grid([counting()], SCHEMES, tmp_path, 1)
    rows = read_in_order(rows, tmp_path)
    write_table(rows, tmp_path / name)
    once = (tmp_path / name).read_bytes()
    assert read_table(tmp_path / name) == rows
    write_table(read_table(tmp_path / name), tmp_path / name)
    assert (tmp_path / name).read_bytes() == once


def test_a_line_left_unfinished_is_passed_over(tmp_path):
    run_grid([counting()], SCHEMES, tmp_path, 1)
    path = tmp_path / TABLE
    path.write_text(path.read_text()[:-40])
    assert len(read_table(path)) == 7
    assert len(run_grid([counting()], SCHEMES, tmp_path, 1)) == 8
    assert runs(tmp_path) == 9


def test_the_version_of_a_run_follows_all_that_it_imports():
    result = set(closure(("rotor_fmu.model.simulation",)))
    assert {f"rotor_fmu.model.{name}" for name in ("step.step", "schemes.family")} <= result
    assert not {name for name in result if "impact" in name or "false_state" in name}


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--experiment", "car"], "--experiment car: must be one of rotor, bounce, planted, bars"),
        (["--scheme", "houbolt"], "--scheme houbolt: cannot turn a rotor"),
        (["--scheme", "hht"], "--scheme hht: needs alpha_f: hht=ALPHA_F"),
        (["--step", "3"], "--step 3 s: must be one of 5e-06"),
        (["--jobs", "0"], "--jobs 0: "),
        (["--table", "none.csv"], "--table none.csv: cannot be read"),
        (["--table", str(ROOT / "README.md")], "is not the table of a survey"),
        (["--out", "/proc/nothing"], "--out /proc/nothing: cannot be written to"),
    ],
)
def test_bad_options_are_refused_in_one_line(input_error, arguments, expected):
    assert expected in input_error("survey", *arguments)


def test_a_partial_table_makes_no_page_and_says_why(input_error, tmp_path_factory):
    folder = tmp_path_factory.mktemp("table")
    run_grid([counting()], SCHEMES, folder, 1)
    assert "has no rows of rotor" in input_error("survey", "--table", str(folder / TABLE))


def test_quick_picks_a_few_runs_of_every_kind():
    result = survey_command.chosen_experiments((), (), True)
    assert [experiment.name for experiment in result] == list(survey_command.EXPERIMENTS)
    schemes = survey_command.chosen_schemes(survey_command.QUICK_SCHEMES)
    assert len(jobs_of(result, schemes)) < 40


@pytest.mark.slow
def test_ctrl_c_ends_a_survey_in_one_line_and_keeps_what_was_finished(tmp_path):
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "papers.integrators", "survey"),
            *("--experiment", "bounce", "--jobs", "2", "--out", str(tmp_path)),
        ],
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    table = tmp_path / TABLE
    status, said = interrupted(process, lambda: table.exists() and len(read_table(table)) > 2)
    assert status == 130, said
    assert "stopped" in said
    assert "Traceback" not in said
    assert len(read_table(tmp_path / TABLE)) > 2


def test_a_run_down_has_no_error_against_itself_and_one_against_another(tmp_path):
    h = rotor.STEPS[0]
    simulation = rotor.perturbed(MODERATE_DISSIPATION, h, 0.0, 400.0)
    amplitudes, _ = rotor._run_down(simulation)
    np.savez(tmp_path / "run_down.npz", amplitudes=amplitudes, impacts=np.full((2, 2), 0.5))
    row = rotor.run_down(MODERATE_DISSIPATION, h, 0, tmp_path)
    assert (row["status"], row["error"], row["steps"]) == ("ok", 0.0, 10_000)
    other = rotor.run_down(hht(0.1), h, 0, tmp_path)
    assert 0.01 < other["error"] < 0.5
    assert other["impact_speed"] == 0.5


def test_an_unstable_scheme_is_run_and_flagged(tmp_path):
    np.savez(tmp_path / "run_down.npz", amplitudes=np.ones((1000, 2)), impacts=np.ones((1, 1)))
    row = rotor.run_down(wbz(0.08), rotor.STEPS[0], 0, tmp_path)
    assert re.fullmatch(r"diverged at [0-9.]+ s", row["status"])
    assert "error" not in row


def test_where_no_cycle_is_predicted_none_is_planted(tmp_path):
    assert planted.planted(chung_hulbert(0.1), rotor.STEPS[4], 0, tmp_path) == {
        "status": "no cycle"
    }


@pytest.fixture(scope="module")
def stored():
    """The rows that `docs/explanation/integrators.md` was made of."""
    return Findings(read_table(KEPT))


def test_the_table_holds_the_whole_grid(stored):
    whole = jobs_of(
        survey_command.chosen_experiments((), (), False),
        survey_command.chosen_schemes(survey_command.SCHEMES),
    )
    places = {(job.experiment, job.label, job.h, job.case_name) for job in whole}
    assert places == {(r["experiment"], r["scheme"], r["h"], r["case"]) for r in stored.rows}


def test_no_run_down_is_trapped_where_no_impact_is_predicted_to_end_in_the_false_state(stored):
    for scheme in stored.schemes("rotor"):
        for h in stored.steps("rotor"):
            impacts = stored.of("bounce", scheme=scheme, h=h)
            if not any(row["trapped"] for row in impacts):
                assert not stored.trapped_share(scheme, h)


def test_what_is_predicted_of_the_false_state_is_what_is_seen(stored):
    seen, predicted, h = map(np.array, zip(*stored.predictions(), strict=True))
    assert np.corrcoef(seen, predicted)[0, 1] > 0.8
    # coarser steps have weak cycles, which the unbalance pulls apart
    assert (seen[(predicted > 0.6) & (h < 7.5e-4)] > 0.0).all()


def test_the_presets_default_integrator_is_a_safe_one(stored):
    assert "chung-hulbert=0.2" in safe_schemes(stored)
    assert "moderate-dissipation" not in safe_schemes(stored)
