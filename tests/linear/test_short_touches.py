"""Touches shorter than the time between two rows of a recording, in the runs of other commands."""

import pytest
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.balancing.trial_runs import balance

from ..parts.machines import bouncing


@pytest.mark.parametrize(("clearance", "touches"), [(1e-3, True), (1.1e-3, False)])
def test_a_bounce_off_a_hard_wall_once_a_turn_is_said_when_balancing(clearance, touches):
    """Of 83 N, for less than a 64th of a turn; the wider wall is beyond the motion."""
    rotor = parse_rotor(bouncing(clearance))
    assert balance(rotor, [101.0], [2], trial=1e-6).touches == touches
