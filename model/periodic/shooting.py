"""Shooting, for periodic motions with more harmonics than can be balanced, such as a journal that
bounces on its wall.

The state X at the begin of the period is unknown; the machine is integrated over the period, and

    R(X, lambda) = X(T) - X = 0

The structure, linear but for its interface forces, is integrated in modes by Radau IIA; the forces
at the three points of a step are solved for (`entry_points`), the response to constant loads and
unbalance is exact, and the steps are adapted to the motion (`mesh`). The Jacobian is that of the
steps themselves, linearized (`floquet`); its eigenvalues are the Floquet multipliers less 1.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .. import backend
from . import mesh
from .arclength import ContinuationEquations
from .balance import HarmonicBalance, Orbit
from .entry_points import Period, Propagators, step_through
from .floquet import (
    Frequencies,
    ModalBasis,
    modal_basis,
    orbit_path,
    propagators,
    real_amplitudes,
    real_transition_matrix,
    tangents_by_y,
    with_weak_springs,
)
from .fourier import amplitudes, series_of
from .linear_structure import DynamicStiffness
from .newton import NotConverged

_HARMONICS = 256  # at least, of the orbit that is given
# of a step: how far before its end its last tangent is taken, since a corner moves from there with
# the motion, until the steps are chosen anew
_OWN_SIDE = 0.02
# clearances by which a motion moves before the ends of steps in corners move with it, however often
# since the equations stay smooth, and before all steps are chosen anew, which changes the equations
# by the error of the steps
_RENEW_BEYOND, _CELLS_BEYOND = 1e-6, 1e-4
# share of its last such move that a small one may have: those that do not shrink are the error of
# the steps, which ends in corners would follow to and fro
_SHRINKS = 0.5
_FAR_BEYOND, _RENEWALS = 1e-2, 3  # so many times all steps, after it has moved far
_REFINEMENTS = 5  # times that steps are shortened at most
_SHORTER = 3.0  # than by the mean square of all coordinates, a way along the curve counts
_SYSTEMS = 5  # that are kept, at the last values of the parameter
_SAME = 1e-5  # of the unknowns: so near the multipliers are those of the last iteration


class ModalSystem(NamedTuple):
    """The machine without its interfaces at a value of the parameter: speed and frequency [rad/s],
    mean tangents of the interfaces, modes with these tangents; the state by real amplitudes, and
    its inverse; complex amplitudes of the modes under constant loads, and under the unbalance,
    forward and backward."""

    speed: float
    omega: float
    mean: np.ndarray
    modes: ModalBasis
    state: np.ndarray
    amplitudes: np.ndarray
    constant: np.ndarray
    synchronous: tuple[np.ndarray, np.ndarray]

    @property
    def initial(self) -> np.ndarray:
        """The complex amplitudes of the modes by the loads alone, at the begin of the
        period."""
        return self.constant + self.synchronous[0] + self.synchronous[1]

    def load_response(self, turns: int, shares: np.ndarray) -> np.ndarray:
        """Return the displacements and velocities of the interfaces by the loads alone at fractions
        of the period."""
        turn = np.exp(2j * np.pi * turns * shares)[..., None]
        V, (forward, backward) = self.modes.V, self.synchronous
        return (V @ self.constant).real + (turn * (V @ forward + (V @ backward).conj())).real


class IntegratedPeriod(NamedTuple):
    """A period integrated from a state x at a value of the parameter, on a mesh with these step
    ends: displacements and velocities y of the interfaces at the points, shape (steps, 3, 2 b), the
    defect (state at the end less that at the begin), and which steps were too long to be solved."""

    x: np.ndarray
    value: float
    ends: np.ndarray
    y: np.ndarray
    defect: np.ndarray
    unsolved: np.ndarray


class Shooting(ContinuationEquations):
    """The equations of the state at the begin of the period of a motion near an orbit.

    balance: the harmonic balance equations of the same motions. Raises `NotConverged` for laws with
    internal states.
    """

    is_autonomous, balanced_H = False, 0
    tolerance = 1e-7  # below the error of its steps
    damped_beyond = 1e-3  # steps that are chosen anew change the equations a little
    difference = 1e-6

    def __init__(self, problem: HarmonicBalance, orbit: Orbit) -> None:
        if problem.s:
            raise NotConverged()
        self.balance = problem.modified(max(_HARMONICS, 4 * problem.H), reference=orbit.parameter)
        self.machine_at, self.scale = problem.machine_at, problem.scale
        self.reference, self.H, self.turns = orbit.parameter, self.balance.H, problem.turns
        machine = self.machine_at(self.reference)
        mass = np.sqrt(np.diag(machine.matrices(0.0).M))
        of_d = mass / (mass.max() * problem.length_scale * math.sqrt(machine.size) * _SHORTER)
        self._weights = np.concatenate([of_d, of_d / problem.frequency_scale])
        self.modal_system = lru_cache(_SYSTEMS)(self._modal_system)
        self._ends = mesh.UNIFORM_MESH
        for _ in range(_RENEWALS):
            times = mesh.mesh_points(self._ends).ravel() * 2 * math.pi / orbit.omega
            d, v, _ = orbit_path(machine, orbit).at(times)
            y = np.hstack([machine.b_of_displacements(d), machine.b_of_displacements(v)])
            self._motion_of_mesh = y.reshape(-1, 3, y.shape[1])
            force = self._forces(self.reference, self._motion_of_mesh)
            ends = self._ends
            cells = mesh.adapted_cells(force, ends)
            self._ends, self._cells = mesh.with_corners(machine, self._motion_of_mesh, ends, cells)
        self._ends = ends
        tangent = self._tangents(self.reference, ends, self._motion_of_mesh)
        h = np.diff(self._ends)
        self._mean = np.einsum("t,i,tiao->ao", h, mesh.mean_weights(), tangent)
        none = np.zeros(0)
        self._last_period = IntegratedPeriod(
            none, self.reference, self._ends, self._motion_of_mesh, none, none
        )
        self._renewals, self._last_move = _RENEWALS, math.inf
        self._propagator_cache: list[tuple[tuple[Propagators, np.ndarray], float, np.ndarray]] = []
        self._last_transition: tuple[np.ndarray, float, np.ndarray] | None = None

    def _forces(self, value: float, y: np.ndarray) -> np.ndarray:
        """Return the forces along a motion, shape (steps, 3, b)."""
        machine, b, flat = self.machine_at(value), self.balance.b, y.reshape(-1, y.shape[2])
        d, v = flat[:, :b] @ machine.B.T, flat[:, b:] @ machine.B.T
        laws = machine.laws.forces(d, v, np.zeros((len(d), 0)), self.balance.speed_at(value))
        return (laws.force @ machine.B).reshape(*y.shape[:2], b)

    def _tangents(self, value: float, ends: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the tangents along a motion, at the end of a step those before the corner."""
        machine, b = self.machine_at(value), self.balance.b
        h = np.diff(ends) * 2 * math.pi / self.balance.omega_at(value)
        flat = y.copy()
        flat[:, 2, :b] -= _OWN_SIDE * h[:, None] * y[:, 2, b:]
        flat = flat.reshape(-1, 2 * b)
        d, v, none = flat[:, :b] @ machine.B.T, flat[:, b:] @ machine.B.T, np.zeros((len(flat), 0))
        laws = machine.laws.tangents(d, v, none, np.zeros(0), self.balance.speed_at(value))
        return tangents_by_y(machine, laws).reshape(*y.shape[:2], b, 2 * b)

    def _modal_system(self, value: float) -> ModalSystem:
        """Return the machine without its interfaces at a value of the parameter."""
        machine, speed = self.machine_at(value), self.balance.speed_at(value)
        omega = self.balance.omega_at(value)
        frequencies = Frequencies(speed, omega, math.inf)
        mean = with_weak_springs(machine, frequencies, self._mean)
        modes = modal_basis(machine, frequencies, mean)
        T, _ = real_amplitudes(modes.roots)
        state = (modes.shapes @ T).real
        of_state, N = np.linalg.inv(state), machine.size
        accelerations = np.zeros((2 * N, 2), complex)
        both = np.column_stack([machine.constant, 0.5 * machine.turning_force(speed)])
        accelerations[N:] = np.linalg.solve(machine.matrices(speed).M, both)
        constant, forward = (T @ of_state @ accelerations).T
        backward = T @ of_state @ accelerations[:, 1].conj()
        turn = 1j * abs(speed)
        synchronous = forward / (turn - modes.roots), backward / (-turn - modes.roots)
        constant_amplitudes = -constant / modes.roots
        return ModalSystem(
            speed, omega, mean, modes, state, of_state, constant_amplitudes, synchronous
        )

    def _propagators(self, value: float, ends: np.ndarray) -> tuple[Propagators, np.ndarray]:
        """Return the propagators of the steps at a value of the parameter, and the response to the
        loads alone."""
        for known, of_value, of_ends in self._propagator_cache:
            if of_value == value and of_ends is ends:
                return known
        modal_system = self.modal_system(value)
        load_response = modal_system.load_response(self.turns, mesh.mesh_points(ends))
        h = np.diff(ends) * 2 * math.pi / modal_system.omega
        result = propagators(modal_system.modes, h), load_response
        self._propagator_cache = [(result, value, ends), *self._propagator_cache[:3]]
        return result

    def _integrate(self, x: np.ndarray, value: float, ends: np.ndarray) -> IntegratedPeriod:
        """Return the period integrated from a state on; raises `NotConverged` if the motion
        diverges."""
        modal_system, machine = self.modal_system(value), self.machine_at(value)
        _, inverse = real_amplitudes(modal_system.modes.roots)
        loads = (inverse @ modal_system.initial).real
        begin = modal_system.amplitudes @ (x / self._weights) - loads
        steps, load_response = self._propagators(value, ends)
        near = self._nearby_motion(ends)
        unsolved = np.zeros(len(near), bool)
        period = Period(machine.B, modal_system.mean, load_response, near, unsolved, begin)
        sizes = {"steps": len(near), "lengths": len(steps.diagonal), "modes": len(begin)}
        block, run = machine.laws.block_of_steps(**sizes, b=machine.b)
        for group, values in ((run.propagators, steps), (run.period, period)):
            for target, source in zip(group, values, strict=True):
                target[...] = source
        run.work.columns[...] = np.arange(3 * machine.b)
        backend.bound(step_through, block)(float(modal_system.speed))
        end, done = run.period.state.copy(), run.period
        if not np.isfinite(end).all():
            raise NotConverged()
        defect = self._weights * (modal_system.state @ (end - begin))
        return IntegratedPeriod(x.copy(), value, ends, done.y.copy(), defect, done.unsolved.copy())

    def _nearby_motion(self, ends: np.ndarray) -> np.ndarray:
        """Return the interfaces' last motion, at the points of the mesh."""
        of, y = self._last_period.ends, self._last_period.y
        return y if of is ends else mesh.at_mesh_points(y, of, ends)

    def _integrated(self, x: np.ndarray, value: float) -> IntegratedPeriod:
        """Return the period integrated from a state on, on a refined mesh if necessary; raises
        `NotConverged` if refinement does not help."""
        ends, last = self._ends, self._last_period
        if last.ends is ends and last.value == value and np.array_equal(last.x, x):
            return last
        for _ in range(_REFINEMENTS):
            period = self._integrate(x, value, ends)
            if not period.unsolved.any():
                self._last_period = period
                return period
            ends = mesh.refined_mesh(ends, period.unsolved)
        raise NotConverged()

    def _on_adapted_mesh(self, x: np.ndarray, value: float) -> IntegratedPeriod:
        """Return the period integrated from a state on, on a mesh that is adapted to it and
        kept."""
        period = self._adopted(self._integrated(x, value))
        b = self.balance.b
        moved = np.abs(period.y - self._motion_of_mesh)[..., :b]
        far = float(moved.max()) / self.balance.length_scale
        if far > _FAR_BEYOND:
            self._renewals = _RENEWALS
        if far > _CELLS_BEYOND:
            self._last_move = math.inf
        if _RENEW_BEYOND < far < _SHRINKS * self._last_move:
            self._last_move = far
            if far > _CELLS_BEYOND and self._renewals:
                self._renewals -= 1
                self._cells = mesh.adapted_cells(self._forces(value, period.y), period.ends)
            machine = self.machine_at(value)
            steps = mesh.with_corners(machine, period.y, period.ends, self._cells)
            self._ends, self._cells = steps
            self._motion_of_mesh = self._nearby_motion(self._ends)
            period = self._adopted(self._integrated(x, value))
        return period

    def _adopted(self, period: IntegratedPeriod) -> IntegratedPeriod:
        """Store the mesh of a period as the current one, and return the period."""
        if period.ends is not self._ends:
            self._motion_of_mesh = mesh.at_mesh_points(
                self._motion_of_mesh, self._ends, period.ends
            )
            self._ends = self._cells = period.ends
        return period

    def residual(self, x: np.ndarray, value: float) -> np.ndarray:
        """Return the residual of the equations: the change of the state over a period."""
        return self._integrated(x, value).defect

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual and the Jacobian."""
        period, modal_system = self._on_adapted_mesh(x, value), self.modal_system(value)
        tangent = self._tangents(value, period.ends, period.y)
        P = real_transition_matrix(
            self._propagators(value, period.ends)[0], tangent - modal_system.mean
        )
        self._last_transition = x.copy(), value, P
        jacobian = modal_system.state @ (P - np.eye(len(P))) @ modal_system.amplitudes
        return period.defect, self._weights[:, None] * jacobian / self._weights

    def seen(
        self, x: np.ndarray, value: float, direction: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the velocities at the begin of the period of the places that are observed, over
        the frequency at the reference, shape (n,) [m], and their derivative along a direction of
        the curve."""
        probes = self.machine_at(value).probes / self.balance.frequency_scale
        n = probes.shape[1]
        motion, along = (probes @ (each / self._weights)[n:] for each in (x, direction[:-1]))
        return motion, along

    def motion(self, x: np.ndarray, value: float) -> np.ndarray:
        """Return the orbit's series in clearances, as harmonic balance has it for its unknowns."""
        return self.split(x, value).b.ravel() / self.balance.length_scale

    def multipliers(self, x: np.ndarray, value: float) -> np.ndarray:
        """Return the Floquet multipliers, the largest first."""
        last = self._last_transition
        if last is None or last[1] != value or np.abs(last[0] - x).max() > _SAME:
            self.linearized(x, value)
        assert self._last_transition is not None
        values = np.linalg.eigvals(self._last_transition[2])
        return values[np.argsort(-np.abs(values), kind="stable")]

    def fix_phase(self, x: np.ndarray) -> None:
        """Let the steps be chosen anew on the way to the next point, and for the multipliers of
        this one: the excitation fixes the phase."""
        self._renewals, self._last_move = _RENEWALS, math.inf
        self._last_transition = None

    def dynamic_stiffness(self, value: float, omega: float) -> DynamicStiffness:
        """Return the linear part at a value of the parameter."""
        return self.balance.dynamic_stiffness(value, omega)

    def join(self, orbit: Orbit) -> np.ndarray:
        """Return the unknowns of an orbit with any number of harmonics."""
        machine = self.machine_at(orbit.parameter)
        parts = machine.dynamic_stiffness(orbit.omega, orbit.speed, orbit.H, self.turns)
        q = parts.whole(amplitudes(orbit.b))
        v = 1j * orbit.omega * np.arange(len(q))[:, None] * q
        return self._weights * np.concatenate([each.sum(axis=0).real for each in (q, v)])

    def split(self, x: np.ndarray, value: float) -> Orbit:
        """Return the orbit of unknowns that solve the equations."""
        period, of, n = self._integrated(x, value), self.balance, 8 * self.H
        y = mesh.interpolated(period.y[..., : of.b], period.ends, np.arange(n) / n)
        b = series_of(np.fft.rfft(y, axis=0)[: self.H + 1] / n)
        own, speed = np.zeros((len(b), 0)), of.speed_at(value)
        return Orbit(b, own, of.omega_at(value), self.turns, speed, value)
