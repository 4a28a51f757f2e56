"""The closures of a step: complementarity, circles, and impulses that keep the laws."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize, nnls

from papers.integrators.members import (
    MODERATE_DISSIPATION,
    TRANSIENT_FIDELITY,
    amplification,
    generalized_alpha,
    hht,
    newmark,
    rebound,
    wbz,
)
from papers.ishikawa_koguchi.impact.stepping.contacts import FlatStops, RoundStops
from papers.ishikawa_koguchi.impact.stepping.hard_stop import complementarity, held, unilateral
from papers.ishikawa_koguchi.impact.stepping.march import march
from papers.ishikawa_koguchi.impact.stepping.stepper import Stepper
from papers.ishikawa_koguchi.impact.stepping.structure import Elastic


def random_problem(seed, m):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(m + 2, m))
    return root.T @ root, rng.normal(size=m)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("m", [1, 2, 5, 10])
def test_the_active_set_is_that_of_a_quadratic_program(seed, m):
    A, b = random_problem(seed, m)
    rng = np.random.default_rng(seed + 100)
    z, is_found = complementarity(A, b, rng.random(m) < 0.5)
    assert is_found
    # min 1/2 z A z + b z, z >= 0, as non-negative least squares with A = L L^T
    L = np.linalg.cholesky(A)
    expected, _ = nnls(L.T, -np.linalg.solve(L, b))
    rounding = 100 * m * np.finfo(float).eps
    np.testing.assert_allclose(z, expected, 1e-9, rounding * np.linalg.cond(A) * np.abs(z).max())
    w = A @ z + b
    terms = np.abs(A) @ z + np.abs(b)  # what w is the difference of
    assert np.all(w >= -rounding * terms)
    assert abs(z @ w) <= rounding * (z @ terms)


def free_step(W, p, b=1e-6, w=None):
    w = np.zeros(len(p)) if w is None else w
    return SimpleNamespace(W=W, p=p, w=w, b=b, p_dot=np.zeros(len(p)))


@pytest.mark.parametrize("seed", range(10))
def test_journals_land_on_the_nearest_points_of_their_circles(seed):
    A, _ = random_problem(seed, 4)
    W = A / np.trace(A)
    rng = np.random.default_rng(seed)
    p = rng.normal(size=4)
    contacts = RoundStops(np.eye(4), np.array([0.5, 0.7]), np.zeros(2))
    free = free_step(W, p)
    N, force = unilateral(free, contacts, np.zeros(2, dtype=bool))
    reached = p + free.b * W @ (N @ force)
    assert force.min() >= 0
    s = contacts.openings(reached)
    assert s.min() > -1e-12
    assert np.abs(s * force).max() < 1e-12 * (1 + force.max())
    metric = np.linalg.inv(W)
    result = minimize(
        lambda x: (x - p) @ metric @ (x - p),
        reached + rng.normal(scale=0.1, size=4),
        constraints=[
            {"type": "ineq", "fun": lambda x, j=j: contacts.openings(x)[j]} for j in (0, 1)
        ],
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 500},
    )
    np.testing.assert_allclose(result.x, reached, atol=1e-5)


def test_a_held_journal_may_be_pulled_back_to_its_circle():
    contacts = RoundStops(np.eye(2), np.array([1.0]), np.zeros(1))
    free = free_step(np.diag([1.0, 2.0]), np.array([0.6, 0.5]), b=1.0)
    N, force = held(free, contacts, np.array([True]), np.zeros(1), by_acceleration=False)
    assert force[0] < 0
    assert math.hypot(*(free.p + free.W @ (N @ force))) == pytest.approx(1)


def test_the_bend_of_a_round_stop_is_the_centripetal_acceleration():
    contacts = RoundStops(np.eye(2), np.array([0.1]), np.zeros(1))
    turn = 7.0
    p = 0.1 * np.array([np.cos(0.4), np.sin(0.4)])
    p_dot = turn * np.array([-p[1], p[0]])
    # uniform motion on the wall keeps the gap: N^T p'' + bend = 0
    p_ddot = -(turn**2) * p
    assert contacts.gradient(p).T @ p_ddot + contacts.bend(p, p_dot) == pytest.approx(0)
    assert contacts.bend(p, p_dot)[0] == pytest.approx(-0.1 * turn**2)


def ball(mass=2.0, opening=0.05, compliance=0.0):
    """A free mass that flies downwards towards a floor."""
    contacts = FlatStops(np.ones((1, 1)), np.array([opening]), np.array([compliance]))
    one = np.array([[mass]])
    return Elastic(one, np.zeros((1, 1)), np.zeros(1), contacts, energy_scale=1.0)


def fly(scheme, impact="no", dt=0.01, **kinds):
    structure = ball(**kinds)
    start = Stepper(structure, scheme).start(0.0, np.zeros(1), np.array([-1.0]))
    return march(structure, scheme, start, dt, 0.2, impact, lambda m: (m.q[0], m.v[0]))


@pytest.mark.parametrize(
    "scheme",
    [
        newmark(),
        newmark(0.5, 0.5),
        hht(0.5),
        MODERATE_DISSIPATION,
        TRANSIENT_FIDELITY,
        generalized_alpha(0.1, 0.08),
        wbz(-0.3),
    ],
)
def test_a_ball_leaves_the_floor_as_the_energy_momentum_criterion_says(scheme):
    """Paper B, eq. (12), where the touch falls on the end of a step: d_{n+1} = d_n."""
    result = fly(scheme, opening=0.05)
    (touch,) = np.flatnonzero(result.force[:, 0] > 0)
    assert result.seen[touch + 1, 1] == pytest.approx(rebound(scheme), rel=1e-9)


@pytest.mark.parametrize("impact", ["average-time", "current-time"])
def test_an_impulse_stops_a_ball(impact):
    result = fly(TRANSIENT_FIDELITY, impact, opening=0.0537)
    assert result.seen[-1] == pytest.approx([-0.0537, 0.0], abs=1e-12)
    assert result.energy[-1] == pytest.approx(0, abs=1e-20)


def test_average_time_touches_when_the_ball_does():
    result = fly(TRANSIENT_FIDELITY, "average-time", opening=0.0537)
    assert result.cutbacks == 1
    assert np.abs(result.t - 0.0537).min() < 1e-12


def test_a_penalty_floor_gives_the_ball_its_speed_back():
    result = fly(newmark(), dt=1e-4, compliance=1e-4)
    assert result.seen[-1, 1] == pytest.approx(1, rel=1e-3)
    # half a period of mass and spring
    touching = (result.force > 0).sum() * 1e-4
    assert touching == pytest.approx(math.pi * math.sqrt(2.0 * 1e-4), rel=0.02)


@pytest.mark.parametrize(
    "scheme", [TRANSIENT_FIDELITY, MODERATE_DISSIPATION, hht(0.5), newmark(0.25, 0.5)]
)
def test_a_velocity_jump_throws_a_stiffly_damped_mass_by_beta_over_gamma_less_a_half(scheme):
    """Why consistent accelerations after an impulse ruin a rotor with a viscous shaft."""
    stiffness = 1e6  # c h / m
    q, _, _ = amplification(scheme, 1e-3, stiffness / 2e-3) @ [0.0, 1.0, -stiffness]
    expected = scheme.beta / scheme.gamma - 0.5
    assert q / stiffness == pytest.approx(expected, abs=3e-6)
