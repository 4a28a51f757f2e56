"""What a study says, against what is known of the function it runs."""

import math

import numpy as np
import pytest

from rotor_fmu.studies.analysis import (
    analyse,
    design_of,
    exceedance,
    is_drawn,
    statistics,
    worst,
)
from rotor_fmu.studies.conduct import conduct
from rotor_fmu.studies.dataset import about_of, open_dataset

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
    conduct(study, folder / "out", here, quiet)
    return analyse(folder / "out")


def test_sobol_indices_of_ishigamis_function_lie_within_their_confidence_intervals(tmp_path):
    found = analysed(tmp_path, "saltelli", 1024)["sensitivity"]["y"]["indices"]
    for name, row in found.items():
        assert row["S1"] == pytest.approx(FIRST[name], abs=row["S1_conf"])
        assert row["ST"] == pytest.approx(TOTAL[name], abs=row["ST_conf"])
        assert row["S1_conf"] < 0.1
        assert row["ST_conf"] < 0.1


def test_morris_ranks_ishigamis_parameters_and_sees_what_acts_with_others(tmp_path):
    found = analysed(tmp_path, "morris", 64)["sensitivity"]["y"]["indices"]
    assert found["x2"]["mu"] == pytest.approx(0.0, abs=1e-9 + found["x2"]["mu_star"])
    assert found["x3"]["mu_star"] > found["x3"]["mu_star_conf"]
    assert found["x3"]["sigma"] > abs(found["x3"]["mu"])


def test_blocks_with_a_failed_run_are_left_out_of_the_indices(tmp_path):
    report = analysed(tmp_path, "saltelli", 256, Ishigami(fails_above=3.1))
    found = report["sensitivity"]["y"]
    assert 0 < report["failed"] < 30
    assert 200 < found["blocks"] < 256 == found["of"]
    assert found["indices"]["x2"]["S1"] == pytest.approx(FIRST["x2"], abs=0.15)


def test_mean_and_standard_deviation_of_ishigamis_function(tmp_path):
    found = analysed(tmp_path, "sobol", 1024)["columns"]["y"]
    assert found["mean"] == pytest.approx(3.5, abs=0.02)
    assert found["std"] == pytest.approx(math.sqrt(_V), rel=0.01)


def test_shares_are_counted_over_runs_that_were_drawn_independently(tmp_path):
    """Those of a block of saltelli share coordinates: two of five are whole draws."""
    report = analysed(tmp_path, "saltelli", 64)
    assert report["rows"] == 64 * 5
    assert report["columns"]["y"]["count"] == 64 * 2
    data = open_dataset(tmp_path / "out")
    drawn = data.isel(run=np.flatnonzero(is_drawn(design_of_folder(tmp_path), data.run.values)))
    for name in ("x1", "x2", "x3"):
        assert len(np.unique(drawn[name])) == 64 * 2


def test_quantiles_are_those_of_the_distribution_that_was_drawn():
    values = np.append(np.linspace(0, 1, 1001), np.nan)
    found = statistics(values)
    assert found["count"] == 1001
    assert found["quantiles"]["0.95"] == pytest.approx(0.95)


def test_the_share_above_a_limit_has_the_interval_of_clopper_and_pearson():
    found = exceedance(np.arange(100.0), 94.5)
    assert found["above"] == 5
    # R: binom.test(5, 100)$conf.int
    assert found["interval"] == pytest.approx([0.01643187, 0.11283491], abs=1e-7)


def test_the_share_of_a_grids_points_is_no_estimate(tmp_path):
    values = "\n".join(f"x{i} = {{ values = [0.1, 1.0, 2.0] }}" for i in (1, 2, 3))
    study = ishigami_study(tmp_path, text=f"[vary]\n{values}\n[limits]\ny = 5.0\n")
    conduct(study, tmp_path / "out", here, quiet)
    found = analyse(tmp_path / "out")["limits"]["y"]
    assert 0 < found["above"] < found["count"] == 27
    assert "interval" not in found


def test_the_worst_runs_are_the_failed_ones_and_then_the_largest(tmp_path):
    study = ishigami_study(tmp_path, Ishigami(fails_above=3.0))
    conduct(study, tmp_path / "out", here, quiet)
    rows = worst(open_dataset(tmp_path / "out"), "y", 80)
    failed = [row["status"].startswith("failed") for row in rows]
    assert failed == sorted(failed, reverse=True)
    finite = [abs(row["y"]) for row in rows if not math.isnan(row["y"])]
    assert finite == sorted(finite, reverse=True)
