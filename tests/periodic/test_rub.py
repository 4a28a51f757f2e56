"""The synchronous rub and dry whirl as curves, against their closed forms."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from rotor_fmu.model.periodic import newton
from rotor_fmu.model.periodic.arclength import ContinuationSteps
from rotor_fmu.model.periodic.folds import FoldCurve
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.queries import folds_over, motions_at
from rotor_fmu.model.periodic.self_excited import rolling_whirls

import rotor_fmu as rf
from rotor_fmu.errors import InputError

from ..known import EXAMPLES
from .machines import BETA, CLEARANCE, OMEGA, RADIUS, ZETA, E, growth, jeffcott, rolling, rub

WHOLE = 2 * ("end of the range",)  # how both ends of a curve of folds are said


def radii(curve, omega):
    """Radii in clearances at a speed, the largest first, with whether each is stable."""
    result = [
        (curve.amplitude(p, "disc") / CLEARANCE, p.is_stable) for p in curve.at(omega * OMEGA)
    ]
    return sorted(result, reverse=True)


@pytest.mark.parametrize(
    ("omega", "radius", "unstable"),
    [
        (0.9, 1.039376, None),
        (1.0, 1.109153, None),
        (1.2, 1.296981, None),
        (1.4, 1.580638, 1.007200),
        (1.8, 2.777077, 1.416169),
        (2.0, 3.598968, 2.459855),
    ],
)
def test_the_curve_has_the_radii_of_the_closed_form(curve, omega, radius, unstable):
    result = radii(curve, omega)
    assert result[0][0] == pytest.approx(radius, rel=1e-6, abs=1e-6)
    assert result[0][1]
    if unstable is None:
        assert len(result) == 1
    else:
        assert result[1][0] == pytest.approx(unstable, rel=1e-6, abs=1e-6)
        assert not result[1][1]
        assert result[2][0] < 1
        assert result[2][1]


def test_at_the_value_of_a_point_of_the_curve_its_motion_is_given_once(curve):
    """Such as at a seed, from which a branch goes both ways."""
    for point in curve.points[5:40:17]:
        found = radii(curve, point.value / OMEGA)
        again = radii(curve, (point.value + 1e-6) / OMEGA)
        assert [r for r, _ in found] == pytest.approx([r for r, _ in again], rel=1e-4)


@pytest.mark.parametrize("failures", [1, 2])
def test_a_motion_between_points_far_apart_is_found_in_smaller_steps(curve, monkeypatch, failures):
    """Where Newton's method does not converge from what lies between them, in 4 or 16."""
    few, solve, calls = replace(curve._response), newton.solve, []
    few.branches = [replace(curve.branches[0], points=curve.points[10:31:20])]
    first, last = few.branches[0].points
    value = 0.6 * first.value + 0.4 * last.value
    (expected,) = motions_at(few, value)

    def failing(*arguments):
        calls.append(arguments[2])
        if len(calls) <= failures:
            raise newton.NotConverged
        return solve(*arguments)

    monkeypatch.setattr(newton, "solve", failing)
    (found,) = motions_at(few, value)
    assert found.orbit.b == pytest.approx(expected.orbit.b, abs=1e-9 * CLEARANCE)
    assert len(calls) == failures + 4**failures
    assert (np.diff(calls[failures:]) > 0).all()


def test_it_jumps_up_and_down_where_the_closed_form_does(curve):
    fold, grazing = curve.bifurcations
    assert (fold.kind, grazing.kind) == ("fold", "grazing")
    assert fold.value / OMEGA == pytest.approx(2.02208, rel=1e-5)
    # where the whirl without rub fills the clearance: E s^2 = |1 - s^2 + 2 i ZETA s|
    squares = np.roots([1 - 0.5**2, -2 + 4 * 0.1**2, 1])
    assert grazing.value / OMEGA == pytest.approx(math.sqrt(squares.real.max()), rel=1e-4)


@pytest.mark.parametrize("omega", [0.9, 1.0, 1.2, 1.4, 1.8, 2.0])
def test_multipliers_are_those_of_the_closed_forms_exponents(curve, omega):
    for point in curve.at(omega * OMEGA):
        r = curve.amplitude(point, "disc") / CLEARANCE
        if r > 1:
            seen = np.log(np.abs(point.multipliers[:2])) * omega / (2 * math.pi)
            assert seen == pytest.approx(growth(omega, r)[:2], abs=1e-5)


