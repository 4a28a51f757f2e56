"""Floquet multipliers against a fine integration of the linearized machine by other means."""

import math

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.periodic.fourier import basis
from rotor_fmu.model.periodic.linear_structure import CondensedMachine

import rotor_fmu as rf

from .machines import CLEARANCE, FAINT, FAINT_RUB, OMEGA, jeffcott

_GAUSS = np.array([0.5 - math.sqrt(3) / 6, 0.5 + math.sqrt(3) / 6])


def shooting(machine, orbit, steps=256):
    """Multipliers by Magnus' expansion of order 4: exponentials of the whole machine's matrix."""
    M, D, K = machine.matrices(orbit.speed)
    N, b = machine.size, machine.b
    h = 2 * math.pi / steps
    angles = (h * (np.arange(steps)[:, None] + _GAUSS)).ravel()
    value, slope = basis(orbit.H, angles)
    along = machine.laws.tangents(
        value @ orbit.b,
        orbit.omega * slope @ orbit.b,
        value @ orbit.states,
        np.ones(0),
        orbit.speed,
    )
    h /= orbit.omega
    stiff, damping = (np.repeat(matrix[None], 2 * steps, axis=0) for matrix in (K, D))
    for c in range(b // 2):
        at = slice(2 * c, 2 * c + 2)
        stiff[:, at, at] -= along.by_d[:, c]
        damping[:, at, at] -= along.by_v[:, c]
    of_state = np.zeros((2 * steps, 2 * N, 2 * N))
    of_state[:, :N, N:] = np.eye(N)
    of_state[:, N:, :N] = -np.linalg.solve(M, stiff)
    of_state[:, N:, N:] = -np.linalg.solve(M, damping)
    first, second = of_state[::2], of_state[1::2]
    middle = 0.5 * h * (first + second)
    middle -= math.sqrt(3) / 12 * h * h * (first @ second - second @ first)
    passed = np.eye(2 * N)
    for each in scipy.linalg.expm(middle):
        passed = each @ passed
    return np.linalg.eigvals(passed)


def test_multipliers_are_those_of_a_fine_integration(curve):
    """At 20 points of the curve, of both signs of stability."""
    linear = CondensedMachine(jeffcott().rotor)
    points = curve.points[:: len(curve.points) // 20][:20]
    assert len(points) == 20
    assert {p.is_stable for p in points} == {True, False}
    for point in points:
        sizes = -np.sort(-np.abs(shooting(linear, point.orbit)))
        seen = np.abs(point.multipliers)
        assert seen[:4] == pytest.approx(sizes[:4], rel=1e-4), point.value / OMEGA


def hill(machine, orbit, H=20):
    """Multipliers by Hill's method: the eigenvalues of the harmonics of the linearized machine,
    those whose eigenvectors are centred about the mean (Moore 2005)."""
    M, D, K = machine.matrices(orbit.speed)
    N, n = machine.size, 8 * H
    angles = 2 * math.pi * np.arange(n) / n
    value, slope = basis(orbit.H, angles)
    along = machine.laws.tangents(
        value @ orbit.b,
        orbit.omega * slope @ orbit.b,
        value @ orbit.states,
        np.ones(0),
        orbit.speed,
    )
    of_d, of_v = (
        np.fft.fft(machine.tangents_in_b(by), axis=0) / n for by in (along.by_d, along.by_v)
    )
    k = np.arange(-H, H + 1)
    size = N * len(k)
    stiff, damping = np.zeros((2, size, size), complex)
    for i, row in enumerate(k):
        for j, column in enumerate(k):
            at = slice(i * N, (i + 1) * N), slice(j * N, (j + 1) * N)
            d, v = np.zeros((2, N, N), complex)
            d[: machine.b, : machine.b] = -of_d[row - column]
            v[: machine.b, : machine.b] = -of_v[row - column]
            if row == column:
                d, v = d + K, v + D
            w = 1j * column * orbit.omega
            stiff[at] = d + w * v + (w * w * M if row == column else 0)
            damping[at] = v + (2 * w * M if row == column else 0)
    inverse = np.kron(np.eye(len(k)), np.linalg.inv(M))
    state = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-inverse @ stiff, -inverse @ damping]]
    )
    exponents, shapes = np.linalg.eig(state)
    weights = (np.abs(shapes[:size]) ** 2).reshape(len(k), N, -1).sum(axis=1)
    centre = np.abs((k[:, None] * weights).sum(axis=0) / weights.sum(axis=0))
    chosen = exponents[np.argsort(centre)[: 2 * N]]
    return np.exp(chosen * 2 * math.pi / orbit.omega)


def test_multipliers_are_those_of_hills_method(curve):
    """Of the rub, whose tangents turn with twice the speed."""
    linear = CondensedMachine(jeffcott().rotor)
    rubbing = [p for p in curve.points if curve.amplitude(p, "disc") > 1.01e-3]
    for point in rubbing[:: len(rubbing) // 5]:
        sizes = -np.sort(-np.abs(hill(linear, point.orbit, 6)))
        assert np.abs(point.multipliers[:4]) == pytest.approx(sizes[:4], rel=1e-4)


def test_a_motion_far_slower_than_all_modes_is_stable():
    """Which it would have none of, and moves as far as the unbalance bends the support."""
    result = rf.response(FAINT_RUB, speed=(0.001, 0.0011), step=3.0)
    assert all(point.is_stable for point in result.points)
    still = FAINT * CLEARANCE * (0.001 / OMEGA) ** 2
    assert result.amplitude(result.points[0], "disc") == pytest.approx(still, rel=1e-6)
