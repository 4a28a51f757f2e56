"""Without contact the integrators converge with the square of the step to the exact motion."""

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from papers.dense_machine import rest

from ..machines import (
    METHODS,
    disc_dofs,
    first_order,
    jeffcott,
    jeffcott_shaft_mass,
    jeffcott_stiffness,
    overhung,
    unbalance_vector,
)

DURATION, STOPS = 0.04, 40  # [s], and communication points within it
OMEGA = 150.0


def exact_motion(structure):
    """(q, v) about the rest at the stops, shape (STOPS, 2, n), by the matrix exponential."""
    A = first_order(structure, OMEGA)
    n = len(A) // 2
    # the turning vector exp(i Omega t) is one more state
    larger = np.zeros((2 * n + 1, 2 * n + 1), dtype=complex)
    larger[:-1, :-1] = A
    larger[n:-1, -1] = np.linalg.solve(
        to_dense(structure.M), OMEGA**2 * unbalance_vector(structure)
    )
    larger[-1, -1] = 1j * OMEGA
    step = scipy.linalg.expm(larger * DURATION / STOPS)
    state = np.append(np.zeros(2 * n), 1).astype(complex)
    states = [state := step @ state for _ in range(STOPS)]
    return np.array(states)[:, :-1].reshape(STOPS, 2, n)


def exact_run_up(rotor, rate):
    """The same for a speed of rate * t, by an explicit solver of order eight."""
    structure = assemble(rotor)
    M, C, K, G = (to_dense(band) for band in (structure.M, structure.C, structure.K, structure.G))
    n, U = len(M), unbalance_vector(structure)
    inverse = np.linalg.inv(M)
    still = rest(rotor)[:-1]

    def slope(t, x):
        q, v = x[:n], x[n:]
        omega = rate * t
        f = U * np.exp(0.5j * rate * t**2) * (omega**2 - 1j * rate)
        f = f - C @ v - K @ q + 1j * omega * (G @ v) + 0.5j * rate * (G @ (still + q))
        return np.concatenate([v, inverse @ f])

    at = np.linspace(0, DURATION, STOPS + 1)
    run = scipy.integrate.solve_ivp(
        slope, (0, DURATION), np.zeros(2 * n, dtype=complex), "DOP853", at, rtol=1e-12, atol=1e-16
    )
    return run.y.T[1:].reshape(STOPS, 2, n)


def integrated(rotor, settings, speed, rate=0.0):
    """(q, v) about the rest at the stops as the simulation finds them."""
    sim = Simulation(rotor, settings, speed=speed, rate=rate)
    still = rest(rotor)
    states = []
    for t in np.linspace(0, DURATION, STOPS + 1)[1:]:
        sim.advance(t, speed + rate * sim.time)
        states.append([(sim.motion.q - still)[:-1], sim.motion.v[:-1].copy()])
    return np.array(states)


def orders_of_convergence(rotor, settings, exact, **spin):
    """Of displacements and velocities, as the step is halved."""
    errors = []
    for h in (1e-5, 5e-6):
        result = integrated(rotor, choose("robust", **settings, h=h), **spin)
        errors.append(np.abs(result - exact).max(axis=(0, 2)) / np.abs(exact).max(axis=(0, 2)))
    assert np.all(errors[1] < 1e-4)
    return np.log2(errors[0] / errors[1])


@pytest.mark.parametrize("method", METHODS)
def test_every_integrator_is_of_second_order(method):
    rotor = overhung()
    exact = exact_motion(assemble(rotor))
    orders = orders_of_convergence(rotor, METHODS[method], exact, speed=OMEGA)
    np.testing.assert_allclose(orders, 2, atol=0.05)


@pytest.mark.parametrize("method", ["newmark", "chung-hulbert"])
def test_a_run_up_is_of_second_order_too(method):
    rotor, rate = overhung(), 8000.0
    exact = exact_run_up(rotor, rate)
    orders = orders_of_convergence(rotor, METHODS[method], exact, speed=0.0, rate=rate)
    np.testing.assert_allclose(orders, 2, atol=0.05)


def settled(rotor, omega, revolutions, per_revolution=400):
    """q about the rest in the turning frame, q exp(-i theta), after so many revolutions."""
    period = 2 * np.pi / omega
    sim = Simulation(rotor, choose("robust", h=period / per_revolution), speed=omega)
    still = rest(rotor)
    sim.advance(revolutions * period, omega)
    return (sim.motion.q - still)[:-1] * np.exp(-1j * sim.read("phi"))


@pytest.mark.parametrize("omega", [90.0, 130.0, 300.0])
def test_the_unbalance_response_settles_at_that_of_the_frequency_domain(omega):
    rotor = overhung(eta_v=1e-3)
    s = assemble(rotor)
    M, C, K, G = (to_dense(band) for band in (s.M, s.C, s.K, s.G))
    # q = A exp(i Omega t) in M q'' + (C - i Omega G) q' + K q = U Omega^2 exp(i Omega t)
    dynamic = K - omega**2 * M + 1j * omega * (C - 1j * omega * G)
    amplitude = np.linalg.solve(dynamic, omega**2 * unbalance_vector(s))
    result = settled(rotor, omega, revolutions=100)
    np.testing.assert_allclose(result, amplitude, atol=1e-3 * np.abs(amplitude).max())


@pytest.mark.parametrize("ratio", [0.5, 0.8, 1.25, 4.0])
def test_jeffcotts_rotor_whirls_on_the_circle_of_the_textbook(ratio):
    e, zeta = 1e-4, 0.05
    mass = jeffcott().discs[0].mass(jeffcott().material.density)
    # the shaft takes part with 17/35 of its mass, but has no eccentricity
    moving = mass + 17 / 35 * jeffcott_shaft_mass()
    natural = np.sqrt(jeffcott_stiffness() / moving)
    rotor = jeffcott(e=e, damping=2 * zeta * natural * moving)
    # behind the shaft's centre below resonance, beyond it the mass centre lies inside: -e
    circle = mass / moving * e * ratio**2 / (1 - ratio**2 + 2j * zeta * ratio)
    result = settled(rotor, ratio * natural, revolutions=60 * max(1, ratio))
    disc = disc_dofs(rotor)[0]
    assert abs(result[disc] - circle) < 0.02 * abs(circle)
