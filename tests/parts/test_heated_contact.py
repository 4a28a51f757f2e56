"""Bows of the shaft by the heat of a rub: growth, spiral, ledger, and what they must be equal to."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

_MASS, _DAMPING, _RATIO = 40.0, 0.02, 0.5
_MU, _SOFT, _RADIUS = 0.1, 1.0, 0.05
_SLOW = 4e-3  # rate of growth and spiral [1/s]: against some 100 rad/s
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


def _bow(sim):
    return cmath.rect(sim.read("heated_contact[1].bow"), sim.read("heated_contact[1].bow_angle"))


def _rate(text, speed, lasting, **settings):
    """The rate of growth and spiral of a bow [1/s]: b(t) = c (exp(rate t) - 1), from 0 on."""
    sim = Simulation(parse_rotor(text), choose(**settings), speed=speed, warn=lambda _: None)
    sim.advance(lasting, speed)
    first = _bow(sim)
    sim.advance(2.0 * lasting, speed)
    return cmath.log(_bow(sim) / first - 1.0) / lasting


# Reference B5: growth and spiral over q, of p/q = 0.5 and a damping of 0.02
SPIRALS = {
    0.8: complex(0.3780, -0.1225),
    0.95: complex(3.4520, -1.7351),
    1.05: complex(-5.1768, -1.7115),
    1.2: complex(-2.1230, -0.1225),
}


@pytest.mark.parametrize(("s", "expected"), SPIRALS.items())
def test_a_bow_grows_and_turns_as_kellenbergers_closed_form(s, expected):
    """A = 1 / (1 - s^2 + 2 i z s), rate = q (A / 2 - 1), for a bow that is slow."""
    q = _SLOW / abs(expected)
    text, speed = _jeffcott(s, q)
    rate = _rate(text, speed, 1.0 / _SLOW) / q
    assert rate.real == pytest.approx(expected.real, rel=1e-2)
    assert rate.imag == pytest.approx(expected.imag, rel=1e-2)
