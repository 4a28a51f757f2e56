"""Responses of a rotor on tilting pads of which some bear nothing, or which hardly move."""

import numpy as np
import pytest
from rotor_fmu.model.periodic import newton
from rotor_fmu.model.settings import choose

import rotor_fmu as rf

from ..parts.machines import bearings, rigid

SPEED, CLEARANCE = 200.0, 5e-5


def on_pads(gravity, e=2e-6, preload=0.0, inertia=0.0, pivot=0.0):
    """A point mass on four pads, the load between two of them."""
    return rf.parse(
        rigid(
            gravity=gravity,
            mass=8.0,
            parts=bearings(10.0, 10.0)
            + f"""
[[journal_bearing]]
node = 2
journal_radius = 0.02
length = 0.04
clearance = {CLEARANCE}
viscosity = 0.02
tilting = true
pads = [0.785398, 2.356194, 3.926991, 5.497787]
arc = 1.3
preload = {preload}
pad_inertia = {inertia}
pivot_stiffness = {pivot}
[[unbalance]]
node = 2
amount = {8.0 * e}
""",
        )
    )


def stood(rotor):
    """A run of a machine at rest, and its laws."""
    from rotor_fmu.model.periodic.problem import Task, machines_of
    from rotor_fmu.model.simulation import Simulation

    run = Simulation(rotor, choose(), speed=SPEED)
    return run, machines_of(rotor, Task(100.0, 300.0))(SPEED).laws


@pytest.mark.parametrize(
    "more", [{"inertia": 1e-5}, pytest.param({"pivot": 1e8}, marks=pytest.mark.slow)]
)
def test_pads_that_bear_nothing_stay_where_they_are_in_a_response(more):
    """The upper two: what they are free to do is no part of the rotor's stability."""
    result = rf.response(on_pads(9.81, **more), speed=(SPEED, 1.01 * SPEED))
    (branch,) = result.branches
    assert branch.ends == ("start", "end of the range")
    point = branch.points[0]
    # rates, or displacements of pivots
    assert np.abs(point.orbit.states[:, [1, 3]]).max() < 1e-6 * CLEARANCE
    assert abs(point.multipliers[0]) < 0.98
    assert result.check(point, 5).stays


def test_a_response_begins_where_pads_bear_at_rest():
    """Without a run in time: from pads that do not tilt Newton's method goes to pads that bear
    nothing."""
    from rotor_fmu.model.periodic.problem import Task, machines_of
    from rotor_fmu.model.periodic.starting_points import guesses

    rotor, task = on_pads(0.0, preload=0.3).rotor, Task(100.0, 300.0)
    machines = machines_of(rotor, task)
    first = next(guesses(rotor, task, machines, SPEED, False, []))
    problem = task.problem(machines, SPEED, 3)
    orbit = problem.split(newton.solve(problem, problem.join(first), SPEED), SPEED)
    assert (orbit.states[0] > 0.3 * CLEARANCE).all()


def test_pads_on_elastic_pivots_rest_where_a_run_in_time_begins():
    """The lower two; the upper two bear nothing, and may be anywhere where they still do not."""
    from rotor_fmu.model.periodic.problem import Task, machines_of
    from rotor_fmu.model.periodic.self_excited import rest_position

    model, task = on_pads(9.81, pivot=1e8), Task(100.0, 300.0)
    run, _ = stood(model.rotor)
    problem = task.problem(machines_of(model.rotor, task), SPEED, 1)
    rest = rest_position(problem, SPEED)
    begins = run.motion.internal_state
    assert rest.states[0, 4:] == pytest.approx(begins[4:], abs=1e-6 * CLEARANCE)
    assert (rest.states[0, [0, 2]] < begins[[0, 2]]).all()
    assert (rest.states[0, [1, 3]] == 0.0).all()


@pytest.mark.parametrize("more", [{}, {"inertia": 1e-5}, {"pivot": 1e8}])
def test_pads_that_bear_nothing_leave_the_jacobian_regular(more):
    """Although no equation says where they are: what the mean of their tilt is may be any."""
    from rotor_fmu.model.periodic.problem import Task, machines_of
    from rotor_fmu.model.periodic.self_excited import rest_position

    rotor, task = on_pads(9.81, **more).rotor, Task(100.0, 300.0)
    problem = task.problem(machines_of(rotor, task), SPEED, 1)
    x = problem.join(rest_position(problem, SPEED))
    assert np.linalg.cond(problem.linearized(x, SPEED)[1]) < 1e9


def test_pads_that_bear_and_do_not_move_have_the_derivatives_of_their_rates():
    """A vertical rotor without unbalance, whose films' moments are in balance."""
    run, laws = stood(on_pads(0.0, e=0.0, preload=0.3).rotor)
    still, at = np.zeros((8, 2)), run.motion.internal_state
    seen = laws.tangents(still[:1], still[:1], at[None], np.ones(4), SPEED).rates_by_states[0]
    step = 1e-4 * CLEARANCE
    states = at + step * np.vstack([np.eye(4), -np.eye(4)])
    above, below = np.split(laws.forces(still, still, states, SPEED).rates, 2)
    assert seen == pytest.approx((above - below).T / (2 * step), rel=1e-4, abs=1e-6 * SPEED)
    assert (np.diag(seen) < -0.1 * SPEED).all()


@pytest.mark.parametrize("pivot", [pytest.param(0.0, marks=pytest.mark.slow), 1e8])
def test_pads_without_preload_of_a_vertical_rotor_leave_it_to_its_other_supports(pivot):
    """None bears at rest, where each is at the edge of bearing: it whirls between them freely."""
    result = rf.response(on_pads(0.0, pivot=pivot), speed=(SPEED, 1.01 * SPEED), step=3.0)
    (branch,) = result.branches
    assert branch.ends == ("start", "end of the range")
    free = 8.0 * 2e-6 * SPEED**2 / abs(10.0 - 8.0 * SPEED**2 + 10.0j * SPEED)
    (point,) = result.at(SPEED)
    assert np.hypot(*point.orbit.b[1:3, 0]) == pytest.approx(free, rel=1e-6)
    assert result.check(point, 5).stays


def test_the_tilt_of_pads_does_not_decide_how_straight_a_curve_is():
    """The mean tilt of a pad that touches once a turn jumps where the touch passes a sample."""
    from rotor_fmu.model.periodic.problem import Task, machines_of
    from rotor_fmu.model.periodic.self_excited import rest_position

    rotor, task = on_pads(9.81).rotor, Task(100.0, 300.0)
    problem = task.problem(machines_of(rotor, task), SPEED, 2)
    orbit = rest_position(problem, SPEED)
    tilted = orbit._replace(states=orbit.states + 1.0)
    ways = (np.append(problem.join(each), 1.0) for each in (orbit, tilted))
    one, other = map(problem.of_motion, ways)
    assert len(one) == (2 * problem.H + 1) * problem.b + 1
    assert (one == other).all()
