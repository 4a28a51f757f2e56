"""Linear systems of which groups of unknowns are eliminated, against LAPACK's solution of the
whole."""

import numpy as np
import pytest
from rotor_fmu.model.periodic.elimination import solve_by_elimination
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.self_excited import rest_position

from .test_tilting_pads import SPEED, on_pads

# two unknowns before and one behind five harmonics of the states a and b, of which b acts on a, and
# of c, which acts on neither
OWN = 2 + np.arange(15).reshape(5, 3)


def system():
    rng = np.random.default_rng(0)
    matrix = rng.normal(size=(18, 18)) + 4.0 * np.eye(18)
    for first, second in [(0, 2), (1, 2), (1, 0)]:
        matrix[np.ix_(OWN[:, first], OWN[:, second])] = 0.0
        if second == 2:
            matrix[np.ix_(OWN[:, second], OWN[:, first])] = 0.0
    return matrix, rng.normal(size=(18, 2))


def test_a_system_with_groups_has_the_solution_of_the_whole():
    matrix, right = system()
    assert solve_by_elimination(matrix, right, OWN) == pytest.approx(
        np.linalg.solve(matrix, right), rel=1e-9, abs=1e-12
    )
    one = solve_by_elimination(matrix, right[:, 0], OWN)
    assert one == pytest.approx(np.linalg.solve(matrix, right[:, 0]), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("share", [0.0, 1e-14])
def test_a_group_may_be_singular_where_the_whole_is_not(share):
    """To the last digit, or nearly so, which costs the elimination its accuracy."""
    matrix, right = system()
    c = OWN[:, 2]
    matrix[np.ix_(c[:1], c)] = share * matrix[np.ix_(c[1:2], c)]
    matrix[c[0], 0] = 3.0
    solved = solve_by_elimination(matrix, right, OWN)
    assert matrix @ solved == pytest.approx(right, rel=1e-7, abs=1e-9)


def test_a_singular_system_has_the_solution_of_least_squares():
    matrix, right = system()
    matrix[0], right[0] = matrix[1], right[1] + 1.0
    expected = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
    assert solve_by_elimination(matrix, right, OWN) == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_the_pads_of_a_bearing_are_eliminated_one_by_one(monkeypatch):
    """From the Jacobian, bordered or not: the largest system that is solved is of a single pad."""
    rotor, task = on_pads(9.81, preload=0.3, inertia=1e-5).rotor, Task(100.0, 300.0)
    problem = task.problem(machines_of(rotor, task), SPEED, 12)
    x = problem.join(rest_position(problem, SPEED))
    x[: 25 * problem.b] += 1e-3 * np.cos(np.arange(25 * problem.b))
    residual, jacobian = problem.linearized(x, SPEED)
    expected, solve, sizes = np.linalg.solve(jacobian, residual), np.linalg.solve, []

    def counted(matrix, right):
        sizes.append(len(matrix))
        return solve(matrix, right)

    monkeypatch.setattr(np.linalg, "solve", counted)
    solved = problem.solve_linear(jacobian, residual)
    assert np.linalg.norm(solved - expected) < 1e-9 * np.linalg.norm(expected)
    assert max(sizes) == 25 * max(problem.b, problem.s // 4) < problem.size // 3
