"""After a step that ended early: who goes on goes on, whatever of the inputs is set anew, and who
comes there again by an earlier state is warned of a limit once; a reset forgets what was said."""

import pytest

from .skins import Discarded, Extracted, Native, Refused

H, RATE = 0.02, -100.0


@pytest.fixture(scope="module")
def extracted(native_fmu):
    return Extracted(native_fmu)


class Ramp:
    """The native FMU along a run-down of 100 rad/s2; sets: how its host sets the speed."""

    def __init__(self, of, sets="values", **values):
        self.of, self.t, self.sets, self.ends = of, 0.0, sets, 0
        self.fmu = Native(of).put({"speed_rate": RATE, **values}).initialize()

    def speed(self):
        at = [self.of.refs["speed"]]
        self.fmu.set("Real", at, [400.0 + RATE * self.t])
        if self.sets == "slopes":
            self.fmu.slopes(at, [RATE])

    def run(self, to, anew=False):
        while self.t < to - 1e-12:
            self.speed()
            end = min(self.t + H, to)
            while self.t < end - 1e-12:
                try:
                    self.fmu.step(self.t, end - self.t)
                    self.t = end
                except Discarded:
                    self.ends += 1
                    self.t = self.fmu.last_successful_time
                    if anew:
                        self.speed()
        return self

    def get(self, name):
        return self.fmu.get("Real", [self.of.refs[name]])[0]


@pytest.mark.parametrize("anew", [False, True])
@pytest.mark.parametrize("sets", ["values", "slopes"])
def test_a_ramp_goes_on_after_a_step_that_ended_early(extracted, sets, anew):
    t = 0.2
    ramp = Ramp(extracted, sets, **{"solver.max_iterations": 200}).run(t, anew)
    assert ramp.ends > 3
    assert ramp.get("w") == pytest.approx(400.0 + RATE * t, rel=1e-12)
    assert ramp.get("phi") == pytest.approx(400.0 * t + RATE * t**2 / 2, rel=1e-12)


def test_loads_go_on_with_the_slopes_that_they_were_given(extracted):
    at = [extracted.refs["coupling.fx"]]
    work = []
    for limit in (10**7, 200):
        ramp = Ramp(extracted, **{"solver.max_iterations": limit, "solver.tolerance": 1e-5})
        for k in range(5):
            ramp.fmu.set("Real", at, [10.0 * k])
            ramp.fmu.slopes(at, [10.0 / H])
            ramp.run((k + 1) * H)
        work.append(ramp.get("disc[3].x"))
    assert ramp.ends > 3
    assert work[1] == pytest.approx(work[0], rel=1e-3)


def test_a_slope_given_after_an_early_end_stays_with_the_value_before_it_or_behind(extracted):
    at, ends = [extracted.refs["disc[2].fx"]], []
    for order in ("value", "slope"):
        host = Ramp(extracted, **{"solver.max_iterations": 50})
        with pytest.raises(Discarded):
            host.fmu.step(0.0, H)
        if order == "slope":
            host.fmu.slopes(at, [5e4])
        host.fmu.set("Real", at, [1.0])
        if order == "value":
            host.fmu.slopes(at, [5e4])
        state = host.fmu.state()
        host.fmu.step(host.fmu.last_successful_time, 1e-4)
        ends.append(host.get("disc[2].x"))
        host.fmu.restore(state)
        host.fmu.step(host.fmu.last_successful_time, 1e-4)
        ends.append(host.get("disc[2].x"))
    assert len({*ends}) == 1
    # set anew without a slope, it has none
    host.fmu.restore(state)
    host.fmu.slopes(at, [0.0])
    host.fmu.step(host.fmu.last_successful_time, 1e-4)
    assert host.get("disc[2].x") != ends[0]


@pytest.mark.parametrize("name", ["limit.displacement", "limit.force"])
def test_a_master_that_rolls_back_passes_a_limit_that_it_was_told_of(extracted, name):
    """It steps again, from the state before, to the time reached, and on from there."""
    free = Ramp(extracted)
    largest = {"limit.displacement": 0.0, "limit.force": 0.0}
    while free.t < 0.3:
        free.run(free.t + 0.1 * H)
        moved = max(
            abs(complex(free.get(f"disc[{i}].x"), free.get(f"disc[{i}].y"))) for i in (1, 2, 3)
        )
        force = max(free.get("bearing[1].fn"), free.get("bearing[2].fn"))
        seen = {"limit.displacement": moved, "limit.force": force}
        largest = {key: max(size, seen[key]) for key, size in largest.items()}
    host = Ramp(extracted, **{name: 0.8 * largest[name]})
    warned = 0
    while host.t < 0.3:
        host.speed()
        state, size = host.fmu.state(), H
        while True:
            try:
                host.fmu.step(host.t, size)
                break
            except Discarded:
                warned += 1
                reached = host.fmu.last_successful_time
                host.fmu.restore(state)
                if reached > host.t:
                    size = reached - host.t
        host.t += size
        assert warned < 100
    assert warned > 0


def test_a_step_that_ended_early_is_no_reason_after_the_next_that_did_not(extracted):
    host = Ramp(extracted, **{"solver.max_iterations": 100})
    with pytest.raises(Discarded):
        host.fmu.step(0.0, 1.0)
    with pytest.raises(Refused, match="without gap or overlap; the last one ended early: t = "):
        host.fmu.step(5.0, H)
    host.fmu.step(host.fmu.last_successful_time, 1e-4)
    with pytest.raises(Refused, match=r"without gap or overlap$"):
        host.fmu.step(5.0, H)


def test_a_run_after_a_reset_is_warned_of_anew(extracted):
    fmu = Native(extracted).put({"solver.preset": 1, "solver.tolerance": 1e-4}).initialize()
    (warning,) = fmu.warnings
    fmu._call("Reset")
    fmu.put({"solver.preset": 1, "solver.tolerance": 1e-4}).initialize()
    assert fmu.warnings == [warning] * 2
