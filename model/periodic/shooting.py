"""A periodic motion by shooting, where it has more harmonics than can be balanced: a journal that
leaves its wall and bounces on it.

The state X at the begin of the period is unknown; the machine is integrated over the period, and

    R(X, lambda) = X(T) - X

is to be 0. The structure, linear but for its interfaces' forces, steps in modes by Radau IIA, the
forces at the three points of a step solved for (`stepping`), constant loads and the unbalance
answered exactly; steps suit the motion (`mesh`). R's derivative is that of the steps themselves,
linearized (`floquet`), and its eigenvalues are those of the multipliers, less 1.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from . import mesh
from .arclength import Lost
from .balance import Orbit, Problem
from .entry_points import Lengths
from .floquet import (
    Modes,
    Paces,
    by_y,
    held,
    lengths,
    modes_of,
    path_of,
    real_amplitudes,
    through,
    weights,
)
from .fourier import amplitudes, series_of
from .linear_structure import Condensed, Harmonics
from .stepping import run

_HARMONICS = 256  # at least, of the orbit that is given
_OWN_SIDE = 1e-7  # of a step: how far before its end its last tangent is taken, beside a corner
_MOVED = 1e-4  # clearances by which a motion moves before its steps are chosen anew,
_FAR, _RENEWALS = 1e-2, 3  # for so many times after it has moved far
_SHORTENED = 5  # times that steps are shortened at most
_STEP = 1e-6  # of the parameter, as a share of its scale, for the derivative by it
_SHORTER = 3.0  # than by the mean square of all coordinates, a way along the curve counts
_SAME = 1e-5  # of the unknowns: so near the multipliers are those of the last iteration


class Linear(NamedTuple):
    """The machine but for its interfaces, at a value of the parameter: speed and frequency [rad/s],
    the interfaces' mean tangents, modes with these; the state by real amplitudes, and these by it;
    complex amplitudes of the modes that constant loads and the unbalance make, forward and backward
    turning."""

    speed: float
    omega: float
    mean: np.ndarray
    modes: Modes
    state: np.ndarray
    amplitudes: np.ndarray
    constant: np.ndarray
    turning: tuple[np.ndarray, np.ndarray]

    @property
    def at_begin(self) -> np.ndarray:
        """Complex amplitudes of the modes by the loads alone, at the begin of the period."""
        return self.constant + self.turning[0] + self.turning[1]

    def seen_by_loads(self, turns: int, shares: np.ndarray) -> np.ndarray:
        """What is seen by the loads alone at shares of the period."""
        turn = np.exp(2j * np.pi * turns * shares)[..., None]
        V, (forward, backward) = self.modes.V, self.turning
        return (V @ self.constant).real + (turn * (V @ forward + (V @ backward).conj())).real


class Flight(NamedTuple):
    """A period from a state x at a value of the parameter, by steps with these ends: displacements
    and velocities y of the interfaces at their points, shape (steps, 3, 2 b), the state at its end
    less that at its begin, and which steps were not solved, being too long."""

    x: np.ndarray
    value: float
    ends: np.ndarray
    y: np.ndarray
    lack: np.ndarray
    unsolved: np.ndarray


class Shooting:
    """The equations of a motion's state at the begin of its period, about an orbit.

    problem: the equations of harmonics of the same motions. Raises `Lost` for laws with states of
    their own.
    """

    is_autonomous = False
    tolerance = 1e-7  # below what its steps miss
    damped_beyond = 1e-3  # steps that are chosen anew change the equations a little

    def __init__(self, problem: Problem, orbit: Orbit) -> None:
        if problem.s:
            raise Lost([])
        self.series = problem.like(max(_HARMONICS, 4 * problem.H), at=orbit.parameter)
        self.machine_at, self.parameter = problem.machine_at, problem.parameter
        self.at, self.H, self.turns = orbit.parameter, self.series.H, problem.turns
        machine = self.machine_at(self.at)
        mass = np.sqrt(np.diag(machine.matrices(0.0).M))
        of_d = mass / (mass.max() * problem.lengths * math.sqrt(machine.size) * _SHORTER)
        self._weights = np.concatenate([of_d, of_d / problem.pace])
        self._linear: dict[float, Linear] = {}
        self._ends = mesh.even()
        for _ in range(_RENEWALS):
            self._y = self._of(machine, orbit)
            force, tangent = self._laws(self.at, self._ends, self._y)
            ends, self._ends = self._ends, mesh.fitted(machine, self._y, force, self._ends)
        self._ends = ends
        h = np.diff(self._ends)
        self._mean = np.einsum("t,i,tiao->ao", h, weights(), tangent)
        none = np.zeros(0)
        self._flight = Flight(none, self.at, self._ends, self._y, none, none)
        self._renewals = _RENEWALS
        self._known: list[tuple[tuple[Lengths, np.ndarray], float, np.ndarray]] = []
        self._last: tuple[np.ndarray, float, np.ndarray] | None = None

    def _of(self, machine: Condensed, orbit: Orbit) -> np.ndarray:
        """What the interfaces do on an orbit."""
        times = mesh.points(self._ends).ravel() * 2 * math.pi / orbit.omega
        d, v, _ = path_of(machine, orbit).at(times)
        y = np.hstack([machine.b_of(d), machine.b_of(v)])
        return y.reshape(-1, 3, y.shape[1])

    def _laws(self, value: float, ends: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Forces and tangents along a motion, at the end of a step those of its own side of a
        corner."""
        machine, b = self.machine_at(value), self.series.b
        h = np.diff(ends) * 2 * math.pi / self.series.omega_at(value)
        flat = y.copy()
        flat[:, 2, :b] -= _OWN_SIDE * h[:, None] * y[:, 2, b:]
        flat = flat.reshape(-1, 2 * b)
        d, v, none = flat[:, :b] @ machine.B.T, flat[:, b:] @ machine.B.T, np.zeros((len(flat), 0))
        laws = machine.laws.tangents(d, v, none, np.zeros(0), self.series.speed_at(value))
        tangent = by_y(machine, laws).reshape(*y.shape[:2], b, 2 * b)
        return (laws.force @ machine.B).reshape(*y.shape[:2], b), tangent

    def linear(self, value: float) -> Linear:
        """The machine but for its interfaces, at a value of the parameter."""
        if value not in self._linear:
            if len(self._linear) > 4:
                self._linear.clear()
            self._linear[value] = self._made(value)
        return self._linear[value]

    def _made(self, value: float) -> Linear:
        machine, speed = self.machine_at(value), self.series.speed_at(value)
        omega = self.series.omega_at(value)
        paces = Paces(speed, omega, math.inf)
        mean = held(machine, paces, self._mean)
        modes = modes_of(machine, paces, mean)
        T, _ = real_amplitudes(modes.roots)
        state = (modes.shapes @ T).real
        of_state, N = np.linalg.inv(state), machine.size
        pulls = np.zeros((2 * N, 2), complex)
        both = np.column_stack([machine.constant, 0.5 * speed**2 * machine.unbalance])
        pulls[N:] = np.linalg.solve(machine.matrices(speed).M, both)
        constant, forward = (T @ of_state @ pulls).T
        backward = T @ of_state @ pulls[:, 1].conj()
        turning = forward / (1j * speed - modes.roots), backward / (-1j * speed - modes.roots)
        alone = -constant / modes.roots
        return Linear(speed, omega, mean, modes, state, of_state, alone, turning)

    def _steps(self, value: float, ends: np.ndarray) -> tuple[Lengths, np.ndarray]:
        """What steps do at a value of the parameter, and what is seen by the loads alone."""
        for known, of_value, of_ends in self._known:
            if of_value == value and of_ends is ends:
                return known
        linear = self.linear(value)
        seen = linear.seen_by_loads(self.turns, mesh.points(ends))
        made = lengths(linear.modes, np.diff(ends) * 2 * math.pi / linear.omega), seen
        self._known = [(made, value, ends), *self._known[:3]]
        return made

    def _tried(self, x: np.ndarray, value: float, ends: np.ndarray) -> Flight:
        """A period from a state on; raises `Lost` where it ends nowhere."""
        linear, machine = self.linear(value), self.machine_at(value)
        _, inverse = real_amplitudes(linear.modes.roots)
        loads = (inverse @ linear.at_begin).real
        begin = linear.amplitudes @ (x / self._weights) - loads
        steps, seen = self._steps(value, ends)
        near = self._near(ends)
        y, end, unsolved = run(machine, linear.speed, linear.mean, steps, seen, begin, near)
        if not np.isfinite(end).all():
            raise Lost([])
        lack = self._weights * (linear.state @ (end - begin))
        return Flight(x.copy(), value, ends, y, lack, unsolved)

    def _near(self, ends: np.ndarray) -> np.ndarray:
        """What the interfaces do on the last motion, at the points of steps."""
        of, y = self._flight.ends, self._flight.y
        return y if of is ends else mesh.at_points(y, of, ends)

    def _flown(self, x: np.ndarray, value: float) -> Flight:
        """A period from a state on, in shorter steps where it has to; raises `Lost` where that does
        not help."""
        ends, last = self._ends, self._flight
        if last.ends is ends and last.value == value and np.array_equal(last.x, x):
            return last
        for _ in range(_SHORTENED):
            flight = self._tried(x, value, ends)
            if not flight.unsolved.any():
                self._flight = flight
                return flight
            ends = mesh.shortened(ends, flight.unsolved)
        raise Lost([])

    def _placed(self, x: np.ndarray, value: float) -> Flight:
        """A period from a state on, by steps that suit it from now on."""
        flight = self._kept(self._flown(x, value))
        b = self.series.b
        far = float(np.abs(flight.y - self._y)[..., :b].max()) / self.series.lengths
        if far > _FAR:
            self._renewals = _RENEWALS
        if far > _MOVED and self._renewals:
            self._renewals -= 1
            force, _ = self._laws(value, flight.ends, flight.y)
            self._ends = mesh.fitted(self.machine_at(value), flight.y, force, flight.ends)
            self._y = self._near(self._ends)
            flight = self._kept(self._flown(x, value))
        return flight

    def _kept(self, flight: Flight) -> Flight:
        """A period, whose steps are those at hand from now on."""
        if flight.ends is not self._ends:
            self._y = mesh.at_points(self._y, self._ends, flight.ends)
            self._ends = flight.ends
        return flight

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """What the equations lack: what a period changes of a state."""
        return self._flown(x, value).lack

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Residual and its derivative by the state."""
        flight, linear = self._placed(x, value), self.linear(value)
        _, tangent = self._laws(value, flight.ends, flight.y)
        P = through(self._steps(value, flight.ends)[0], tangent - linear.mean)
        self._last = x.copy(), value, P
        jacobian = linear.state @ (P - np.eye(len(P))) @ linear.amplitudes
        return flight.lack, self._weights[:, None] * jacobian / self._weights

    def evaluate(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, its derivative by the state, and by the parameter over its scale."""
        lack, jacobian = self.linearized(x, value)
        beside = self.residual(x, value + _STEP * self.parameter.scale)
        return lack, jacobian, (beside - lack) / _STEP

    def multipliers(self, x: np.ndarray, value: float) -> np.ndarray:
        """Floquet multipliers, the largest first."""
        last = self._last
        if last is None or last[1] != value or np.abs(last[0] - x).max() > _SAME:
            self.linearized(x, value)
        assert self._last is not None
        values = np.linalg.eigvals(self._last[2])
        return values[np.argsort(-np.abs(values), kind="stable")]

    def fix_phase(self, x: np.ndarray) -> None:
        """A motion that is forced has its phase."""

    def harmonics(self, value: float, omega: float) -> Harmonics:
        """The linear part at a value of the parameter."""
        return self.series.harmonics(value, omega)

    def join(self, orbit: Orbit) -> np.ndarray:
        """The unknowns of an orbit, whatever harmonics it has."""
        machine = self.machine_at(orbit.parameter)
        parts = machine.harmonics(orbit.omega, orbit.speed, orbit.H, self.turns)
        b = amplitudes(orbit.b)
        q = np.hstack([b, parts.own - np.einsum("krb,kb->kr", parts.by_b, b)])
        v = 1j * orbit.omega * np.arange(len(q))[:, None] * q
        return self._weights * np.concatenate([each.sum(axis=0).real for each in (q, v)])

    def split(self, x: np.ndarray, value: float) -> Orbit:
        """The orbit of unknowns that solve the equations."""
        flight, of, n = self._flown(x, value), self.series, 8 * self.H
        y = mesh.interpolated(flight.y[..., : of.b], flight.ends, np.arange(n) / n)
        b = series_of(np.fft.rfft(y, axis=0)[: self.H + 1] / n)
        own, speed = np.zeros((len(b), 0)), of.speed_at(value)
        return Orbit(b, own, of.omega_at(value), self.turns, speed, value)
