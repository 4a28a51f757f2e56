"""Step control: indicators against the true local error, and steps that shrink and grow."""

from typing import NamedTuple

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import SettingsError, choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop import adaptive_control

import rotor_fmu as rf
from rotor_fmu.run_pictures.run_folder import error_indicator as error_indicator_of_steps

from ..machines import balanced, first_order, overhung

error_indicator = interpreted(adaptive_control.error_indicator)
next_step, shorter_step = (
    interpreted(adaptive_control.next_step),
    interpreted(adaptive_control.shorter_step),
)

OMEGA = 150.0
PAPER = {"method": "generalized-alpha", "alpha_f": 0.1, "alpha_m": 0.08}
ABAQUS = {"method": "hht", "alpha_f": 0.414}
ROBUST = {"method": "chung-hulbert", "rho": 0.2}
NEWMARK = {"method": "newmark"}


def shown_to_true(method, indicator, h=5e-6, steps=300):
    """Ratios of the error shown to the true error of each step: the exact motion over the step from
    where it began, by the matrix exponential. All motions of the rotor are slow against h."""
    settings = choose(**method, indicator=indicator, mode="adaptive", h=h, h_min=h, h_max=h)
    sim = Simulation(balanced(overhung(gravity=0.0)), settings, speed=OMEGA)
    n = sim.structure.M.shape[0]
    propagator = scipy.linalg.expm(first_order(sim.structure, OMEGA) * h)
    force, loads = np.zeros(n, dtype=complex), np.array([20 + 5j, -7j])
    force[sim.structure.load_dof] = loads
    rest = np.append(np.linalg.solve(to_dense(sim.structure.K), force), np.zeros(n))
    ratios = []
    for i in range(1, steps + 1):
        before = np.concatenate([sim.motion.q[:-1], sim.motion.v[:-1]])
        sim.advance(i * h, OMEGA, loads)
        exact = rest + propagator @ (before - rest)
        shown = sim._run.memory.record["error"][0] * np.linalg.norm(sim.motion.q[:-1] - before[:n])
        ratios.append(shown / np.linalg.norm(sim.motion.q[:-1] - exact[:n]))
    return np.array(ratios)


@pytest.mark.parametrize(
    ("method", "indicator", "expected"),
    [
        # printed with beta alone, the indicators leave out where the accelerations belong in time
        (PAPER, "zienkiewicz-xie", 1.12),
        (ABAQUS, "zienkiewicz-xie", 2.64),
        (NEWMARK, "zienkiewicz-xie", 1.0),
        (PAPER, "zienkiewicz-xie-corrected", 1.0),
        (ABAQUS, "zienkiewicz-xie-corrected", 1.0),
        (ROBUST, "zienkiewicz-xie-corrected", 1.0),
        (NEWMARK, "li-zeng-wiberg", 1.0),
        (PAPER, "li-zeng-wiberg-corrected", 1.0),
        (ABAQUS, "li-zeng-wiberg-corrected", 1.0),
        (ROBUST, "li-zeng-wiberg-corrected", 1.0),
    ],
)
def test_the_error_shown_is_so_many_times_the_true_local_error(method, indicator, expected):
    # the carried accelerations settle in the first steps, hence the median
    assert np.median(shown_to_true(method, indicator)) == pytest.approx(expected, rel=0.015)


class State(NamedTuple):
    """What the indicators see of a motion."""

    q: np.ndarray
    a: np.ndarray
    jerk: np.ndarray


def vibration(t, omega=100.0):
    """Two vibrations with their accelerations and jerks at time t."""
    q = np.array([1e-3, 2e-4j]) * np.exp(np.array([1j, -0.7j]) * omega * t)
    rate = np.array([1j, -0.7j]) * omega
    return State(q, rate**2 * q, rate**3 * q)


@pytest.mark.parametrize("indicator", ["zienkiewicz-xie", "li-zeng-wiberg"])
@pytest.mark.parametrize("norm", ["increment", "mixed"])
def test_indicators_are_newmarks_h_cubed_jerk_over_twelve_in_their_norm(indicator, norm):
    h = 1e-5
    old, new = vibration(0.02), vibration(0.02 + h)
    control = choose("paper", method="newmark", indicator=indicator, norm=norm).numbers
    size = np.linalg.norm(new.q - old.q)
    if norm == "mixed":
        size = control.atol + control.rtol * np.linalg.norm(new.q)
    expected = h**3 / 12 * np.linalg.norm(old.jerk) / size
    after = State(new.q, new.a, np.zeros(2, dtype=complex))
    assert error_indicator(control, h, False, old, after) == pytest.approx(expected, rel=2e-3)
    np.testing.assert_allclose(after.jerk, new.jerk, rtol=1e-3)  # carried on to the next step
    assert error_indicator(control, h, True, old, after) == pytest.approx(expected, rel=2e-3)


def test_no_motion_is_no_error():
    rest = State(*(np.zeros(2, dtype=complex) for _ in range(3)))
    for norm in ("increment", "mixed"):
        control = choose("paper", norm=norm).numbers
        assert error_indicator(control, 0.01, False, rest, rest) == 0