def test_newtons_method_converges_quadratically(curve):
    """Each correction is about the square of the one before; below 1e-5 the difference by which the
    speed's column is made is seen."""
    pairs = [pair for p in curve.points for pair in pairwise(p.corrections) if pair[0] > 1e-5]
    assert len(pairs) > 50
    assert sum(last <= 30 * before**2 for before, last in pairs) > 0.97 * len(pairs)


def test_friction_beyond_hopfs_point_makes_a_torus(curve, over_friction):
    start = curve.at(1.4 * OMEGA)[0]
    assert curve.amplitude(start, "disc") > 1.2 * CLEARANCE
    (torus,) = [b for b in over_friction.bifurcations if b.kind == "Neimark-Sacker"]
    assert torus.value == pytest.approx(0.147023, rel=1e-4)
    # beyond it neither the curve nor a run in time says that the motion is periodic and stays
    for mu, is_stable, turns in ((0.1, True, 30), (0.2, False, 100)):
        (point,) = over_friction.at(mu)
        assert point.is_stable == is_stable
        assert (abs(point.multipliers[0].imag) > 0.1) or is_stable
        assert over_friction.check(point, turns).stays == is_stable


def test_a_curve_of_folds_that_leaves_the_machine_out_is_refused_in_one_line(curve):
    with pytest.raises(InputError, match=r"^contact\[1\]\.mu = 0\.1:0\.2: must hold .*0\.05$"):
        curve.fold_curve("contact[1].mu", 0.1, 0.2)


@pytest.mark.parametrize(
    ("least", "most"), [(0.03, 0.07), pytest.param(0.01, 0.1, marks=pytest.mark.slow)]
)
def test_jumps_over_friction_lie_where_the_closed_form_folds(curve, least, most):
    folds = curve.fold_curve("contact[1].mu", least, most)
    assert folds.ends == WHOLE
    assert_folds_are_those_of_the_closed_form(folds)


def test_a_curve_of_folds_is_drawn_in_the_units_shown_with_a_cross_where_it_is_lost(curve):
    second, first = 1e-3 * np.array([0.9, 1.0, 1.1]), np.array([190.0, 202.0, 215.0])
    folds = FoldCurve(second, first, ("end of the range", "lost: at a corner"))
    axes = curve.fold_figure("contact[1].clearance", folds).axes[0]
    line, cross = axes.lines
    assert line.get_xdata() == pytest.approx(1e6 * second)
    assert line.get_ydata() == pytest.approx(first / (2 * math.pi))
    assert cross.get_xydata() == pytest.approx(line.get_xydata()[-1:])
    assert axes.get_xlabel() == "contact[1].clearance [µm]"
    assert axes.get_ylabel() == "speed of the fold [Hz]"


def test_a_curve_of_folds_begins_at_the_least_that_the_machine_can_have():
    smooth = rf.response(jeffcott(mu=0.0), speed=(130.0, 240.0), step=0.4, stability=False)
    folds = smooth.fold_curve("contact[1].mu", 0.0, 0.05)
    assert folds.ends == WHOLE
    assert folds.second[0] == 0.0
    assert_folds_are_those_of_the_closed_form(folds)


def test_a_curve_of_folds_that_takes_too_many_steps_is_said_to_be_unfinished(curve):
    task = replace(curve._response.task, steps=ContinuationSteps(max_points=3))
    few = replace(curve._response, task=task)
    fold = next(b for b in curve.bifurcations if b.kind == "fold")
    folds = folds_over(few, fold, "contact[1].mu", 0.01, 0.1)
    assert folds.second[0] > 0.01
    assert folds.second[-1] < 0.1
    assert folds.ends == 2 * ("unfinished: 3 steps were taken, the most in one direction",)


def assert_folds_are_those_of_the_closed_form(folds):
    for mu, speed in zip(folds.second, folds.first, strict=True):
        # where the two radii meet
        inside, outside = speed / OMEGA * (1 - 2e-6), speed / OMEGA * (1 + 2e-6)
        assert rub(inside, mu) >= rub(inside, mu, -1)
        with pytest.raises(ValueError, match="domain"):
            rub(outside, mu)


