"""The whirl of a rotor in oil films as a branch with its frequency unknown, against CVODE."""

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.periodic.arclength import with_tangent
from rotor_fmu.model.periodic.floquet import multipliers
from rotor_fmu.model.periodic.fourier import amplitudes, coefficients, sampled
from rotor_fmu.model.periodic.harmonic_count import with_enough_harmonics
from rotor_fmu.model.periodic.newton import solve
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.self_excited import _SIZES, growing_whirls
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf
from rotor_fmu.errors import InputError
from rotor_fmu.periodic.response_page import response_page

from ..parts.test_limit_cycle import _C, REFERENCES, _rotor

LOW, HIGH = 0.95, 1.35  # of the threshold
PAST, CLEARANCE = 1498.0, 5e-5  # rad/s, 1.12 times the threshold of `flexible`; m


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
    task = Task(speed, 1.1 * speed, is_whirl=True)
    problem = task.problem(machines_of(_rotor(), task), speed, 3, omega=speed)
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


def flexible(length, diameter, mass, film, rest="", eta_v=1e-5):
    """A disc in the middle of a shaft, by default one that damps a little, between two short
    films."""
    text = f"""
[material]
young = 2.1e11
density = 7850.0
[shaft]
eta_v = {eta_v}
[[section]]
length = {length}
elements = 4
outer = {diameter}
[[body]]
z = {0.5 * length}
mass = {mass}
I_d = {0.002 * mass}
I_p = {0.004 * mass}
{rest}
"""
    for z in (0.0, length):
        text += f"""
[[journal_bearing]]
z = {z}
journal_radius = 0.015
clearance = {CLEARANCE}
short = true
k = 1e8
{film}
"""
    return parse_rotor(text)


HEAVY = 0.5, 0.04, 40.0, "length = 0.02\nviscosity = 0.02"
THIN = 0.4, 0.03, 2.0, "length = 0.0075\nviscosity = 0.003"


def test_a_large_whirl_in_which_the_mode_about_rest_is_another_is_that_of_a_run_in_time():
    """About rest, at 0.66 of the clearance, the mode is an ellipse at 0.36 of the speed."""
    task = Task(0.9 * PAST, PAST, is_whirl=True)
    machines = machines_of(flexible(*THIN), task)
    problem = task.problem(machines, PAST, 3, omega=PAST)
    *_, guess = growing_whirls(problem, PAST)
    x = problem.join(guess)
    problem.fix_phase(x)
    point = with_tangent(problem, solve(problem, x, PAST), PAST, 1.0)
    problem, point = with_enough_harmonics(problem, point, task.accuracy, True)
    orbit = problem.split(point.x, PAST)
    parts = problem.dynamic_stiffness(PAST, orbit.omega)
    places = machines(PAST).probes @ parts.whole(amplitudes(orbit.b)).T
    x, y = (sampled(coefficients(each), 256) for each in places[:2])
    z = (x + 1j * y) / CLEARANCE
    found = np.abs(z - z.mean())

    inside = f"[start]\nx = {CLEARANCE}\nvy = {0.5 * PAST * CLEARANCE}\n"
    settings = choose("controlled", tolerance=1e-3)
    rotor = flexible(*THIN, rest=inside)
    run = Simulation(rotor, settings, speed=PAST, warn=lambda _: None)
    turn = 2.0 * np.pi / PAST
    run.advance(40.0 * turn, PAST)
    seen = []
    for i in range(320):
        run.advance((40.0 + (i + 1) / 32) * turn, PAST)
        seen.append(complex(run.read("body[1].x"), run.read("body[1].y")) / CLEARANCE)
    z = np.array(seen)
    r = np.abs(z - z.mean())
    assert (found.max(), found.min()) == pytest.approx((r.max(), r.min()), rel=3e-3)
    angle = np.unwrap(np.angle(z - z.mean()))
    frequency = (angle[-1] - angle[0]) / (319 / 32 * turn)
    assert orbit.omega == pytest.approx(frequency, rel=3e-3)


def test_of_the_multipliers_of_a_whirl_that_nearly_fills_its_film_one_is_1():
    """That along its own motion: with the stiffness of so thin a film the journals' modes are far
    faster than the motion, but with its damping, which is larger still, not."""
    task = Task(900.0, 925.0, is_whirl=True)
    machines = machines_of(flexible(*HEAVY, eta_v=0.0), task)
    problem = task.problem(machines, 900.0, 7, omega=900.0)
    *_, circle = growing_whirls(problem, 900.0)
    x = problem.join(circle)
    problem.fix_phase(x)
    for speed in np.linspace(900.0, 922.0, 12):
        x = solve(problem, x, speed)
    orbit = problem.split(x, speed)
    assert 0.98 < np.abs(orbit.b[1:3]).max() / CLEARANCE < 1.0
    for steps in (96, 384):
        values = multipliers(machines(speed), orbit, steps).values
        assert np.abs(values - 1.0).min() < 1e-5
        assert np.abs(values[0]) < 1.0 + 1e-5


@pytest.mark.slow
def test_a_whirl_that_is_reached_with_few_harmonics_beside_a_fold_is_listed_once():
    rotor = flexible(0.3, 0.06, 6.0, "length = 0.015\nviscosity = 0.01")
    threshold = bearing_curves(rotor, np.linspace(800.0, 1600.0, 5)).threshold
    # the whirl folds at 1.029 of it, with few harmonics below the middle of this range
    (branch,) = rf.response(rotor, speed=(0.98 * threshold, 1.076 * threshold), whirl=True).branches
    assert branch.ends == ("the whirl begins there, at rest", "end of the range")
