"""The equations' Jacobian is their derivative, laws with states of their own included."""

import numpy as np
import pytest
from rotor_fmu.model.periodic import newton
from rotor_fmu.model.periodic.problem import Task, machines_of

import rotor_fmu as rf

from ..parts.machines import bearings, rigid, shaft
from ..parts.rings import RING, rigid_in_rings
from .machines import CLEARANCE, OMEGA, jeffcott

CONTACT = """
node = 2
journal_radius = 0.05
clearance = 1e-3
mu = 0.2
k = 4e4
c = 10.0
delta_c = 1e-4
v_s = 0.5
"""
MORE = "[[unbalance]]\nnode = 2\namount = 0.5e-3\n[[sensor]]\nnode = 2\nname = 'disc'\n"
KINDS = {
    "contact": f"[[contact]]{CONTACT}",
    "sticking": f"[[contact]]{CONTACT}k_t = 2e4\nc_t = 50.0\n",
    "race": f"[[touchdown_bearing]]{CONTACT}race_inertia = 1e-3\nrace_damping = 1e-3\n",
    "worn": f"[[contact]]{CONTACT}wear = 2e-4\n",
    # its damping acts in full at once, where the elastic force has a tangent like a root
    "Hertz": f"[[contact]]{CONTACT}exponent = 1.5\n".replace("1e-4", "1e-6").replace("4e4", "1e6"),
}


def rubbing(kind, is_autonomous=False):
    """The equations of a disc in a wall of a kind, and unknowns with which it rubs."""
    from rotor_fmu.model.periodic.balance import HarmonicBalance
    from rotor_fmu.model.periodic.linear_structure import CondensedMachine

    text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + KINDS[kind] + MORE, gravity=9.81)
    machine = CondensedMachine(rf.parse(text).rotor)
    problem = HarmonicBalance(
        lambda value: machine,
        "speed",
        100.0,
        120.0,
        4,
        is_autonomous=is_autonomous,
        omega=90.0,
        state_scale=np.array([50.0, 1e-3])[-machine.laws.states :] if machine.laws.states else None,
    )
    random = np.random.default_rng(7)
    x = 0.16 * random.standard_normal(problem.size)
    x[problem.b], x[2 * problem.b + 1] = 1.28, 1.28
    if is_autonomous:
        x[-1] = 1.0
        problem.fix_phase(x)
    return problem, x


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("is_autonomous", [False, True])
def test_the_jacobian_is_the_derivative(kind, is_autonomous):
    problem, x = rubbing(kind, is_autonomous)
    residual, jacobian, by_speed = problem.linearized_with_parameter(x, 120.0)
    assert residual == pytest.approx(problem.residual(x, 120.0), rel=1e-12, abs=1e-12)
    size = 1e-7
    seen = np.empty_like(jacobian)
    for i in range(problem.size):
        step = size * np.eye(problem.size)[i]
        twice = problem.residual(x + step, 120.0) - problem.residual(x - step, 120.0)
        seen[:, i] = twice / (2 * size)
    idle = np.flatnonzero(~seen.any(axis=1))  # the mean of a state that a part does without
    seen[idle, idle] = 1.0
    assert np.abs(seen - jacobian).max() <= 1e-3 * np.abs(jacobian).max()
    seen = problem.residual(x, 120.0 + 1e-4) - problem.residual(x, 120.0 - 1e-4)
    rounding = 1e-8 * np.abs(residual).max()  # over a step of 2e-4 of 120
    assert np.abs(100 * seen / 2e-4 - by_speed).max() <= 1e-3 * np.abs(by_speed).max() + rounding


def test_forces_that_begin_with_a_tangent_like_a_root_are_summed_as_of_many_samples():
    problem, x = rubbing("Hertz")
    fine = problem.modified(25 * problem.H)
    seen, forces = (
        p.residual(p_x, 120.0) / np.repeat(p.row_scale, p.b)
        for p, p_x in ((problem, x), (fine, problem.converted(x, fine)))
    )
    assert np.abs(seen - forces[: len(seen)]).max() < 4e-7 * np.abs(forces).max()


