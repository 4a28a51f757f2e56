"""Harmonic balance: the equations of a periodic motion in the Fourier coefficients of the relative
displacements of the interfaces, and of the laws' own states.

    S_k(omega) b_k = f_k + B^T F_k,    i k omega s_k = g_k

F and g, forces and rates of states, are sampled in time along the orbit and transformed
(alternating frequency and time: Cameron and Griffin 1989), and so are their tangents. omega is the
speed over `turns`, or, of a motion by itself (whirl without unbalance), an unknown.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..quantities import QuantityError
from .arclength import TOLERANCE
from .force_corners import Samples
from .fourier import (
    add_real,
    amplitudes,
    coefficients,
    derivative,
    products,
    resized,
    series_of,
)
from .linear_structure import Condensed, Harmonics

_STEP = 1e-6  # of a central difference by omega, as a share of its scale
_ONE_SIDED = 1e-7  # of a difference by the parameter, as a share of its scale
_SAMPLES = 16  # a harmonic
_LEAST_SAMPLES = 256


class Orbit(NamedTuple):
    """A periodic motion: coefficients of b [m], shape (2 H + 1, b), of own states, shape
    (2 H + 1, s); omega [rad/s], turns in a period, speed [rad/s], value of the parameter."""

    b: np.ndarray
    own: np.ndarray
    omega: float
    turns: int
    speed: float
    parameter: float

    @property
    def H(self) -> int:
        """How many harmonics."""
        return len(self.b) // 2


@dataclass(frozen=True)
class Parameter:
    """What is varied: `speed`, or a quantity of the machine; scale: of its range."""

    name: str
    scale: float


class Problem:
    """The equations with H harmonics.

    machine_at: the machine at a value of the parameter; speed: of a parameter that is not the speed
    [rad/s]; turns: revolutions in a period; is_autonomous: whether omega is unknown, and nothing
    acts but what is constant; length: by which displacements are measured, by default the least of
    the interfaces' [m].
    """

    tolerance, damped_beyond = TOLERANCE, 0.0

    def __init__(
        self,
        machine_at: Callable[[float], Condensed],
        parameter: Parameter,
        at: float,
        H: int,
        *,
        speed: float = 0.0,
        turns: int = 1,
        is_autonomous: bool = False,
        omega: float = 0.0,
        own_scale: np.ndarray | None = None,
        length: float = 0.0,
    ) -> None:
        self.machine_at, self.parameter, self.at = machine_at, parameter, at
        self.H, self.turns, self.is_autonomous = H, turns, is_autonomous
        self._speed, self.omega_scale = speed, omega
        machine = machine_at(at)
        self.b, self.s = machine.b, machine.laws.states
        self.d = 2 * machine.laws.count
        self.lengths = length or float(np.min(machine.laws.length, initial=np.inf))
        if not math.isfinite(self.lengths):
            self.lengths = float(machine.structure.numbers[0].clearance)
        self.own_scale = np.ones(self.s) if own_scale is None else own_scale
        n = 2 ** math.ceil(math.log2(max(_LEAST_SAMPLES, _SAMPLES * H)))
        self._samples = n
        self.anchor: np.ndarray | None = None
        self._of_last: tuple[tuple[float, float], Harmonics] | None = None
        base = self.omega_at(at) or omega
        S = self.harmonics(at, base).S
        size = np.abs(S).max(axis=(1, 2), initial=0.0)
        rows = np.concatenate([[size[0]], np.repeat(size[1:], 2)])
        self.row_scale = 1.0 / np.maximum(rows, 1e-9 * size.max(initial=1.0))

    def like(
        self, H: int | None = None, at: float | None = None, turns: int | None = None
    ) -> Problem:
        """The same with other harmonics, about another value, or with a longer period."""
        made = Problem(
            self.machine_at,
            self.parameter,
            self.at if at is None else at,
            self.H if H is None else H,
            speed=self._speed,
            turns=self.turns if turns is None else turns,
            is_autonomous=self.is_autonomous,
            omega=self.omega_scale,
            own_scale=self.own_scale,
            length=self.lengths,
        )
        if self.anchor is not None:
            made.anchor = resized(self.anchor, made.H)
        return made

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return (2 * self.H + 1) * (self.b + self.s) + self.is_autonomous

    def speed_at(self, value: float) -> float:
        """The speed at a value of the parameter [rad/s]."""
        return value if self.parameter.name == "speed" else self._speed

    def omega_at(self, value: float) -> float:
        """The frequency at a value of the parameter [rad/s]; 0 where it is unknown."""
        return 0.0 if self.is_autonomous else self.speed_at(value) / self.turns

    def harmonics(self, value: float, omega: float) -> Harmonics:
        """The linear part at a value of the parameter."""
        key = value, omega
        if self._of_last is None or self._of_last[0] != key:
            order, speed = 0 if self.is_autonomous else self.turns, self.speed_at(value)
            made = self.machine_at(value).harmonics(omega, speed, self.H, order)
            self._of_last = key, made
        return self._of_last[1]

    def split(self, x: np.ndarray, value: float) -> Orbit:
        """What unknowns stand for."""
        rows = 2 * self.H + 1
        b = x[: rows * self.b].reshape(rows, self.b) * self.lengths
        own = x[rows * self.b : rows * (self.b + self.s)].reshape(rows, self.s) * self.own_scale
        omega = x[-1] * self.omega_scale if self.is_autonomous else self.omega_at(value)
        return Orbit(b, own, float(omega), self.turns, self.speed_at(value), value)

    def join(self, orbit: Orbit) -> np.ndarray:
        """The unknowns of an orbit, whatever harmonics it has."""
        b = resized(orbit.b, self.H) / self.lengths
        own = resized(orbit.own, self.H) / self.own_scale
        tail = [orbit.omega / self.omega_scale] if self.is_autonomous else []
        return np.concatenate([b.ravel(), own.ravel(), tail])

    def moved(self, x: np.ndarray, other: Problem) -> np.ndarray:
        """Unknowns, or a change of them, of this problem as those of another one."""
        rows = 2 * self.H + 1
        b = resized(x[: rows * self.b].reshape(rows, -1), other.H)
        own = resized(x[rows * self.b : rows * (self.b + self.s)].reshape(rows, self.s), other.H)
        return np.concatenate([b.ravel(), own.ravel(), x[rows * (self.b + self.s) :]])

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """What the equations lack, shape (size,), each on a scale of about 1."""
        orbit, machine = self.split(x, value), self.machine_at(value)
        at = self._sampled(orbit, machine)
        along = at.of_own_corners(machine.laws.forces(at.d, at.v, at.own, orbit.speed))
        return self._lack(orbit, self.harmonics(value, orbit.omega), machine, at, along)

    def _sampled(self, orbit: Orbit, machine: Condensed) -> Samples:
        d = orbit.b @ machine.B.T
        return Samples(machine.laws, d, orbit.own, orbit.omega, self._samples, derivative(d))

    def _lack(self, orbit, parts, machine, at, along) -> np.ndarray:
        linear = coefficients(np.einsum("kij,kj->ki", parts.S, amplitudes(orbit.b)) - parts.force)
        of_b = linear - series_of(at.spectrum(along.force @ machine.B, self.H))
        of_own = orbit.omega * derivative(orbit.own)
        if self.s:
            of_own -= series_of(at.spectrum(along.rates, self.H))
        tail = [self._phase(orbit)] if self.is_autonomous else []
        return np.concatenate(
            [
                (self.row_scale[:, None] * of_b).ravel() / self.lengths,
                (of_own / (self.own_scale * self.pace)).ravel(),
                tail,
            ]
        )

    @cached_property
    def pace(self) -> float:
        """A frequency by which rates of own states are measured [rad/s]."""
        return abs(self.omega_at(self.at)) or self.omega_scale

    def _phase(self, orbit: Orbit) -> float:
        """How far an autonomous orbit has turned from the last one."""
        assert self.anchor is not None
        return float(np.sum(orbit.b / self.lengths * derivative(self.anchor)))

    def fix_phase(self, x: np.ndarray) -> None:
        """Let an autonomous orbit's phase be measured from this one."""
        if not self.is_autonomous:
            return
        rows = 2 * self.H + 1
        self.anchor = x[: rows * self.b].reshape(rows, self.b).copy()
        self.anchor /= max(np.linalg.norm(derivative(self.anchor)), 1e-300)

    def evaluate(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Residual, its derivative by the unknowns, shape (size, size), and by the parameter over
        its scale."""
        residual, jacobian = self.linearized(x, value)
        step = _ONE_SIDED
        try:
            beside = self.residual(x, value + step * self.parameter.scale)
        except QuantityError:  # at the largest that the machine can have
            step = -step
            beside = self.residual(x, value + step * self.parameter.scale)
        return residual, jacobian, (beside - residual) / step

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Residual and its derivative by the unknowns."""
        orbit, machine = self.split(x, value), self.machine_at(value)
        at, H = self._sampled(orbit, machine), self.H
        along = machine.laws.tangents(at.d, at.v, at.own, self.own_scale, orbit.speed)
        along = at.of_own_corners(along)
        parts = self.harmonics(value, orbit.omega)
        residual = self._lack(orbit, parts, machine, at, along)
        n = (2 * H + 1) * self.b
        # of all samples first: there are fewer of them than pairs of harmonics
        by_d, by_v = (at.spectrum(machine.of_b(by), 2 * H) for by in (along.by_d, along.by_v))
        of_b = products(-by_d, -orbit.omega * by_v)
        add_real(of_b, parts.S)
        of_b *= self.row_scale[:, None, None, None]
        jacobian = np.zeros((self.size, self.size))
        jacobian[:n, :n] = of_b.reshape(n, n)
        if self.s:
            self._add_states(jacobian, along, machine, orbit, at)
        if self.is_autonomous:
            near = x.copy()
            near[-1] = x[-1] + _STEP
            above = self.residual(near, value)
            near[-1] = x[-1] - _STEP
            jacobian[:, -1] = (above - self.residual(near, value)) / (2 * _STEP)
            assert self.anchor is not None
            jacobian[-1, :n] = derivative(self.anchor).ravel()
        return residual, jacobian

    def _add_states(self, jacobian, along, machine, orbit, at) -> None:
        rows, nb, s, H = 2 * self.H + 1, self.b, self.s, self.H
        n = rows * nb
        by_state = at.spectrum(along.by_rate, 2 * H)
        rates_by_d, rates_by_v, rates_by_own = (
            at.spectrum(by, 2 * H)
            for by in (along.rates_by_d, along.rates_by_v, along.rates_by_own)
        )
        inverse = 1.0 / (self.own_scale * self.pace)
        by_state = machine.B.T @ by_state * (self.own_scale / self.lengths)
        of_force = -self.row_scale[:, None, None, None] * products(by_state, 0 * by_state)
        jacobian[:n, n : n + rows * s] = of_force.reshape(n, rows * s)
        of_d = products(rates_by_d @ machine.B, orbit.omega * rates_by_v @ machine.B)
        of_d *= -inverse[:, None, None] * self.lengths
        jacobian[n : n + rows * s, :n] = of_d.reshape(rows * s, n)
        of_own = -products(rates_by_own, 0 * rates_by_own)
        turning = orbit.omega * derivative(np.eye(rows))
        of_own += turning[:, None, :, None] * np.eye(s)[:, None, :]
        of_own *= inverse[:, None, None] * self.own_scale
        jacobian[n : n + rows * s, n : n + rows * s] = of_own.reshape(rows * s, rows * s)

    def last_share(self, x: np.ndarray) -> float:
        """The amplitudes of the highest harmonics as a share of all that moves."""
        return last_share(self.split(x, self.at).b)


def last_share(b: np.ndarray) -> float:
    """The amplitudes of the highest harmonics of a series as a share of all that moves."""
    size, H = np.abs(amplitudes(b)).max(axis=1, initial=0.0), len(b) // 2
    last = max(2, H // 4)
    return float(size[-last:].max() / max(size[1:].max(), 1e-300)) if last < H else 1.0


def cached(function: Callable[[float], Any]) -> Callable[[float], Any]:
    """What a function makes of the last few values of a parameter, kept."""
    return lru_cache(maxsize=8)(function)
