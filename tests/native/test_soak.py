"""The FMU that needs no Python, used for long: memory flat, nothing in temporary folders."""

import pytest

from ..fmu.test_soak import linux, soak


@linux
def test_some_hundred_instances_steps_and_states_leave_nothing_behind(fmu, tmp_path):
    soak(fmu, tmp_path / "temporary", (100, 500, 100), 0.0)


@linux
@pytest.mark.slow
def test_a_million_steps_and_ten_thousand_states_leave_nothing_behind(fmu, tmp_path):
    soak(fmu, tmp_path / "temporary", (100, 1_000_000, 10_000), 0.0)
