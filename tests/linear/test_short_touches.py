"""Touches shorter than the time between two rows of a recording, in the runs of other commands."""

import pytest
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.balancing.trial_runs import balance

from ..parts.machines import bearings, rigid

_SAGGING = (
    rigid(gravity=4.0, parts=bearings(1e4, 20.0))
    + """
[[unbalance]]
node = 2
amount = 1.2e-4
[[contact]]
node = 2
journal_radius = 0.05
clearance = {clearance}
mu = 0.0
k = 1e9
c = 50.0
"""
)


@pytest.mark.parametrize(("clearance", "touches"), [(1e-3, True), (1.1e-3, False)])
def test_a_bounce_off_a_hard_wall_once_a_turn_is_said_when_balancing(clearance, touches):
    """Of 83 N, for less than a 64th of a turn; the wider wall is beyond the motion."""
    rotor = parse_rotor(_SAGGING.format(clearance=clearance))
    assert balance(rotor, [101.0], [2], trial=1e-6).touches == touches
