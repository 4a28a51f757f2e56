"""Radau IIA in stages: its order, its ledger, states, rows. What its tolerance promises is in
`population`."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.schemes import radau
from rotor_fmu.model.settings import PRESETS, SettingsError, _given, choose, settings_of_given
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.stability.resolution import resolving_step_in_stages
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.time_loop.recorder import Record

from rotor_fmu.machine_file.loading import machine_text

from ..machines import losses, overhung
from ..parts.dropped import RATE, SPEED
from ..parts.dropped import machine as dropped_machine
from ..physics import test_free_spin
from . import test_oscillations

EXAMPLES = Path(__file__).parents[2] / "examples"


def in_steps(h):
    """Radau IIA in steps of one length [s]."""
    return choose(method="radau5", tolerance=1.0, h=h, h_min=h, h_max=h)


def test_the_stages_integrate_polynomials_as_collocation_does():
    for power in range(3):
        np.testing.assert_allclose(
            radau.A @ radau.C**power, radau.C ** (power + 1) / (power + 1), rtol=1e-14
        )
    # of order five at the end of the step
    for power in range(5):
        assert radau.A[2] @ radau.C**power == pytest.approx(1 / (power + 1), rel=1e-14)
    np.testing.assert_allclose(
        radau.T @ np.diag(radau.LAMBDA) @ radau.T_INVERSE, radau.A, atol=1e-15
    )


def test_a_step_is_damped_as_the_method_says_and_a_growth_is_seen_up_to_its_longest_step():
    amplification = interpreted(radau.amplification)
    for z in (0.3j, -0.2 + 1j, 0.05 + 0.4j):
        system = np.eye(3) - z * radau.A
        exact = 1 + z * (radau.A[2] @ np.linalg.solve(system, np.ones(3)))
        assert amplification(z) == pytest.approx(abs(exact), rel=1e-13)
    assert amplification(1e6j) < 1e-5
    root = 3.0 + 1000j
    h = interpreted(resolving_step_in_stages)(root, 0.9)
    assert math.log(amplification(h * root)) == pytest.approx(0.9 * root.real * h, rel=1e-3)


@pytest.mark.parametrize(
    ("speed", "rate"), [(test_oscillations.OMEGA, 0.0), (0.0, 8000.0)], ids=["steady", "run-up"]
)
def test_it_is_of_order_five_without_contact(speed, rate):
    rotor = overhung()
    if rate:
        exact = test_oscillations.exact_run_up(rotor, rate)
    else:
        exact = test_oscillations.exact_motion(assemble(rotor))
    errors = []
    for h in (2e-4, 1e-4):
        result = test_oscillations.integrated(rotor, in_steps(h), speed, rate)
        errors.append(np.abs(result - exact).max() / np.abs(exact).max())
    assert errors[1] < 1e-5
    assert np.log2(errors[0] / errors[1]) == pytest.approx(5, abs=0.5)


def test_a_free_rotor_and_its_motion_are_solved_with_order_five():
    discs = tuple(replace(disc, e=3e-3) for disc in overhung().discs)
    rotor, run = overhung(discs=discs), {"speed": 120.0, "torque": 4.0}
    q, omega, theta = test_free_spin.exact(rotor, 0.2, **run)
    errors = []
    for h in (4e-3, 2e-3):
        sim = test_free_spin.free(rotor, in_steps(h), 0.2, **run)
        errors.append(
            [
                abs(sim.motion.q[:-1] - q).max() / abs(q).max(),
                abs(sim.read("w") - omega) / omega,
                abs(sim.read("phi") - theta) / theta,
            ]
        )
    assert max(errors[1]) < 1e-5
    assert np.all(np.log2(np.divide(*errors)) > 4)


@cache
def rubbed(tolerance):
    """The orbits of the journals of a rotor that rubs."""
    rotor = parse_rotor(machine_text("file", EXAMPLES / "from_ross" / "rubbing.toml"))
    settings = choose(method="radau5", tolerance=tolerance)
    sim = Simulation(rotor, settings, speed=335.0, rate=12.0)
    orbit = []
    for t in np.linspace(0.0, 0.5, 251)[1:]:
        sim.advance(t, 335.0 + 12.0 * sim.time)
        orbit.append(sim.motion.q[sim.structure.interfaces.dof].copy())
    return np.array(orbit)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_where_contacts_open_and_friction_reverses_it_keeps_to_the_tolerance(tolerance):
    """No method of high order is one there: steps that look as good as others are not."""
    exact, seen = rubbed(1e-7), rubbed(tolerance)
    assert np.abs(seen - exact).max() < tolerance * np.abs(exact - exact[0]).max()


@pytest.mark.parametrize("speed", [250.0, 400.0])
def test_a_loose_tolerance_is_not_dearer_than_a_tight_one(speed):
    """Steps in which Newton's method hardly arrives would be."""
    iterations = []
    for tolerance in (1e-2, 1e-3):
        sim = Simulation(
            rig(), choose(method="radau5", tolerance=tolerance), speed=speed, rate=-10.0
        )
        sim.advance(1.0, speed)
        iterations.append(sim.read("solver.newton"))
    assert iterations[0] < 1.1 * iterations[1]


@pytest.mark.parametrize("mode", ["fixed", "adaptive"])
def test_without_error_control_it_is_refused(mode):
    with pytest.raises(SettingsError, match=r"^method = radau5: takes mode = controlled.*" + mode):
        choose(method="radau5", mode=mode, h=1e-3, h_min=1e-4, h_max=1e-2, eps_max=1.0)


