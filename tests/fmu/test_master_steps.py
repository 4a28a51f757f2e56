"""The communication points of the Jacobi master."""

import math
from itertools import islice

import pytest

from rotor_fmu.cosimulation.master import CoupledFmus
from rotor_fmu.errors import InputError


class Counted:
    """An FMU that notes its steps."""

    def __init__(self):
        self.steps = []

    def begin(self):
        pass

    def get(self, names):
        return {}

    def set(self, values):
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
        (0.3000000000000001, 0.1, [0.1, 0.1, 0.1]),
        (1.0, 0.4998, [0.4998, 0.4998, 0.0004]),  # a thousandth of a step is one
        (1e-9, 1e-2, [1e-9]),
    ],
)
def test_a_run_ends_at_its_end_whatever_the_communication_step(stop, step, lengths):
    one, other = Counted(), Counted()
    coupled = CoupledFmus({"one": one, "other": other}, (), {}, ())
    seen = [point.t for point in coupled.points(stop, step)]
    assert seen[0] == 0.0
    assert seen[-1] == pytest.approx(stop, rel=1e-12)
    for member in (one, other):
        assert [h for _, h in member.steps] == pytest.approx(lengths, rel=1e-9)
        assert [t for t, _ in member.steps] == pytest.approx(seen[:-1], abs=1e-12)


def test_whole_steps_are_kept_to_where_they_miss_the_end_by_a_millionth_of_one():
    one = Counted()
    list(CoupledFmus({"one": one}, (), {}, ()).points(0.3 - 5e-8, 0.1))
    assert [h for _, h in one.steps] == [0.1, 0.1, 0.1]


def test_a_run_whose_number_of_steps_is_no_number_begins_as_any_other():
    one = Counted()
    assert len([*islice(CoupledFmus({"one": one}, (), {}, ()).points(1e300, 1e-300), 3)]) == 3
    assert one.steps == [(0.0, 1e-300), (1e-300, 1e-300)]


@pytest.mark.parametrize("name", ["stop", "step"])
@pytest.mark.parametrize("value", [0.0, -0.1, math.inf, math.nan])
def test_a_run_that_is_none_is_refused(name, value):
    one = Counted()
    length = {"stop": 1.0, "step": 0.1, name: value}
    with pytest.raises(InputError, match=rf"^{name} = .* s: must be > 0 and finite$"):
        list(CoupledFmus({"one": one}, (), {}, ()).points(**length))
    assert not one.steps
