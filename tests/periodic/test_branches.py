"""Branches that hang together with neither end of the range, and those that begin at bifurcations
of others."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.periodic import starting_points, tracer
from rotor_fmu.model.periodic.arclength import ContinuationSteps
from rotor_fmu.model.periodic.balance import Orbit
from rotor_fmu.model.periodic.branch import Branch
from rotor_fmu.model.periodic.checkpoint import EventLog
from rotor_fmu.model.periodic.continuation import (
    BranchSearch,
    _joined,
    _reason_lost,
    follow,
    start_at,
)
from rotor_fmu.model.periodic.harmonic_count import Accuracy
from rotor_fmu.model.periodic.newton import NotConverged, solve
from rotor_fmu.model.periodic.problem import Response, Task, machines_of
from rotor_fmu.model.periodic.response import response

import rotor_fmu as rf
from rotor_fmu.display import choose, restored
from rotor_fmu.periodic.result import ResponseResult

from .machines import BETA, CLEARANCE, FAINT, FAINT_RUB, OMEGA, ZETA, jeffcott, sagging


def radii(omega):
    """Radii of the frictionless rub of T1 in clearances, the smaller first; none without one."""
    s, d = 1 + BETA - omega**2, 2 * ZETA * omega
    a, b, c = s * s + d * d, BETA * s, BETA**2 - (FAINT * omega**2) ** 2
    if b * b < a * c:
        return []
    return [(b + sign * math.sqrt(b * b - a * c)) / a for sign in (-1, 1)]


def test_without_a_seed_the_isolated_rub_is_not_there():
    (branch,) = rf.response(FAINT_RUB, speed=(60.0, 240.0)).branches
    assert all(p.is_stable for p in branch.points)


@pytest.mark.parametrize("omega", [1.1, 1.2, 1.3, 1.4, 1.5])
def test_an_isolated_branch_is_found_by_a_seed_with_the_radii_of_the_closed_form(isola, omega):
    whirl, *rub = sorted(
        (isola.amplitude(p, "disc") / CLEARANCE, p.is_stable) for p in isola.at(omega * OMEGA)
    )
    assert whirl[0] < 1
    assert [r for r, _ in rub] == pytest.approx(radii(omega), rel=1e-6)
    assert [stable for _, stable in rub] == [False, True]


def test_the_isolated_branch_is_closed_and_folds_where_the_closed_form_begins_and_ends(isola):
    assert isola.branches[1].ends == ("the branch is closed",) * 2
    folds = sorted(b.value / OMEGA for b in isola.branches[1].bifurcations)
    for fold, inward in zip(folds, (1, -1), strict=True):
        assert not radii(fold * (1 - inward * 1e-4))
        assert radii(fold * (1 + inward * 1e-4))


def test_a_curve_begins_at_rest_on_a_contact_where_no_other_start_leads_to_a_motion(monkeypatch):
    """On a hard wall with friction, where runs in time settle on no periodic motion. At the other
    end no start leads to a motion, but the curve does: no note denies that."""

    def at_lower_end(problem, value):
        return rest_position(problem, value) if value < 61.0 else None

    rest_position = starting_points.rest_position
    monkeypatch.setattr(starting_points, "_PERIODS", ())
    monkeypatch.setattr(starting_points, "rest_position", at_lower_end)
    machine = sagging(gravity=20.0, k=1e7, mu=0.2, e=0.05)
    found = rf.response(machine, speed=(60.0, 62.0), step=3.0, stability=False)
    assert {branch.ends for branch in found.branches} == {("start", "end of the range")}
    assert not found.notes


@pytest.mark.parametrize(("least", "count"), [(0.2, 0), (0.29, 2)])
def test_a_run_that_diverges_is_said_only_where_no_motion_was_found(least, count):
    """Beyond a friction of 0.24 runs in time diverge, but a curve from below goes on."""
    options = {"speed": 140.0, "over": ("contact[1].mu", least, 0.3), "step": 3.0}
    found = rf.response(sagging(c=20.0, e=0.3), **options, stability=False)
    assert len(found.notes) == count
    for note, mu in zip(found.notes, (0.29, 0.3), strict=False):
        assert f"at contact[1].mu = {mu}: neither from rest, nor from a run in time: " in note
        assert "diverged" in note


def test_a_branch_does_not_begin_at_a_motion_of_few_harmonics_alone():
    """On a hard wall open contacts lead to one, from which no curve can be followed."""
    found = rf.response(sagging(k=1e6), speed=(60.0, 61.0), harmonics=30, step=3.0, stability=False)
    assert all(branch.points for branch in found.branches)
    assert not any("lost" in note for note in found.notes)


def test_a_fold_beside_a_point_at_which_the_harmonics_become_more_is_found():
    """The point is a millionth short of it with 6 harmonics, and would be past it with 10."""
    options = {"speed": (60.0, 240.0), "harmonics": 60, "stability": False}
    (branch,) = rf.response(jeffcott(), parameters={"gravity": 6.0}, **options).branches
    rises = np.diff([p.value for p in branch.points]) > 0
    turned = np.flatnonzero(rises[1:] != rises[:-1])  # each fold is a step before it or behind
    assert len(turned) == len(branch.bifurcations) == 4
    for at, fold in zip(turned, branch.bifurcations, strict=True):
        assert at <= fold.behind <= at + 1
        assert fold.kind == "fold"


@pytest.mark.filterwarnings("error")
def test_a_branch_of_one_point_is_drawn_without_a_warning(isola):
    one = Branch(points=[isola.points[0]], ends=("start", "lost: at once"))
    result = Response(FAINT_RUB.rotor, Task(60.0, 240.0), [one])
    low, high = ResponseResult(result).figure().axes[0].get_xlim()
    assert low < isola.points[0].value / (2 * math.pi) < high


def test_a_branch_lost_before_its_first_point_is_none(monkeypatch):
    def lost(*_):
        raise NotConverged

    monkeypatch.setattr(tracer, "solution", lost)
    result = rf.response(jeffcott(), speed=(60.0, 70.0))
    assert result.branches == []
    assert str(result.notes[0]).startswith("no branch can begin at speed = 9.5493 Hz: lost: ")


def test_a_branch_that_comes_to_one_that_was_lost_ends_there(curve):
    """Beyond the fold at 202.2 rad/s, before which its motions are close to those of the lost one,
    but none of these. A branch that was lost at its start has no point to come to."""
    whole, pointless = curve.branches[0].points, Branch(ends=("start", "lost: at once"))
    lost = Branch(points=whole[:120], ends=("start", "lost: at a corner"))
    steps = ContinuationSteps(longest=0.3)
    task = Task(60.0, 240.0, accuracy=Accuracy(has_stability=False), steps=steps)
    rotor, fast = jeffcott().rotor, whole[-1]
    machines = machines_of(rotor, task)
    search = BranchSearch(
        Response(rotor, task, [pointless, lost]), machines, EventLog(), lambda *_: None
    )
    equations = task.problem(machines, fast.value, fast.orbit.H)
    x = solve(equations, equations.join(fast.orbit), fast.value)
    branch = follow(search, start_at(equations, x, fast.value, -1.0))
    assert branch.ends == ("start", "joins branch 2")
    assert [b.kind for b in branch.bifurcations] == ["grazing", "fold"]
    assert branch.points[-1].value == pytest.approx(lost.points[-1].value, rel=0.01)


@pytest.mark.parametrize(("side", "joined"), [(1.0, 1), (-1.0, None)])
def test_the_other_side_of_a_fold_is_not_joined_however_close(side, joined):
    """Two motions each of the sides of a fold at 1, which are a percent apart."""

    def motions(side, *values):
        series = ([[1.0 + 0.005 * side * math.sqrt(1.0 - value)], [0.0], [0.0]] for value in values)
        orbits = (Orbit(np.array(b), np.zeros((3, 0)), 1.0, 1, 1.0, 0.0) for b in series)
        return [SimpleNamespace(value=v, orbit=o) for v, o in zip(values, orbits, strict=True)]

    lost = Branch(points=motions(1.0, 0.0, 0.5, 0.9), ends=("start", "lost: at a corner"))
    found = SimpleNamespace(branches=[lost, Branch(points=motions(side, 0.8, 0.2))])
    assert _joined(found) == joined


@pytest.mark.usefixtures("one_circle")
def test_a_seed_where_nothing_else_is_says_so():
    result = rf.response(FAINT_RUB, speed=(75.0, 85.0), seeds=(80.0,))
    assert len(result.branches) == 1
    said = "no further motion was found at the seed speed = "
    assert f"{said}12.732 Hz" in result.notes
    with restored():
        choose("rpm")
        assert f"{said}763.94 rpm" in result.notes


def test_a_branch_of_twice_the_period_begins_at_each_period_doubling(doubled):
    first, second = (branch.points for branch in doubled.branches)
    ends = sorted(b.value for b in doubled.branches[0].bifurcations if b.kind == "period doubling")
    assert {p.orbit.turns for p in first} == {1}
    assert {p.orbit.turns for p in second} == {2}
    assert len(ends) == 2
    # it leaves one and joins at the other, where what alternates is nothing
    assert doubled.branches[1].ends[1] == "joins a branch of a shorter period"
    reached = sorted((second[0], second[-1]), key=lambda p: p.value)
    for point, end in zip(reached, ends, strict=True):
        halves = np.abs(point.orbit.b[1:3]).max()
        assert abs(point.value - end) < 0.02 * end
        assert halves < 0.2 * np.abs(point.orbit.b[3:5]).max()
    # between them the period of one turn is unstable
    between = [p for p in first if ends[0] < p.value < ends[1]]
    assert not any(p.is_stable for p in between)


def test_a_branch_is_followed_from_a_motion_of_twice_the_period_that_no_option_tells(doubled):
    options = {"start": doubled.branches[1].points[5], "harmonics": 40, "step": 0.8}
    (branch,) = rf.response(sagging(), speed=(240.0, 300.0), **options).branches
    assert branch.ends == ("joins a branch of a shorter period", "end of the range")
    assert {p.orbit.turns for p in branch.points} == {2}


def test_the_table_says_where_a_real_multiplier_crosses_the_unit_circle(doubled):
    crossings = {row[1]: row[3] for row in doubled.table().rows}
    assert crossings["period doubling"] == pytest.approx(-1.0, abs=1e-5)
    assert crossings["fold"] == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("turns", [30, pytest.param(60, marks=pytest.mark.slow)])
def test_the_integrator_stays_on_a_doubled_period_and_comes_round_in_two_turns(doubled, turns):
    stable = [p for p in doubled.branches[1].points if p.is_stable]
    apart = []
    for point in stable[:: len(stable) // 2]:
        assert doubled.check(point, turns).distance < 1e-3
        y = doubled.series(point, "disc", 128)[1]
        apart.append(np.abs(y - np.roll(y, 64)).max() / np.ptp(y))
    assert max(apart) > 0.2


@pytest.mark.slow
def test_all_motions_at_a_speed_are_those_of_both_periods(doubled):
    points = doubled.at(330.0)
    assert sorted(p.orbit.turns for p in points)[0] == 1
    assert sorted(p.orbit.turns for p in points)[-1] == 2
    # and the one looked for by its period is the same
    direct = rf.response(sagging(), speed=(324.0, 327.0), period=2, harmonics=40, seeds=(325.0,))
    sizes = [direct.amplitude(p, "disc") for p in direct.at(326.0) if p.is_stable]
    expected = [doubled.amplitude(p, "disc") for p in doubled.at(326.0) if p.is_stable]
    assert min(abs(s / expected[0] - 1) for s in sizes) < 1e-4


def test_a_curve_of_hundreds_of_clearances_is_whole():
    """Lightly damped beside a wall too soft to matter, as the linear rotor's closed form; of more
    steps than are allowed here if they did not grow with the motion."""
    zeta, e = 1e-3, 0.5
    machine = jeffcott(zeta=zeta, beta=1e-7, mu=0.0, e=e)
    steps = ContinuationSteps(longest=0.8, max_points=200)
    task = Task(30.0, 300.0, steps=steps, accuracy=Accuracy(has_stability=False))
    found = ResponseResult(response(machine.rotor, task))
    (branch,) = found.branches
    assert branch.ends[1] == "end of the range"
    curve = found.curve("disc")
    omega = curve.parameter / OMEGA
    r = e * omega**2 / abs(1 - omega**2 + 2j * zeta * omega)
    assert curve.value / CLEARANCE == pytest.approx(r, rel=1e-3)
    assert curve.value.max() / CLEARANCE == pytest.approx(e / (2 * zeta), rel=1e-3)


def test_a_branch_that_is_not_finished_says_so_in_note_table_and_picture():
    steps = ContinuationSteps(longest=0.1, max_points=10)
    found = ResponseResult(response(FAINT_RUB.rotor, Task(60.0, 100.0, steps=steps)))
    last = [branch.points[-1].value for branch in found.branches]
    why = "unfinished: 10 steps were taken, the most in one direction"
    assert [note.code for note in found.notes] == ["branch-unfinished"] * len(last) != []
    for i, (note, value) in enumerate(zip(found.notes, last, strict=True), 1):
        at = f"branch {i} ends at speed = {value / (2 * math.pi):.5g} Hz: "
        assert note == f"{at}{why}; ask for a longer step or a shorter range"
        assert 60.0 < value < 100.0
    assert why in found.table().title
    labels = [text.get_text() for text in found.figure().axes[0].get_legend().get_texts()]
    assert "the curve is unfinished" in labels


def test_a_response_without_a_branch_says_so_in_its_table():
    none = ResponseResult(Response(FAINT_RUB.rotor, Task(60.0, 100.0)))
    assert none.table().title == "Periodic response over speed; no branch"


WORN = """
gravity = 9.81
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.15, 0.3, 0.5]
diameters = [0.02, 0.02, 0.02]
eta_v = 2e-5
[[disc]]
node = 2
diameter = 0.2
width = 0.02
e = 8e-5
[[support]]
node = 1
stiffness = 1e6
damping = 300.0
[[support]]
node = 4
stiffness = 1e6
damping = 300.0
[[seal]]
node = 2
kxx = 2e5
kyy = 2e5
kxy = 4e4
kyx = -4e4
cxx = 100.0
cyy = 100.0
cxy = 10.0
cyx = -10.0
[[contact]]
node = 3
journal_radius = 0.012
clearance = 1e-4
mu = 0.2
k = 1e8
exponent = 1.5
wear = 3e-5
mu_rise = 0.1
v_stribeck = 0.02
housing = "stator"
[[housing]]
name = "stator"
mass = 2.0
mass_ratio = 1.5
kx = 1e6
ky = 2e6
cx = 50.0
cy = 60.0
"""


def test_a_branch_is_followed_once_although_few_harmonics_are_another_motion_at_its_end():
    """In a worn bore the three harmonics of a start are 3 % off the motion with enough."""
    result = rf.response(rf.parse(WORN), speed=(150.0, 420.0), stability=False)
    assert len(result.branches) == 1
    assert len(result.at(300.0)) == 1


@pytest.mark.parametrize(("walls", "advice"), [([], "ask for more"), ([0], "soften the wall")])
def test_a_branch_with_too_many_harmonics_advises_of_a_wall_only_where_there_is_one(walls, advice):
    """Of a machine in oil films there is none to be softened."""
    machine = SimpleNamespace(laws=SimpleNamespace(rubbing=walls))
    balance = SimpleNamespace(machine_at=lambda _: machine)
    tracer = SimpleNamespace(broken=[], balance=balance)
    last = SimpleNamespace(value=1.0, last_share=0.1, orbit=SimpleNamespace(H=30))
    why = _reason_lost(tracer, Branch(points=[last]), Accuracy(most=30))
    assert why.endswith(advice)


def test_branches_that_break_a_symmetry_are_followed_although_they_stay_near_the_one_they_leave():
    """In unequal springs, without gravity, an orbit inverted is an orbit half a turn later."""
    kyy = {f"linear_bearing[{i}].kyy": k for i, k in ((1, 125.0), (2, 12250.0), (3, 125.0))}
    rotor = jeffcott(zeta=0.04, beta=8.0, mu=0.015, e=0.25, v_s=1e-2)
    options = {"parameters": kyy, "harmonics": 15, "branches": True, "step": 1.0}
    found = rf.response(rotor, speed=(102, 105), **options)
    seen = [(p.is_stable, found.quantities(p, "disc")) for p in found.at(103.9)]
    assert [is_stable for is_stable, _ in seen] == [False, True, True]
    middles = np.array([complex(q["x"], q["y"]) for _, q in seen]) / CLEARANCE
    assert middles[0] == pytest.approx(0.0, abs=1e-9)
    assert middles[1] == pytest.approx(-middles[2], rel=1e-6)
    assert abs(middles[1]) > 1e-3
    # at 104.28 rad/s they turn too sharply for a step, and are not listed as the first one again
    assert [branch.ends[1] for branch in found.branches[1:]] == ["joins branch 1"] * 2
