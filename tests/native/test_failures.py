"""What goes wrong is told as the FMU in Python tells it, and whatever is called then survives."""

import pytest

from rotor_fmu.packing.bundle import build

from ..fmu.masters import Master
from ..fmu.test_failures import (  # noqa: F401  the same tests, with this folder's masters
    FAILURES,
    check,
    march_through,
    test_a_refused_call_changes_nothing,
    test_a_step_after_one_that_failed_says_what_to_do,
    test_an_unstable_scheme_is_warned_of_before_it_diverges,
)


@pytest.fixture(scope="module")
def grid(master):
    """Two calls after each failure."""
    return march_through(master, FAILURES.values(), 2)


@pytest.mark.parametrize("name", FAILURES)
def test_a_failure_is_told_and_whatever_is_called_then_survives(grid, name):
    for entry in grid:
        if entry[0] is FAILURES[name]:
            check(*entry)


def test_each_failure_is_an_error_that_is_not_fatal_in_the_words_of_the_fmu_in_python(
    grid, tmp_path
):
    python = Master(build(tmp_path))
    expected = march_through(python, FAILURES.values(), 0)
    python.close()
    mine = [entry for entry in grid if not entry[1]]
    assert len(mine) == len(expected) == len(FAILURES)
    for (failure, _, replies), (_, _, others) in zip(mine, expected, strict=True):
        at = len(failure.before) + 2
        # of an exception pythonfmu puts a line of its own before the sentence
        assert replies[at].log[-1] == others[at].log[-1].rpartition("PyObject_CallMethod ")[2]
        assert replies[at].status == 3
    assert all(reply.status < 4 for entry in grid for reply in entry[2])


@pytest.mark.slow
@pytest.mark.parametrize("name", FAILURES)
def test_so_do_three_calls_after_a_failure(master, name):
    for entry in march_through(master, [FAILURES[name]], 3):
        check(*entry)
