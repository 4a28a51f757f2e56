"""Harmonic balance: the equations of a periodic motion in the Fourier coefficients of the relative
displacements of the interfaces and of the laws' internal states.

    S_k(omega) b_k = f_k + B^T F_k,    i k omega s_k = g_k

The forces F and the rates g of the states are sampled in time along the orbit and transformed
(alternating frequency/time method: Cameron and Griffin 1989), and so are their tangents. omega is
above 0: the size of the speed over `turns`, or an unknown for self-excited motions (whirl without
unbalance).
"""

import math
from collections.abc import Callable
from copy import copy
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .arclength import ContinuationEquations
from .elimination import groups_of, solve_by_elimination
from .force_corners import SampledOrbit
from .fourier import (
    add_real,
    amplitudes,
    coefficients,
    derivative,
    last_share,
    products,
    resized,
    series_of,
    times_derivative,
)
from .linear_structure import CondensedMachine, DynamicStiffness
from .newton import by_parameter, solve_linear

_CENTRAL_STEP = 1e-6  # of a central difference of the stiffness by omega, as a share of its scale
_PARAMETER_STEP, _WHIRL_STEP = 1e-7, 1e-8  # of a difference by the parameter, of its scale
_MOVED = 0.1  # of a motion: a larger part of it comes into contact in a step across a corner
_LEAST_SHARE = 1e-3  # of the stiffness at the speed: the least by which an equation is scaled
_SAMPLES_A_HARMONIC = 16
_LEAST_SAMPLES = 256
_KEPT = 16  # linear parts, back to those of a curve's last point


class Orbit(NamedTuple):
    """A periodic motion: Fourier coefficients of b [m], shape (2 H + 1, b), and of the internal
    states, shape (2 H + 1, s); omega [rad/s], revolutions in a period, speed [rad/s], value of the
    parameter."""

    b: np.ndarray
    states: np.ndarray
    omega: float
    turns: int
    speed: float
    parameter: float

    @property
    def H(self) -> int:
        """The number of harmonics."""
        return len(self.b) // 2


