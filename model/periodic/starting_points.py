"""Starting points of branches by time integration, and whether a motion persists in time."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ..linear.real_matrices import in_plane, to_complex
from ..machine.rotor import Rotor
from ..parts.base_and_start import Start
from ..settings import choose
from ..simulation import EquilibriumError, Simulation, StepFailure
from .balance import HarmonicBalance, Orbit
from .fourier import amplitudes, basis, coefficients, projection
from .linear_structure import CondensedMachine
from .lyapunov import sample
from .problem import Machines, Task
from .self_excited import rest_position

_PERIODS = (30, 200)  # until a run in time has settled
_HARMONICS = 256  # harmonics taken of the recorded motion
_RADII, _PHASES = (1.1, 1.5, 3.0), (0.0, -0.5 * math.pi, -0.9 * math.pi)  # [clearances], [rad]
_TOLERANCE, _TOLERANCE_OF_GUESSES = 1e-6, 1e-4  # of runs that test persistence; that search
# of a revolution: the first, shortest and longest step of a run, whose error sets the others
_FIRST_STEP, _SHORTEST_STEP, _LONGEST_STEP = 1e-4, 1e-8, 0.05
_NEAR = 1e-2  # share of an orbit's size within which a run counts as staying on it


class Persistence(NamedTuple):
    """The result of integrating from an orbit: the turns that were run, the distance from the orbit
    at the end relative to its size, and whether the motion stays on the orbit."""

    turns: int
    distance: float
    stays: bool


def guesses(
    rotor: Rotor, task: Task, machines: Machines, value: float, is_seed: bool, failures: list[str]
) -> Iterator[Orbit]:
    """Yield orbits to start from at a value of the parameter: its rest if films have pads that tilt
    or rings that float, that with open contacts, then those that the machine reaches in time from
    rest; at a seed also circles beyond the clearances, and what the machine reaches from them; last
    its rest, near which it may move unstably; of a machine without nonlinear interfaces its motion
    alone. failures: receives why time integration failed."""
    problem = task.coarse_problem(machines, value)
    machine, loads = machines(value), task.loads
    speed, H = task.speed_at(value), max(problem.H, _HARMONICS)
    changed = task.rotor_at(rotor, value)
    open_contacts = problem.split(np.zeros(problem.size), value)
    at_rest = rest_position(problem, value) if machine.laws.has_moving_films else None
    if at_rest is not None:
        yield at_rest
    if machine.laws.count == 0:  # then it is the only motion, whose mean may be many times its size
        linear = problem.dynamic_stiffness(value, open_contacts.omega)
        b = np.linalg.solve(linear.S, linear.force[..., None])[..., 0]
        yield open_contacts._replace(b=coefficients(b))
        return
    yield open_contacts
    circles = list(_circles(problem, open_contacts)) if is_seed else []
    yield from circles

    def settled(periods: int, *begin: Any) -> Orbit:
        """Return the motion after some periods from rest, or from an orbit and its motion."""
        run = _simulation(
            _in_motion(changed) if begin else changed, speed, loads, _TOLERANCE_OF_GUESSES
        )
        if begin:
            _set_motion(run, machine, *begin)
        run.advance(2 * math.pi / abs(speed) * periods * task.turns, speed)
        return _recorded_period(run, machine, speed, task.turns, H)

    try:
        for periods in _PERIODS:
            yield settled(periods)
        for circle in circles:
            parts = problem.dynamic_stiffness(value, circle.omega)
            yield settled(_PERIODS[0], circle, machine.expanded(parts, amplitudes(circle.b)))
    except (StepFailure, EquilibriumError) as error:
        failures.append(str(error))
    if not machine.laws.has_moving_films and (at_rest := rest_position(problem, value)):
        yield at_rest


def _circles(problem: HarmonicBalance, open_contacts: Orbit) -> Iterator[Orbit]:
    """Yield synchronous forward circles of all interfaces beyond their clearances, in several
    phases, on which a wall pushes back all around."""
    turn, sense = 2 * problem.turns, math.copysign(1.0, open_contacts.speed)
    for radius in _RADII:
        for phase in _PHASES:
            size = problem.length_scale * radius * np.exp(1j * phase)
            d = size * np.tile([1.0, -1.0j * sense], problem.d // 2)
            b = open_contacts.b.copy()
            at = problem.machine_at(open_contacts.parameter)
            b[turn - 1], b[turn] = at.b_of_displacements(d.real), at.b_of_displacements(-d.imag)
            yield open_contacts._replace(b=b)


def _recorded_period(
    run: Simulation, machine: CondensedMachine, speed: float, turns: int, H: int
) -> Orbit:
    """Return the next period of a run as an orbit. Of one that does not end where it begins, since
    the run has not settled, the drift is taken out, whose jump has all harmonics."""
    n, frequency = 4 * H, abs(speed)
    period = 2 * math.pi * turns / frequency
    start, phase = run.time, math.remainder(frequency * run.time, 2 * math.pi)
    d = np.empty((n + 1, machine.laws.count), complex)
    states = np.empty((n + 1, len(run.motion.internal_state)))
    for t in range(n + 1):
        run.advance(start + period * t / n, speed)
        _, displacements, _, states[t] = sample(run)
        d[t] = displacements[machine.is_nonlinear]
    shares = np.arange(n) / n
    angles = 2 * math.pi * shares + phase / turns
    drifted = shares[:, None] - 0.5
    value, _ = basis(min(H, n // 3), angles)
    P = projection(value)
    d, states = (each[:-1] - drifted * (each[-1] - each[0]) for each in (d, states))
    b = P @ machine.b_of_displacements(in_plane(d))
    return Orbit(b, P @ states, frequency / turns, turns, speed, speed)


def integrate_from_orbit(
    rotor: Rotor,
    machine: CondensedMachine,
    orbit: Orbit,
    motion: np.ndarray,
    loads: np.ndarray | None,
    turns: int,
) -> Persistence:
    """Start the integrator on an orbit, and return whether it is still there after so many turns;
    motion: complex amplitudes of all dofs, x and y in turn, shape (H + 1, 2 size). Raises
    `StepFailure`."""
    run = _simulation(_in_motion(rotor), orbit.speed, loads, _TOLERANCE)
    _set_motion(run, machine, orbit, motion)
    start = run.motion.q.copy()
    size = float(np.abs(motion[1:, : 2 * (len(start) - 1)]).sum(axis=0)[::2].max())
    period = 2 * math.pi / orbit.omega
    count = max(1, turns // orbit.turns)
    run.advance(count * period, orbit.speed)
    distance = float(np.abs(run.motion.q - start)[::2].max()) / size
    return Persistence(count * orbit.turns, distance, distance < _NEAR)


def _simulation(
    rotor: Rotor, speed: float, loads: np.ndarray | None, tolerance: float
) -> Simulation:
    turn = 2 * math.pi / abs(speed)
    first, least, most = _FIRST_STEP * turn, _SHORTEST_STEP * turn, _LONGEST_STEP * turn
    settings = choose(tolerance=tolerance, h=first, h_min=least, h_max=most)
    return Simulation(rotor, settings, speed=speed, loads=loads, warn=lambda _: None)


def _in_motion(rotor: Rotor) -> Rotor:
    """Return a machine whose motion is set after its start, which then needs no rest: a damper
    without a spring carries its journal by whirling alone."""
    return rotor.with_parts(Start, Start())


def _set_motion(
    run: Simulation, machine: CondensedMachine, orbit: Orbit, motion: np.ndarray
) -> None:
    """Put a run at the beginning of an orbit."""
    state = run.motion
    factor = 1j * orbit.omega * np.arange(len(motion))[:, None]
    for target, power in ((state.q, 0), (state.v, 1), (state.a, 2), (state.v_dot, 2)):
        target[:] = to_complex((factor**power * motion).sum(axis=0).real)
    series = amplitudes(orbit.states).real.sum(axis=0)
    state.internal_state[machine.state_places] = series