@pytest.mark.parametrize(("side", "force"), [(-1.0, 1.0), (1.0, 0.0)])
def test_beside_a_corner_the_derivative_by_a_clearance_is_that_of_its_own_side(side, force):
    """Of a circle that touches the wall all around, or just does not."""
    from rotor_fmu.model.periodic.problem import Task, machines_of

    rotor, r = jeffcott(mu=0.0).rotor, 1.5e-3
    task = Task(1e-3, 2e-3, "contact[1].clearance", speed=140.0)
    problem = task.problem(machines_of(rotor, task), r, 1, length_scale=r)
    x = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 1.0])
    _, _, by = problem.linearized_with_parameter(x, r * (1.0 + 1e-9 * side))
    expected = -force * problem.row_scale[1] * rotor.parameters()["contact[1].k"].value * 1e-3 / r
    assert by == pytest.approx(expected * x, rel=1e-5, abs=1e-8 * problem.row_scale[1])


def test_the_derivative_by_a_parameter_at_the_end_of_its_range_is_of_one_side():
    """Of a law with states too, whose other derivatives by a parameter are central."""
    rotor = rf.parse(rigid(parts=bearings(1e4, 20.0) + KINDS["race"] + MORE)).rotor
    task = Task(0.0, 0.3, "touchdown_bearing[1].mu", speed=140.0)
    problem = task.problem(machines_of(rotor, task), 0.0, 3)
    x = np.zeros(problem.size)
    x[problem.b], x[2 * problem.b + 1] = 1.3, 1.3
    residual, _, by = problem.linearized_with_parameter(x, 0.0)
    expected = (problem.residual(x, 1e-6) - residual) / (1e-6 / 0.3)
    assert by == pytest.approx(expected, rel=1e-3, abs=1e-3 * np.abs(expected).max())
    assert by.any()


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_the_phase_condition_is_scaled_to_one_however_large_the_whirl(size):
    """Else rounding of it would outweigh the other equations of a whirl of many clearances."""
    problem, x = rubbing("contact", is_autonomous=True)
    problem.fix_phase(np.append(size * x[:-1], 1.0))
    assert np.linalg.norm(problem.linearized(x, 120.0)[1][-1]) == pytest.approx(1.0)


@pytest.mark.parametrize("kind", ["sticking", "race"])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_beside_a_corner_the_derivatives_of_rates_are_those_of_their_own_side(kind, side):
    from rotor_fmu.model.periodic.linear_structure import CondensedMachine

    laws = CondensedMachine(rf.parse(rigid(parts=bearings(1e4, 20.0) + KINDS[kind])).rotor).laws
    v, states = np.array([[0.0, 0.1]]), np.zeros((1, laws.states))
    beside, near = (
        laws.tangents(np.array([[r, 0.0]]), v, states, laws.state_scales(OMEGA), OMEGA)
        for r in (CLEARANCE * (1.0 + side * far) for far in (1e-8, 1e-4))
    )
    assert (side > 0) == near.rates_by_d.any()
    apart = np.abs(beside.rates_by_d - near.rates_by_d).max()
    assert apart <= 0.05 * np.abs(near.rates_by_d).max()


PADS = """
[[journal_bearing]]
node = 2
journal_radius = 0.05
length = 0.05
clearance = 1e-4
viscosity = 0.1
tilting = true
pads = [0.9, 2.4, 4.0, 5.5]
arc = 1.3
preload = 0.5
offset = 0.55
"""


