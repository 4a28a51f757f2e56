"""Motions whose contacts open and close, by shooting: against integration in time by another
program, against harmonic balance, and gone on with after a stop."""

from copy import copy
from itertools import islice, pairwise

import numpy as np
import pytest
import scipy.integrate
from rotor_fmu.model.periodic import arclength, mesh
from rotor_fmu.model.periodic.arclength import ContinuationSteps, with_tangent
from rotor_fmu.model.periodic.bifurcation_search import bifurcations_between
from rotor_fmu.model.periodic.branch import solution
from rotor_fmu.model.periodic.branch_switching import follow_switched
from rotor_fmu.model.periodic.checkpoint import EventLog
from rotor_fmu.model.periodic.continuation import BranchSearch, follow, start_at
from rotor_fmu.model.periodic.fourier import resized, shifted
from rotor_fmu.model.periodic.harmonic_count import Accuracy
from rotor_fmu.model.periodic.method_switch import suitable_equations
from rotor_fmu.model.periodic.newton import solve
from rotor_fmu.model.periodic.problem import PeriodicError, Response, Task, machines_of
from rotor_fmu.model.periodic.queries import folds_over, motions_at
from rotor_fmu.model.periodic.shooting import Shooting

import rotor_fmu as rf

from .machines import CLEARANCE, FAINT_RUB, OMEGA, sagging
from .test_resume import called, equal

SPEED = 245.0
LIFTING = {"speed": (183.65, 185.5), "step": 0.1}  # of the rig


@pytest.fixture(scope="module")
def shot():
    """The equations of a rotor that leaves its stator and comes back each turn, and its state."""
    balanced = rf.response(sagging(), speed=(244.0, 246.0), harmonics=40, share=1e-6)
    (point,) = balanced.at(SPEED)
    task = Task(SPEED, SPEED + 1.0)
    machines = machines_of(sagging().rotor, task)
    equations = Shooting(task.problem(machines, SPEED, 60), point.orbit)
    return equations, solve(equations, equations.join(point.orbit), SPEED), point


def acceleration(t, z):
    """Of `sagging`, by hand: a disc of 1 kg on its spring, with its weight, in its stator."""
    r = np.hypot(z[0], z[1])
    pressed = 4 * OMEGA**2 * max(r - CLEARANCE, 0.0) / r
    turn = 0.3 * CLEARANCE * SPEED**2
    pull = turn * np.cos(SPEED * t), turn * np.sin(SPEED * t) - 9.81
    return [
        *z[2:],
        *(pull[i] - (OMEGA**2 + pressed) * z[i] - 2 * 0.05 * OMEGA * z[2 + i] for i in range(2)),
    ]


def test_a_motion_is_that_of_an_integrator_that_stops_at_each_touch(shot):
    equations, x, _ = shot
    orbit = equations.split(x, SPEED)
    y = orbit.b[0] + orbit.b[1::2].sum(axis=0)
    k = np.arange(1, orbit.H + 1)
    v = SPEED * (k[:, None] * orbit.b[2::2]).sum(axis=0)

    def touches(t, z):
        return np.hypot(z[0], z[1]) - CLEARANCE

    run = scipy.integrate.solve_ivp(
        acceleration,
        (0.0, 2 * np.pi / SPEED),
        np.append(y, v),
        rtol=1e-11,
        atol=1e-16,
        max_step=1e-4,
        events=touches,
        dense_output=True,
    )
    assert len(run.t_events[0]) >= 2
    t = np.linspace(0.0, 2 * np.pi / SPEED, 200)
    value = (
        np.cos(np.outer(SPEED * t, np.arange(orbit.H + 1))) @ np.vstack([orbit.b[0], orbit.b[1::2]])
        + np.sin(np.outer(SPEED * t, k)) @ orbit.b[2::2]
    )
    assert np.abs(run.sol(t)[:2].T - value).max() < 2e-5 * np.ptp(value)


