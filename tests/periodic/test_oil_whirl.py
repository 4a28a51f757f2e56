"""The whirl of a rotor in oil films as a branch with its frequency unknown, against CVODE."""

import numpy as np
import pytest
from rotor_fmu.model.linear import bearing_curves
from rotor_fmu.model.periodic.newton import solve
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.self_excited import _SIZES, growing_whirls

import rotor_fmu as rf
from rotor_fmu.errors import InputError
from rotor_fmu.periodic.response_page import response_page

from ..parts.test_limit_cycle import _C, REFERENCES, _rotor

LOW, HIGH = 0.95, 1.35  # of the threshold


@pytest.fixture(scope="module")
def threshold():
    return bearing_curves(_rotor(), np.linspace(400.0, 1200.0, 5)).threshold


@pytest.fixture(scope="module")
def whirl(threshold):
    return rf.response(_rotor(), speed=(LOW * threshold, HIGH * threshold), whirl=True)


@pytest.mark.parametrize("beyond", REFERENCES)
def test_the_branch_is_the_limit_cycle_in_size_and_frequency(whirl, threshold, beyond):
    speed = beyond * threshold
    expected = REFERENCES[beyond]
    (point,) = whirl.at(speed)
    assert point.is_stable
    x, y = whirl.series(point, "body[1]", 2000)
    z = (x + 1j * y) / _C
    r = np.abs(z - z.mean())
    assert (r.max(), r.min()) == pytest.approx((expected.largest, expected.least), rel=1e-3)
    assert point.orbit.omega / speed == pytest.approx(expected.ratio, rel=1e-4)


def test_the_branch_begins_where_rest_loses_its_stability(whirl, threshold):
    (branch,) = whirl.branches
    assert branch.ends == ("the whirl begins there, at rest", "end of the range")
    assert branch.points[0].value == pytest.approx(threshold, rel=2e-3)
    # it leaves towards higher speeds, turns back, and goes on as the large whirl from below
    assert [b.kind for b in whirl.bifurcations] == ["fold", "fold"]
    upper, lower = (b.value / threshold for b in whirl.bifurcations)
    assert lower < 1.0 < upper


def test_far_beyond_the_threshold_a_large_whirl_is_found_that_carries_its_load_itself(threshold):
    """From a guess about the place of rest Newton's method does not get there."""
    speed = 2.0 * threshold
    task = Task(speed, 1.1 * speed)
    problem = task.problem(machines_of(_rotor(), task), speed, 3, is_autonomous=True, omega=speed)
    guess = list(growing_whirls(problem, speed))[_SIZES.index(0.9)]
    x = problem.join(guess)
    problem.fix_phase(x)
    b = problem.split(solve(problem, x, speed), speed).b / _C
    assert np.abs(b[0]).max() < 0.1 < 0.9 < np.abs(b[1:3]).max() < 1.0


def test_a_whirl_shows_its_own_frequency_and_nothing_that_is_bound_to_the_shaft(whirl):
    fold, table = whirl.bifurcations[0], whirl.table()
    row = dict(zip(table.heads, table.rows[0], strict=True))
    assert row["whirl [Hz]"] == pytest.approx(fold.orbit.omega / (2 * np.pi))
    assert not whirl.curve("body[1].x_1x").value.any()
    assert np.isnan(whirl.curve("body[1].x_1x_phase").value).all()
    html = response_page(whirl, "whirl")
    assert '"frequency":"Hz"' in html
    assert '"x_1x"' not in html
    with pytest.raises(InputError, match=r"^body\[1\]\.x: .*no section once a turn$"):
        whirl.section("body[1]", "x")


def test_below_the_threshold_no_whirl_is_found_and_that_is_said(threshold):
    result = rf.response(_rotor(), speed=(0.5 * threshold, 0.9 * threshold), whirl=True)
    assert not result.branches
    assert any("rolls along a wall or grows from rest" in note for note in result.notes)
