"""STUDY.toml: what it may say, and the one line where it says something else."""

import re
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies import response_runs, run_metrics
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.machine_studies.run_kinds import IN_TIME
from rotor_fmu.studies.design import DESIGNS, DISTRIBUTIONS, GRID
from rotor_fmu.studies.study_file import TABLES

VALUES = "values = [40e-6, 60e-6]"
STUDY = """
[run]
kind = "run-down"
from = 220
rate = 40
[set]
"solver.tolerance" = 1e-2
[vary]
clearance = { names = "bearing[*].clearance", values = [40e-6, 60e-6] }
"disc[2].e" = { grid = { from = 10e-6, to = 90e-6, count = 3 } }
[keep]
X = { peak = "disc[3].x_amp" }
[limits]
X = 400e-6
"""
HELD = (
    '[run]\nkind = "constant"\nspeed = 150\nturns = 8\n[vary]\n"run.speed" = { values = [150] }\n'
)


def read(tmp_path, text):
    path = tmp_path / "study.toml"
    path.write_text(text)
    return read_study(path)


def test_a_study_is_the_product_of_its_lists_with_names_told_together(tmp_path):
    study = read(tmp_path, STUDY)
    points = [study.design.point(i) for i in range(len(study.design))]
    assert [p["clearance"] for p in points] == [40e-6] * 3 + [60e-6] * 3
    assert [p["disc[2].e"] for p in points][:3] == pytest.approx([10e-6, 50e-6, 90e-6])
    assert study.design.settings(points[3]) == {
        "bearing[1].clearance": 60e-6,
        "bearing[2].clearance": 60e-6,
        "disc[2].e": 10e-6,
    }


def test_what_is_varied_has_the_unit_of_its_quantity_in_the_rows(tmp_path):
    run = '"run.rate" = { values = [40] }\n"bearing[1].mu" = { values = [0.1] }\n[keep]'
    axes = read(tmp_path, STUDY.replace("[keep]", run)).design.axes
    assert [axis.unit for axis in axes] == ["m", "m", "rad/s2", "1"]


def test_numbers_may_have_units(tmp_path):
    text = (
        STUDY.replace("from = 220", 'from = "2100 rpm"\nstep = "20 ms"')
        .replace("rate = 40", 'rate = "6 Hz/s"')
        .replace("[40e-6, 60e-6]", '["0.04 mm", "60 um"]')
        .replace("from = 10e-6, to = 90e-6", 'from = "10 um", to = "90 um"')
        .replace("X = 400e-6", 'X = "0.4 mm"')
        .replace("[limits]", 'at = { value = "disc[3].x_amp", speed = "30 Hz" }\n[limits]')
        .replace("[set]", '[set]\n"disc[1].e" = "20 um"')
    )
    study = read(tmp_path, text)
    numbers = study.model.how.numbers
    assert [numbers[name] for name in ("from", "step", "rate")] == pytest.approx(
        [70 * np.pi, 0.02, 12 * np.pi]
    )
    assert study.model.values["disc[1].e"] == pytest.approx(20e-6)
    clearances, eccentricities = (axis.values for axis in study.design.axes)
    assert clearances == pytest.approx([40e-6, 60e-6])
    assert eccentricities == pytest.approx([10e-6, 50e-6, 90e-6])
    assert study.limits["X"].value == pytest.approx(400e-6)
    assert dict(study.model.metrics[1].options)["speed"] == pytest.approx(60 * np.pi)
    with pytest.raises(InputError, match=r"run.from = 2 mm: must be a speed of rotation"):
        read(tmp_path, STUDY.replace("from = 220", 'from = "2 mm"'))


def test_quantities_in_different_units_are_not_varied_as_one(tmp_path):
    text = STUDY.replace('"bearing[*].clearance"', '["bearing[1].clearance", "bearing[1].mu"]')
    with pytest.raises(InputError, match=r"clearance is in m, bearing\[1\].mu in 1"):
        read(tmp_path, text)


def test_ids_follow_what_decides_a_run_and_nothing_else(tmp_path):
    point = {"bearing[1].clearance": 4e-5, "bearing[2].clearance": 4e-5, "disc[2].e": 1e-5}
    first = read(tmp_path, STUDY)
    said_otherwise = read(tmp_path, "# a comment\n" + STUDY.replace("from = 220", "from = 220.0"))
    assert first.row_id(point) == said_otherwise.row_id(dict(reversed(point.items())))
    assert first.identity == said_otherwise.identity
    others = [
        first.row_id(point | {"disc[2].e": np.nextafter(1e-5, 1)}),
        *(
            read(tmp_path, STUDY.replace(*change)).row_id(point)
            for change in (("rate = 40", "rate = 41"), ("tolerance", "rtol"), ("X =", "Y ="))
            if "X" not in change[0]
        ),
        read(tmp_path, STUDY + "[design]\nseed = 1\n").row_id(point),
    ]
    assert len({first.row_id(point), *others}) == 1 + len(others)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--jobs", "2", "--cluster", "local:2"], "--jobs, --scheduler, --cluster: only one"),
        (["--cluster", "far:2"], "--cluster far:2: must be local:N"),
        (["--cluster", "local:0"], "--cluster local:0: must be local:N"),
        (["--select", "99"], "--select 99: no run of this study has that id; numbers go to 5"),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path, input_error, arguments, expected):
    (tmp_path / "study.toml").write_text(STUDY)
    assert expected in input_error("study", "study.toml", "--out", "out", *arguments)