@pytest.mark.parametrize("speed", [400.0, 215.0, 40.0])
def test_the_ledger_of_the_rubbing_rig_closes(speed):
    sim = Simulation(rig(), choose(method="radau5"), speed=speed, rate=-10.0)
    for i in range(100):
        sim.advance(0.03 * (i + 1), speed - 0.3 * i)
    assert sim.read("energy.friction_loss") > 0.5  # it did rub
    assert abs(sim.read("energy.residual")) < 1e-3 * losses(sim)


def test_the_ledger_closes_with_races_that_friction_turns_and_they_move_as_others_find_them():
    runs = []
    for settings in (choose(method="radau5", tolerance=1e-5), choose(tolerance=1e-5)):
        sim = Simulation(dropped_machine(), settings, speed=SPEED, rate=RATE)
        for i in range(50):
            sim.advance(2e-3 * (i + 1), SPEED + RATE * sim.time)
        assert abs(sim.read("energy.residual")) < 1e-3 * losses(sim)
        runs.append(sim)
    races = [sim.motion.internal_state.copy() for sim in runs]
    assert np.abs(races[0]).max() > 1.0
    np.testing.assert_allclose(races[0], races[1], atol=3e-3 * np.abs(races[1]).max())
    steps = [sim.read("solver.steps") for sim in runs]
    assert steps[0] < steps[1] / 3


def test_a_restored_run_repeats_itself_to_the_bit():
    for rotor, speed in ((rig(), 300.0), (dropped_machine(), SPEED)):
        sim = Simulation(rotor, choose(method="radau5"), speed=speed)
        sim.advance(0.05, speed)
        state = sim.snapshot()
        sim.advance(0.1, speed)
        first = sim.observed.copy()
        sim.restore(state)
        sim.advance(0.1, speed)
        np.testing.assert_array_equal(sim.observed, first)
        other = Simulation(rotor, choose(method="radau5"), speed=speed)
        other.restore(state)
        other.advance(0.1, speed)
        np.testing.assert_array_equal(other.observed, first)


def test_rows_are_recorded_within_the_steps_and_change_no_number_of_the_run():
    names = ("disc[3].x", "disc[3].vx", "w", "energy.friction_loss")
    exact = Simulation(
        rig(), choose(tolerance=1e-6), speed=400.0, rate=-10.0, record=Record(names, 0.0, 40000)
    )
    alone = Simulation(rig(), choose(method="radau5", tolerance=1e-4), speed=400.0, rate=-10.0)
    sim = Simulation(
        rig(),
        choose(method="radau5", tolerance=1e-4),
        speed=400.0,
        rate=-10.0,
        record=Record(names, math.pi / 128),
    )
    for run in (exact, alone, sim):
        run.advance(0.1, 400.0, rate=-10.0)
    np.testing.assert_array_equal(sim.observed, alone.observed)
    rows, truth_rows = sim.drain(), exact.drain()
    assert len(rows) > 1.5 * sim.read("solver.steps")
    assert np.all(np.diff(rows[:, 0]) > 0.0)
    for column in range(1, 5):
        expected = np.interp(rows[:, 0], truth_rows[:, 0], truth_rows[:, column])
        span = np.ptp(truth_rows[:, column])
        assert np.abs(rows[:, column] - expected).max() < 5e-3 * span


def test_amplitudes_are_seen_within_the_steps():
    """Steps of some third of a radian, whose ends alone would miss a hundredth of a peak."""
    runs = []
    for settings in (choose(method="radau5", tolerance=1e-3), choose(tolerance=1e-5)):
        sim = Simulation(rig(), settings, speed=400.0)
        for i in range(20):
            sim.advance(0.05 * (i + 1), 400.0)
        runs.append([sim.read(f"disc[3].{axis}_{of}") for axis in "xy" for of in ("amp", "1x")])
    np.testing.assert_allclose(runs[0], runs[1], rtol=3e-3)


def test_with_component_modes_it_moves_as_the_other_method_does():
    orbits = []
    for given in ({"method": "radau5", "tolerance": 1e-5}, {"tolerance": 1e-5}):
        sim = Simulation(rig(), choose(reduction=4, **given), speed=200.0, rate=-10.0)
        seen = []
        for i in range(50):
            sim.advance(0.01 * (i + 1), 200.0 - 10.0 * sim.time)
            seen.append(complex(sim.read("disc[3].x"), sim.read("disc[3].y")))
        orbits.append(np.array(seen))
    assert np.abs(orbits[0] - orbits[1]).max() < 1e-3 * np.abs(orbits[1]).max()


def test_the_setting_that_it_does_not_look_at_is_named():
    chosen = _given(list(PRESETS).index("controlled"), {"method": "radau5", "fitted": True})
    _, said = settings_of_given(chosen, 0)
    assert said == ["fitted = yes: has no effect with the method radau5"]
    assert said[0].code == "idle-setting"
    chosen = _given(list(PRESETS).index("controlled"), {"method": "radau5"})
    assert settings_of_given(chosen, 0)[1] == []


def test_a_rotor_that_a_torque_drives_takes_no_more_steps_than_one_of_given_speed():
    rotor = parse_rotor(machine_text("--rotor", EXAMPLES / "turbocharger/rotor.toml"))
    settings, end = choose(method="radau5", tolerance=1e-6), 0.01
    driven = Simulation(rotor, settings, speed=380.0)
    free = Simulation(rotor, settings, speed=380.0, drive_torque=0.0)
    driven.advance(end, 380.0)
    free.advance(end, 0.0)
    assert free.read("solver.steps") < 1.5 * driven.read("solver.steps")
