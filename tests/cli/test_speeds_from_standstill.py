"""A range of speeds from 0, where oil films carry nothing."""

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, lowest_speed
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.cli.speeds import where_carried
from rotor_fmu.linear import answers

from ..parts.films import film, heavy_shaft

FILMS = parse_rotor(heavy_shaft() + film(1) + film(3))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_range_from_0_begins_where_the_films_carry_the_machine(sign):
    given = np.sort(sign * np.array([0.0, 0.5, 300.0]))
    with pytest.raises(LinearError, match=r"film carries .* N in that direction"):
        answers.campbell(FILMS, given, count=1)
    speeds = where_carried(given, FILMS, None)
    assert len(speeds) == 3
    slowest = speeds[np.argmin(abs(speeds))]
    assert slowest == lowest_speed(FILMS, sign * 300.0)
    assert slowest * sign > 0
    assert answers.campbell(FILMS, speeds, count=1).critical is not None


def test_other_ranges_are_as_they_are_given():
    for speeds in ([], [0.0], [10.0, 20.0], [-10.0, 20.0]):
        assert where_carried(np.array(speeds), FILMS, None).tolist() == speeds
