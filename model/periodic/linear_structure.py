"""The linear structure, condensed exactly to its nonlinear interfaces at each harmonic.

With the relative displacements b of the interfaces among the coordinates, and all others r,

    D(i w) = K - w^2 M + i w D,    S = D_bb - D_br D_rr^-1 D_rb,    S b = f_b - D_br D_rr^-1 f_r + F

Displacements are x, y in turn. A free shaft has no static flexibility, but S always exists, because
the shaft is supported while its interfaces are fixed.
"""

import math
from copy import copy
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..laws_at_rest.oil import machine_with_oil
from ..linear import LinearError, LinearMachine
from ..linear.linear_machine import shared_machine
from ..linear.linearization import OPEN
from ..linear.real_matrices import TURN, in_plane
from ..linear.supports import are_linear
from ..linear.unbalance import bow_pull, turning
from ..machine.rotor import Rotor
from ..structure.assembly import assemble, interface_names
from ..structure.structure import Structure
from .fourier import sampled
from .laws import LawsAlongMotion

_INSTANTS = 1024  # at least, at which gaps along a motion are looked at


class ReducedMatrices(NamedTuple):
    """M, D, K in the coordinates (b, r) at a speed, without the nonlinear interfaces."""

    M: np.ndarray
    D: np.ndarray
    K: np.ndarray


class DynamicStiffness(NamedTuple):
    """The condensed equations at harmonics 0 to H: dynamic stiffness S, shape (H + 1, b, b), forces
    on b, shape (H + 1, b), and the other coordinates r = r_of_loads - r_by_b b."""

    S: np.ndarray
    force: np.ndarray
    r_of_loads: np.ndarray
    r_by_b: np.ndarray

    def whole(self, b: np.ndarray) -> np.ndarray:
        """Return all coordinates (b, r) from amplitudes b, shape (H + 1, b)."""
        r = self.r_of_loads - np.einsum("krb,kb->kr", self.r_by_b, b)
        return np.concatenate([b, r], axis=1)


