"""Machines that CVODE's equations do not know keep the promise beside another integrator."""

from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.settings import choose

from .bearings import KINDS, drawn, orbit, truth
from .judge import TOLERANCES, is_false_alarm, is_kept, judged
from .truth import RTOL

FIRST = range(len(KINDS))  # a machine of each kind
QUICK = (0, 3, 9, 10, 12, 13, 14, 15, 16)  # of which each takes at most some 1.5 s


@cache
def _truth(seed):
    return truth(drawn(seed))


@pytest.mark.parametrize(
    "seed", [pytest.param(s, marks=[] if s in QUICK else [pytest.mark.slow]) for s in FIRST]
)
def test_a_machine_keeps_what_a_tolerance_promises(seed):
    case, exact = drawn(seed), _truth(seed)
    for tolerance in TOLERANCES:
        run = judged(case, exact, choose(tolerance=tolerance))
        assert is_kept(run, tolerance, exact.condition), (case.name, run, exact.condition)
        assert not is_false_alarm(run, tolerance, exact.condition), (case.name, run.status)


@pytest.mark.slow
@pytest.mark.parametrize("seed", FIRST)
def test_the_truth_has_converged(seed):
    """To a ten-thousandth of what is promised of the least of the tolerances."""
    exact, near = _truth(seed), orbit(drawn(seed), 10 * RTOL)
    assert np.abs(near - exact.orbit).max() < 1e-8 * (1 + exact.condition) * exact.size