def test_shooting_and_harmonic_balance_have_one_motion_and_one_stability(shot):
    equations, x, point = shot
    orbit = equations.split(x, SPEED)
    rows = 2 * point.orbit.H + 1
    size = np.abs(point.orbit.b).max()
    assert np.abs(orbit.b[:rows] - point.orbit.b).max() < 1e-5 * size
    seen, other = np.abs(equations.multipliers(x, SPEED)), np.abs(point.multipliers)
    assert seen[:4] == pytest.approx(other[:4], rel=1e-3)


def test_newtons_method_converges_quadratically_although_contacts_open(shot):
    equations, x, _ = shot
    near, sizes = x + 1e-3 * np.sin(np.arange(len(x))), []
    for _ in range(4):
        lack, jacobian = equations.linearized(near, SPEED)
        correction = -np.linalg.solve(jacobian, lack)
        near = near + correction
        sizes.append(float(np.linalg.norm(correction)))
    assert sizes[0] > 1e-4
    assert sizes[-1] < 1e-9
    assert sizes[2] < 1e-3 * sizes[1]


def test_steps_are_shorter_where_forces_change_and_end_in_their_corners(shot):
    equations, x, _ = shot
    equations.linearized(x, SPEED)
    flight = equations._integrated(x, SPEED)
    h = np.diff(flight.ends)
    assert h.sum() == pytest.approx(1.0)
    at = mesh.interpolated(flight.y[..., :2], flight.ends, flight.ends)
    gap = np.abs(np.hypot(at[:, 0], at[:, 1]) - CLEARANCE)
    assert np.sort(gap)[:2].max() < 1e-4 * CLEARANCE
    assert h.min() < 0.1 * h.max()


def test_steps_end_in_the_corners_also_after_many_small_changes_of_the_motion(shot):
    """Too small ones, each by itself, for a motion that has moved far."""
    equations, x, _ = shot
    equations = copy(equations)
    for speed in SPEED + 0.2 * np.arange(1, 9):
        x = solve(equations, x, speed)
        equations.fix_phase(x)
    flight = equations._integrated(x, speed)
    at = mesh.interpolated(flight.y[..., :2], flight.ends, flight.ends)
    gap = np.abs(np.hypot(at[:, 0], at[:, 1]) - CLEARANCE)
    assert np.sort(gap)[:2].max() < 1e-6 * CLEARANCE


def test_steps_end_in_the_corners_also_where_newtons_method_goes_to_and_fro(shot):
    """As beside a sharp fold, where one step along the curve after another is shortened."""
    equations, x, _ = shot
    equations = copy(equations)
    equations.fix_phase(x)
    for i in range(8):
        away = x.copy()
        away[-2:] += 1e-4 * np.array([1.0, -1.0]) * (-1) ** i * (i + 1)
        equations.linearized(away, SPEED)
    flight = equations._integrated(away, SPEED)
    at = mesh.interpolated(flight.y[..., :2], flight.ends, flight.ends)
    gap = np.abs(np.hypot(at[:, 0], at[:, 1]) - CLEARANCE)
    assert np.sort(gap)[:2].max() < 1e-6 * CLEARANCE


def test_steps_do_not_follow_small_changes_of_the_motion_that_do_not_shrink(shot):
    """Which are the error of the steps: Newton's method would go to and fro with them."""
    equations, x, _ = shot
    equations = copy(equations)
    equations.fix_phase(x)
    ends = []
    for i in range(6):
        away = x.copy()
        away[-2:] += 2e-5 * np.array([1.0, -1.0]) * (-1) ** i
        equations.linearized(away, SPEED)
        ends.append(equations._integrated(away, SPEED).ends)
    assert ends[-1] is ends[1]
    assert ends[0] is not shot[0]._ends


def test_beside_a_corner_no_other_step_ends_so_that_it_can_move(monkeypatch):
    """And none comes back behind it: the equations stay smooth."""
    at, tenths = np.array([0.505, 0.73]), np.linspace(0.0, 1.0, 11)
    monkeypatch.setattr(mesh, "_corners", lambda *_: at)
    ends, cells = mesh.with_corners(None, None, None, tenths)
    assert ends == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.505, 0.6, 0.7, 0.73, 0.8, 0.9, 1])
    at[0] = 0.55
    ends, cells = mesh.with_corners(None, None, None, cells)
    assert ends == pytest.approx([0, 0.1, 0.2, 0.3, 0.4, 0.55, 0.6, 0.7, 0.73, 0.8, 0.9, 1])


