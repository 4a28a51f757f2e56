"""Rub and dry whirl against closed forms, through the FMUs of machines described in TOML.

The closed forms are of a rigid disc; what stands for it here, `machines.rigid`, is one to 1e-6 of
its stiffness. Lengths in clearances, times in 1 / OMEGA, as the closed forms have them; the FMU
gets and gives SI units.
"""

import cmath
import math

import numpy as np
import pytest

from .machines import IN_THE_AIR, bearings, rigid, robust, started

OMEGA, CLEARANCE, RADIUS = 100.0, 1e-3, 0.05


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