@pytest.mark.parametrize("v", [2.0, *(pytest.param(v, marks=pytest.mark.slow) for v in (4.0, 8.0))])
def test_dry_whirl_rolls_as_the_closed_form_says(v):
    machine = jeffcott(0.05, 20.0, 0.1, 0.0)
    speed = v * CLEARANCE * OMEGA / RADIUS
    over = ("contact[1].mu", 0.02, 0.11)
    result = rf.response(machine, speed=speed, over=over, whirl=True, step=1.0)
    points = result.at(0.1)
    (rolls,) = [p for p in points if p.is_stable]
    (slides,) = [p for p in points if not p.is_stable]
    omega, r = rolling(v)
    assert rolls.orbit.omega / OMEGA == pytest.approx(omega, rel=1e-4)
    assert result.amplitude(rolls, "disc") / CLEARANCE == pytest.approx(r, rel=1e-4)
    # the separatrix of T2
    assert slides.orbit.omega / OMEGA == pytest.approx(1.618034, rel=1e-4)
    assert result.amplitude(slides, "disc") / CLEARANCE == pytest.approx(1.088023, rel=1e-4)
    (needed,) = [b.value for b in result.bifurcations if b.kind == "fold"]
    assert needed == pytest.approx(2 * 0.05 * omega / (20 * (1 - 1 / r)), rel=5e-3)


def test_a_whirl_of_many_clearances_rolls_as_the_closed_form_says_over_all_speeds():
    """In long steps, although its friction turns within a millionth of its frequency."""
    machine = jeffcott(mu=0.2, e=0.0)
    result = rf.response(machine, speed=(50.0, 250.0), whirl=True, stability=False)
    assert {branch.ends for branch in result.branches} == {2 * ("end of the range",)}
    points = [p for p in result.points if p.orbit.omega > 2.1 * OMEGA]
    assert len(points) < 100
    for point in points:
        omega, r = rolling(point.value * RADIUS / (CLEARANCE * OMEGA), BETA)
        assert point.orbit.omega / OMEGA == pytest.approx(omega, rel=1e-5)
        assert result.amplitude(point, "disc") / CLEARANCE == pytest.approx(r, rel=1e-5)
    assert {50.0, 250.0} <= {point.value for point in points}


@pytest.mark.parametrize("v", [1.5, 5.6, 10.0, 300.0])
def test_the_first_guess_of_a_whirl_that_rolls_is_balanced(v):
    """From one beside it Newton's method finds the unstable whirl that slides, or none."""
    machine, speed = jeffcott(0.05, 20.0, 0.1, 0.0), v * CLEARANCE * OMEGA / RADIUS
    task = Task(speed, 2.0 * speed, is_whirl=True)
    machines = machines_of(machine.rotor, task)
    problem = task.problem(machines, speed, 3, omega=speed)
    guess = next(rolling_whirls(problem, speed))
    omega, r = rolling(v)
    assert guess.omega / OMEGA == pytest.approx(omega, rel=1e-5)
    assert np.abs(guess.b[1:3]).max() / CLEARANCE == pytest.approx(r, rel=1e-5)


def test_a_branch_that_comes_back_to_the_end_of_the_range_where_it_began_has_both_motions(curve):
    start = curve.at(1.9 * OMEGA)[0]
    options = {"start": start, "stability": False, "step": 3.0}
    over = "contact[1].clearance", CLEARANCE, 1.4 * CLEARANCE
    (branch,) = rf.response(jeffcott(), speed=1.9 * OMEGA, over=over, **options).branches
    ends = branch.points[0], branch.points[-1]
    assert [end.value for end in ends] == [CLEARANCE, CLEARANCE]
    r = sorted(abs(end.orbit.b[1, 0] + 1j * end.orbit.b[2, 0]) / CLEARANCE for end in ends)
    assert r == pytest.approx([rub(1.9, sign=-1), rub(1.9)], rel=1e-6)