class HarmonicBalance(ContinuationEquations):
    """The harmonic balance equations with H harmonics.

    machine_at: gives the machine at a value of the parameter, `speed` or a quantity of the machine;
    scale: of its range; reference: value of the parameter at which the equations are scaled; speed
    [rad/s]: used if it is not the parameter; turns: revolutions in a period; is_autonomous: omega
    is unknown, and only constant loads act; state_scale: units of the laws' internal states, by
    default their sizes in a motion as large as each interface's length; length_scale: unit of
    displacements [m], by default that of the machine.
    """

    def __init__(
        self,
        machine_at: Callable[[float], CondensedMachine],
        parameter: str,
        scale: float,
        reference: float,
        H: int,
        *,
        speed: float = 0.0,
        turns: int = 1,
        is_autonomous: bool = False,
        omega: float = 0.0,
        state_scale: np.ndarray | None = None,
        length_scale: float = 0.0,
    ) -> None:
        self.machine_at, self.parameter, self.scale = machine_at, parameter, scale
        self.turns, self.is_autonomous = turns, is_autonomous
        self._speed, self.omega_scale = speed, omega
        machine = machine_at(reference)
        self.b, self.s = machine.b, machine.laws.states
        self.d = 2 * machine.laws.count
        # the friction of a race or a whirl that rolls turns within a hardly larger change of speed
        self.is_central = self.s > 0 or is_autonomous
        self.difference = _WHIRL_STEP if is_autonomous else _PARAMETER_STEP
        self.length_scale = length_scale or machine.length
        if state_scale is None:
            state_scale = machine.laws.state_scales(abs(self.speed_at(reference)))
        self.state_scale = state_scale
        self.phase_reference: np.ndarray | None = None
        self._set(H, reference)

    def _set(self, H: int, reference: float) -> None:
        """Set the number of harmonics, and scale the equations at a value of the parameter."""
        self.H, self.reference = H, reference
        # scales the rates of the internal states [rad/s]
        self.frequency_scale = abs(self.omega_at(reference)) or self.omega_scale
        self._samples = 2 ** math.ceil(math.log2(max(_LEAST_SAMPLES, _SAMPLES_A_HARMONIC * H)))
        self._last_sampled: SampledOrbit | None = None
        self.dynamic_stiffness = lru_cache(_KEPT)(self._dynamic_stiffness)
        S = self.dynamic_stiffness(reference, self.omega_at(reference) or self.omega_scale).S
        size = np.abs(S).max(axis=(1, 2), initial=0.0)
        rows = np.concatenate([[size[0]], np.repeat(size[1:], 2)])
        # a free shaft has no stiffness at rest
        least = max(_LEAST_SHARE * size[min(self.turns, H)], 1e-9 * size.max(initial=0.0), 1e-300)
        self.row_scale = 1.0 / np.maximum(rows, least)

    def modified(self, H: int, reference: float | None = None) -> "HarmonicBalance":
        """Return the equations with another number of harmonics, and another reference value."""
        other = copy(self)
        other._set(H, self.reference if reference is None else reference)
        if self.phase_reference is not None:
            other.phase_reference = resized(self.phase_reference, H)
        return other

    @property
    def balance(self) -> "HarmonicBalance":
        """These equations, as shooting has those of its motions."""
        return self

    @property
    def balanced_H(self) -> int:
        """The number of harmonics, of shooting 0."""
        return self.H

    @property
    def size(self) -> int:
        """The number of unknowns."""
        return (2 * self.H + 1) * (self.b + self.s) + self.is_autonomous

    def speed_at(self, value: float) -> float:
        """Return the speed at a value of the parameter [rad/s]."""
        return value if self.parameter == "speed" else self._speed

    def omega_at(self, value: float) -> float:
        """Return the frequency at a value of the parameter [rad/s]; 0 where it is unknown."""
        return 0.0 if self.is_autonomous else abs(self.speed_at(value)) / self.turns

    def _dynamic_stiffness(self, value: float, omega: float) -> DynamicStiffness:
        """Return the linear part at a value of the parameter."""
        order, speed = 0 if self.is_autonomous else self.turns, self.speed_at(value)
        return self.machine_at(value).dynamic_stiffness(omega, speed, self.H, order)

    def split(self, x: np.ndarray, value: float) -> Orbit:
        """Return the orbit that a vector of unknowns describes."""
        b, states, _ = self._series(x)
        omega = x[-1] * self.omega_scale if self.is_autonomous else self.omega_at(value)
        own = b * self.length_scale, states * self.state_scale
        return Orbit(*own, float(omega), self.turns, self.speed_at(value), value)

    def _series(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the coefficients of b and of the internal states among unknowns, a row each, and
        the unknowns behind them."""
        rows, own = 2 * self.H + 1, self._rows_of_states()
        b, states, tail = x[: own.start], x[own], x[own.stop :]
        return b.reshape(rows, self.b), states.reshape(rows, self.s), tail

    def join(self, orbit: Orbit) -> np.ndarray:
        """Return the unknowns of an orbit with any number of harmonics."""
        b = resized(orbit.b, self.H) / self.length_scale
        states = resized(orbit.states, self.H) / self.state_scale
        tail = [orbit.omega / self.omega_scale] if self.is_autonomous else []
        return np.concatenate([b.ravel(), states.ravel(), tail])

    def converted(self, x: np.ndarray, other: "HarmonicBalance") -> np.ndarray:
        """Return unknowns, or a change of them, as those of equations with another number of
        harmonics."""
        *series, tail = self._series(x)
        return np.concatenate([*(resized(each, other.H).ravel() for each in series), tail])

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """Return the residual of the equations, shape (size,), each scaled to about 1."""
        orbit, machine = self.split(x, value), self.machine_at(value)
        samples = self._sampled(orbit, machine)
        laws = machine.laws.forces(samples.d, samples.v, samples.states, orbit.speed)
        laws, stiffness = samples.of_own_corners(laws), self.dynamic_stiffness(value, orbit.omega)
        return self._residual_of(orbit, stiffness, machine, samples, laws)

    def _sampled(self, orbit: Orbit, machine: CondensedMachine) -> SampledOrbit:
        of = machine.laws, orbit.b @ machine.B.T, orbit.states, orbit.omega
        last = self._last_sampled
        self._last_sampled = last.at(*of) if last else SampledOrbit(*of, self._samples)
        return self._last_sampled

    def _residual_of(self, orbit, stiffness, machine, samples, laws) -> np.ndarray:
        linear = coefficients(
            np.einsum("kij,kj->ki", stiffness.S, amplitudes(orbit.b)) - stiffness.force
        )
        of_b = linear - series_of(samples.spectrum(laws.force @ machine.B, self.H))
        of_states = orbit.omega * derivative(orbit.states)
        if self.s:
            of_states -= series_of(samples.spectrum(laws.rates, self.H))
        of_b = (self.row_scale[:, None] * of_b).ravel() / self.length_scale
        of_states = (of_states / (self.state_scale * self.frequency_scale)).ravel()
        tail = [self._phase_condition(orbit)] if self.is_autonomous else []
        return np.concatenate([of_b, of_states, tail])

    def _phase_condition(self, orbit: Orbit) -> float:
        assert self.phase_reference is not None
        return float(np.sum(orbit.b / self.length_scale * derivative(self.phase_reference)))

    def fix_phase(self, x: np.ndarray) -> None:
        """Use these unknowns as the reference of the phase condition, if the motion is
        self-excited."""
        if not self.is_autonomous:
            return
        self.phase_reference = self._series(x)[0].copy()
        self.phase_reference /= max(np.linalg.norm(derivative(self.phase_reference)), 1e-300)

    def of_motion(self, way: np.ndarray) -> np.ndarray:
        """Return a way along the curve without the internal states: the mean place of a pad that
        nothing holds, but for one touch in each period, jumps where the touch passes a sample."""
        return np.delete(way, self._rows_of_states())

    def _rows_of_states(self) -> slice:
        """Return where the internal states are among the unknowns."""
        rows = 2 * self.H + 1
        return slice(rows * self.b, rows * (self.b + self.s))

    def seen(
        self, x: np.ndarray, value: float, direction: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the motion about the mean of the places that are observed, real and imaginary
        parts of their amplitudes [m], shape (n,), and its derivative along a direction of the
        curve."""

        def along(way: float) -> np.ndarray:
            at = value + way * self.scale * direction[-1]
            orbit = self.split(x + way * direction[:-1], at)
            whole = self.dynamic_stiffness(at, orbit.omega).whole(amplitudes(orbit.b))
            return (whole[1:] @ self.machine_at(at).probes.T).ravel().view(float)

        motion = along(0.0)
        return motion, by_parameter(along, 0.0, motion, 1.0, _PARAMETER_STEP)

    def is_across(self, x: np.ndarray, value: float, other: float) -> bool:
        """Return whether the same motion touches a wall, or leaves it, all at once between two
        values of the parameter."""
        machines = self.machine_at(value), self.machine_at(other)
        if machines[0] is machines[1]:
            return False
        here, there = (machine.gaps_along(self.split(x, value).b) > 0 for machine in machines)
        return bool(((here != there).mean(axis=0) > _MOVED).any())

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual and the Jacobian, shape (size, size)."""
        orbit, machine = self.split(x, value), self.machine_at(value)
        samples, H = self._sampled(orbit, machine), self.H
        laws = machine.laws.tangents(
            samples.d, samples.v, samples.states, self.state_scale, orbit.speed
        )
        laws = samples.of_own_corners(laws)
        stiffness = self.dynamic_stiffness(value, orbit.omega)
        residual = self._residual_of(orbit, stiffness, machine, samples, laws)
        n = (2 * H + 1) * self.b
        # of all samples first: there are fewer of them than pairs of harmonics
        by_d, by_v = (
            samples.spectrum(machine.tangents_in_b(by), 2 * H) for by in (laws.by_d, laws.by_v)
        )
        of_b = products(-by_d, -orbit.omega * by_v)
        add_real(of_b, stiffness.S)
        of_b *= self.row_scale[:, None, None, None]
        jacobian = np.zeros((self.size, self.size))
        jacobian[:n, :n] = of_b.reshape(n, n)
        if self.s:
            self._add_states(jacobian, laws, machine, orbit, samples)
        if self.is_autonomous:
            jacobian[:n, -1] = self._by_omega(orbit, value, by_v)
            assert self.phase_reference is not None
            jacobian[-1, :n] = derivative(self.phase_reference).ravel()
        return residual, jacobian

    def _by_omega(self, orbit: Orbit, value: float, by_v: np.ndarray) -> np.ndarray:
        """Return the derivative of the equations of the motion by omega over its scale, of the
        forces by their tangents: friction that rolls turns within any difference of omega."""
        ends = (orbit.omega + side * self.omega_scale for side in (_CENTRAL_STEP, -_CENTRAL_STEP))
        above, below = (self.dynamic_stiffness(value, omega).S for omega in ends)
        change = np.einsum("kij,kj->ki", above - below, amplitudes(orbit.b))
        by_omega = coefficients(change) / (2 * _CENTRAL_STEP)
        by_omega -= self.omega_scale * times_derivative(by_v, orbit.b)
        return (self.row_scale[:, None] * by_omega).ravel() / self.length_scale

    def _add_states(self, jacobian, laws, machine, orbit, samples) -> None:
        rows, s, H, n = 2 * self.H + 1, self.s, self.H, (2 * self.H + 1) * self.b
        by_state = samples.spectrum(laws.by_states, 2 * H)
        rates_by_d, rates_by_v, rates_by_states = (
            samples.spectrum(by, 2 * H)
            for by in (laws.rates_by_d, laws.rates_by_v, laws.rates_by_states)
        )
        inverse = 1.0 / (self.state_scale * self.frequency_scale)
        by_state = machine.B.T @ by_state * (self.state_scale / self.length_scale)
        of_force = -self.row_scale[:, None, None, None] * products(by_state, 0 * by_state)
        jacobian[:n, n : n + rows * s] = of_force.reshape(n, rows * s)
        of_d = products(rates_by_d @ machine.B, orbit.omega * rates_by_v @ machine.B)
        of_d *= -inverse[:, None, None] * self.length_scale
        jacobian[n : n + rows * s, :n] = of_d.reshape(rows * s, n)
        states = self._rows_of_states()
        of_states = jacobian[states, states].reshape(rows, s, rows, s)  # a view
        for group in groups_of(laws.rates_by_states.any(axis=0)):
            own = rates_by_states[:, group[:, None], group]
            every = np.arange(rows)
            of_states[np.ix_(every, group, every, group)] = -products(own, 0 * own)
        differentiation = orbit.omega * derivative(np.eye(rows))
        for state in range(s):
            of_states[:, state, :, state] += differentiation
        of_states *= inverse[:, None, None] * self.state_scale
        # a state that stays what it is may have any mean, or, where it is the rate of another one
        # that acts on nothing, such as of the tilt of a pad that bears nothing, that other one
        still, acts = ~jacobian[n : n + s].any(axis=1), jacobian[:, n : n + s].any(axis=0)
        rate_of = (jacobian[n : n + s, n : n + s] != 0.0) & ~acts[:, None]
        free = np.where(rate_of.any(axis=0), rate_of.argmax(axis=0), np.arange(s))
        jacobian[n + np.flatnonzero(still), n + free[still]] = 1.0
        if self.is_autonomous:
            by_omega = derivative(orbit.states) - times_derivative(rates_by_v @ machine.B, orbit.b)
            jacobian[n : n + rows * s, -1] = (self.omega_scale * inverse * by_omega).ravel()

    def solve_linear(self, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
        """Return the solution of a linear system with the Jacobian, which may be bordered by
        further rows and columns."""
        if not self.s:
            return solve_linear(matrix, right)
        own = np.arange(len(matrix))[self._rows_of_states()].reshape(-1, self.s)
        return solve_by_elimination(matrix, right, own)

    def last_share(self, x: np.ndarray) -> float:
        """Return the amplitude of the highest harmonics relative to the largest harmonic."""
        return last_share(self.split(x, self.reference).b)