def errors_of_derivatives(laws, motion, sizes, speed):
    """Differences of the derivatives of forces and rates of two interfaces from differences, as
    shares of the largest of each row; motion: d, v and states, of these sizes."""

    def split(x):
        return x[:, :4], x[:, 4:8], x[:, 8:]

    seen = laws.tangents(*split(motion), sizes[8:], speed)
    force, rates = laws.forces(*split(motion), speed)
    for mine, other in ((seen.force, force), (seen.rates, rates)):
        assert np.abs(mine - other).max() <= 1e-14 * np.abs(other).max()
    mine = np.zeros((len(motion), 4 + laws.states, len(sizes)))
    for at in (slice(0, 2), slice(2, 4)):
        mine[:, at, at], mine[:, at, 4:8][..., at] = (by[:, at.start // 2] for by in seen[1:3])
    mine[:, :4, 8:], mine[:, 4:, 8:] = seen.by_states, seen.rates_by_states
    mine[:, 4:, :4], mine[:, 4:, 4:8] = seen.rates_by_d, seen.rates_by_v
    mine *= sizes
    slopes = np.zeros_like(mine)
    for i, step in enumerate(np.diag(1e-5 * sizes)):
        above, below = (laws.forces(*split(x), speed) for x in (motion + step, motion - step))
        slopes[:, :, i] = (np.hstack(above) - np.hstack(below)) / 2e-5
    return np.abs(mine - slopes) / np.maximum(np.abs(mine).max(axis=2, keepdims=True), 1e-12)


WALL = "k = 1e8\nroughness = 4e-5\n"


@pytest.mark.parametrize(
    ("inertia", "pivot", "wall"),
    [
        *((0.0, 0.0, WALL), (2e-3, 0.0, ""), (2e-3, 3e8, WALL)),
        *(
            pytest.param(*each, marks=pytest.mark.slow)
            for each in ((0.0, 0.0, ""), (2e-3, 0.0, WALL), (2e-3, 3e8, ""))
        ),
    ],
)
def test_derivatives_of_pads_are_those_of_force_and_rates(inertia, pivot, wall):
    """Beside them a contact that sticks, whose derivatives are differences."""
    from rotor_fmu.model.periodic.linear_structure import CondensedMachine

    pads = f"{PADS}pad_inertia = {inertia}\npivot_stiffness = {pivot}\n{wall}"
    text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + pads + KINDS["sticking"] + MORE)
    laws, c, speed, n = CondensedMachine(rf.parse(text).rotor).laws, 1e-4, 100.0, 6
    random = np.random.default_rng(5)
    each = [c] + [c * speed] * (inertia > 0) + [0.1 * c] * (pivot > 0)
    sizes = np.array([c] * 4 + [c * speed] * 4 + each * 4 + [c])
    assert len(sizes) == 8 + laws.states
    motion = 0.1 * sizes * random.uniform(-1, 1, (n, len(sizes)))
    motion[:, 2:4] += 11 * c  # in the contact
    if pivot:  # which the film presses outwards
        motion[:, 8:-1] = np.abs(motion[:, 8:-1])

    errors = errors_of_derivatives(laws, motion, sizes, speed)
    # a pad on which nothing presses may be anywhere between its edges of rupture: most bear
    assert np.median(errors, axis=0).max() < 1e-5


@pytest.mark.parametrize("short", [True, False])
def test_derivatives_of_a_floating_ring_are_those_of_force_and_rates(short):
    from rotor_fmu.model.periodic.linear_structure import CondensedMachine

    laws, speed, n = CondensedMachine(rf.parse(rigid_in_rings(short=short)).rotor).laws, 500.0, 4
    c = RING["clearance"]
    sizes = np.array([c] * 4 + [c * speed] * 4 + [c, c, c * speed, c * speed, speed] * 2)
    motion = 0.3 * sizes * np.random.default_rng(5).uniform(-1, 1, (n, len(sizes)))
    assert errors_of_derivatives(laws, motion, sizes, speed).max() < 1e-6


@pytest.mark.slow  # test_every_part compares the motion of a race with a run in time
@pytest.mark.parametrize("turns", [30, 100])
def test_a_race_turns_as_fast_as_friction_and_drag_let_it(turns):
    """Over a turn friction's torque is what the drag takes."""
    text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + KINDS["race"] + MORE)
    result = rf.response(rf.parse(text), speed=(119.0, 121.0))
    points = result.at(120.0)
    rub = max(points, key=lambda p: result.amplitude(p, "disc"))
    assert result.amplitude(rub, "disc") > 1e-3
    assert result.check(rub, turns).stays == rub.is_stable
    assert 0 < rub.orbit.states[0, 0] < 120.0


