"""The FMU that needs no Python, used for long: memory flat, nothing in temporary folders."""

import pytest

from ..fmu.test_soak import linux, soak


@linux
@pytest.mark.parametrize(
    "counts", [(100, 500, 100), pytest.param((100, 1_000_000, 10_000), marks=pytest.mark.slow)]
)
def test_instances_steps_and_states_leave_nothing_behind(fmu, tmp_path, counts):
    seen = soak(fmu, tmp_path / "temporary", counts)
    of_instances, *of_others = seen.grown
    assert of_instances < 4000
    assert max(of_others) < 1000  # the memory's own rounding
    assert -1e-3 < seen.y < 0.0
    assert seen.left == []
