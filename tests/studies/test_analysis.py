"""What a study says, against what is known of the function it runs."""

import math
from dataclasses import replace

import numpy as np
import pytest
from SALib.analyze import morris
from xarray import Dataset

from rotor_fmu.cli.studies import _analyse, _print_table, _say_result
from rotor_fmu.run_status import OK
from rotor_fmu.studies.analysis import (
    analyse,
    design_of,
    drawn_rows,
    exceedance,
    sensitivity,
    statistics,
    worst,
)
from rotor_fmu.studies.design import Axis, Design, Distribution
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.store import about_of, open_dataset
from rotor_fmu.studies.study import Column, Limit, Result

from .functions import Ishigami, here, ishigami_study, quiet, study_text

# Ishigami and Homma 1990, by integration
_V1, _V2 = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2, 49 / 8
_V13 = 0.01 * math.pi**8 * 8 / 225
_V = _V1 + _V2 + _V13
FIRST = {"x1": _V1 / _V, "x2": _V2 / _V, "x3": 0.0}
TOTAL = {"x1": (_V1 + _V13) / _V, "x2": _V2 / _V, "x3": _V13 / _V}


def design_of_folder(folder):
    return design_of(about_of(folder / "out")["design"])


def analysed(folder, kind, size, model=None):
    study = ishigami_study(folder, model, study_text(kind, size))
    run_study(study, folder / "out", here, quiet)
    return analyse(folder / "out")


def test_sobol_indices_of_ishigamis_function_lie_within_their_confidence_intervals(tmp_path):
    result = analysed(tmp_path, "saltelli", 1024)["sensitivity"]["y"]["indices"]
    for name, row in result.items():
        assert row["S1"] == pytest.approx(FIRST[name], abs=row["S1_conf"])
        assert row["ST"] == pytest.approx(TOTAL[name], abs=row["ST_conf"])
        assert row["S1_conf"] < 0.1
        assert row["ST_conf"] < 0.1


def test_morris_ranks_ishigamis_parameters_and_sees_what_acts_with_others(tmp_path):
    result = analysed(tmp_path, "morris", 64)["sensitivity"]["y"]["indices"]
    assert result["x2"]["mu"] == pytest.approx(0.0, abs=1e-9 + result["x2"]["mu_star"])
    assert result["x3"]["mu_star"] > result["x3"]["mu_star_conf"]
    assert result["x3"]["sigma"] > abs(result["x3"]["mu"])


def test_blocks_with_a_failed_run_are_left_out_of_the_indices(tmp_path):
    report = analysed(tmp_path, "saltelli", 256, Ishigami(fails_above=3.1))
    result = report["sensitivity"]["y"]
    assert 0 < report["failed"] < 30
    assert 200 < result["blocks"] < 256 == result["of"]
    assert result["indices"]["x2"]["S1"] == pytest.approx(FIRST["x2"], abs=0.15)


def test_mean_and_standard_deviation_of_ishigamis_function(tmp_path):
    result = analysed(tmp_path, "sobol", 1024)["columns"]["y"]
    assert result["mean"] == pytest.approx(3.5, abs=0.02)
    assert result["std"] == pytest.approx(math.sqrt(_V), rel=0.01)


def test_shares_are_counted_over_runs_that_were_drawn_independently(tmp_path):
    """Those of a block of saltelli share coordinates: two of five are whole draws."""
    report = analysed(tmp_path, "saltelli", 64)
    assert report["rows"] == 64 * 5
    assert report["columns"]["y"]["count"] == 64 * 2
    data = open_dataset(tmp_path / "out")
    drawn = data.isel(run=drawn_rows(design_of_folder(tmp_path), data.run.values))
    for name in ("x1", "x2", "x3"):
        assert len(np.unique(drawn[name])) == 64 * 2


def test_quantiles_are_those_of_the_distribution_that_was_drawn():
    values = np.append(np.linspace(0, 1, 1001), np.nan)
    result = statistics(values)
    assert result["count"] == 1001
    assert result["quantiles"]["0.95"] == pytest.approx(0.95)


def test_the_share_above_a_limit_has_the_interval_of_clopper_and_pearson():
    result = exceedance(np.arange(100.0), Limit(94.5))
    assert result["beyond"] == 5
    # R: binom.test(5, 100)$conf.int
    assert result["interval"] == pytest.approx([0.01643187, 0.11283491], abs=1e-7)
    assert exceedance(-np.arange(100.0), Limit(-94.5, is_least=True))["beyond"] == 5