def test_multipliers_of_a_damped_contact_are_those_of_its_harmonics():
    """Though the corner where its damping begins lies a little before the end of a step."""
    machine = sagging(c=20.0, mu=0.1)
    options = {"harmonics": 100, "share": 1e-5, "step": 1.0}
    (point,) = rf.response(machine, speed=(70.5, 70.7), **options).at(70.7)
    task = Task(70.5, 70.7)
    equations = Shooting(task.problem(machines_of(machine.rotor, task), 70.7, 60), point.orbit)
    x = solve(equations, equations.join(point.orbit), 70.7)
    equations.fix_phase(x)
    seen, other = np.abs(equations.multipliers(x, 70.7)), np.abs(point.multipliers)
    assert seen[:4] == pytest.approx(other[:4], rel=1e-4)


def test_a_bifurcation_that_is_located_leaves_the_steps_of_the_curve_as_they_are(shot):
    equations, x, _ = shot
    ends = [with_tangent(equations, x, SPEED, 1.0)]
    ends.append(with_tangent(equations, solve(equations, x, 250.0), 250.0, 1.0))
    motions = [solution(equations, end, Accuracy()) for end in ends]
    steps = equations._ends
    (seen,) = bifurcations_between(equations, *ends, *motions)
    assert seen.kind == "period doubling"
    assert equations._ends is steps


def test_a_motion_of_few_harmonics_is_balanced_again_but_for_the_end_of_its_curve(shot):
    """Whose value is that of the range: in other unknowns the point moves along the curve."""
    equations, x, _ = shot
    point, few = with_tangent(equations, x, SPEED, 1.0), Accuracy(share=0.1, most=20)
    orbit = equations.split(x, SPEED)
    same, at, _ = suitable_equations(equations, point, orbit, few, is_end=True)
    assert (same, at) == (equations, point)
    balance, at, _ = suitable_equations(equations, point, orbit, few, is_end=False)
    assert balance.balanced_H == 20
    again, size = balance.split(at.x, at.value).b, np.abs(orbit.b).max()
    assert np.abs(again - resized(orbit.b, 20)).max() < 1e-3 * size


@pytest.mark.slow
def test_a_branch_is_followed_by_shooting_and_gone_on_with_after_a_stop(tmp_path):
    """To the same points, bit for bit, also after a stop in the midst of them."""
    machine = rf.load()
    whole = rf.response(machine, **LIFTING)
    assert whole.branches[0].ends == ("start", "end of the range")
    shot = [i for i, p in enumerate(whole.points) if p.orbit.H > 60]
    for stop in (shot[0] + 2, shot[1] + 2):
        assert called(tmp_path, machine, stop, **LIFTING).is_stopped
    assert equal(called(tmp_path, machine, **LIFTING), whole)


@pytest.mark.slow
def test_a_range_in_which_a_journal_lifts_off_throughout_begins_with_a_run_in_time():
    result = rf.response(rf.load(), speed=(186.0, 187.0))
    (branch,) = result.branches
    assert branch.ends == ("start", "end of the range")
    assert all(p.is_stable and p.orbit.H > 60 for p in branch.points)


@pytest.fixture(scope="module")
def by_shooting():
    """A branch with what begins on it, all followed by shooting, and the same by its harmonics."""
    balanced = rf.response(sagging(), speed=(244.0, 254.0), branches=True, harmonics=40, share=1e-6)
    (point,) = balanced.at(244.5)
    task = Task(244.0, 254.0, accuracy=Accuracy(share=1e-12, most=12), follows_bifurcations=True)
    machines = machines_of(sagging().rotor, task)
    search = BranchSearch(Response(sagging().rotor, task), machines, EventLog(), lambda *_: None)
    equations = Shooting(task.problem(machines, 244.5, 12), point.orbit)
    x = solve(equations, equations.join(point.orbit), 244.5)
    follow(search, start_at(equations, x, 244.5, 1.0))
    follow_switched(search)
    return search.result, balanced


