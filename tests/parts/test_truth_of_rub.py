"""Rub and touchdown against closed forms, through machines told in TOML.

The closed forms are of a rigid disc; what stands for it here, `machines.rigid`, is one to 1e-6 of
its stiffness. Lengths in clearances, times in 1 / OMEGA, as the closed forms have them.
"""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from .machines import bearings, rigid

OMEGA, CLEARANCE, RADIUS, G = 100.0, 1e-3, 0.05, 9.81


def started(z, v):
    """A start in the air at a displacement [m] with a velocity [m/s]."""
    return f"[start]\nx = {z.real}\ny = {z.imag}\nvx = {v.real}\nvy = {v.imag}\n"


def jeffcott(z, v, *, zeta, beta, mu, e=0.0, v_s=1e-3):
    """A Jeffcott rotor in a stator of stiffness beta, from z, v in units of the closed form."""
    parts = (
        bearings(OMEGA**2, 2 * zeta * OMEGA)
        + f"""
[[contact]]
node = 2
journal_radius = {RADIUS}
clearance = {CLEARANCE}
mu = {mu}
k = {beta * OMEGA**2}
c = 0.0
v_s = {v_s}
[[sensor]]
node = 2
name = "disc"
"""
    )
    if e:
        parts += f"[[unbalance]]\nnode = 2\namount = {e * CLEARANCE}\n"
    start = started(z * CLEARANCE, v * CLEARANCE * OMEGA)
    return parse_rotor(rigid(parts=parts, rest=start))


def orbit(machine, speed, duration, window, h=1e-4, samples=400):
    """Radius in clearances, averaged over a window at the end, and the whirl in units of OMEGA."""
    sim = Simulation(machine, choose("robust", rho=0.9, h=h), speed=speed * OMEGA)
    sim.advance((duration - window) / OMEGA, speed * OMEGA)
    z = []
    times = np.linspace(duration - window, duration, samples + 1)
    for t in times:
        sim.advance(t / OMEGA, speed * OMEGA)
        z.append(complex(sim.read("disc.x"), sim.read("disc.y")) / CLEARANCE)
    angle = np.unwrap(np.angle(z))
    return np.abs(z).mean(), (angle[-1] - angle[0]) / window


# --- T1: synchronous full annular rub ---

ZETA, BETA, MU, E = 0.1, 4.0, 0.05, 0.5


def synchronous(omega, mu=MU, stable=True):
    """Radius and phase of the full annular rub."""
    s, d = 1 + BETA - omega**2, 2 * ZETA * omega + mu * BETA
    a, b = s * s + d * d, BETA * (s + mu * d)
    c = (1 + mu**2) * BETA**2 - (E * omega**2) ** 2
    r = (b + (1 if stable else -1) * math.sqrt(b * b - a * c)) / a
    return r, -cmath.phase(complex(s, d) * r - BETA * (1 + 1j * mu))


def rub(omega, r, phase, mu=MU, duration=300.0):
    z = cmath.rect(r, phase)
    machine = jeffcott(z, 1j * omega * z, zeta=ZETA, beta=BETA, mu=mu, e=E)
    return orbit(machine, omega, duration, 40 * math.pi / omega, h=5e-5)[0]


@pytest.mark.parametrize(
    ("omega", "radius"),
    [
        (0.9, 1.039376), (1.0, 1.109153), (1.2, 1.296981), (1.4, 1.580638), (1.8, 2.777077),
        (2.0, 3.598968),
    ],
)  # fmt: skip
def test_the_full_annular_rub_has_the_radius_of_the_closed_form(omega, radius):
    r, phase = synchronous(omega)
    assert r == pytest.approx(radius, abs=2e-6)
    assert rub(omega, 1.01 * r, phase) == pytest.approx(r, rel=1e-4)


@pytest.mark.parametrize(("share", "end"), [(0.995, 0.98), (1.005, 1.580638)])
def test_the_unstable_rub_parts_whirl_without_and_with_contact(share, end):
    r, phase = synchronous(1.4, stable=False)
    assert r == pytest.approx(1.007200, abs=1e-6)
    # without rub: e Omega^2 / |1 - Omega^2 + 2 i zeta Omega|
    free = E * 1.96 / abs(1 - 1.96 + 0.28j)
    expected = free if share < 1 else end
    assert rub(1.4, share * r, phase, duration=600.0) == pytest.approx(expected, rel=1e-3)


