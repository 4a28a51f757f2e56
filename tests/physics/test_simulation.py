"""A run: its state, its angle, its failures and warnings, its symmetries."""

import math
import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import RotorWarning, Simulation, StepFailure

RIG = rig()
PRESETS = {"robust": choose("robust"), "paper-adaptive": choose("paper-adaptive")}
LOADS = np.array([0, 2 + 1j, 0, -3j])
NEAR = 2e-5 * RIG.bearings[0].clearance  # rounding, magnified at every contact


def run_down(sim, until, stop=0.04, loads=None):
    """March along 400 - 10 t rad/s."""
    while sim.time < until - 1e-9:
        sim.advance(sim.time + stop, 400 - 10 * sim.time, loads)


@pytest.mark.parametrize("preset", PRESETS)
def test_a_restored_run_repeats_itself_to_the_bit(preset):
    sim = Simulation(RIG, PRESETS[preset], speed=400.0, rate=-10.0)
    run_down(sim, 0.4)
    saved, at_snapshot = sim.snapshot(), sim.observed.copy()
    run_down(sim, 0.8, loads=LOADS)
    first = sim.observed.copy()
    for _ in range(2):
        sim.restore(saved)
        np.testing.assert_array_equal(sim.observed, at_snapshot)
        assert sim.time == pytest.approx(0.4)
        run_down(sim, 0.8, loads=LOADS)
        np.testing.assert_array_equal(sim.observed, first)


@pytest.mark.parametrize("carried", [np.copy, np.ndarray.tobytes])
def test_a_snapshot_continues_in_an_equal_simulation_to_the_bit(carried):
    sim = Simulation(RIG, speed=400.0, rate=-10.0)
    run_down(sim, 0.2, loads=LOADS)
    other = Simulation(RIG, speed=3.0)
    other.restore(carried(sim.snapshot()))
    for one in (sim, other):
        run_down(one, 0.4)
    np.testing.assert_array_equal(other.observed, sim.observed)


@pytest.mark.parametrize("settings", [{}, {"method": "radau5"}, {"tolerance": 1e-2}], ids=str)
def test_a_snapshot_at_constant_speed_continues_to_the_bit_wherever_it_is_taken(settings):
    """What is carried from step to step, factorized, is that of the step at hand."""
    sim, other = (Simulation(RIG, choose(**settings), speed=400.0) for _ in range(2))
    for i in range(1, 80):
        saved = sim.snapshot()
        sim.advance(1e-3 * i, 400.0)
        if i % 8 == 0:
            other.restore(saved)
            other.advance(1e-3 * i, 400.0)
            np.testing.assert_array_equal(other.observed, sim.observed)


def test_a_snapshot_is_a_copy():
    sim = Simulation(RIG, speed=400.0)
    saved = sim.snapshot()
    retained = saved.tobytes()
    sim.advance(0.1, 400.0, LOADS)
    assert saved.tobytes() == retained
    assert sim.snapshot().tobytes() != retained


def test_where_the_stops_lie_does_not_matter_at_constant_speed():
    whole, split = (Simulation(RIG, choose("robust"), speed=300.0) for _ in range(2))
    whole.advance(0.4, 300.0)
    for stop in (0.01, 0.05, 0.0505, 0.3, 0.4):
        split.advance(stop, 300.0)
    for name in (
        "phi",
        "disc[2].x",
        "disc[2].y",
        "bearing[1].fn",
        "solver.steps",
        "energy.kinetic",
    ):
        assert split.read(name) == pytest.approx(whole.read(name), rel=1e-6)


@pytest.mark.parametrize("preset", PRESETS)
def test_no_time_is_no_motion(preset):
    sim = Simulation(RIG, PRESETS[preset], speed=400.0, rate=-10.0)
    run_down(sim, 0.4)
    q, v = sim.motion.q.copy(), sim.motion.v.copy()
    sim.advance(sim.time, 396.0)
    np.testing.assert_array_equal(sim.motion.q, q)
    np.testing.assert_array_equal(sim.motion.v, v)
    run_down(sim, 0.8)
    assert np.all(np.isfinite(sim.observed))


def test_the_angle_is_the_integral_of_a_linear_speed():
    sim = Simulation(RIG, speed=400.0, rate=-10.0)
    for i in range(1, 26):
        sim.advance(0.04 * i, 400 - 10 * sim.time)
    t = sim.time
    assert sim.read("w") == pytest.approx(400 - 10 * t, rel=1e-14)
    assert sim.read("phi") == pytest.approx(400 * t - 5 * t**2, rel=1e-14)


