"""Where whirl by itself may begin: circles against the spin that roll along a wall.

A journal of radius R that rolls without sliding whirls backward with omega = R Omega / r on a
circle of radius r; of such circles along one wall, those are tried that the linear part nearly
balances.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .balance import Orbit, Problem

_RADII = 1.0 + np.geomspace(1e-3, 1e7, 150)  # in clearances
_TRIED = 8


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
