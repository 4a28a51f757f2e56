"""The communication points of the Jacobi master."""

import math

import pytest

from rotor_fmu.cosimulation.master import Side, points
from rotor_fmu.errors import InputError


class Counted:
    """An FMU that notes its steps."""

    def __init__(self):
        self.steps = []

    def references(self, *names):
        return list(names)

    def begin(self):
        pass

    def get(self, references):
        return [0.0 for _ in references]

    def set(self, references, values):
        pass

    def step(self, t, h):
        self.steps.append((t, h))


@pytest.mark.parametrize(
    ("stop", "step", "lengths"),
    [
        (1.0, 0.3, [0.3, 0.3, 0.3, 0.1]),
        (0.1, 0.3, [0.1]),
        (0.5, 0.3, [0.3, 0.2]),
        (0.3, 0.1, [0.1, 0.1, 0.1]),  # though 0.3 / 0.1 is less than 3
        (3 * 0.1, 0.1, [0.1, 0.1, 0.1]),  # and this more
    ],
)
def test_a_run_ends_at_its_end_whatever_the_communication_step(stop, step, lengths):
    one, other = Counted(), Counted()
    seen = [point.t for point in points(Side(one, (), ()), Side(other, (), ()), stop, step)]
    assert seen[0] == 0.0
    assert seen[-1] == pytest.approx(stop, rel=1e-12)
    for member in (one, other):
        assert [h for _, h in member.steps] == pytest.approx(lengths, rel=1e-9)
        assert [t for t, _ in member.steps] == pytest.approx(seen[:-1], abs=1e-12)


@pytest.mark.parametrize("name", ["stop", "step"])
@pytest.mark.parametrize("value", [0.0, -0.1, math.inf, math.nan])
def test_a_run_that_is_none_is_refused(name, value):
    one, other = Counted(), Counted()
    length = {"stop": 1.0, "step": 0.1, name: value}
    with pytest.raises(InputError, match=rf"^{name} = .* s: must be > 0 and finite$"):
        list(points(Side(one, (), ()), Side(other, (), ()), **length))
    assert not one.steps
