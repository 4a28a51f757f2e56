"""Floquet multipliers against a fine integration of the linearized machine by other means."""

import math

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.periodic.condensed import Condensed
from rotor_fmu.model.periodic.fourier import basis

import rotor_fmu as rf

from .machines import OMEGA, jeffcott

_GAUSS = np.array([0.5 - math.sqrt(3) / 6, 0.5 + math.sqrt(3) / 6])


def shooting(machine, orbit, steps=800):
    """Multipliers by Magnus' expansion of order 4: exponentials of the whole machine's matrix."""
    M, D, K = machine.matrices(orbit.speed)
    N, b = machine.size, machine.b
    h = 2 * math.pi / steps
    angles = (h * (np.arange(steps)[:, None] + _GAUSS)).ravel()
    value, slope = basis(orbit.H, angles)
    along = machine.laws.tangents(
        value @ orbit.b, orbit.omega * slope @ orbit.b, value @ orbit.own, np.ones(0), orbit.speed
    )
    inverse = np.linalg.inv(M)
    passed = np.eye(2 * N)
    h /= orbit.omega
    for i in range(steps):
        pair = []
        for j in (2 * i, 2 * i + 1):
            stiff, damping = K.copy(), D.copy()
            for c in range(b // 2):
                at = slice(2 * c, 2 * c + 2)
                stiff[at, at] -= along.by_d[j, c]
                damping[at, at] -= along.by_v[j, c]
            pair.append(
                np.block([[np.zeros((N, N)), np.eye(N)], [-inverse @ stiff, -inverse @ damping]])
            )
        first, second = pair
        middle = 0.5 * h * (first + second)
        middle -= math.sqrt(3) / 12 * h * h * (first @ second - second @ first)
        passed = scipy.linalg.expm(middle) @ passed
    return np.linalg.eigvals(passed)


def test_multipliers_are_those_of_a_fine_integration():
    """At 20 points of the curve, of both signs of stability."""
    machine = jeffcott()
    result = rf.response(machine, speed=(60.0, 240.0))
    linear = Condensed(machine.rotor)
    points = result.points[:: len(result.points) // 20][:20]
    assert len(points) == 20
    assert {p.is_stable for p in points} == {True, False}
    for point in points:
        sizes = -np.sort(-np.abs(shooting(linear, point.orbit)))
        seen = np.abs(point.multipliers)
        assert seen[:4] == pytest.approx(sizes[:4], rel=1e-4), point.value / OMEGA
