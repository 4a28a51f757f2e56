"""The communication points of the Jacobi master."""

import math

import pytest
from rotor_fmu.model.message_templates import Message

from rotor_fmu.cosimulation.master import Connection, CoupledFmus, CoupledRun, coupled
from rotor_fmu.cosimulation.member import EndedEarly
from rotor_fmu.errors import InputError, RunFailed


class Counted:
    """An FMU that notes its steps."""

    takes_any_step = True

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
    fmus = CoupledFmus({"one": one, "other": other}, (), {}, (), stop)
    seen = [point.t for point in fmus.points(step)]
    assert seen[0] == 0.0
    assert seen[-1] == pytest.approx(stop, rel=1e-12)
    for member in (one, other):
        assert [h for _, h in member.steps] == pytest.approx(lengths, rel=1e-9)
        assert [t for t, _ in member.steps] == pytest.approx(seen[:-1], abs=1e-12)


def test_whole_steps_are_kept_to_where_they_miss_the_end_by_a_millionth_of_one():
    one = Counted()
    list(CoupledFmus({"one": one}, (), {}, (), 0.3 - 5e-8).points(0.1))
    assert [h for _, h in one.steps] == [0.1, 0.1, 0.1]


def test_an_fmu_that_takes_equal_steps_only_gets_no_others():
    one = Counted()
    one.takes_any_step = False
    fmus = CoupledFmus({"other": Counted(), "one": one}, (), {}, (), 1.0)
    expected = "^step = 0.3 s: must divide stop = 1 s: one takes equal steps only$"
    with pytest.raises(InputError, match=expected):
        list(fmus.points(0.3))
    assert not one.steps
    list(fmus.points(0.25))
    assert [h for _, h in one.steps] == [0.25] * 4
    list(fmus.points(3.0))
    assert one.steps[4:] == [(0.0, 1.0)]


@pytest.mark.parametrize(
    ("stop", "step", "runs", "steps"),
    [
        (1.0, 9.9e-10, "points", "1.01e+09 steps until stop = 1 s; at most 1e+09"),
        (1e300, 1e-300, "points", "inf steps until stop = 1e+300 s; at most 1e+09"),
        (1.0, 4.9e-7, "run", "2.04e+06 steps until stop = 1 s; at most 2e+06"),
    ],
)
def test_a_run_that_would_not_end_or_not_fit_into_memory_is_refused(stop, step, runs, steps):
    one = Counted()
    fmus = CoupledFmus({"one": one}, (), {}, (), stop)
    with pytest.raises(InputError) as refused:
        next(iter(getattr(fmus, runs)(step)))
    assert str(refused.value) == f"step = {step:g} s: would make {steps}"
    assert not one.steps
    assert next(CoupledFmus({"one": one}, (), {}, (), 1.0).points(1e-9)).t == 0.0


@pytest.mark.parametrize("value", [0.0, -0.1, math.inf, math.nan])
def test_a_run_that_is_none_is_refused(value):
    one = Counted()
    fmus = CoupledFmus({"one": one}, (), {}, (), 1.0)
    for run in (fmus.run, lambda step: list(fmus.points(step))):
        with pytest.raises(InputError, match=r"^step = .* s: must be > 0 and finite$"):
            run(value)
    for name in ("stop", "tolerance"):
        of = {"stop": 1.0, name: value}
        expected = rf"^{name} = .*: must be > 0 and finite$"
        with pytest.raises(InputError, match=expected), coupled({}, (), **of):
            pass
    assert not one.steps


class Ends(Counted):
    """An FMU that ends the run in its second step."""

    def step(self, t, h):
        if self.steps:
            raise EndedEarly("Ends.fmu: enough")
        super().step(t, h)

    def get(self, names):
        return dict.fromkeys(names, float(len(self.steps)))


def test_a_run_that_an_fmu_ends_is_returned_up_to_the_last_common_point(tmp_path):
    read = {"one": ("w",), "ends": ("w",)}
    fmus = CoupledFmus({"one": Counted(), "ends": Ends()}, (), read, (), 1.0)
    fmus.members["one"].get = lambda names: {"w": 3.0}
    run = fmus.run(0.1)
    assert run.t.tolist() == [0.0, 0.1]
    assert run["ends"]["w"].tolist() == [0.0, 1.0]
    assert run.status == "failed: Ends.fmu: enough"
    run.save(tmp_path / "run.npz")
    read_again = CoupledRun.load(tmp_path / "run.npz")
    assert (read_again.status, [*read_again.values]) == (run.status, ["one", "ends"])
    assert CoupledFmus({"one": Counted()}, (), {}, (), 1.0).run(0.1).status == "ok"
    doubtful = (Message("it jumps", "false-state"),)
    run = CoupledFmus({"one": Counted()}, (), {}, doubtful, 1.0).run(0.1)
    assert run.status == "doubtful: false-state"


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("set", "two.fmu: broken; with one.w, one.a at t = 0.1 s"),
        ("step", "two.fmu: broken; in the step from t = 0.1 s"),
        ("get", "two.fmu: broken; read at t = 0.1 s"),
    ],
)
def test_a_call_that_fails_says_when_and_an_input_from_where(monkeypatch, call, expected):
    def fails(*arguments):
        raise RunFailed("two.fmu: broken")

    one, two = Counted(), Counted()
    one.get = lambda names: {"w": math.nan, "a": 1.0}
    pairs = [Connection("one", of, "two", of) for of in ("w", "a")]
    read = {"one": ("w", "a"), "two": ()}
    monkeypatch.setattr(CoupledFmus, "_warn_of_jumps", lambda self, start: None)
    points = CoupledFmus({"one": one, "two": two}, pairs, read, [], 1.0).points(0.1)
    next(points)
    if call != "get":
        next(points)
    setattr(two, call, fails)
    with pytest.raises(RunFailed) as failed:
        next(points)
    assert str(failed.value) == expected