def test_a_state_that_a_part_does_without_leaves_the_jacobian_regular():
    """Such as the spring of a race that never sticks: its mean may be any, and stays."""
    problem, x = rubbing("race")
    residual, jacobian = problem.linearized(x, 120.0)
    assert np.linalg.cond(jacobian) < 1e9
    idle = (2 * problem.H + 1) * problem.b + 1
    assert np.linalg.solve(jacobian, residual)[idle] == 0.0


def test_a_state_that_a_part_does_without_has_no_multiplier():
    """A race that slides throughout has the multipliers it has with a spring to stick."""
    largest = []
    for spring in ("", "k_t = 1e6\nc_t = 100.0\n"):
        text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + KINDS["race"] + spring + MORE)
        result = rf.response(
            rf.parse(text.replace("v_s = 0.5", "v_s = 1e-4")), speed=(119.0, 121.0)
        )
        rub = max(result.at(120.0), key=lambda p: result.amplitude(p, "disc"))
        assert result.amplitude(rub, "disc") > 1e-3
        largest.append(np.abs(rub.multipliers[:3]))
    assert largest[0] == pytest.approx(largest[1], rel=1e-3)
    assert largest[0].max() < 0.999


def test_the_error_that_newtons_method_leaves_is_a_small_residual_also_of_a_free_shaft():
    """Which has no stiffness at rest: else no correction would make its residual smaller."""
    from rotor_fmu.model.periodic.problem import Task, machines_of

    walls = "".join(
        f"[[contact]]{CONTACT.replace('node = 2', f'node = {node}')}" for node in (1, 3)
    )
    rotor = rf.parse(shaft(0.0, 0.1, 0.2) + walls).rotor
    problem = Task(100.0, 200.0).problem(machines_of(rotor, Task(100.0, 200.0)), 150.0, 5)
    x = np.zeros(problem.size)
    x[1 : problem.b : 2] = -1.2  # clearances
    _, jacobian = problem.linearized(x, 150.0)
    assert np.abs(jacobian).max() * newton.Equations.tolerance < 1e-3


ROLLING = """[[touchdown_bearing]]
node = 2
journal_radius = 0.05
clearance = 1e-3
mu = 0.2
k = 1e6
c = 10.0
race_inertia = 1e-5
race_damping = 1e-6
race_drag = 1e-5
"""


def test_the_tangents_of_a_race_that_rolls_are_those_of_its_curve():
    """Its surface speed, by which friction changes, is a small part of the rotor's, and of a wide
    range of speeds, to which differences are relative."""
    text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + ROLLING + MORE, gravity=20.0)
    machine = rf.parse(text.replace("0.5e-3", "1e-6"))
    found = rf.response(machine, speed=(2000.0, 2100.0), stability=False, harmonics=10)
    (branch,) = found.branches
    assert branch.ends == ("start", "end of the range")
    assert len(branch.points) < 25  # steps along tangents that are wrong are short
    wide, last = Task(2000.0, 6500.0), branch.points[-1]
    problem = wide.problem(machines_of(machine.rotor, wide), last.value, last.orbit.H)
    x, step = problem.join(last.orbit), 1e-5
    *_, by_speed = problem.linearized_with_parameter(x, last.value)
    above, below = (problem.residual(x, last.value + side * step) for side in (1, -1))
    exact = (above - below) / (2 * step) * problem.scale
    assert np.linalg.norm(by_speed - exact) < 5e-4 * np.linalg.norm(exact)
