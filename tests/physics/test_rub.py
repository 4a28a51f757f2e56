"""A rub against an explicit solver of order eight with the equations written anew."""

import math

import numpy as np
import pytest
import scipy.integrate
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from papers.dense_machine import rest
from tests.dense import dense_matrices

from ..machines import overhung

# soft enough for an explicit solver; a housing heavy and uneven enough to matter
BEARING = Bearing(
    node=3, journal_radius=0.01, clearance=2e-5, k=2e6, mu=0.2, mass=5.0, kx=2e5, ky=5e5, cx=50.0,
    cy=90.0, c=80.0, delta_c=2e-6,
)  # fmt: skip
DURATION, STOPS, SPEED, RATE = 0.1, 20, 150.0, -200.0


def rubbing():
    discs = (Disc(2, 0.2, 0.03, e=2e-4, phase=0.3), Disc(3, 0.1, 0.02, e=1e-4))
    supports = (Support(1, 2e5, 40.0),)
    return overhung(discs, supports, (BEARING,))


def contact_on_journal(d, d_dot, omega):
    """(F_x, F_y) in real coordinates: n against the wall, friction across it."""
    r = math.hypot(*d)
    depth = r - BEARING.clearance
    if depth <= 0:
        return np.zeros(2)
    e = d / r
    t = np.array([-e[1], e[0]])
    damping = BEARING.c * min(1.0, depth / BEARING.delta_c)
    n = max(0.0, BEARING.k * depth + damping * (d_dot @ e))
    v_t = d_dot @ t + BEARING.journal_radius * omega
    return -n * e - BEARING.mu * n * v_t / math.hypot(v_t, BEARING.v_s) * t


def reference(rotor):
    """Displacements of the whole machine at the stops, shape (STOPS, n + 1), complex."""
    structure = assemble(rotor)
    M, C, K, G, _ = dense_matrices(structure)
    size = len(M) // 2
    journal, housing = 2 * (BEARING.node - 1), size - 1
    still = rest(rotor)[:-1]
    start = np.concatenate([still.real, still.imag])
    fall = np.concatenate([structure.static_load.imag, [-BEARING.mass * rotor.gravity]])
    inverse = np.linalg.inv(M)

    def slope(t, x):
        q, v = x[: 2 * size], x[2 * size :]
        omega, theta = SPEED + RATE * t, SPEED * t + RATE * t * t / 2
        f = np.concatenate([np.zeros(size), fall])
        for dof, u in zip(structure.unbalances.dof, structure.unbalance, strict=True):
            angle = theta + math.atan2(u.imag, u.real)
            cos, sin = abs(u) * math.cos(angle), abs(u) * math.sin(angle)
            f[dof] += omega**2 * cos + RATE * sin
            f[size + dof] += omega**2 * sin - RATE * cos
        at = np.array([journal, size + journal])
        against = np.array([housing, size + housing])
        force = contact_on_journal(q[at] - q[against], v[at] - v[against], omega)
        f[at] += force
        f[against] -= force
        f -= (C + omega * G) @ v + (K + 0.5 * RATE * G) @ q
        return np.concatenate([v, inverse @ f])

    times = np.linspace(0, DURATION, STOPS + 1)
    state = np.concatenate([start, np.zeros(2 * size)])
    run = scipy.integrate.solve_ivp(
        slope, (0, DURATION), state, "DOP853", times, rtol=1e-9, atol=1e-13, max_step=5e-5
    )
    q = run.y[:size] + 1j * run.y[size : 2 * size]
    return q.T[1:]


@pytest.fixture(scope="module")
def exact():
    return reference(rubbing())


def simulated(settings):
    sim = Simulation(rubbing(), settings, speed=SPEED, rate=RATE)
    result, touching = [], []
    for t in np.linspace(0, DURATION, STOPS + 1)[1:]:
        sim.advance(t, SPEED + RATE * sim.time)
        result.append(sim.motion.q[:-1].copy())
        touching.append(sim.read("bearing[1].contact"))
    return np.array(result), touching, sim


@pytest.mark.parametrize("preset", ["robust", "moderate", "paper"])
def test_a_rub_converges_to_what_an_explicit_solver_finds(preset, exact):
    errors = []
    for h in (1e-5, 5e-6):
        result, touching, _ = simulated(choose(preset, h=h))
        assert 0 < sum(touching) < STOPS  # it does knock: touches here, flies there
        errors.append((np.abs(result - exact).max(axis=0) / np.abs(exact).max(axis=0)).max())
    assert errors[1] < 1e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


def test_the_ledger_of_the_rub_closes():
    _, _, sim = simulated(choose("robust", h=5e-6))
    for flow in ("structure", "housing", "contact", "friction"):
        assert sim.read(f"energy.{flow}_loss") > 5e-4
    assert abs(sim.read("energy.residual")) < 1e-6 * sim.read("energy.friction_loss")