@pytest.mark.slow
def test_an_address_that_nobody_answers_at_is_said_after_its_time_out(tmp_path, process):
    file = tmp_path / "study.toml"
    file.write_text(STUDY)
    address = "tcp://127.0.0.1:9"
    done = process("study", "study.toml", "--out", "out", "--scheduler", address)
    assert done.returncode == 2
    assert list(tmp_path.iterdir()) == [file]
    said = f"rotor-fmu: --scheduler {address}: no scheduler answers within 10 s"
    assert done.stderr.strip().endswith(said)


def test_a_distance_that_a_part_does_not_have_is_not_suggested(tmp_path):
    keep = '[keep]\nq = { peak = "floating_ring_bearing[1].r" }\n'
    with pytest.raises(InputError, match=r"did you mean floating_ring_bearing\[1\]\.f"):
        read(tmp_path, f'machine = "turbocharger/rotor.toml"\n{HELD}{keep}')


def test_numbers_of_a_run_that_are_varied_suit_one_another(tmp_path):
    ends = '"run.from" = { values = [160, 100] }\n"run.to" = { values = [150, 50] }\n[keep]'
    run = STUDY.replace("from = 220", "from = 220\nto = 160").replace("[keep]", ends)
    assert len(read(tmp_path, run).design) == 4 * 6
    with pytest.raises(InputError, match=r"run.to = 100 rad/s: must differ from run.from"):
        read(tmp_path, run.replace("150", "100"))


def test_choices_are_listed_by_name_and_truths_as_such(tmp_path):
    listed = '"limit.contact" = { values = [true, 0] }\n"solver.preset" = { values = ["paper", 0] }'
    truths, presets = read(tmp_path, STUDY.replace("[keep]", f"{listed}\n[keep]")).design.axes[-2:]
    assert truths.values == (1.0, 0.0)
    assert presets.values == (1.0, 0.0)


def test_settings_that_suit_one_another_in_some_runs_begin(tmp_path):
    methods = '"solver.alpha_f" = { values = [0.1] }\n"solver.method" = { values = [1, 2] }\n[keep]'
    assert len(read(tmp_path, STUDY.replace("[keep]", methods)).design) == 12


def test_a_drawn_setting_that_no_run_could_have_is_refused_before_any(tmp_path):
    drawn = """"solver.alpha_f" = { distribution = "uniform", low = 0.1, high = 0.3 }
[design]
kind = "random"
size = 2
[keep]"""
    with pytest.raises(InputError, match=r"alpha_f = .*: not a parameter of chung-hulbert"):
        read(tmp_path, STUDY.replace("[keep]", drawn))
    method = f'"solver.method" = {{ values = [1, 2] }}\n{drawn}'  # as some of its runs could
    assert len(read(tmp_path, STUDY.replace("[keep]", method)).design)


@pytest.mark.parametrize(
    ("name", "low", "refusal"),
    [
        ("bearing[1].mu", -0.1, r"vary bearing\[1\].mu = -0.1: must be a finite number >= 0$"),
        ("run.rate", -5, r"run.rate = -5 rad/s2: must be > 0 and finite$"),
    ],
)
def test_a_distribution_ends_where_a_run_can_be(tmp_path, name, low, refusal):
    drawn = f'"{name}" = {{ distribution = "uniform", low = {low}, high = 10 }}\n[design]\n'
    text = STUDY.replace("[keep]", f'{drawn}kind = "random"\nsize = 2\n[keep]')
    with pytest.raises(InputError, match=refusal):
        read(tmp_path, text)


def test_whole_numbers_of_a_machine_are_not_drawn(tmp_path):
    law = '"solver.adaptive" = { distribution = "uniform", low = 0, high = 4 }\n[design]\n'
    text = STUDY.replace("[keep]", f'{law}kind = "random"\nsize = 2\n[keep]')
    with pytest.raises(InputError, match=r"vary solver.adaptive: is an integer; list its values"):
        read(tmp_path, text)


def test_what_is_kept_is_not_called_like_a_dimension_of_the_rows(tmp_path):
    with pytest.raises(InputError, match="keep turn: is the name of something else in the rows"):
        read(tmp_path, f'{HELD}[keep]\nturn = {{ poincare = "disc[3].x" }}\n')


def test_the_page_of_the_study_file_has_every_name_and_default():
    page = Path(__file__).parents[2] / "docs" / "reference" / "study_file.md"
    text = page.read_text(encoding="utf-8")
    words = {*re.findall(r"[\w-]+", " ".join(re.findall(r"`([^`\n]+)`", text)))}
    runs = (*IN_TIME, response_runs.RESPONSE)
    metrics = (*run_metrics.KINDS.values(), *response_runs.KINDS.values())
    named = {name for run in runs for name in (run.name, *run.numbers)}
    named |= {
        name for kind in metrics for name in (kind.said.split()[0], *kind.needed, *kind.optional)
    }
    named |= {*DESIGNS, *DISTRIBUTIONS, *(p for needed in DISTRIBUTIONS.values() for p in needed)}
    assert not sorted((named | {*TABLES}) - words - {GRID})
    defaults = {(n, of.default) for run in runs for n, of in run.numbers.items()}
    given = [(n, value) for n, value in defaults if isinstance(value, float) and value]
    assert not [n for n, value in given if f"`{n}` = {value:g}" not in text]