def test_a_doubled_period_that_begins_on_a_branch_by_shooting_is_that_of_its_harmonics(by_shooting):
    result, balanced = by_shooting
    first, second = result.branches
    assert {(p.orbit.H > 12, p.orbit.turns) for p in first.points} == {(True, 1)}
    assert {(p.orbit.H > 12, p.orbit.turns) for p in second.points} == {(True, 2)}
    assert not any(note.code == "few-harmonics" for note in result.notes)  # it needs none
    (doubling,), (other,) = first.bifurcations, balanced.branches[0].bifurcations
    assert doubling.kind == other.kind == "period doubling"
    assert doubling.value == pytest.approx(other.value, rel=5e-5)
    for speed in (250.0, 252.0):
        for one, same in zip(motions_at(result, speed), balanced.at(speed), strict=True):
            rows = 2 * same.orbit.H + 1
            size = np.abs(same.orbit.b).max()
            assert one.orbit.turns == same.orbit.turns
            turns_later = (shifted(one.orbit.b, 2 * np.pi * i / same.orbit.turns) for i in (0, 1))
            apart = min(np.abs(b[:rows] - same.orbit.b).max() for b in turns_later)
            assert apart < 1e-6 * size
            assert abs(one.multipliers[0]) == pytest.approx(abs(same.multipliers[0]), rel=1e-3)


@pytest.mark.parametrize(("first", "is_short"), [(1.0, True), (0.05, False)])
def test_with_too_few_harmonics_a_curve_goes_on_by_shooting_where_its_steps_are_short(
    first, is_short
):
    """Shorter than the first one. There are 3 for each turn, and for this share never enough."""
    accuracy = Accuracy(share=-1.0, most=3, has_stability=False)
    steps = ContinuationSteps(initial=first, longest=0.1)
    task, rotor = Task(60.0, 62.0, accuracy=accuracy, steps=steps), FAINT_RUB.rotor
    machines = machines_of(rotor, task)
    search = BranchSearch(Response(rotor, task), machines, EventLog(), lambda *_: None)
    equations = task.problem(machines, 60.0, 3, turns=2)
    x = solve(equations, np.zeros(equations.size), 60.0)
    branch = follow(search, start_at(equations, x, 60.0, 1.0))
    H = [point.orbit.H for point in branch.points]
    assert H[:2] == [6, 6]
    assert (min(H[2:]) > 12) == is_short


def test_a_fold_found_by_shooting_has_no_curve_of_folds_and_says_what_to_do(by_shooting):
    result, _ = by_shooting
    (doubling,) = result.branches[0].bifurcations
    fold = doubling._replace(kind="fold")
    with pytest.raises(
        PeriodicError, match=r"^fold at 248\.9\d*: .* 12 harmonics, .* study"
    ) as error:
        folds_over(result, fold, "contact[1].clearance", 0.5 * CLEARANCE, 2 * CLEARANCE)
    assert "\n" not in str(error.value)


def test_the_longest_step_is_as_long_by_shooting_as_by_harmonics():
    """In clearances of the motion's series; a step is as long as the last one lets expect."""
    (point,) = rf.response(sagging(), speed=(244.0, 246.0), harmonics=40).at(SPEED)
    task = Task(200.0, 10200.0)
    machines = machines_of(sagging().rotor, task)
    balance = task.problem(machines, SPEED, 12)
    for equations in (balance, Shooting(balance, point.orbit)):
        x = solve(equations, equations.join(point.orbit), SPEED)
        start = with_tangent(equations, x, SPEED, 1.0)
        trace = arclength.trace(equations, start, 200.0, 1e4, ContinuationSteps(longest=0.1))
        points = [start, *(point for point, _ in islice(trace, 15))]
        b = [resized(equations.split(p.x, p.value).b, 60) / CLEARANCE for p in points]
        ways = [
            float(np.hypot(np.linalg.norm(after - before), (q.value - p.value) / 1e4))
            for (p, q), (before, after) in zip(pairwise(points), pairwise(b), strict=True)
        ]
        assert max(ways) == pytest.approx(0.1, rel=0.03)
