"""The studies that come with the project, at their quick size, against what is known."""

import math
import pickle
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu import studies
from rotor_fmu.machine_studies.machine_runs import machine_of
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.studies.runner import run_study

from .functions import here, quiet

FOLDER = Path(__file__).parents[2] / "examples" / "studies"


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    """The rows of a study at its quick size."""

    def made(name):
        study = read_study(FOLDER / f"{name}.toml", is_quick=True)
        out = tmp_path_factory.mktemp(name)
        run_study(study, out, here, quiet)
        data = studies.open(out)
        assert (data.status.values == "ok").all()
        return data

    return made


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.toml")), ids=lambda path: path.stem)
def test_every_study_of_the_examples_can_be_read_and_sent_to_a_worker(path):
    if path.stem == "whip":
        assert machine_of(path.read_text(), False).rotor.name == "Jeffcott rotor that whips"
        return
    study = read_study(path)
    assert len(study.design) > 8
    assert pickle.loads(pickle.dumps(study.model)).identity == study.model.identity
    assert len(read_study(path, is_quick=True).design) <= 12


@pytest.mark.slow  # through the FMU it is in tests/fmu/test_fold.py
def test_the_jump_up_is_the_fold_of_the_full_annular_rub_within_a_percent(quick):
    data = quick("hysteresis")
    assert data.fall.values / 100.0 == pytest.approx([2.02208], rel=0.01)
    radius = data.radius.sel({"held speed": [120.0, 140.0, 180.0]}, method="nearest")
    # closed form, stable branch, in clearances
    assert radius.values[0] / 1e-3 == pytest.approx([1.296981, 1.580638, 2.777077], rel=1e-3)


def test_a_dry_rotor_whips_only_with_more_friction_than_rolling_needs(quick):
    data = quick("dry_whip")
    V, beta, zeta = 8.0 / 2, 20.0, 0.05
    rolling = (-beta + math.sqrt(beta**2 + 4 * V**2 * (1 + beta))) / (2 * V)
    r = V / rolling
    needed = 2 * zeta * rolling / (beta * (1 - 1 / r))
    little, much = data["contact[1].mu"].values
    assert little < needed < much
    assert data.radius.values == pytest.approx([0.0, 1e-3 * r], rel=2e-3, abs=1e-6)
    assert data.whirl.values[1] == pytest.approx(-100 * rolling, rel=2e-3)


def test_a_motor_too_small_hangs_below_the_resonances_that_a_larger_one_passes(quick):
    data = quick("motor")
    small, large = data.w.values
    assert small < 2 * math.pi * 29.5 < 2 * math.pi * 32.5 < large
    assert np.isnan(data.passed.values[0])


def test_the_rig_with_wide_bearings_does_not_repeat_itself_every_turn(quick):
    data = quick("bifurcation_clearance")
    spread = np.ptp(data.y.values, axis=1)
    assert spread.max() > 1e-5


def test_the_rows_of_tolerances_give_indices(quick):
    data = quick("tolerances")
    assert data.sizes["run"] == 12
    assert np.ptp(data.X.values) > 1e-5
    assert np.isfinite(data.X_over_speed.values).any(axis=1).all()
