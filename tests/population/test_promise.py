"""No run that says nothing is far from what CVODE finds: machines drawn at random, the examples."""

from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.settings import choose

from .. import known
from .judge import PROMISED, TOLERANCES, Judged, is_kept, judged
from .machines import KINDS, drawn
from .truth import truth

QUICK = (0, 3, 7, 23)  # of which CVODE makes an end soon
METHODS = {"default": {}, "radau5": {"method": "radau5"}}
# Of which the journals start pressed on a wall, into a motion far smaller than their accelerations
# lead one to expect.
PRESSED = (27, 82, 118, 129)
SLOW = sorted({*range(3 * len(KINDS)), *PRESSED} - {*QUICK})


def _cases():
    for seed in [*QUICK, *SLOW]:
        for name, method in METHODS.items():
            marks = [] if seed in QUICK else [pytest.mark.slow]
            yield pytest.param(seed, method, marks=marks, id=f"{seed}-{name}")


@cache
def _truth(seed):
    return truth(drawn(seed))


@pytest.mark.parametrize(("seed", "method"), [*_cases()])
def test_a_machine_keeps_what_a_tolerance_promises(seed, method):
    case, exact = drawn(seed), _truth(seed)
    for tolerance in TOLERANCES:
        run = judged(case, exact, choose(**method, tolerance=tolerance))
        assert is_kept(run, tolerance, exact.condition), (case.name, run, exact.condition)


@pytest.mark.slow
@pytest.mark.parametrize("run", [*known.examples()], ids=lambda run: run.name)
def test_the_examples_keep_to_the_tolerance_as_the_machines_do(run):
    exact = run.exact()
    condition = known.condition(run, exact)
    for tolerance in TOLERANCES:
        status, orbit = run.solve(choose(tolerance=tolerance))
        error = np.abs(orbit - exact).max() / np.abs(exact).max()
        assert is_kept(Judged(status, 0.0, 0.0, 0.0, error), tolerance, condition)
        assert status == "ok"


def test_a_run_breaks_the_promise_that_is_off_and_says_nothing():
    assert not is_kept(Judged("ok", 0.0, 0.0, 0.0, 1.1 * PROMISED * 1e-3 * 3), 1e-3, 2.0)
    assert is_kept(Judged("ok", 0.0, 0.0, 0.0, 0.9 * PROMISED * 1e-3 * 3), 1e-3, 2.0)
    assert not is_kept(Judged("ok", 0.03, 0.0, 0.0, 0.0), 1e-3, 2.0)
    assert is_kept(Judged("ok", 0.03, 0.0, 0.0, 0.0), 1e-3, 20.0)
