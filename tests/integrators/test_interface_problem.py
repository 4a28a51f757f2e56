"""The small nonlinear problem of a step's interfaces: solved exactly, and always."""

import math

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.clearance_contact import contact_force
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.step.excitation import spin_of
from rotor_fmu.model.step.interface_problem import TOLERANCE, solve_columns, solve_interfaces
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.time_loop.block import LAYOUT, new_block

from papers.dense_machine import clearance_contacts
from papers.integrators.members import chung_hulbert, generalized_alpha, hht, newmark
from tests.dense import dense_matrices

STRUCTURE = assemble(rig())
BEARINGS = clearance_contacts(STRUCTURE)
CLEARANCE, STIFFNESS = BEARINGS.clearance[0], BEARINGS.k[0]
SCHEMES = (newmark(), hht(0.2), generalized_alpha(0.1, 0.08), chung_hulbert(0.2))
INTERPRETED, SPIN_OF = interpreted(solve_interfaces), interpreted(spin_of)


def new_problem():
    """An empty problem of the rig's interfaces, as it lies in a run's memory."""
    return LAYOUT.view_in_python(new_block(STRUCTURE, 0)).problem


def solved(problem, omega, b_d, b_v, solve=INTERPRETED):
    """Whether it was solved, and the iterations."""
    s, spin = STRUCTURE, SPIN_OF(omega, 0.0, 0.0)
    return solve(problem, s.laws, s.interfaces, spin, Weights(b_d, b_v, 0.0))


def step_flexibility(scheme, h, omega):
    """Relative accelerations of journals and housings by unit contact forces, all dense."""
    M, C, K, G, _ = dense_matrices(STRUCTURE)
    n, m = STRUCTURE.M.shape[0], len(BEARINGS)
    relative = np.zeros((len(M), 2 * m))
    for j, bearing in enumerate(BEARINGS):
        for axis, plane in enumerate((0, n + m)):
            relative[plane + bearing.dof, 2 * j + axis] = 1
            relative[plane + bearing.end, 2 * j + axis] = -1
    share = 1 - scheme.alpha_f
    matrix = (1 - scheme.alpha_m) * M
    matrix = matrix + share * (scheme.gamma * h * (C + omega * G) + scheme.beta * h**2 * K)
    return share * relative.T @ np.linalg.solve(matrix, relative)


def draw(rng, problem, omega, b_d):
    """A state as in a coarse step through contact, and displacements expected, right or not."""
    m = len(BEARINGS)

    def disc(radius):
        return radius * np.sqrt(rng.random(m)) * np.exp(2j * np.pi * rng.random(m))

    problem.d0[:] = disc(2 * CLEARANCE)
    problem.d0_dot[:] = disc(0.3)
    problem.w_free[:] = (disc(4 * CLEARANCE) - problem.d0) / b_d
    problem.w[:] = problem.force[:] = 0
    problem.expected[:] = np.where(rng.random(m) < 0.3, 0, disc(1.1 * CLEARANCE))


def as_pairs(z):
    return np.column_stack([z.real, z.imag]).ravel()


def apart(problem, b_d):
    """How far the motion is from that of the forces, a displacement in units of the clearance."""
    moved = as_pairs(problem.w - problem.w_free)
    return b_d * np.abs(moved - problem.flexibility @ as_pairs(problem.force)).max() / CLEARANCE


def out_of_balance(problem, omega, b_d, b_v):
    """w - w_free - W F(w), as displacements in units of the clearance."""
    forces = np.array(
        [
            interpreted(contact_force)(bearing, Kinematics(d, d_dot, omega, omega, 0.0)).force
            for bearing, d, d_dot in zip(
                BEARINGS,
                problem.d0 + b_d * problem.w,
                problem.d0_dot + b_v * problem.w,
                strict=True,
            )
        ]
    )
    rest = as_pairs(problem.w - problem.w_free) - problem.flexibility @ as_pairs(forces)
    return b_d * np.abs(rest).max() / CLEARANCE, np.abs(forces - problem.force).max()


@pytest.mark.parametrize("limit", [1, 2, 4, 20])
def test_within_a_limit_the_residual_is_what_the_forces_lack_of_their_laws(limit):
    """The accelerations follow from the forces whatever they are."""
    h, omega, scheme = 0.001, 180.0, chung_hulbert(0.2)
    rng = np.random.default_rng(7)
    problem = new_problem()
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    problem.flexibility[:] = step_flexibility(scheme, h, omega)
    weights, s = Weights(b_d, b_v, 0.0), STRUCTURE
    residuals = []
    for _ in range(15):
        draw(rng, problem, omega, b_d)
        spin = SPIN_OF(omega, 0.0, 0.0)
        is_solved, iterations = INTERPRETED(problem, s.laws, s.interfaces, spin, weights, limit)
        assert is_solved
        assert 1 <= iterations <= limit
        _, forces_differ = out_of_balance(problem, omega, b_d, b_v)
        largest = np.abs(problem.force).max()
        assert problem.residual[0] == pytest.approx(forces_differ, rel=1e-9, abs=1e-12 * largest)
        rest = problem.w - problem.w_free
        moved = as_pairs(rest) - problem.flexibility @ as_pairs(problem.force)
        assert np.abs(moved).max() <= 1e-9 * max(np.abs(rest).max(), 1.0)
        residuals.append(problem.residual[0] / (1.0 + largest))
    assert (np.median(residuals) < 1e-6) == (limit == 20)