def test_the_rub_ends_at_the_upper_jump():
    r, phase = synchronous(2.0)
    assert rub(2.015, r, phase, duration=1500.0) > 3.0
    assert rub(2.03, r, phase, duration=1500.0) < 1.0


@pytest.mark.parametrize(("mu", "stays"), [(0.140, True), (0.155, False)])
def test_friction_beyond_hopfs_point_drives_the_rub_away(mu, stays):
    r, phase = synchronous(1.4, mu)
    found = rub(1.4, 1.001 * r, phase, mu, duration=1500.0)
    assert (abs(found / r - 1) < 1e-3) == stays
    if stays:
        assert r == pytest.approx(1.532005, abs=1e-5)


# --- T2, T3: dry friction backward whirl ---

WHIRL = {"zeta": 0.05, "beta": 20.0, "v_s": 1e-5}


def rolling(v):
    """Whirl and radius of rolling at the surface speed v."""
    beta = WHIRL["beta"]
    omega = (math.sqrt(beta**2 + 4 * v * v * (1 + beta)) - beta) / (2 * v)
    return omega, v / omega


def backward(v, omega, r, mu, duration=200.0, share=1.0):
    """Whirl and radius that come of a backward whirl, its velocity taken `share` times."""
    machine = jeffcott(r + 0j, -1j * omega * r * share, mu=mu, **WHIRL)
    speed = v * CLEARANCE / RADIUS
    found_r, found_omega = orbit(machine, speed, duration, 20.0, h=5e-5)
    return -found_omega, found_r


@pytest.mark.parametrize("v", [2.0, 4.0, 8.0])
def test_rolling_has_the_whirl_and_radius_of_the_closed_form(v):
    omega, r = rolling(v)
    found = backward(v, omega, 1.001 * r, 0.1)
    assert found == pytest.approx((omega, r), rel=1e-3)


def test_dry_whirl_dies_below_its_separatrix_and_rolls_above():
    mu, zeta, beta = 0.1, WHIRL["zeta"], WHIRL["beta"]
    omega = zeta / mu + math.sqrt(1 + (zeta / mu) ** 2)
    r = beta / (beta - 2 * zeta * omega / mu)
    assert (omega, r) == pytest.approx((1.618034, 1.088023), abs=1e-6)
    assert backward(4.0, omega, r, mu, share=0.98)[1] < 0.9
    found = backward(4.0, omega, r, mu, share=1.02, duration=400.0)
    assert found == pytest.approx(rolling(4.0), rel=1e-3)


def test_dry_whirl_needs_friction_above_its_threshold():
    # needed at V = 4: 2 zeta omega / (beta (1 - 1 / r)) = 0.0425
    omega, r = rolling(4.0)
    needed = 2 * WHIRL["zeta"] * omega / (WHIRL["beta"] * (1 - 1 / r))
    assert needed == pytest.approx(0.0425, abs=1e-4)
    assert backward(4.0, omega, r, 1.05 * needed)[1] == pytest.approx(r, rel=2e-3)
    assert backward(4.0, omega, r, 0.95 * needed, duration=400.0)[1] < 0.95 * r


# --- T4, T5, T6: drop, sliding, spin-up ---

GAP = 0.25e-3


def dropped(z, mu, *, kind="contact", k=1e9, c=2e4, more="", body="", radius=RADIUS, gap=GAP):
    """A rotor of 1 kg released at z [m] in a stiff circle."""
    parts = f"""
[[{kind}]]
node = 2
journal_radius = {radius}
clearance = {gap}
mu = {mu}
k = {k}
c = {c}
delta_c = 1e-9
v_s = 1e-4
{more}
[[sensor]]
node = 2
name = "disc"
"""
    return parse_rotor(rigid(gravity=G, parts=body + parts, rest=started(z, 0j)))