def test_one_value_does_not_scatter_and_none_has_no_statistics():
    one = statistics(np.array([math.nan, 2.0]))
    assert (one["count"], one["mean"], one["std"]) == (1, 2.0, 0.0)
    assert statistics(np.array([math.nan])) == {"count": 0}
    none = {"limit": 1.0, "is_least": False, "beyond": 0, "failed": 0, "count": 0}
    assert exceedance(np.array([math.nan]), Limit(1.0)) == none


def test_an_infinite_value_is_above_a_limit_and_among_the_worst():
    """The verification of a run whose finer twin has no value."""
    values = np.array([0.5, math.inf, math.nan, 2.0])
    result = exceedance(values, Limit(1.0))
    assert (result["beyond"], result["count"]) == (2, 3)
    status = ("run", ["ok", "doubtful: not-confirmed", "failed: so", "ok"])
    data = Dataset(
        {"q": ("run", values), "status": status}, {"run": range(4), "id": ("run", list("abcd"))}
    )
    assert [row["id"] for row in worst(data, "q")] == list("cbda")


def test_a_column_that_varies_only_outside_whole_blocks_has_no_indices(tmp_path):
    study = ishigami_study(tmp_path, None, study_text("saltelli", 4))
    columns = np.full(len(study.design), 5.0)
    columns[:2] = math.nan, 7.0
    data = Dataset({"y": ("run", columns)}, {"run": range(len(columns))})
    assert sensitivity(study.design, data, "y") == {}


def test_no_number_is_cut_off_on_a_narrow_screen(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "60")
    _print_table([{"column": "a"} | {f"quantile {i}": -1.234e-100 for i in range(20)}])
    assert capsys.readouterr().out.count("-1.234e-100") == 20


def test_a_speed_in_the_tables_of_a_study_has_all_digits_before_the_point(capsys):
    _print_table([{"run.speed [rpm]": 12345.0, "pk [um]": 0.0123}])
    assert capsys.readouterr().out.split()[-2:] == ["12345", "0.0123"]


def with_limit(folder, kind, size, model=None, limit=5.0):
    text = f"{study_text(kind, size)}\n[limits]\ny = {limit}\n"
    run_study(ishigami_study(folder, model, text), folder / "out", here, quiet)
    return analyse(folder / "out")


def test_the_share_of_a_grids_points_is_no_estimate(tmp_path):
    values = "\n".join(f"x{i} = {{ values = [0.1, 1.0, 2.0] }}" for i in (1, 2, 3))
    study = ishigami_study(tmp_path, text=f"[vary]\n{values}\n[limits]\ny = 5.0\n")
    run_study(study, tmp_path / "out", here, quiet)
    report = analyse(tmp_path / "out")
    result = report["limits"]["y"]
    assert 0 < result["beyond"] < result["count"] == 27
    assert "interval" not in result
    assert "the points of a grid are chosen" in report["says"][0]


class _PartOfIshigami(Ishigami):
    """Without a value of y where x1 is not positive, as of a speed that no run passes."""

    def run(self, values):
        result = super().run(values)
        is_there = values["x1"] > 0
        return result if is_there else replace(result, cells={**result.cells, "y": math.nan})


@pytest.mark.parametrize("kind", ["random", "morris"])
def test_a_share_tells_how_many_runs_have_no_value(tmp_path, kind):
    report = with_limit(tmp_path, kind, 20, _PartOfIshigami(fails_above=3.0))
    result = report["limits"]["y"]
    said = [text for text in report["says"] if "no value" in text]
    lacking = 20 - result["count"]
    assert 0 < lacking < 20 or kind == "morris"
    words = f"{lacking} of 20 runs have no value of y, whose share is of the others"
    assert said == ([words] if kind == "random" else [])


class _IshigamiInMetres(Ishigami):
    columns = (Column("y", "m", "value"), Ishigami.columns[1])


