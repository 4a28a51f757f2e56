"""No run that says nothing is far from what CVODE finds: machines drawn at random, the examples."""

from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.settings import choose

from papers.integrators import tolerances

from .. import known
from .__main__ import MACHINES
from .judge import PROMISED, TOLERANCES, Judged, is_false_alarm, is_kept, judged
from .machines import FAST, KINDS, drawn
from .truth import KEPT, RTOL, kept, orbit, truth

METHODS = {"default": {}, "radau5": {"method": "radau5"}}
# Of which the journals start pressed on a wall, into a motion far smaller than their accelerations
# lead one to expect.
PRESSED = (27, 82, 118, 129)
TURNING_FAST = tuple(FAST + seed for seed in (1, 3, 4, 6, 7, 9, 10, 11))
SLOW = sorted({*range(3 * len(KINDS)), *PRESSED, *TURNING_FAST} - {*KEPT})


def _cases():
    for seed in [*KEPT, *SLOW]:
        for name, method in METHODS.items():
            marks = [] if seed in KEPT else [pytest.mark.slow]
            yield pytest.param(seed, method, marks=marks, id=f"{seed}-{name}")


@cache
def _truth(seed):
    return kept(seed) if seed in KEPT else truth(drawn(seed))


@pytest.mark.parametrize(("seed", "method"), [*_cases()])
def test_a_machine_keeps_what_a_tolerance_promises(seed, method):
    case, exact = drawn(seed), _truth(seed)
    for tolerance in TOLERANCES:
        run = judged(case, exact, choose(**method, tolerance=tolerance))
        assert is_kept(run, tolerance, exact.condition), (case.name, run, exact.condition)
        assert not is_false_alarm(run, tolerance, exact.condition), (case.name, run.status)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*KEPT, *PRESSED])
def test_the_truth_has_converged(seed):
    exact = orbit(drawn(seed), RTOL)
    assert np.abs(orbit(drawn(seed), RTOL / 10) - exact).max() < 1e-6 * np.abs(exact).max()


@pytest.mark.slow
@pytest.mark.parametrize("seed", KEPT)
def test_what_is_written_down_is_the_truth(seed):
    """`python -m tests.population.truth` writes it anew."""
    exact, written = truth(drawn(seed)), kept(seed)
    assert np.abs(written.orbit - exact.orbit).max() < 1e-5 * exact.size
    assert written.condition == pytest.approx(exact.condition, rel=0.01)


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_the_rows_of_the_page_keep_the_promise_and_hold_few_false_alarms(tolerance):
    """All 277 machines, of which the tests here and of `test_bearings` make some anew."""
    runs = {
        row.name: (Judged(*row[3:8]), tolerance, row.condition)
        for row in tolerances.rows()
        if row.group in ("drawn", "fast", "bearings") and row.tolerance == tolerance
    }
    assert len(runs) == len(MACHINES) == 277
    assert [name for name, run in runs.items() if not is_kept(*run)] == []
    assert sum(is_false_alarm(*run) for run in runs.values()) < 0.01 * len(runs)


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


def test_a_false_alarm_is_doubt_about_a_run_that_is_right():
    right, wrong = 0.9 * PROMISED * 1e-3 * 3, 1.1 * PROMISED * 1e-3 * 3
    assert is_false_alarm(Judged("doubtful: slow", 0.0, 0.0, 0.0, right), 1e-3, 2.0)
    assert not is_false_alarm(Judged("doubtful: slow", 0.0, 0.0, 0.0, wrong), 1e-3, 2.0)
    assert not is_false_alarm(Judged("ok", 0.0, 0.0, 0.0, right), 1e-3, 2.0)