def _moved_by(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return the coordinates b that move an interface, its displacements by these, of all of b rows
    of shape (2, b), and whether they are its displacements."""
    at = np.flatnonzero(rows.any(axis=0))
    near = rows[:, at]
    return at, near, len(at) == 2 and np.array_equal(near, np.eye(2))


class CondensedMachine:
    """A machine whose linear part is condensed to its nonlinear interfaces.

    loads: constant complex forces on the machine's ports, in the order of `Structure.load_dof` [N].
    Raises `LinearError` if the machine has rigid-body motions that the interfaces do not restrain.
    """

    def __init__(self, rotor: Rotor, loads: np.ndarray | None = None) -> None:
        machine = shared_machine(rotor, OPEN)
        self.rotor, self.machine, s = rotor, machine, machine.structure
        self.structure = s
        linear = are_linear(rotor)
        self.is_nonlinear, self._loads = ~linear, loads
        self.laws = LawsAlongMotion(s, ~linear)
        rows = np.repeat(~linear, 2)
        expand = machine.expand
        across, N = (machine.across @ expand).toarray(), expand.shape[1]
        if linear.all():  # then the curve is followed by what is looked at
            followed = expand[2 * s.probes.dof][:, ::2].toarray()
        else:
            followed = across[rows][::2, ::2]
        pivots, independent = _independent(followed)
        rest = np.setdiff1d(np.arange(N // 2), pivots)
        self._T = np.kron(
            np.linalg.inv(np.vstack([followed[independent], np.eye(N // 2)[rest]])), np.eye(2)
        )
        self.size, self.b = N, 2 * len(independent)
        # of d, the relative displacements of all nonlinear interfaces, by b
        self.B = (across[rows] @ self._T)[:, : self.b]
        self._moved_by = [_moved_by(rows) for rows in self.B.reshape(len(self.B) // 2, 2, self.b)]
        self._linear_rows = (across[~rows] @ self._T).reshape(-1, 2, N)
        self._linear = linear
        # of the observed displacements, x and y of each place in turn, by all coordinates
        x, slope, both = 2 * s.probes.dof, 2 * s.probes.slope, np.arange(2)
        at, of_slope = ((place[:, None] + both).ravel() for place in (x, slope))
        offset = np.repeat(s.probes.offset, 2)[:, None]
        self.probes = (expand[at].toarray() + offset * expand[of_slope].toarray()) @ self._T
        self._set_matrices(machine, across)
        self._set_forces(loads)

    def with_rotor(self, rotor: Rotor) -> "CondensedMachine":
        """Return the machine with other quantities; the linear part is taken over if only nonlinear
        laws change."""
        s = assemble(machine_with_oil(rotor))
        if not _is_same_but_laws(self.structure, s, self._linear):
            return CondensedMachine(rotor, self._loads)
        result = copy(self)
        result.rotor, result.structure = rotor, s
        result.laws = LawsAlongMotion(s, self.is_nonlinear)
        return result

    def _set_matrices(self, machine: LinearMachine, across: np.ndarray) -> None:
        T, s = self._T, self.structure
        at_rest, at_one = (machine.at_zero_load(speed) for speed in (0.0, 1.0))

        def without_laws(matrix, by):
            """Return a matrix without the tangents `by` of the laws, which are in it."""
            each = across.reshape(-1, 2, across.shape[1])
            return matrix.toarray() + np.einsum("jaN,jab,jbM->NM", each, by, each)

        def reduced(matrix):
            return T.T @ matrix @ T

        D_at_rest = without_laws(at_rest.D, at_rest.laws.by_v)
        self._M = reduced(at_rest.M.toarray())
        self._K = reduced(without_laws(at_rest.K, at_rest.laws.by_d))
        self._D = reduced(D_at_rest)
        self._gyroscopic = reduced(without_laws(at_one.D, at_one.laws.by_v) - D_at_rest)
        self._circulatory = reduced(at_rest.system.matrix(0.0 * at_rest.own_K, TURN).toarray())
        self._kappa = s.numbers[0].kappa_v, s.numbers[0].kappa_h
        linear = s.interfaces[self._linear]
        tables = [s.laws[i.law][i.row] for i in linear]
        self._follows_speed = any(record.rows > 0 for record in tables)
        self._linear_laws = lru_cache(1)(self._tangents_of_linear_laws)

    def _set_forces(self, loads: np.ndarray | None) -> None:
        s, T = self.structure, self._T
        size = len(s.static_load) + len(s.housings) + 1
        pull, constant = np.zeros(size, complex), np.zeros(size, complex)
        np.add.at(pull, s.unbalances.dof, s.unbalance)
        np.add.at(pull, s.unbalances.slope, s.unbalances.offset * s.unbalance)
        for i, load in enumerate(() if loads is None else loads):
            if load and s.load_dof[i] >= 0:
                arm = s.load_arms[i]
                constant[s.load_dof[i]] += load
                constant[arm.slope] += arm.offset * load
        expand = self.machine.expand
        self.unbalance, self.bow = (T.T @ (expand.T @ turning(of)) for of in (pull, bow_pull(s)))
        self.constant = T.T @ (expand.T @ (self.machine.static_load + in_plane(constant)))

    @property
    def length(self) -> float:
        """The unit of displacements [m]: the smallest clearance of the nonlinear interfaces; of a
        machine without them what its unbalance moves it by far above all critical speeds, or its
        bow."""
        if self.laws.count:
            return float(self.laws.length.min())
        far = np.linalg.solve(self._M, self.unbalance)[: self.b]
        bows = np.abs(self.structure.bow).max(initial=0.0)
        return float(np.abs(far).max(initial=bows) or self.structure.numbers[0].clearance)

    def turning_force(self, speed: float) -> np.ndarray:
        """Return the complex amplitude of the unbalance's and bows' force at a speed [rad/s], as a
        vibration in time, of the frequency abs(speed), shape (size,) [N]."""
        force = speed**2 * self.unbalance + self.bow
        return force if speed > 0.0 else force.conj()

    def matrices(self, speed: float) -> ReducedMatrices:
        """Return M, D, K in the reduced coordinates at a speed [rad/s]."""
        kappa_v, kappa_h = self._kappa
        kappa = kappa_v * speed + math.copysign(kappa_h * (speed != 0), speed)
        by_d, by_v = self._linear_laws(speed if self._follows_speed else 0.0)
        D = self._D + speed * self._gyroscopic - by_v
        return ReducedMatrices(self._M, D, self._K - kappa * self._circulatory - by_d)

    def _tangents_of_linear_laws(self, speed: float) -> tuple[np.ndarray, ...]:
        """Return the tangents of the linear laws with respect to displacements and velocities."""
        middle = np.zeros(len(self.structure.interfaces), complex)
        result, rows = self.machine.laws.tangents(middle, speed), self._linear_rows
        return tuple(
            np.einsum("jaN,jab,jbM->NM", rows, by[self._linear], rows)
            for by in (result.by_d, result.by_v)
        )

    def dynamic_stiffness(self, omega: float, speed: float, H: int, order: int) -> DynamicStiffness:
        """Return the condensed equations at harmonics 0 to H of omega [rad/s]; order: harmonic at
        which unbalance and bows act, 0: none."""
        M, D, K = self.matrices(speed)
        w = omega * np.arange(H + 1)[:, None, None]
        dynamic = K - w**2 * M + 1j * w * D
        force = np.zeros((H + 1, self.size), complex)
        force[0] = self.constant
        if order:
            force[order] += self.turning_force(speed)
        b = self.b
        right = np.concatenate([dynamic[:, b:, :b], force[:, b:, None]], axis=2)
        solved = np.linalg.solve(dynamic[:, b:, b:], right)
        r_by_b, r_of_loads = solved[:, :, :b], solved[:, :, b]
        S = dynamic[:, :b, :b] - dynamic[:, :b, b:] @ r_by_b
        of_force = force[:, :b] - (dynamic[:, :b, b:] @ r_of_loads[:, :, None])[:, :, 0]
        return DynamicStiffness(S, of_force, r_of_loads, r_by_b)

    @property
    def state_places(self) -> np.ndarray:
        """The indices of the nonlinear interfaces' states among a run's internal states."""
        places = [
            np.arange(i.internal_state, i.internal_state + i.states)
            for i, is_nonlinear in zip(self.structure.interfaces, self.is_nonlinear, strict=True)
            if is_nonlinear
        ]
        return np.concatenate(places).astype(int) if places else np.zeros(0, int)

    def expanded(self, parts: DynamicStiffness, b: np.ndarray) -> np.ndarray:
        """Return all displacements from complex amplitudes b, shape (H + 1, b): x and y of every
        dof and housing in turn, complex, shape (H + 1, 2 size)."""
        return parts.whole(b) @ (self.machine.expand @ self._T).T

    def tangents_in_b(self, by: np.ndarray) -> np.ndarray:
        """Return the tangents of the interfaces, shape (n, m, 2, 2), in the coordinates b, shape
        (n, b, b)."""
        out = np.zeros((len(by), self.b, self.b))
        for j, (at, near, is_direct) in enumerate(self._moved_by):
            out[:, at[:, None], at] += by[:, j] if is_direct else near.T @ by[:, j] @ near
        return out

    def b_of_displacements(self, d: np.ndarray) -> np.ndarray:
        """Return b for relative displacements of all nonlinear interfaces, shape (n, 2 m)."""
        return d @ np.linalg.pinv(self.B).T

    def gaps_along(self, b: np.ndarray) -> np.ndarray:
        """Return the distances from the onset of the interfaces' forces [m] along a motion b, a
        series of 2 H + 1 coefficients, at evenly spaced instants, shape (n, m)."""
        n = max(_INSTANTS, 4 * len(b))
        return self.laws.gaps(sampled(b, n) @ self.B.T)

    def broken_films(self, b: np.ndarray, states: np.ndarray) -> list[str]:
        """Return the names of the parts whose film is thinner than its roughness somewhere along a
        motion b with internal states, series of 2 H + 1 coefficients."""
        if not self.laws.may_break:
            return []
        n = max(_INSTANTS, 4 * len(b))
        is_broken = self.laws.are_invalid(sampled(b, n) @ self.B.T, sampled(states, n)).any(axis=0)
        names = np.array(interface_names(self.rotor), object)[self.is_nonlinear]
        return list(names[is_broken])

    def check_supported(self) -> None:
        """Raise `LinearError` unless the machine is supported while its interfaces are fixed."""
        K = self.matrices(0.0).K[self.b :, self.b :]
        M = self._M[self.b :, self.b :]
        lowest = np.linalg.eigvals(np.linalg.solve(M, K)).real.min() if len(K) else 1.0
        if lowest < 1e-9 * self.structure.numbers[0].lowest_omega ** 2:
            raise LinearError(self.machine.why_not_held())


_LINEAR = (
    "M",
    "C",
    "K",
    "G",
    "K_shaft",
    "K_axial",
    "static_load",
    "unbalance",
    "bow",
    "housings",
    "springs",
)
_SPEED_DEPENDENT = ("kappa_v", "kappa_h", "eta_v", "eta_h")


def _is_same_but_laws(a: Structure, b: Structure, linear: np.ndarray) -> bool:
    """Return whether two structures differ only in their nonlinear laws."""
    if not all(np.array_equal(getattr(a, name), getattr(b, name)) for name in _LINEAR):
        return False
    if any(a.numbers[0][name] != b.numbers[0][name] for name in _SPEED_DEPENDENT):
        return False
    return all(a.laws[i.law][i.row] == b.laws[i.law][i.row] for i in a.interfaces[linear])


def _independent(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pivots of linearly independent rows of an incidence matrix, and the indices of
    these rows."""
    left = rows.astype(float).copy()
    pivots: list[int] = []
    retained: list[int] = []
    for i in range(len(left)):
        for j, pivot in zip(retained, pivots, strict=True):
            left[i] -= left[i, pivot] / left[j, pivot] * left[j]
        if np.abs(left[i]).max(initial=0.0) > 0.5:
            pivots.append(int(np.argmax(np.abs(left[i]))))
            retained.append(i)
    return np.array(pivots, int), np.array(retained, int)