def test_a_centred_rotor_falls_through_its_clearance():
    sim = Simulation(dropped(0j, 0.2), choose("robust", h=2e-6), speed=100.0)
    while not sim.read("contact[1].contact"):
        before = sim.time, sim.read("disc.vy"), sim.read("disc.y")
        sim.advance(sim.time + 2e-6, 100.0)
    time, velocity, y = before
    # the rest of the way at that velocity
    assert time + (GAP + y) / -velocity == pytest.approx(math.sqrt(2 * GAP / G), rel=1e-3)
    assert -velocity == pytest.approx(math.sqrt(2 * GAP * G), rel=1e-3)


def test_without_friction_it_swings_like_a_pendulum_as_long_as_its_clearance():
    depth = GAP + G / 1e9
    machine = dropped(depth * cmath.exp(1j * (0.02 - math.pi / 2)), 0.0)
    sim = Simulation(machine, choose("robust", h=1e-5))
    crossings, before = [], sim.read("disc.x")
    while len(crossings) < 5:
        sim.advance(sim.time + 1e-5, 0.0)
        x = sim.read("disc.x")
        if x * before < 0:
            crossings.append(sim.time - 1e-5 * x / (x - before))
        before = x
    period = (crossings[4] - crossings[0]) / 2
    assert 2 * math.pi / period == pytest.approx(math.sqrt(G / GAP), rel=1e-3)


def climb(mu):
    """Angles from the bottom [rad] over a climb from rest, and whether contact was lost."""
    sim = Simulation(dropped(-1j * (GAP + G / 1e9), mu), choose("robust", h=2e-6), speed=1000.0)
    angles, was_lost = [0.0], False
    while angles[-1] >= max(angles) - 1e-4 and angles[-1] < 2 * math.pi and sim.time < 0.2:
        sim.advance(sim.time + 1e-5, 1000.0)
        was_lost = was_lost or not sim.read("contact[1].contact")
        # to the left for a spin from x towards y
        angle = math.atan2(-sim.read("disc.x"), -sim.read("disc.y"))
        angles.append(angle + 2 * math.pi * round((angles[-1] - angle) / (2 * math.pi)))
    return max(angles), was_lost


@pytest.mark.parametrize(("mu", "turns"), [(0.1, 11.498), (0.3, 35.622), (0.5, 65.659)])
def test_a_rubbing_rotor_climbs_from_the_bottom_and_turns(mu, turns):
    angle, was_lost = climb(mu)
    assert math.degrees(angle) == pytest.approx(turns, abs=0.05)
    assert not was_lost


def test_strong_friction_loses_contact_before_it_turns():
    assert not climb(0.59)[1]
    assert climb(0.62)[1]


def test_friction_turns_the_race_until_it_rolls_with_the_rotor():
    mu, j_rotor, j_race, radius, gap, omega = 0.2, 1e-3, 2e-4, 0.1, 1e-5, 100.0
    lean, normal = math.atan(mu), G / math.sqrt(1 + mu**2)
    z = -1j * cmath.exp(-1j * lean) * (gap + normal / 1e9)
    body = f"[[body]]\nnode = 2\nmass = 1e-6\nI_d = 0.0\nI_p = {j_rotor}\n"
    machine = dropped(
        z, mu, kind="touchdown_bearing", more=f"race_inertia = {j_race}", body=body,
        radius=radius, gap=gap,
    )  # fmt: skip
    sim = Simulation(machine, choose("robust", h=1e-5), speed=omega, drive_torque=0.0)
    together = omega / (mu * normal * radius * (1 / j_race + 1 / j_rotor))
    sim.advance(0.5 * together, 0.0)
    assert sim.read("touchdown_bearing[1].ft") == pytest.approx(mu * normal, rel=1e-3)
    while sim.read("touchdown_bearing[1].sliding") > 1e-3:
        sim.advance(sim.time + 1e-5, 0.0)
    assert sim.time == pytest.approx(together, rel=1e-3)
    end = omega * j_rotor / (j_rotor + j_race)
    assert sim.read("w") == pytest.approx(end, rel=1e-3)
    assert sim.read("touchdown_bearing[1].race") == pytest.approx(end, rel=1e-3)
