"""What a run in time gives a response to begin with."""

from itertools import islice

import numpy as np
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