CONTROL = choose("paper-adaptive", h=0.01, h_min=0.004, h_max=0.02).numbers


def test_a_rejected_step_shrinks_with_the_cube_root_but_not_below_the_least():
    h = CONTROL.h_max
    assert shorter_step(CONTROL, h, 8 * CONTROL.eps_max) == pytest.approx(0.9 * h / 2)
    assert shorter_step(CONTROL, h, 1e6 * CONTROL.eps_max) == CONTROL.h_min
    assert shorter_step(CONTROL, h, 1.000001 * CONTROL.eps_max) < 0.91 * h


def test_an_accurate_step_lets_the_next_grow_with_the_cube_root_up_to_the_largest():
    h = 0.006
    assert next_step(CONTROL, h, h, CONTROL.eps_min / 8) == pytest.approx(2 * h)
    assert next_step(CONTROL, h, h, 1e-9 * CONTROL.eps_min) == CONTROL.h_max
    assert next_step(CONTROL, h, h, 0.0) == CONTROL.h_max


def test_between_its_limits_the_error_changes_nothing():
    for error in (CONTROL.eps_min, (CONTROL.eps_min + CONTROL.eps_max) / 2):
        assert next_step(CONTROL, 0.012, 0.012, error) == 0.012


def test_a_step_cut_short_does_not_lower_the_wish():
    for error in (0.0, 1e-3 * CONTROL.eps_min, 0.99 * CONTROL.eps_min, CONTROL.eps_max):
        assert next_step(CONTROL, 0.015, 1e-4, error) >= 0.015


@pytest.mark.parametrize("stop", [0.04, 0.013, 0.0021])
def test_the_steps_of_a_run_down_keep_within_their_limits(stop):
    sim = Simulation(rig(), choose("paper-adaptive"), speed=60.0, rate=-10.0)
    for i in range(1, int(4 / stop)):
        sim.advance(i * stop, 60 - 10 * sim.time)
        assert sim.read("solver.h_last") <= min(stop, 0.02) * (1 + 1e-9)
    assert 0.004 <= sim.read("solver.h_min_used") < sim.read("solver.h_max_used") <= 0.02


def test_the_error_of_a_step_is_told_in_the_measure_of_the_mode():
    """Zienkiewicz and Xie's indicator by its formula (paper A, eq. 13), from what moved."""
    settings = choose("paper-adaptive", indicator="zienkiewicz-xie", h=0.004)
    sim = Simulation(rig(), settings, speed=380.0)
    motion, beta, told = sim._run.motion, settings.numbers.beta_error, []
    for _ in range(200):
        steps, q, a = sim.read("solver.steps"), motion.q.copy(), motion.a.copy()
        sim.advance(sim.time + 0.004, 380.0)
        if sim.read("solver.steps") == steps + 1:
            error = abs(beta - 1 / 6) * 0.004**2 * np.linalg.norm(motion.a - a)
            told.append((sim.read("solver.error_last"), error / np.linalg.norm(motion.q - q)))
    shown, expected = np.array(told).T
    assert len(told) > 100
    assert shown == pytest.approx(expected, rel=1e-7)


def test_the_picture_of_the_error_shows_the_indicator_that_the_limits_are_for():
    """It exceeds eps_max in the shortest steps alone; the local error is hundreds of tolerances."""
    at = {"speed": 100.0, "stop": 4.0, "step": 0.04}
    run = rf.simulate(rf.load(), **at, preset="paper-adaptive", per_turn=None)
    (line,) = error_indicator_of_steps(run.recording, "").axes[0].lines
    is_longer = run["solver.h_last"][1:] > 1.001 * 0.004
    assert is_longer.sum() > 50
    assert 0.05 < line.get_ydata()[is_longer].max() <= 1.0


def test_a_finer_limit_of_the_error_takes_more_steps():
    steps = []
    for scale in (1.0, 0.3, 0.1):
        settings = choose(
            **PAPER, mode="adaptive", h=1e-3, h_min=1e-5, h_max=0.01, eps_min=0.1 * scale,
            eps_max=0.3 * scale
        )  # fmt: skip
        sim = Simulation(overhung(), settings, speed=OMEGA)
        sim.advance(1.0, OMEGA)
        steps.append(sim.read("solver.steps"))
        assert sim._run.memory.record[0].error <= 0.3 * scale
    assert steps[0] < steps[1] < steps[2]


def test_a_first_step_that_is_not_given_lies_within_the_limits_that_are():
    assert choose("controlled", h_max=5e-7).h == 5e-7
    assert choose("controlled", h_min=1e-4).h == 1e-4
    assert choose("controlled", h_min=1e-6).h == choose("controlled").h
    assert choose("robust", h_max=1e-5).h == choose("robust").h  # has no effect
    with pytest.raises(SettingsError, match=r"^h_min = 0\.01 s: must be at most h_max = 0\.005 s$"):
        choose("controlled", h_min=0.01)
    with pytest.raises(SettingsError, match=r"^h = 0\.01 s: must lie between"):
        choose("controlled", h=0.01)