@pytest.mark.slow
def test_the_threshold_of_dry_whirl_is_the_closed_forms():
    """Of a clearance that is nothing beside the surface's speed."""
    gap = 1e-9
    result = rf.response(
        jeffcott(0.05, 20.0, 0.03, 0.0, gap),
        speed=1e6 * gap * OMEGA / RADIUS,
        over=("contact[1].mu", 0.015, 0.05),
        whirl=True,
    )
    fold = min(b.value for b in result.bifurcations if b.kind == "fold")
    assert fold == pytest.approx(2 * 0.05 * math.sqrt(21) / 20, rel=1e-5)


@pytest.mark.parametrize("turns", [30, pytest.param(100, marks=pytest.mark.slow)])
def test_the_integrator_stays_on_stable_motions_and_leaves_others(curve, turns):
    stable, unstable, free = sorted(
        curve.at(1.8 * OMEGA), key=lambda p: -curve.amplitude(p, "disc")
    )
    assert curve.check(stable, turns).distance < 1e-5
    assert curve.check(free, turns).distance < 1e-5
    assert not curve.check(unstable, turns).stays


@pytest.mark.parametrize("width", [3.0, pytest.param(30.0, marks=pytest.mark.slow)])
def test_a_curve_doubles_back_where_a_contact_begins_however_narrow_the_range(width):
    """At 138.45 rad/s, in the narrow range nearly the way it came."""
    found = rf.response(jeffcott(), speed=(138.0, 138.0 + width), step=1.0)
    assert {branch.ends for branch in found.branches} == {("start", "end of the range")}
    omega = 1.4
    r = [found.amplitude(p, "disc") / CLEARANCE for p in found.at(omega * OMEGA)]
    whirl = E * omega**2 / abs(1 - omega**2 + 2j * ZETA * omega)
    assert sorted(r) == pytest.approx([whirl, rub(omega, sign=-1), rub(omega)], rel=1e-6)


def test_an_undamped_resonance_that_a_hard_wall_stops_goes_on_at_the_wall():
    """The wall is as stiff as 600 of the rotor's springs: where its curve comes to the wall, it
    turns at right angles, and back along the motion that is just pressed against it."""
    e, beta, omega = 0.004, 600.0, 1.03
    machine = jeffcott(zeta=1e-6, beta=beta, mu=0.0, e=e)
    found = rf.response(machine, speed=(0.98 * OMEGA, 1.05 * OMEGA), stability=False)
    assert {branch.ends for branch in found.branches} == {("start", "end of the range")}
    r = [found.amplitude(p, "disc") / CLEARANCE for p in found.at(omega * OMEGA)]
    pushed, stiff = e * omega**2, 1 + beta - omega**2
    free = pushed / (omega**2 - 1)
    expected = [free, (beta - pushed) / stiff, (beta + pushed) / stiff]
    assert sorted(r) == pytest.approx(expected, rel=1e-5)


@pytest.mark.slow
def test_over_its_clearance_a_rub_goes_on_beyond_the_corner_where_its_contact_begins():
    """In one branch: the rub up to its fold, back to the corner, and the whirl without contact."""
    over = ("contact[1].clearance", 7e-4, 2.1e-3)
    found = rf.response(jeffcott(), speed=160.0, over=over, step=1.0, stability=False)
    (branch,) = found.branches
    assert branch.ends == ("start", "end of the range")
    fold, corner = branch.bifurcations
    assert (fold.kind, corner.kind) == ("fold", "grazing")
    whirl = E * 1.6**2 / abs(1 - 1.6**2 + 2j * ZETA * 1.6)
    assert corner.value == pytest.approx(whirl * CLEARANCE, rel=1e-4)
    assert len(found.at(1e-3)) == 3


def test_a_doubled_period_that_differs_by_less_than_a_thousandth_of_the_sag_is_found():
    """In a resonance of the rub a turn's mark of the sagging disc alternates by 0.86 um, its sag is
    0.98 mm and the clearance 1 mm. The numbers are of a run of 600 turns, tolerance 1e-7."""
    machine = rf.load(EXAMPLES / "response" / "sag.toml")
    found = rf.response(machine, speed=(29.4, 29.75), branches=True)
    doubled = next(p for p in found.at(29.6) if p.orbit.turns == 2)
    marks = found.series(doubled, "disc", 256)[1][::128]
    assert sorted(marks) == pytest.approx([-986.22e-6, -985.37e-6], abs=0.01e-6)
    assert doubled.is_stable
    assert found.check(doubled).stays