@pytest.mark.parametrize(
    ("solve", "draws"),
    [(INTERPRETED, 5), pytest.param(solve_interfaces, 300, marks=pytest.mark.slow)],
    ids=["interpreted", "compiled"],
)
@pytest.mark.parametrize(
    "h", [0.0005, *(pytest.param(h, marks=pytest.mark.slow) for h in (0.001, 0.002)), 0.004]
)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_coarse_step_is_solved_to_tolerance(h, scheme, solve, draws):
    rng = np.random.default_rng(int(1e5 * h))
    problem = new_problem()
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    touched = 0
    for omega in (20.0, 180.0, 400.0):
        problem.flexibility[:] = step_flexibility(scheme, h, omega)
        stiffening = b_d * np.linalg.norm(problem.flexibility, 2) * STIFFNESS
        assert stiffening > 30  # else these were no coarse steps
        for _ in range(draws):
            draw(rng, problem, omega, b_d)
            is_solved, _ = solved(problem, omega, b_d, b_v, solve)
            assert is_solved
            rest, forces_differ = out_of_balance(problem, omega, b_d, b_v)
            # Newton stops at a small correction: through W k it leaves that much out of balance
            assert rest < 10 * TOLERANCE * stiffening
            assert forces_differ < 10 * TOLERANCE * CLEARANCE * STIFFNESS
            assert apart(problem, b_d) < 1e-11  # whichever attempt it was
            touched += np.any(problem.force != 0)
    assert touched > 1.5 * draws  # of three times as many


@pytest.mark.parametrize("h", [0.004, pytest.param(0.01, marks=pytest.mark.slow)])
def test_newton_does_not_cycle_far_within_the_walls(h):
    """Where a step may reverse the sliding, or leave the wall, and more so in a coarse one."""
    rng = np.random.default_rng(3)
    problem = new_problem()
    iterations = []
    for scheme in SCHEMES:
        b_d, b_v = scheme.beta * h * h, scheme.gamma * h
        for omega in (20.0, 180.0, 400.0):
            problem.flexibility[:] = step_flexibility(scheme, h, omega)
            for _ in range(30):
                draw(rng, problem, omega, b_d)
                for given in (problem.d0, problem.d0_dot, problem.w_free):
                    given[:] *= 30.0
                is_solved, needed = solved(problem, omega, b_d, b_v)
                assert is_solved
                iterations.append(needed)
    assert np.mean(iterations) < 120


def test_without_contact_the_free_accelerations_are_the_solution():
    problem = new_problem()
    problem.flexibility[:] = step_flexibility(newmark(), 1e-3, 100.0)
    problem.w_free[:] = [1 + 2j, -3j]
    problem.expected[:] = [60e-6j, 0]
    is_solved, _ = solved(problem, 100.0, 2.5e-7, 5e-4)
    assert is_solved
    np.testing.assert_allclose(problem.w, problem.w_free)
    assert np.all(problem.force == 0)


def test_a_solved_state_is_recognised_at_once():
    rng = np.random.default_rng(1)
    problem = new_problem()
    scheme, h = chung_hulbert(0.2), 1e-3
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    problem.flexibility[:] = step_flexibility(scheme, h, 300.0)
    for _ in range(50):
        draw(rng, problem, 300.0, b_d)
        solved(problem, 300.0, b_d, b_v)
        w = problem.w.copy()
        problem.expected[:] = problem.d0 + b_d * w
        is_solved, iterations = solved(problem, 300.0, b_d, b_v)
        assert is_solved
        assert iterations <= 3
        np.testing.assert_allclose(b_d * problem.w, b_d * w, atol=10 * TOLERANCE * CLEARANCE)


@pytest.mark.parametrize("share", [1.0, 0.5])
@pytest.mark.parametrize("m", [1, 2, 4, 9])
def test_elimination_with_pivoting_solves_what_numpy_solves(m, share):
    rng = np.random.default_rng(m)
    a, b = np.eye(m), rng.standard_normal(m)
    places = np.sort(rng.permutation(m)[: math.ceil(share * m)])
    a[:, places] = rng.standard_normal((m, len(places)))
    if len(places) > 1:
        a[places[0], places[0]] = 0.0  # needs the pivoting
    x = b.copy()
    assert interpreted(solve_columns)(a[:, places].copy(), places, x)
    np.testing.assert_allclose(x, np.linalg.solve(a, b), rtol=1e-9)


@pytest.mark.parametrize("entry", [0.0, math.nan])
def test_elimination_reports_a_singular_matrix(entry):
    a = np.full((3, 3), entry)
    assert not interpreted(solve_columns)(a, np.arange(3), np.ones(3))


def test_newtons_matrix_has_columns_of_closed_contacts_only():
    problem = new_problem()
    scheme, h = chung_hulbert(0.2), 1e-3
    b_d, b_v = scheme.beta * h * h, scheme.gamma * h
    problem.flexibility[:] = step_flexibility(scheme, h, 300.0)
    problem.w_free[:] = [0.1j * CLEARANCE / b_d, 1.5 * CLEARANCE / b_d]
    problem.jacobian[:] = math.nan
    is_solved, _ = solved(problem, 300.0, b_d, b_v)
    assert is_solved
    assert [force != 0 for force in problem.force] == [False, True]
    assert np.isfinite(problem.jacobian[:, :2]).all()
    assert np.isnan(problem.jacobian[:, 2:]).all()