@pytest.mark.parametrize(
    ("kind", "heading"), [("morris", "y [um], indices from 8 of"), ("saltelli", "y, indices from")]
)
def test_only_indices_of_morris_have_the_columns_unit(kind, heading, tmp_path, capsys):
    study = ishigami_study(tmp_path, _IshigamiInMetres(), study_text(kind, 8))
    run_study(study, tmp_path / "out", here, quiet)
    _analyse(study, tmp_path / "out")
    assert f"\n{heading}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("of", "said"), [("y", "no run has a value of y\n"), ("curve", "the points of a grid")]
)
def test_columns_without_a_number_are_said_instead_of_an_empty_table(of, said, tmp_path, capsys):
    columns = tuple(column for column in Ishigami.columns if column.name == of)
    model = type("Failing", (Ishigami,), {"columns": columns})(fails_above=-math.inf)
    values = "\n".join(f"x{i} = {{ values = [1.0] }}" for i in (1, 2, 3))
    study = ishigami_study(tmp_path, model, f"[vary]\n{values}\n")
    run_study(study, tmp_path / "out", here, quiet)
    _analyse(study, tmp_path / "out")
    assert capsys.readouterr().out.startswith(said)


def test_infinite_values_are_counted_as_values(tmp_path, capsys):
    """As of a machine that leaves its rest without a vibration, whose decrement is -inf."""

    class Leaving(Ishigami):
        columns = Ishigami.columns[:1]

        def run(self, values):
            return Result(OK, {"y": -math.inf if values["x1"] < 2.0 else 1.0})

    def said(values, name):
        text = f"[vary]\nx1 = {{ values = {values} }}\nx2 = {{ values = [1.0] }}\n"
        study = ishigami_study(tmp_path, Leaving(), f"{text}x3 = {{ values = [1.0] }}\n")
        run_study(study, tmp_path / name, here, quiet)
        _analyse(study, tmp_path / name)
        return capsys.readouterr().out

    infinite = "runs have an infinite value of y, which stands in no quantile\n"
    assert f"1 of 2 {infinite}" in said([1.0, 2.0], "some")
    of_all = said([0.0, 1.0], "all")
    assert f"2 of 2 {infinite}" in of_all
    assert "no run has a value" not in of_all


def test_points_that_morris_places_give_no_quantiles_and_no_share(tmp_path):
    report = with_limit(tmp_path, "morris", 32)
    assert set(report["columns"]["y"]) == {"count", "least", "largest"}
    assert set(report["limits"]["y"]) == {"limit", "is_least", "beyond", "failed", "count"}
    assert "no quantiles and no shares" in report["says"][0]
    assert report["sensitivity"]["y"]["indices"]


@pytest.mark.parametrize(
    ("kind", "size", "is_conservative"),
    [
        ("random", 64, False),
        ("latin-hypercube", 64, True),
        ("sobol", 64, True),
        ("saltelli", 32, True),
    ],
)
def test_an_interval_of_points_spread_evenly_says_that_it_is_conservative(
    tmp_path, kind, size, is_conservative
):
    report = with_limit(tmp_path, kind, size)
    result = report["limits"]["y"]
    assert result["conservative"] == is_conservative
    assert any("conservative" in sentence for sentence in report["says"]) == is_conservative
    # P(y > 5), by four million random draws
    assert result["interval"][0] < 0.3621 < result["interval"][1]


@pytest.mark.parametrize("kind", ["latin-hypercube", "sobol"])
def test_shares_of_points_spread_evenly_do_scatter_less(kind):
    """What makes the interval conservative: of a sum that exceeds its 0.9 quantile."""
    law = Distribution("uniform", {"low": 0.0, "high": 1.0})
    axes = tuple(Axis(n, (n,), distribution=law) for n in "abc")
    shares = []
    for seed in range(60):
        design = Design(axes, kind, 64, seed)
        sums = [sum(design.point(run).values()) for run in range(len(design))]
        shares.append(np.mean(np.array(sums) > 2.156))
    assert np.mean(shares) == pytest.approx(0.1, abs=0.02)
    assert np.std(shares) < 0.93 * math.sqrt(0.1 * 0.9 / 64)


def test_a_draw_at_several_points_of_a_list_is_not_several_draws(tmp_path):
    drawn = "x1 = { distribution = 'uniform', low = -3, high = 3 }"
    listed = "x2 = { values = [0.1, 1.0] }\nx3 = { values = [0.5] }"
    design = "[design]\nkind = 'random'\nsize = 20\n"
    text = f"{design}[vary]\n{drawn}\n{listed}\n[limits]\ny = 1.0\n"
    run_study(ishigami_study(tmp_path, None, text), tmp_path / "out", here, quiet)
    report = analyse(tmp_path / "out")
    assert report["limits"]["y"]["count"] == 40
    assert "interval" not in report["limits"]["y"]
    assert "each draw stands at all points of the lists" in report["says"][0]