def test_the_speed_goes_on_linearly_from_the_last_two_given():
    sim = Simulation(RIG, speed=100.0)
    sim.advance(0.1, 100.0)
    sim.advance(0.2, 103.0)
    assert sim.read("w") == pytest.approx(106.0)
    assert sim.read("phi") == pytest.approx(10 + 10.3 + 0.15)


def test_a_mirrored_machine_moves_as_the_mirror_image():
    discs = tuple(replace(d, phase=0.4 * i) for i, d in enumerate(RIG.discs))
    mirrored = tuple(replace(d, phase=math.pi - d.phase) for d in discs)
    sim = Simulation(RIG.with_parts(Disc, *discs), speed=250.0)
    image = Simulation(RIG.with_parts(Disc, *mirrored), speed=-250.0)
    for i in range(1, 11):
        sim.advance(0.01 * i, 250.0, LOADS)
        image.advance(0.01 * i, -250.0, -LOADS.conjugate())
        assert np.abs(image.motion.q + sim.motion.q.conjugate()).max() < NEAR
    assert image.read("tau") == pytest.approx(-sim.read("tau"), rel=1e-3)


def test_a_machine_turned_by_a_right_angle_moves_alike_without_gravity():
    round_bearings = tuple(replace(b, ky=b.kx) for b in RIG.bearings)
    still = replace(RIG.with_parts(Bearing, *round_bearings), gravity=0.0)
    discs = tuple(replace(d, phase=d.phase + math.pi / 2) for d in RIG.discs)
    sim, turned = (Simulation(r, speed=250.0) for r in (still, still.with_parts(Disc, *discs)))
    for i in range(1, 11):
        sim.advance(0.01 * i, 250.0, LOADS)
        turned.advance(0.01 * i, 250.0, 1j * LOADS)
        assert np.abs(turned.motion.q - 1j * sim.motion.q).max() < NEAR


def unstable():
    return choose("paper", method="wbz", alpha_m=0.08)


def test_an_unstable_scheme_is_warned_of():
    with pytest.warns(RotorWarning) as said:
        Simulation(RIG, unstable(), speed=400.0)
    assert len(said) == 1
    assert re.search(r"alpha_m = 0\.08 is unstable.*spectral radius", str(said[0].message))


def test_a_diverging_run_stops_with_a_finite_state_and_says_what_to_do():
    said = []
    sim = Simulation(RIG, unstable(), speed=400.0, rate=-10.0, warn=said.append)
    with pytest.raises(StepFailure) as failure:
        sim.advance(200 * 0.004, 400.0)
    message = str(failure.value)
    assert len(said) == 1
    for part in (f"t = {sim.time:.6g} s", "step 0.004 s", "unstable", "take alpha_m <= alpha_f"):
        assert part in message
    assert sim.read("solver.steps") < 60  # the paper: "diverges at the beginning"
    assert np.all(np.isfinite(sim.observed))
    assert np.abs(sim.motion.q[: 2 * len(RIG.nodes) : 2]).max() < 0.1 * RIG.length


@pytest.mark.parametrize(("preset", "is_false"), [("paper", True), ("robust", False)])
def test_the_false_state_is_reported_where_it_happens_and_only_there(preset, is_false):
    said = []
    sim = Simulation(RIG, choose(preset, h=5e-4), speed=400.0, rate=-10.0, warn=said.append)
    run_down(sim, 20.0)
    assert (sim.read("solver.trapped") > 0) == is_false
    false = [message for message in said if message.startswith("false state since t = ")]
    assert len(false) == is_false
    # in the false state the ledger no longer closes, else it does
    lost = sim.read("energy.friction_loss")
    assert (abs(sim.read("energy.residual")) > 0.1 * lost) == is_false


def test_a_sound_run_is_silent():
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        run_down(Simulation(RIG, speed=400.0, rate=-10.0), 1.0)
    assert [str(each.message) for each in said] == []


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((0.02, 396.0), "to = 0.02 s: must not lie before"),
        ((float("nan"), 396.0), "to = nan"),
        ((0.5, float("nan")), "speed = nan"),
        ((0.5, 396.0, np.full(4, np.nan + 0j)), "loads = "),
    ],
)
def test_nonsense_is_refused_before_it_reaches_the_state(arguments, expected):
    sim = Simulation(RIG, speed=400.0, rate=-10.0)
    run_down(sim, 0.04)
    before = sim.observed.copy()
    with pytest.raises(ValueError, match=expected):
        sim.advance(*arguments)
    np.testing.assert_array_equal(sim.observed, before)
    run_down(sim, 0.08)
    assert np.all(np.isfinite(sim.observed))
