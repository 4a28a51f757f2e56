"""State of the native FMU: the tests of the FMU in Python, on this one."""

import pytest

from ..fmu.test_state import (  # noqa: F401
    OTHER,
    instance,
    test_a_damaged_state_is_refused_with_a_reason,
    test_a_rejected_step_can_be_repeated_with_smaller_ones,
    test_a_reset_restores_the_start,
    test_a_state_carries_parameters_into_a_fresh_instance,
    test_a_state_of_another_build_is_refused_with_a_reason,
    test_a_state_serialized_in_another_process_goes_on_bit_for_bit,
    test_it_says_that_it_can,
    test_the_same_steps_from_the_same_state_give_the_same_bits,
)


@pytest.fixture
def other(make):
    """The FMU of another machine."""
    return make(toml=OTHER)
