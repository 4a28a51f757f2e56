"""Where a branch may begin: what the machine comes to by itself, and whether it stays there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from ..message_templates import Message
from ..settings import choose
from ..simulation import EquilibriumError, Simulation, StepFailure
from ..step.laws import relative
from .balance import Orbit, Problem
from .fourier import amplitudes, basis, projection
from .linear_structure import Condensed
from .problem import Machines, Task

_TURNS = (30, 200)
_HARMONICS = 256  # of what is recorded
_RADII, _PHASES = (1.1, 1.5, 3.0), (0.0, -0.5 * math.pi, -0.9 * math.pi)  # [clearances], [rad]
_TOLERANCE, _OF_GUESSES = 1e-6, 1e-4  # of runs: whether they stay; where they lead
_STAYS = 1e-2  # of an orbit: how far a run that stays on it may be


class Stay(NamedTuple):
    """Of an orbit taken into time: turns that were run, how far the machine is from it at the end,
    as a share of the orbit's size, and whether that is little."""

    turns: int
    distance: float
    stays: bool


def guesses(
    rotor: Rotor, task: Task, machines: Machines, value: float, is_seed: bool, notes: list[Message]
) -> Iterator[Orbit]:
    """Orbits to start from at a value of the parameter: that of open contacts, then what the
    machine comes to in time from rest; at a seed also circles beyond the clearances, and what the
    machine comes to from them. notes: takes why there is no run in time."""
    problem = task.problem(
        machines, value, max(task.accuracy.least, 3) * task.turns, turns=task.turns
    )
    machine, loads = machines(value), task.loads
    speed, H = task.speed_at(value), max(problem.H, _HARMONICS)
    changed = task.rotor_at(rotor, value)
    still = problem.split(np.zeros(problem.size), value)
    yield still
    circles = list(_circles(problem, still)) if is_seed else []
    yield from circles
    try:
        for turns in _TURNS:
            yield time_seed(changed, machine, speed, task.turns, loads, H, turns)
        for circle in circles:
            parts = problem.harmonics(value, circle.omega)
            motion = machine.expanded(parts, amplitudes(circle.b))
            begin = circle, motion
            yield time_seed(changed, machine, speed, task.turns, loads, H, _TURNS[0], begin)
    except (StepFailure, EquilibriumError) as error:
        notes.append(Message(str(error), "no-motion"))


def _circles(problem: Problem, still: Orbit) -> Iterator[Orbit]:
    """Forward circles of all interfaces at the speed, beyond their clearances, in several phases:
    what a wall presses back from all around."""
    turn = 2 * problem.turns
    for radius in _RADII:
        for phase in _PHASES:
            d = (
                problem.lengths
                * radius
                * np.exp(1j * phase)
                * np.tile([1.0, -1.0j], problem.d // 2)
            )
            b = still.b.copy()
            at = problem.machine_at(still.parameter)
            b[turn - 1], b[turn] = at.b_of(d.real), at.b_of(-d.imag)
            yield still._replace(b=b)


def time_seed(
    rotor: Rotor,
    machine: Condensed,
    speed: float,
    turns: int,
    loads: np.ndarray | None,
    H: int,
    settle: int,
    begin: tuple[Orbit, np.ndarray] | None = None,
) -> Orbit:
    """What the machine does after some turns from rest at a speed [rad/s], or from a motion
    `begin`, as an orbit of `turns` revolutions with H harmonics. Raises `StepFailure` where it does
    nothing."""
    run = _run(rotor, speed, loads, _OF_GUESSES)
    if begin is not None:
        _set(run, machine, *begin)
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
    run = _run(rotor, orbit.speed, loads, _TOLERANCE)
    _set(run, machine, orbit, motion)
    start = run.motion.q.copy()
    size = float(np.abs(motion[1:, : 2 * (len(start) - 1)]).sum(axis=0)[::2].max())
    period = 2 * math.pi / orbit.omega
    count = max(1, turns // orbit.turns)
    run.advance(count * period, orbit.speed)
    distance = float(np.abs(run.motion.q - start)[::2].max()) / size
    return Stay(count * orbit.turns, distance, distance < _STAYS)


def _run(rotor: Rotor, speed: float, loads: np.ndarray | None, tolerance: float) -> Simulation:
    return Simulation(
        rotor, choose(tolerance=tolerance), speed=speed, loads=loads, warn=lambda _: None
    )


def _set(run: Simulation, machine: Condensed, orbit: Orbit, motion: np.ndarray) -> None:
    """Put a run at the beginning of an orbit."""
    state = run.motion
    factor = 1j * orbit.omega * np.arange(len(motion))[:, None]
    for target, power in ((state.q, 0), (state.v, 1), (state.a, 2), (state.v_dot, 2)):
        plane = (factor**power * motion).sum(axis=0).real
        target[:] = plane[::2] + 1j * plane[1::2]
    series = amplitudes(orbit.own).real.sum(axis=0)
    state.internal_state[machine.state_places] = series
