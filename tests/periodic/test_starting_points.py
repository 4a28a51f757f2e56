"""What a run in time gives a response to begin with."""

from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.periodic import branch_switching
from rotor_fmu.model.periodic.fourier import amplitudes
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.starting_points import guesses

from .machines import OMEGA, jeffcott


def test_a_run_that_has_not_settled_gives_no_harmonics_of_a_jump():
    """A rotor that swings freely for hundreds of turns: harmonics of a jump fall as 1 / k, of a
    bend as 1 / k^2."""
    rotor, task = jeffcott(zeta=2e-3, e=1e-3).rotor, Task(1.4 * OMEGA, 1.6 * OMEGA)
    machines = machines_of(rotor, task)
    _, orbit = islice(guesses(rotor, task, machines, 1.5 * OMEGA, False, []), 2)
    size = np.abs(amplitudes(orbit.b)).max(axis=1)
    assert size[6] > 1e-3 * size[1]
    assert size[12] < 0.3 * size[6]


@pytest.mark.parametrize(
    ("along", "other"), [([1.0, 0.0, 0.0], [0.0, 0.5**0.5, 0.5**0.5]), ([0.0, 3.0, 3.0], [1, 0, 0])]
)
def test_each_branch_through_a_branch_point_leads_to_the_other(along, other):
    """x (1 - x^2 - lambda) = 0 and y = lambda, at 0, 1, 1."""
    jacobian, by_lambda = np.diag([0.0, 1.0]), np.array([0.0, -1.0])
    problem = SimpleNamespace(linearized_with_parameter=lambda *_: (None, jacobian, by_lambda))
    found = branch_switching._other_direction(problem, np.zeros(2), 1.0, np.array(along))
    assert found * np.sign(found.sum()) == pytest.approx(other)
