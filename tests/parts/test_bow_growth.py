"""Bows that grow and turn with the heat of a rub, against closed forms and eigenvalues."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from .heated import bow, run

_MASS, _DAMPING, _RATIO = 40.0, 0.02, 0.5
_MU, _SOFT, _RADIUS = 0.1, 1.0, 0.05
_SLOW = 1.2e-2  # rate of growth and spiral [1/s]: against some 100 rad/s
_JEFFCOTT = f"""
gravity = 0.0
[material]
young = 2.1e11
density = 1e-3
[shaft]
nodes = [0.0, 0.2, 0.5, 0.75, 1.0]
diameters = [0.03, 0.03, 0.03, 0.03]
[[support]]
node = 1
stiffness = 1e9
damping = 0.0
[[support]]
node = 5
stiffness = 1e9
damping = 0.0
[[point_mass]]
node = 3
mass = {_MASS}
[[unbalance]]
node = 3
amount = {_MASS * 1e-6}
"""
_DAMPER = """
[[linear_bearing]]
node = 3
kxx = 0.0
kyy = 0.0
cxx = {c}
cyy = {c}
"""
_BRUSH = f"""
[[heated_contact]]
node = 3
journal_radius = {_RADIUS}
clearance = 1e-10
mu = {_MU}
k = {_SOFT}
c = 0.0
bow_per_heat = {{p}}
bow_decay = {{q}}
"""


def _natural(text):
    """The lowest natural frequency of a machine [rad/s]."""
    return float(modes(parse_rotor(text), 0.0, count=1).eigenvalues[0].imag)


def _jeffcott(s, q, ratio=_RATIO):
    """A Jeffcott rotor and the speed s times its natural frequency, with a brush so soft that it
    does nothing but heat: by its deflection r times mu k R Omega."""
    natural = abs(_natural(_JEFFCOTT))
    speed = s * natural
    heat = _MU * _SOFT * _RADIUS * speed
    damper = _DAMPER.format(c=2.0 * _DAMPING * _MASS * natural)
    return _JEFFCOTT + damper + _BRUSH.format(p=ratio * q / heat, q=q), speed


def _rate(text, speed, lasting, **settings):
    """The rate of growth and spiral of a bow [1/s], c exp(rate t) + rest, at three even times."""
    sim = Simulation(parse_rotor(text), choose(**settings), speed=speed, warn=lambda _: None)
    bows = []
    for i in range(3):
        sim.advance((i + 1) * lasting, speed)
        bows.append(bow(sim))
    return cmath.log((bows[2] - bows[1]) / (bows[1] - bows[0])) / lasting


# Reference B5: growth and spiral over q, of p/q = 0.5 and a damping of 0.02
SPIRALS = {
    0.8: complex(0.3780, -0.1225),
    0.95: complex(3.4520, -1.7351),
    1.05: complex(-5.1768, -1.7115),
    1.2: complex(-2.1230, -0.1225),
}


@pytest.mark.parametrize(
    "s", [1.05, *(pytest.param(s, marks=pytest.mark.slow) for s in (0.8, 0.95, 1.2))]
)
def test_a_bow_grows_and_turns_as_kellenbergers_closed_form(s):
    """A = 1 / (1 - s^2 + 2 i z s), rate = q (A / 2 - 1), for a bow that is slow."""
    expected = SPIRALS[s]
    q = _SLOW / abs(expected)
    text, speed = _jeffcott(s, q)
    rate = _rate(text, speed, 0.5 / _SLOW) / q
    assert rate.real == pytest.approx(expected.real, rel=1e-2)
    assert rate.imag == pytest.approx(expected.imag, rel=1e-2)


_DAMPED = "cxx = 2e3\ncyy = 2e3\n"
_SEAT = f"[[linear_bearing]]\nnode = {{}}\nkxx = 3e6\nkyy = 3e6\n{_DAMPED}"
_FLEXIBLE = f"""
gravity = 0.0
[material]
young = 2.1e11
density = 7850.0
[shaft]
nodes = [0.0, 0.1, 0.3, 0.45, 0.6]
diameters = [0.03, 0.04, 0.03, 0.025]
eta_v = 1e-5
rotating_damping = true
[[disc]]
node = 3
diameter = 0.25
width = 0.03
e = 1e-7
{_SEAT.format(1)}
{_SEAT.format(5)}
[[heated_contact]]
node = 4
journal_radius = 0.05
clearance = 1e-11
mu = 0.2
k = 1e4
c = 0.0
bow_per_heat = 2e-6
bow_decay = 0.1
"""


def _eigenvalue(text, speed):
    """The slow root [1/s] of shaft and bow together, seen from the shaft, by dense matrices."""
    s = assemble(parse_rotor(text))
    n = len(s.M)
    M, C, K, G, K_shaft = (
        to_dense(band).astype(complex) for band in (s.M, s.C, s.K, s.G, s.K_shaft)
    )
    K += -1j * 1e-5 * speed * K_shaft
    for end in (0, n - 2):
        K[end, end] += 3e6
        C[end, end] += 2e3
    ring = 6
    K[ring, ring] += 1e4 * (1.0 + 0.2j)
    D = C - 1j * speed * G
    A = np.zeros((2 * n + 1, 2 * n + 1), complex)
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n] = -np.linalg.solve(M, K + 1j * speed * D - speed**2 * M)
    A[n : 2 * n, n : 2 * n] = -np.linalg.solve(M, D + 2j * speed * M)
    A[n : 2 * n, -1] = np.linalg.solve(M, s.bow_forces[0])
    A[-1, ring], A[-1, -1] = 2e-6 * 0.2 * 1e4 * 0.05 * speed, -0.1
    roots = np.linalg.eigvals(A)
    return roots[np.argmin(abs(roots))]


@pytest.mark.parametrize("share", [0.9, pytest.param(1.1, marks=pytest.mark.slow)])
def test_a_flexible_shaft_grows_it_as_the_eigenvalues_of_shaft_and_bow_say(share):
    """Masses, gyroscopics, bearings, damping that turns and the ring's own friction included."""
    speed = share * abs(_natural(_FLEXIBLE))
    expected = _eigenvalue(_FLEXIBLE, speed)
    assert (expected.real > 0.0) == (share < 1.0)
    rate = _rate(_FLEXIBLE, speed, 0.7 / abs(expected), tolerance=1e-4)
    assert rate == pytest.approx(expected, rel=1e-3)


def test_a_step_in_stages_grows_it_alike():
    expected = SPIRALS[0.95]
    q = _SLOW / abs(expected)
    text, speed = _jeffcott(0.95, q)
    rate = _rate(text, speed, 0.5 / _SLOW, method="radau5") / q
    assert rate == pytest.approx(expected, rel=1e-2)


@pytest.mark.parametrize("hours", [0.2, pytest.param(2.0, marks=pytest.mark.slow)])
def test_a_bow_that_is_no_longer_heated_decays_over_hours(hours):
    """A clearance out of reach, a decay over thousands of revolutions: exp(-q t), not a digit of it
    lost in all the steps."""
    q = 1e-4
    text, _ = _jeffcott(0.8, q)
    sim = run(text.replace("clearance = 1e-10", "clearance = 1.0"), 0.0, 10.0)
    sim.motion.internal_state[1:3] = 1e-5, -2e-5
    sim.advance(1.0, 10.0)
    sim.advance(hours * 3600.0, 10.0)
    expected = complex(1e-5, -2e-5) * math.exp(-q * hours * 3600.0)
    assert sim.read("solver.steps") > 5e4 * hours
    assert bow(sim) == pytest.approx(expected, rel=1e-8)
