"""Where whirl by itself may begin: circles against the spin that roll along a wall, and modes that
grow from rest.

A journal of radius R that rolls without sliding whirls backward with omega = R Omega / r on a
circle of radius r; of such circles along one wall, those are tried that the linear part nearly
balances. Past a threshold, of oil films or of damping that turns with the rotor, a mode about the
position of rest grows: whirls along it of several sizes are tried.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from . import arclength
from .arclength import Lost
from .balance import Orbit, Problem
from .floquet import Paces, by_y, modes_of

_RADII = 1.0 + np.geomspace(1e-3, 1e7, 150)  # in clearances
_TRIED = 8
_LOWERED = (0.0, 0.1, 0.3, 0.6, 0.9)  # in clearances, where rest is looked for
_SIZES = (0.7, 0.5, 0.9, 0.3, 0.1)  # of whirls, in clearances


class _Rest:
    """The equations of a machine at rest, without its unbalance, in the mean displacements of the
    interfaces and the laws' own states."""

    tolerance, damped_beyond = arclength.TOLERANCE, 0.0

    def __init__(self, problem: Problem, value: float) -> None:
        self.machine, self.speed = problem.machine_at(value), problem.speed_at(value)
        self.scale = np.append(np.full(problem.b, problem.lengths), problem.own_scale)
        self.b, self._own_scale = problem.b, problem.own_scale
        parts = self.machine.harmonics(self.speed, self.speed, 0, 0)
        self.S, self.force = parts.S[0].real, parts.force[0].real
        sizes = np.maximum(np.abs(self.S).max(axis=1, initial=0.0), 1e-300) * problem.lengths
        self._sizes = np.append(sizes, problem.own_scale * abs(self.speed))

    def tangents(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces and rates, and their derivatives by displacements, velocities and states."""
        y = x * self.scale
        d = (self.machine.B @ y[: self.b])[None]
        laws = self.machine.laws.tangents(d, 0 * d, y[None, self.b :], self._own_scale, self.speed)
        given = np.append(laws.force[0] @ self.machine.B, laws.rates[0])
        return given, by_y(self.machine, laws)[0]

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """What the equations lack."""
        return self.linearized(x, value)[0]

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Residual and its derivative."""
        given, by = self.tangents(x)
        b = self.b
        lack = -given
        lack[:b] += self.S @ (x[:b] * self.scale[:b]) - self.force
        jacobian = -np.hstack([by[:, :b], by[:, 2 * b :]])
        jacobian[:b, :b] += self.S
        return lack / self._sizes, jacobian * self.scale / self._sizes[:, None]


def growing(problem: Problem, value: float) -> Iterator[Orbit]:
    """Guesses of whirls along the modes that grow from rest."""
    rest = _Rest(problem, value)
    machine, b = rest.machine, rest.b
    down = np.append(
        rest.force / max(np.abs(rest.force).max(initial=0.0), 1e-300), 0 * rest.scale[b:]
    )
    start = np.append(np.zeros(b), machine.laws.starts)
    for lowered in _LOWERED:
        try:
            x = arclength.solve(rest, start + lowered * down, value)
            break
        except Lost:
            continue
    else:
        return
    _, mean = rest.tangents(x)
    modes = modes_of(machine, Paces(rest.speed, abs(rest.speed), np.inf), mean)
    at_rest = x * rest.scale
    for i in np.flatnonzero((modes.roots.imag > 0) & (modes.roots.real > 0)):
        shape = np.append(modes.V[:b, i], modes.V[2 * b :, i])
        shape /= np.abs(shape[:b]).max() / problem.lengths
        for size in _SIZES:
            series = np.zeros((2 * problem.H + 1, len(shape)))
            # the larger a whirl, the more of the load it carries itself
            series[0] = np.append((1.0 - size) * at_rest[:b], at_rest[b:])
            series[1], series[2] = size * shape.real, -size * shape.imag
            omega = float(modes.roots[i].imag)
            yield Orbit(series[:, :b], series[:, b:], omega, 1, rest.speed, value)


def rolling(problem: Problem, value: float) -> Iterator[Orbit]:
    """Guesses of whirls that roll along the walls, the best balanced first."""
    machine = problem.machine_at(value)
    speed = problem.speed_at(value)
    tried: list[tuple[float, Orbit]] = []
    for j in np.flatnonzero(machine.laws.has_wall):
        journal = machine.laws.radius(int(j))
        for r in _RADII * machine.laws.length[j]:
            omega = journal * speed / r
            d = np.zeros(2 * machine.laws.count, complex)
            # x + i y = r exp(-i omega t)
            d[2 * j : 2 * j + 2] = r, 1j * r
            b = np.zeros((2 * problem.H + 1, problem.b))
            b[1], b[2] = machine.b_of(d.real), machine.b_of(-d.imag)
            own = np.zeros((2 * problem.H + 1, problem.s))
            own[0] = machine.laws.starts
            orbit = Orbit(b, own, float(omega), 1, speed, value)
            S = machine.harmonics(float(omega), speed, 1, 0).S[1]
            pull = (S @ (b[1] - 1j * b[2])) @ np.conj(machine.b_of(d))
            inward = -(machine.laws.normal(int(j), r) * r)
            size = abs(pull.real) + abs(inward)
            # half of |d|^2 = 2 r^2 is that of x and of y
            tried.append((abs(0.5 * pull.real - inward) / max(size, 1e-300), orbit))
    for _, orbit in sorted(tried, key=lambda pair: pair[0])[:_TRIED]:
        yield orbit