def test_runs_that_failed_count_in_the_share_and_are_said(tmp_path):
    report = with_limit(tmp_path, "random", 200, Ishigami(fails_above=2.5))
    data = open_dataset(tmp_path / "out")
    failed = int((data.x1 > 2.5).sum())
    above = int((data.y > 5.0).sum())
    result = report["limits"]["y"]
    assert failed == result["failed"] == report["failed"] > 5
    assert (result["beyond"], result["count"]) == (above, 200)
    assert result["share"] == (above + failed) / 200
    assert result["interval"][0] < result["share"] < result["interval"][1]
    assert report["columns"]["y"]["count"] == 200 - failed
    assert f"{failed} of 200 runs failed: they count as beyond every limit" in report["says"][0]


def test_equal_points_are_one_run_with_one_id(tmp_path):
    """Trajectories of morris on a coarse grid meet again and again; its indices are those that all
    points give."""
    text = study_text("morris", 40).replace("seed = 3", "seed = 3\nlevels = 2")
    study = ishigami_study(tmp_path, None, text)
    assert len(study.design) == 8 < study.design.drawn_points == 160
    run_study(study, tmp_path / "out", here, quiet)
    data = open_dataset(tmp_path / "out")
    assert len(set(data.id.values)) == data.sizes["run"] == 8
    sample = study.design.sample
    x1, x2, x3 = (2 * math.pi * sample - math.pi).T
    y = np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)
    right = morris.analyze(study.design.problem(), sample, y, num_levels=2, seed=3)
    result = analyse(tmp_path / "out")["sensitivity"]["y"]
    assert (result["blocks"], result["of"]) == (40, 40)
    for i, name in enumerate(("x1", "x2", "x3")):
        assert result["indices"][name]["mu_star"] == pytest.approx(float(right["mu_star"][i]))


def test_a_value_that_is_listed_twice_is_run_once(tmp_path):
    lists = "x1 = { values = [1.0, 1, 2.0] }\nx2 = { grid = { from = 3, to = 3, count = 4 } }"
    study = ishigami_study(tmp_path, None, f"[vary]\n{lists}\nx3 = {{ values = [0.0, -0.0] }}\n")
    run_study(study, tmp_path / "out", here, quiet)
    data = open_dataset(tmp_path / "out")
    assert data.x1.values.tolist() == [1.0, 2.0]
    assert len(set(data.id.values)) == 2


def test_the_worst_runs_are_the_failed_ones_and_then_the_largest(tmp_path):
    study = ishigami_study(tmp_path, Ishigami(fails_above=3.0))
    run_study(study, tmp_path / "out", here, quiet)
    rows = worst(open_dataset(tmp_path / "out"), "y", 80)
    failed = [row["status"].startswith("failed") for row in rows]
    assert failed == sorted(failed, reverse=True)
    finite = [abs(row["y"]) for row in rows if not math.isnan(row["y"])]
    assert finite == sorted(finite, reverse=True)


@pytest.mark.parametrize(
    ("limits", "said", "order"),
    [
        ("", "largest of y [1] in size", [3, -3, 1, -1]),
        ("[limits]\ny = 5\n", "largest of y [1]", [3, 1, -1, -3]),
        ("[limits]\ny = { least = 5 }\n", "smallest of y [1]", [-3, -1, 1, 3]),
    ],
)
def test_runs_beyond_a_limit_stand_before_those_far_from_it(tmp_path, capsys, limits, said, order):
    lists = "x1 = { values = [1.5, -1.5] }\nx2 = { values = [0] }\nx3 = { values = [1, 3] }\n"
    study = ishigami_study(tmp_path, text=f"[vary]\n{lists}{limits}")
    progress = run_study(study, tmp_path / "out", here, quiet)
    shown = _say_result(study, tmp_path / "out", progress)["worst"]
    assert f"the {said}, what failed first:" in capsys.readouterr().out
    assert [row["x3"] * np.sign(row["x1"]) for row in shown] == order
