"""FMI's rules of time on an instance of either skin: start, end, and steps without gaps."""

import math

import pytest

from .rig_host import H
from .skins import Refused

UNIX_TIME = 1.7e9


def test_a_run_does_not_depend_on_the_time_that_it_starts_at(new):
    """Steps of a power of 2, which both times hold exactly."""
    h = 2.0**-7
    there = new("robust").start(UNIX_TIME).steps(UNIX_TIME, 8, h)
    here = new("robust").start().steps(0.0, 8, h)
    for name in ("phi", "disc[3].x", "disc[3].y", "bearing[1].fn", "solver.steps"):
        assert there.get(name) == here.get(name)


@pytest.mark.parametrize(
    ("start", "off"),
    [(UNIX_TIME, 1.5), (UNIX_TIME, 1e-3), (1e6, -0.5e-3), (0.0, 1e-7), (0.0, -1e-7)],
)
def test_a_gap_or_an_overlap_is_refused_at_any_time(new, start, off):
    host = new().start(start).steps(start, 1)
    angle = host.get("phi")
    with pytest.raises(Refused, match="without gap or overlap"):
        host.fmu.step(start + H + off, H)
    assert host.get("phi") == angle


@pytest.mark.parametrize("start", [0.0, -3.0, 1e6, UNIX_TIME])
def test_a_masters_own_round_off_is_no_gap(new, start):
    host, t = new("robust").start(start, stop=start + 1.0), start
    for i in range(100):
        host.fmu.step(t, H)
        t = start + (i + 1) * H if i % 2 else t + H
    assert host.get("phi") == pytest.approx(400, rel=1e-6)


def test_a_step_that_time_cannot_resolve_is_refused(new):
    for start, h in ((1e15, H), (1e15, 0.4), (UNIX_TIME, 9e-7), (0.0, 1e-30)):
        host = new("robust").start(start)
        with pytest.raises(Refused, match=r"time is a multiple of .*; the step must be at least"):
            host.fmu.step(start, h)


@pytest.mark.parametrize("start", [math.nan, math.inf, -math.inf])
def test_a_start_time_that_is_no_number_is_refused_at_once(new, start):
    with pytest.raises(Refused, match=r"setupExperiment: start time = .* must be finite"):
        new().fmu.setup(start, None, None)


@pytest.mark.parametrize("stop", [-1.0, math.nan])
def test_a_stop_time_before_the_start_is_refused(new, stop):
    with pytest.raises(Refused, match=r"stop time = .* must not lie before the start time"):
        new().fmu.setup(0.0, stop, None)


def test_a_step_past_the_stop_time_is_refused(new):
    host = new().start(0.0, stop=2 * H).steps(0.0, 1)
    with pytest.raises(Refused, match=r"doStep to 0\.03 s: past the stop time, 0\.02 s"):
        host.fmu.step(H, 2 * H)
    host.fmu.step(H, H)
    with pytest.raises(Refused, match="past the stop time"):
        host.fmu.step(2 * H, H)


def test_an_instant_is_told_in_the_hosts_time(new):
    """The false state begins at the same instant of the run, whatever time it started at."""
    seen = []
    for start in (0.0, 1000.0):
        host = new("paper")
        host.set("solver.h", 5e-4)
        host.set("speed", 200.0)
        host.start(start)
        host.fmu.step(start, 0.5)
        seen.append((host.get("solver.trapped_at"), host.get("solver.trapped"), host.warnings))
    (at, steps, warned), (later, as_many, warned_later) = seen
    assert as_many == steps > 0
    assert 0 < at < 0.5
    assert later == pytest.approx(at + 1000.0, abs=1e-9)
    assert warned_later == [f"{warned[0]} (t from the start, 1000 s)"]


def test_a_step_may_miss_the_stop_time_by_a_thousandth_of_itself(new):
    """As of a master that has added up its steps; not by more."""
    host = new().start(0.0, stop=H)
    with pytest.raises(Refused, match="past the stop time"):
        host.fmu.step(0.0, 1.002 * H)
    host.fmu.step(0.0, 1.0009 * H)
