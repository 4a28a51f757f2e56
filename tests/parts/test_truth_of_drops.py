"""Drops, sliding on a wall and the spin-up of a race against closed forms, through the FMUs of
machines described in TOML; the rigid disc is `machines.rigid`."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from .machines import IN_THE_AIR, rigid, robust, started

RADIUS, G = 0.05, 9.81
GAP = 0.25e-3


def dropped(kind="contact", k=1e9, c=2e4, more="", body="", radius=RADIUS, gap=GAP):
    """A rotor of 1 kg in a stiff circle."""
    parts = f"""
[[{kind}]]
node = 2
journal_radius = {radius}
clearance = {gap}
mu = 0.2
k = {k}
c = {c}
delta_c = 1e-9
v_s = 1e-4
{more}
[[sensor]]
node = 2
name = "disc"
"""
    return rigid(gravity=G, parts=body + parts, rest=IN_THE_AIR)


@pytest.fixture(scope="module")
def drop(machine_of):
    """A rotor released at z [m] with friction mu at a speed [rad/s], in steps of h [s]."""
    machine = machine_of(dropped())
    return lambda z, mu, speed, h: machine.start(
        at={"contact[1].mu": mu, "speed": speed, **started(z), **robust(h)}
    )


def test_a_centred_rotor_falls_through_its_clearance(drop):
    with drop(0j, 0.2, 100.0, 2e-6) as run:
        while not run.read("contact[1].contact"):
            before = run.time, *run.read("disc.vy", "disc.y")
            run.advance(run.time + 2e-6)
    time, velocity, y = before
    # the rest of the way at that velocity
    assert time + (GAP + y) / -velocity == pytest.approx(math.sqrt(2 * GAP / G), rel=1e-3)
    assert -velocity == pytest.approx(math.sqrt(2 * GAP * G), rel=1e-3)


def test_without_friction_it_swings_like_a_pendulum_as_long_as_its_clearance(drop):
    depth = GAP + G / 1e9
    with drop(depth * cmath.exp(1j * (0.02 - math.pi / 2)), 0.0, 0.0, 1e-5) as run:
        crossings, before = [], run.read("disc.x")
        while len(crossings) < 5:
            run.advance(run.time + 1e-5)
            x = run.read("disc.x")
            if x * before < 0:
                crossings.append(run.time - 1e-5 * x / (x - before))
            before = x
    period = (crossings[4] - crossings[0]) / 2
    assert 2 * math.pi / period == pytest.approx(math.sqrt(G / GAP), rel=1e-3)


@pytest.fixture(scope="module")
def climb(drop):
    """Angles from the bottom [rad] over a climb from rest, and whether contact was lost."""

    def climbed(mu):
        angles, was_lost = [0.0], False
        with drop(-1j * (GAP + G / 1e9), mu, 1000.0, 2e-6) as run:
            while angles[-1] >= max(angles) - 1e-4 and angles[-1] < 2 * math.pi and run.time < 0.2:
                run.advance(run.time + 1e-5)
                was_lost = was_lost or not run.read("contact[1].contact")
                x, y = run.read("disc.x", "disc.y")
                # to the left for a spin from x towards y
                angle = math.atan2(-x, -y)
                angles.append(angle + 2 * math.pi * round((angles[-1] - angle) / (2 * math.pi)))
        return max(angles), was_lost

    return climbed


@pytest.mark.parametrize(("mu", "turns"), [(0.1, 11.498), (0.3, 35.622), (0.5, 65.659)])
def test_a_rubbing_rotor_climbs_from_the_bottom_and_turns(climb, mu, turns):
    angle, was_lost = climb(mu)
    assert math.degrees(angle) == pytest.approx(turns, abs=0.05)
    assert not was_lost


@pytest.mark.parametrize(("mu", "loses"), [(0.59, False), (0.62, True)])
def test_strong_friction_loses_contact_before_it_turns(climb, mu, loses):
    """Above mu = 0.60334."""
    assert climb(mu)[1] == loses


def test_a_rubbing_rotor_comes_to_rest_at_the_angle_of_friction(drop):
    """At arctan mu, the friction's own regularization aside."""
    mu, lean = 0.3, math.atan(0.3)
    z = -1j * cmath.exp(-1j * 1.02 * lean) * (GAP + G / 1e9 / math.sqrt(1 + mu**2))
    with drop(z, mu, 1000.0, 1e-5) as run:
        seen = []
        for t in np.arange(1, 4001) * 1e-4:
            run.advance(t)
            x, y = run.read("disc.x", "disc.y")
            seen.append(math.atan2(-x, -y))
    assert np.mean(seen) == pytest.approx(lean, rel=1e-3)


def test_friction_turns_the_race_until_it_rolls_with_the_rotor(machine_of):
    mu, j_rotor, j_race, radius, gap, omega = 0.2, 1e-3, 2e-4, 0.1, 1e-5, 100.0
    lean, normal = math.atan(mu), G / math.sqrt(1 + mu**2)
    z = -1j * cmath.exp(-1j * lean) * (gap + normal / 1e9)
    body = f"[[body]]\nnode = 2\nmass = 1e-6\nI_d = 0.0\nI_p = {j_rotor}\n"
    race = f"race_inertia = {j_race}"
    toml = dropped("touchdown_bearing", more=race, body=body, radius=radius, gap=gap)
    together = omega / (mu * normal * radius * (1 / j_race + 1 / j_rotor))
    values = {"w_start": omega, **started(z), **robust(1e-5)}
    with machine_of(toml, is_free=True).start(at=values) as run:
        run.advance(0.5 * together)
        assert run.read("touchdown_bearing[1].ft") == pytest.approx(mu * normal, rel=1e-3)
        while run.read("touchdown_bearing[1].sliding") > 1e-3:
            run.advance(run.time + 1e-5)
        assert run.time == pytest.approx(together, rel=1e-3)
        end = omega * j_rotor / (j_rotor + j_race)
        assert run.read("w") == pytest.approx(end, rel=1e-3)
        assert run.read("touchdown_bearing[1].race") == pytest.approx(end, rel=1e-3)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_error_control_finds_the_same_and_doubts_nothing_when_race_and_rotor_roll(tolerance):
    """All that friction dissipates ceases at one instant, and is no loss to the integrator."""
    mu, j_rotor, j_race, gap, omega = 0.2, 1e-3, 2e-4, 1e-5, 100.0
    lean, normal = math.atan(mu), G / math.sqrt(1 + mu**2)
    z = -1j * cmath.exp(-1j * lean) * (gap + normal / 1e9)
    body = f"[[body]]\nnode = 2\nmass = 1e-6\nI_d = 0.0\nI_p = {j_rotor}\n"
    toml = dropped("touchdown_bearing", more=f"race_inertia = {j_race}", body=body, gap=gap)
    start = f"[start]\nx = {z.real!r}\ny = {z.imag!r}\n"
    rotor = parse_rotor(toml.replace(IN_THE_AIR, start))
    together = omega / (mu * normal * RADIUS * (1 / j_race + 1 / j_rotor))
    said = []
    settings = choose(tolerance=tolerance)
    run = Simulation(rotor, settings, speed=omega, drive_torque=0.0, warn=said.append)
    run.advance(0.99 * together, 0.0)
    assert run.read("touchdown_bearing[1].sliding") > 1e-3
    run.advance(1.01 * together, 0.0)
    assert abs(run.read("touchdown_bearing[1].sliding")) < 1e-3
    run.advance(2.0 * together, 0.0)
    assert run.read("w") == pytest.approx(omega * j_rotor / (j_rotor + j_race), rel=2e-4)
    assert said == []
