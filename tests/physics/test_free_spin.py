"""A rotor that a torque drives: its speed is a state, and slows for what its motion costs."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation
from scipy.integrate import solve_ivp

from rotor_fmu.machine_file.loading import load_rotor

from ..known import EXAMPLES
from ..machines import METHODS, balanced, overhung, unbalance_vector
from .test_energy import orders_of_residual


def free(rotor, settings, duration, *, speed, torque, stops=50):
    sim = Simulation(rotor, settings, speed=speed, drive_torque=torque)
    for t in np.linspace(0, duration, stops + 1)[1:]:
        sim.advance(t, torque)
    return sim


def test_a_balanced_rotor_speeds_up_as_torque_by_inertia():
    rotor = balanced(overhung(gravity=0.0))
    sim = free(rotor, choose("robust"), 0.2, speed=30.0, torque=0.5)
    inertia = sim.read("J")
    assert sim.read("a") == pytest.approx(0.5 / inertia, rel=1e-9)
    assert sim.read("w") == pytest.approx(30 + 0.2 * 0.5 / inertia, rel=1e-9)
    assert sim.read("phi") == pytest.approx(30 * 0.2 + 0.5 * 0.2**2 * 0.5 / inertia, rel=1e-9)


def exact(rotor, duration, speed, torque):
    """The same machine by DOP853 on the coupled equations of lateral motion and spin, dense."""
    sim = Simulation(rotor, choose("robust"), speed=speed, drive_torque=torque)
    s = sim.structure
    M, C, K, G = (to_dense(band) for band in (s.M, s.C, s.K, s.G))
    arm, n = unbalance_vector(s), len(s.static_load)
    coupled = np.zeros((2 * n + 1, 2 * n + 1))

    def rates(t, y):
        q, v = y[: 2 * n].view(complex), y[2 * n : 4 * n].view(complex)
        omega, theta = y[4 * n :]
        turned = arm * np.exp(1j * theta)
        force = s.static_load + turned * omega**2 - C @ v + 1j * omega * (G @ v) - K @ q
        # what multiplies the angular acceleration in the lateral equations, and the reverse
        column = 1j * turned - 0.5j * (G @ q)
        for part, rows in ((np.real, slice(0, n)), (np.imag, slice(n, 2 * n))):
            coupled[rows, rows] = M
            coupled[rows, 2 * n] = part(column)
        coupled[2 * n, :n] = -turned.imag + 0.5 * (G @ q).imag
        coupled[2 * n, n : 2 * n] = turned.real - 0.5 * (G @ q).real
        coupled[2 * n, 2 * n] = s.numbers[0].inertia
        balance = torque - rotor.gravity * turned.real.sum()
        a = np.linalg.solve(coupled, np.concatenate([force.real, force.imag, [balance]]))
        acceleration = a[:n] + 1j * a[n : 2 * n]
        return np.concatenate([y[2 * n : 4 * n], acceleration.view(float), [a[2 * n], omega]])

    start = np.concatenate([sim.motion.q[:-1].view(float), np.zeros(2 * n), [speed, 0.0]])
    done = solve_ivp(rates, (0, duration), start, "DOP853", rtol=1e-8, atol=1e-11)
    y = done.y[:, -1]
    return y[: 2 * n].view(complex), y[4 * n], y[4 * n + 1]


def test_the_coupled_equations_are_solved_with_second_order():
    """A strong unbalance, so that whirl and spin feel each other, through the first resonance."""
    discs = tuple(replace(disc, e=3e-3) for disc in overhung().discs)
    rotor, run = overhung(discs=discs), {"speed": 120.0, "torque": 4.0}
    q, omega, theta = exact(rotor, 0.2, **run)
    errors = []
    for h in (1e-4, 5e-5, 2.5e-5):
        sim = free(rotor, choose("robust", method="newmark", h=h), 0.2, **run)
        errors.append(
            [
                abs(sim.motion.q[:-1] - q).max() / abs(q).max(),
                abs(sim.read("w") - omega) / omega,
                abs(sim.read("phi") - theta) / theta,
            ]
        )
    assert abs(omega - (120 + 0.2 * 4.0 / sim.read("J"))) > 0.01 * omega
    assert max(errors[-1]) < 1e-3
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, atol=0.3)


@pytest.mark.parametrize("method", METHODS)
def test_without_contact_the_residual_falls_with_the_square_of_the_step(method):
    orders = orders_of_residual(method, partial(free, torque=30.0))
    assert orders == pytest.approx(2, abs=0.3)


def test_the_torque_that_the_motion_needs_is_that_of_the_drive():
    sim = Simulation(rig(), choose("robust"), speed=180.0, drive_torque=-0.05)
    for i in range(1, 200):
        torque = 0.05 * math.sin(0.1 * i)
        sim.advance(i * 2e-3, torque)
        assert sim.read("tau") == pytest.approx(torque, abs=1e-5)


@pytest.mark.parametrize("modes", [0, 4])
def test_a_torque_needs_an_inertia_beside_that_of_the_unbalances(modes):
    """A point mass has none about the axis: with its shaft's alone, a torque would turn what the
    unbalance moves, U^2/m."""
    rotor = load_rotor(EXAMPLES / "jeffcott_rub" / "jeffcott.toml")[1]
    settings = choose("controlled", reduction=modes)
    with pytest.raises(EquilibriumError, match=r"5e-09 kg.m2: must be at least 1e-06 kg.m2"):
        Simulation(rotor, settings, speed=10.0, drive_torque=0.0)
    heavy = replace(rotor.material, density=2e3 * rotor.material.density)
    sections = tuple(replace(section, material=heavy) for section in rotor.sections)
    heavier = replace(rotor, sections=sections)
    turned = Simulation(heavier, settings, speed=10.0, drive_torque=1e-4)
    turned.advance(0.1, 1e-4)
    assert turned.read("w") == pytest.approx(11.0, rel=0.01)
    Simulation(rotor, settings, speed=10.0)


def test_a_free_rotor_goes_on_from_a_snapshot_bit_for_bit():
    sim = Simulation(rig(), choose("robust"), speed=200.0, drive_torque=-0.05)

    def march(t):
        seen = []
        for i in range(1, 21):
            sim.advance(t + i * 1e-3, 0.02 * i)
            seen.append(sim.observed.copy())
        return np.array(seen)

    march(0.0)
    snapshot = sim.snapshot()
    first = march(0.02)
    sim.restore(snapshot)
    assert np.array_equal(march(0.02), first)


def test_dry_friction_holds_a_resting_rotor_against_a_small_torque():
    torque = 0.01
    sim = free(rig(), choose("robust"), 1.0, speed=0.0, torque=torque)
    assert abs(sim.read("w")) < 0.2  # the regularised friction creeps
    friction = sum(7.5e-3 * sim.read(f"bearing[{j}].ft") for j in (1, 2))
    lever = abs(unbalance_vector(sim.structure).sum()) * 9.81
    assert friction == pytest.approx(torque - lever, rel=0.1)


def test_adaptive_steps_turn_a_free_rotor_too():
    fixed = free(rig(), choose("robust", h=1e-4), 0.5, speed=100.0, torque=0.05)
    adaptive = free(
        rig(),
        choose("robust", mode="adaptive", h=5e-4, h_min=1e-5, h_max=2e-3, norm="mixed"),
        0.5,
        speed=100.0,
        torque=0.05,
    )
    assert adaptive.read("w") == pytest.approx(fixed.read("w"), rel=2e-3)
