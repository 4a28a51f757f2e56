"""Rub and touchdown against closed forms, through the FMUs of machines described in TOML.

The closed forms are of a rigid disc; what stands for it here, `machines.rigid`, is one to 1e-6 of
its stiffness. Lengths in clearances, times in 1 / OMEGA, as the closed forms have them; the FMU
gets and gives SI units.
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
IN_THE_AIR = "[start]\nx = 0.0\n"


def started(z, v=0j):
    """Parameters of a start in the air at a displacement [m] with a velocity [m/s]."""
    return {"start.x": z.real, "start.y": z.imag, "start.vx": v.real, "start.vy": v.imag}


def robust(h, **more):
    """Steps of a fixed length [s]."""
    return {"solver.preset": 0, "solver.h": h, **{f"solver.{k}": v for k, v in more.items()}}


# A Jeffcott rotor in a stator, as T1 has it; the FMU's parameters make all others of it.
JEFFCOTT = rigid(
    parts=bearings(OMEGA**2, 0.2 * OMEGA)
    + f"""
[[contact]]
node = 2
journal_radius = {RADIUS}
clearance = {CLEARANCE}
mu = 0.05
k = {4 * OMEGA**2}
c = 0.0
v_s = 1e-5
[[sensor]]
node = 2
name = "disc"
[[unbalance]]
node = 2
amount = 0.0
""",
    rest=IN_THE_AIR,
)


@pytest.fixture(scope="module")
def orbit(machine_of):
    """Radius in clearances, averaged over a window at the end, and the whirl in units of OMEGA."""
    machine = machine_of(JEFFCOTT)

    def whirl(
        z, v, speed, duration, window, *, zeta, beta, mu, e=0.0, gap=CLEARANCE, samples=400, h=1e-4
    ):  # fmt: skip
        c = 2 * zeta * OMEGA
        values = {
            "speed": speed * OMEGA,
            "contact[1].clearance": gap,
            "contact[1].mu": mu,
            "contact[1].k": beta * OMEGA**2,
            "unbalance[1].amount": e * gap,
            **started(z * gap, v * gap * OMEGA),
            **robust(h, rho=0.9),
        }
        for i, share in ((1, 0.01), (2, 0.98), (3, 0.01)):
            values |= dict.fromkeys(
                (f"linear_bearing[{i}].cxx", f"linear_bearing[{i}].cyy"), share * c
            )
        with machine.start(at=values) as run:
            seen = []
            for t in np.linspace(duration - window, duration, samples + 1):
                run.advance(t / OMEGA)
                seen.append(complex(*run.read("disc.x", "disc.y")) / gap)
        angle = np.unwrap(np.angle(seen))
        return np.abs(seen).mean(), (angle[-1] - angle[0]) / window

    return whirl


# --- T1: synchronous full annular rub ---

ZETA, BETA, MU, E = 0.1, 4.0, 0.05, 0.5


def synchronous(omega, mu=MU, stable=True):
    """Radius and phase of the full annular rub."""
    s, d = 1 + BETA - omega**2, 2 * ZETA * omega + mu * BETA
    a, b = s * s + d * d, BETA * (s + mu * d)
    c = (1 + mu**2) * BETA**2 - (E * omega**2) ** 2
    r = (b + (1 if stable else -1) * math.sqrt(b * b - a * c)) / a
    return r, -cmath.phase(complex(s, d) * r - BETA * (1 + 1j * mu))


@pytest.fixture(scope="module")
def rub(orbit):
    """The radius that comes of a synchronous rub at a radius and a phase."""

    def radius(omega, r, phase, mu=MU, duration=300.0, h=1e-4):
        z = cmath.rect(r, phase)
        window = 40 * math.pi / omega
        of = {"zeta": ZETA, "beta": BETA, "mu": mu, "e": E, "h": h}
        return orbit(z, 1j * omega * z, omega, duration, window, **of)[0]

    return radius


@pytest.mark.parametrize(
    ("omega", "radius"),
    [
        (0.9, 1.039376), pytest.param(1.0, 1.109153, marks=pytest.mark.slow), (1.2, 1.296981),
        pytest.param(1.4, 1.580638, marks=pytest.mark.slow),
        pytest.param(1.8, 2.777077, marks=pytest.mark.slow), (2.0, 3.598968),
    ],
)  # fmt: skip
def test_the_full_annular_rub_has_the_radius_of_the_closed_form(rub, omega, radius):
    r, phase = synchronous(omega)
    assert r == pytest.approx(radius, abs=2e-6)
    assert rub(omega, 1.01 * r, phase, h=5e-5) == pytest.approx(r, rel=1e-4)


@pytest.mark.parametrize(
    ("omega", "radius", "larger"),
    [
        (1.4, 1.007200, 1.580638),
        pytest.param(1.8, 1.416169, 2.777077, marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("share", [0.995, 1.005])
def test_the_unstable_rub_parts_whirl_without_and_with_contact(rub, omega, radius, larger, share):
    r, phase = synchronous(omega, stable=False)
    assert r == pytest.approx(radius, abs=1e-6)
    # without rub: e Omega^2 / |1 - Omega^2 + 2 i zeta Omega|
    free = E * omega**2 / abs(1 - omega**2 + 2j * ZETA * omega)
    expected = free if share < 1 else larger
    assert rub(omega, share * r, phase, duration=600.0) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(("omega", "rubs"), [(2.015, True), (2.03, False)])
def test_the_rub_ends_at_the_upper_jump(rub, omega, rubs):
    """At 2.02208, where the two radii meet."""
    r, phase = synchronous(2.0)
    result = rub(omega, r, phase, duration=1500.0)
    assert (result > 3.0) == rubs
    assert (result < 1.0) != rubs


@pytest.mark.parametrize(("mu", "stays"), [(0.140, True), (0.155, False)])
def test_friction_beyond_hopfs_point_drives_the_rub_away(rub, mu, stays):
    """At mu = 0.147023."""
    r, phase = synchronous(1.4, mu)
    result = rub(1.4, 1.001 * r, phase, mu, duration=1500.0)
    assert (abs(result / r - 1) < 1e-3) == stays
    if stays:
        assert r == pytest.approx(1.532005, abs=1e-5)


# --- T2, T3: dry friction backward whirl ---

WHIRL = {"zeta": 0.05, "beta": 20.0}


def rolling(v):
    """Whirl and radius of rolling at the surface speed v."""
    beta = WHIRL["beta"]
    omega = (math.sqrt(beta**2 + 4 * v * v * (1 + beta)) - beta) / (2 * v)
    return omega, v / omega


@pytest.fixture(scope="module")
def backward(orbit):
    """Whirl and radius that come of a backward whirl, its velocity taken `share` times."""

    def whirl(v, omega, r, mu, duration=200.0, share=1.0, gap=CLEARANCE):
        speed = v * gap / RADIUS
        start = r + 0j, -1j * omega * r * share
        found_r, found_omega = orbit(*start, speed, duration, 20.0, mu=mu, gap=gap, **WHIRL)
        return -found_omega, found_r

    return whirl


@pytest.mark.parametrize("v", [2.0, *(pytest.param(v, marks=pytest.mark.slow) for v in (4.0, 8.0))])
def test_rolling_has_the_whirl_and_radius_of_the_closed_form(backward, v):
    omega, r = rolling(v)
    result = backward(v, omega, 1.001 * r, 0.1)
    assert result == pytest.approx((omega, r), rel=1e-3)


def test_dry_whirl_dies_below_its_separatrix_and_rolls_above(backward):
    mu, zeta, beta = 0.1, WHIRL["zeta"], WHIRL["beta"]
    omega = zeta / mu + math.sqrt(1 + (zeta / mu) ** 2)
    r = beta / (beta - 2 * zeta * omega / mu)
    assert (omega, r) == pytest.approx((1.618034, 1.088023), abs=1e-6)
    assert backward(4.0, omega, r, mu, share=0.98)[1] < 0.9
    result = backward(4.0, omega, r, mu, share=1.02, duration=400.0)
    assert result == pytest.approx(rolling(4.0), rel=1e-3)


@pytest.mark.parametrize(("share", "stays"), [(0.95, False), (1.05, True)])
def test_rolling_needs_the_friction_of_the_closed_form(backward, share, stays):
    omega, r = rolling(4.0)
    needed = 2 * WHIRL["zeta"] * omega / (WHIRL["beta"] * (1 - 1 / r))
    assert needed == pytest.approx(0.0425, abs=1e-4)
    result = backward(4.0, omega, r, share * needed, duration=400.0)[1]
    if stays:
        assert result == pytest.approx(r, rel=2e-3)
    else:
        assert result < 0.95 * r


@pytest.mark.parametrize(("share", "lasts"), [(0.95, False), (1.05, True)])
def test_dry_whirl_needs_friction_above_its_threshold(backward, share, lasts):
    """Above mu_c = 2 zeta sqrt(1 + beta) / beta a whirl that is fast enough ends in rolling; below
    it even the fastest dies."""
    zeta, beta, v = WHIRL["zeta"], WHIRL["beta"], 80.0
    threshold = 2 * zeta * math.sqrt(1 + beta) / beta
    assert threshold == pytest.approx(0.0229129, abs=1e-7)
    mu, (omega, r) = share * threshold, rolling(v)
    if lasts:  # from just above the separatrix
        omega = zeta / mu + math.sqrt(1 + (zeta / mu) ** 2)
        r = beta / (beta - 2 * zeta * omega / mu)
    result = backward(v, omega, r, mu, 2000.0, 1.03 if lasts else 0.99, gap=1e-4)
    if lasts:
        assert r < 0.75 * rolling(v)[1]
        assert result == pytest.approx(rolling(v), rel=1e-3)
    else:
        assert result[1] < 0.3 * r


# --- T4, T5, T6: drop, sliding, spin-up ---

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
