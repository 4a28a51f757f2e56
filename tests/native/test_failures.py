"""What goes wrong is logged, and whatever is called then survives: tests of the FMU in Python."""

import pytest

from ..fmu.test_failures import (  # noqa: F401  the same tests, with this folder's masters
    FAILURES,
    march_through,
    mistakes,
    sequences,
    test_a_refused_call_changes_nothing,
    test_a_step_after_one_that_failed_says_what_to_do,
    test_an_unstable_scheme_is_warned_of_before_it_diverges,
    test_so_do_three_calls_after_a_failure_in_a_process_of_its_own,
)


@pytest.fixture(scope="module")
def grid(master):
    """Two calls after each failure."""
    return march_through(master, FAILURES.values(), 2)


@pytest.mark.parametrize("name", FAILURES)
def test_a_failure_is_told_and_whatever_is_called_then_survives(grid, name):
    mine = [entry for entry in grid if entry[0] is FAILURES[name]]
    assert len(mine) == len(sequences(2))
    assert [mistake for entry in mine for mistake in mistakes(*entry)] == []


def test_no_failure_is_fatal(grid):
    assert {reply.status for entry in grid for reply in entry[2]} <= {0, 1, 3}
