"""Where a branch may begin: what the machine comes to by itself, and whether it stays there."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from ..settings import choose
from ..simulation import Simulation
from ..step.laws import relative
from .balance import Orbit
from .condensed import Condensed
from .fourier import basis, projection

_TURNS = 30
_TOLERANCE = 1e-6


class Stay(NamedTuple):
    """Of an orbit taken into time: turns that were run, how far the machine went from it at the
    end, and at most over the last period, as a share of the orbit's largest displacement."""

    turns: int
    distance: float
    stays: bool


def time_seed(
    rotor: Rotor,
    machine: Condensed,
    speed: float,
    turns: int,
    loads: np.ndarray | None,
    H: int,
    settle: int = _TURNS,
) -> Orbit:
    """What the machine does after some turns from rest at a speed [rad/s], as an orbit of `turns`
    revolutions with H harmonics. Raises `StepFailure` where it does nothing."""
    run = Simulation(
        rotor, choose(tolerance=_TOLERANCE), speed=speed, loads=loads, warn=lambda _: None
    )
    run.advance(2 * math.pi / speed * settle * turns, speed)
    return _recorded(run, machine, speed, turns, H)


def _recorded(run: Simulation, machine: Condensed, speed: float, turns: int, H: int) -> Orbit:
    """The next period of a run."""
    n = 4 * H
    period = 2 * math.pi * turns / speed
    start, phase = run.time, math.remainder(speed * run.time, 2 * math.pi)
    d = np.empty((n, machine.laws.count), complex)
    own = np.empty((n, len(run.motion.own)))
    interfaces = [
        i for i, is_in in zip(run.structure.interfaces, machine.is_in, strict=True) if is_in
    ]
    for t in range(n):
        run.advance(start + period * t / n, speed)
        d[t] = [relative(i, run.motion.q) for i in interfaces]
        own[t] = run.motion.own
    angles = 2 * math.pi * np.arange(n) / n + phase / turns
    value, _ = basis(min(H, n // 3), angles)
    plane = np.empty((n, 2 * machine.laws.count))
    plane[:, ::2], plane[:, 1::2] = d.real, d.imag
    P = projection(value)
    return Orbit(P @ machine.b_of(plane), P @ own, speed / turns, turns, speed, speed)
