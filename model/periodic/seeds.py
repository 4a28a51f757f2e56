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
from .fourier import amplitudes, basis, projection

_TURNS = 30
_TOLERANCE = 1e-6
_STAYS = 1e-2  # of an orbit: how far a run that stays on it may be


class Stay(NamedTuple):
    """Of an orbit taken into time: turns that were run, how far the machine is from it at the end,
    as a share of the orbit's size, and whether that is little."""

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
    own = np.empty((n, len(run.motion.internal_state)))
    interfaces = [
        i for i, is_in in zip(run.structure.interfaces, machine.is_in, strict=True) if is_in
    ]
    for t in range(n):
        run.advance(start + period * t / n, speed)
        d[t] = [relative(i, run.motion.q) for i in interfaces]
        own[t] = run.motion.internal_state
    angles = 2 * math.pi * np.arange(n) / n + phase / turns
    value, _ = basis(min(H, n // 3), angles)
    plane = np.empty((n, 2 * machine.laws.count))
    plane[:, ::2], plane[:, 1::2] = d.real, d.imag
    P = projection(value)
    return Orbit(P @ machine.b_of(plane), P @ own, speed / turns, turns, speed, speed)


def stay(
    rotor: Rotor,
    machine: Condensed,
    orbit: Orbit,
    motion: np.ndarray,
    loads: np.ndarray | None,
    turns: int,
) -> Stay:
    """Start the integrator on an orbit, and see whether it is there after so many turns; motion:
    complex amplitudes of all dofs, x and y in turn, shape (H + 1, 2 size). Raises `StepFailure`."""
    run = Simulation(
        rotor, choose(tolerance=_TOLERANCE), speed=orbit.speed, loads=loads, warn=lambda _: None
    )
    state = run.motion
    factor = 1j * orbit.omega * np.arange(len(motion))[:, None]
    for target, power in ((state.q, 0), (state.v, 1), (state.a, 2), (state.v_dot, 2)):
        plane = (factor**power * motion).sum(axis=0).real
        target[:] = plane[::2] + 1j * plane[1::2]
    series = amplitudes(orbit.own).real.sum(axis=0)
    state.internal_state[machine.state_places] = series
    start = state.q.copy()
    size = float(np.abs(motion[1:, : 2 * (len(start) - 1)]).sum(axis=0)[::2].max())
    period = 2 * math.pi / orbit.omega
    count = max(1, turns // orbit.turns)
    run.advance(count * period, orbit.speed)
    distance = float(np.abs(run.motion.q - start)[::2].max()) / size
    return Stay(count * orbit.turns, distance, distance < _STAYS)
