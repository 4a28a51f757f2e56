"""The machine linearized about its equilibrium, at any speed, as sparse real matrices.

The unknowns are x, y in turn of every deflection and slope of the shaft, then of the housings:

    M u'' + D u' + K u = f,   D = C + Omega G - dF/dd',   K = K_shaft + springs + kappa K_c - dF/dd

in motions slower than the rotation; in faster ones hysteresis is another (`system_at_speed`).
A clearance contact is open (as if it were not there), or pinned (the journal moves as its housing
does). The laws of all other interfaces are linearized where gravity holds them at that speed.
"""

import math
from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from ..kernels.kernel import interpreted
from ..machine.rotor import Rotor
from ..parts.housing import masses
from ..structure.assembly import assemble
from ..structure.parameters import elastic_share, lengths_of
from ..structure.strain_solver import StrainedMatrices
from .bearing_equilibrium import check_films
from .real_matrices import (
    TURN,
    Between,
    differences,
    expansion,
    in_plane,
    matrices_of,
    to_complex,
    unknowns,
)
from .supports import are_linear, interfaces, seat, supports
from .system_at_speed import Linear, LinearError, Strain
from .tangents import LawsAtRest, Tangents

OPEN, PINNED = "open", "pinned"
CONTACTS = (OPEN, PINNED)
_SOFT = 1e-7  # of the lowest elastic frequency, squared: what is softer is not held
_ITERATIONS = 200
_SHARE = 0.2  # of a film's clearance, that a step of Newton's method moves its journal
_FAR = 1e9  # what is more than any displacement [m]
_ABOVE = (64.0, 32.0, 16.0, 8.0, 4.0, 2.0, 1.4)
_CHANGE, _STEADY = 1e-12, 1e-8  # of the displacements; the latter of one that no longer shrinks


class LinearMachine:
    """A machine for linear analyses.

    contacts: `open` or `pinned`; None: open where the machine is held without its contacts, else
    pinned. Raises `LinearError` for another word. system: where matrices of its unknowns have
    numbers, with the shaft's strain.
    """

    def __init__(self, rotor: Rotor, contacts: str | None = None) -> None:
        if contacts not in (None, *CONTACTS):
            raise LinearError(f"contacts = {contacts}: must be one of {', '.join(CONTACTS)}")
        self.rotor = rotor
        self.structure = assemble(rotor)
        self.supports = supports(rotor)
        self._full = matrices_of(rotor, self.structure)
        self.laws = LawsAtRest(self.structure.laws, self.structure.interfaces)
        self._set_contacts(contacts or OPEN)
        if contacts is None and self.has_contacts and not self.is_held:
            self._set_contacts(PINNED)

    def _set_contacts(self, contacts: str) -> None:
        s = self.structure
        self.contacts = contacts
        self.pinned = np.flatnonzero(s.interfaces.has_wall == 1)
        self._acts = s.interfaces.has_wall == 0
        self._lengths = np.where(self._acts, lengths_of(s), 0.0)
        self._is_curved = ~are_linear(self.rotor)
        self._follows = any(e.law.vibrate is not None for e in interfaces(self.rotor))
        full, size = self._full, len(s.weight) + len(s.housings) + 1
        pinned = self.pinned if contacts == PINNED else np.arange(0)
        held = zip(s.interfaces.dof[pinned], s.interfaces.end[pinned], strict=True)
        self._unknown = unknown = unknowns(size, held)
        self.expand = expansion(unknown)
        ends = [(dof, end) for dof, end in zip(s.interfaces.dof, s.interfaces.end, strict=True)]
        self.across = differences(size, ends)
        self._across = (self.across @ self.expand).tocsr()
        rows, columns = unknown[full.rows], unknown[full.columns]
        moving = (rows >= 0) & (columns >= 0)
        rows, columns = rows[moving], columns[moving]
        self._between = Between(self._across, rows, columns)
        places = self._between.places
        at = places.at(rows, columns)
        self._M, self._D, self._K, self._gyroscopic = (
            places.summed(at, numbers[moving])
            for numbers in (full.M, full.C, full.K, full.gyroscopic)
        )
        strained = (full.strained @ self.expand).tocsr()
        self.system = StrainedMatrices(places, strained, full.stiffness)
        self._seated = self._rigid()[:, 1] * -seat(self.rotor)
        self._is_held_at_rest = self._holds(self._linear(0.0, self._seated))
        turning = s.numbers[0].lowest_omega
        self.is_held = self._is_held_at_rest or self._holds(self.at_zero_load(turning))
        self._near: np.ndarray | None = None  # where it was at rest last
        self._begin = self._seated  # where Newton's method begins otherwise
        if not self.is_held:
            # pads that tilt, without preload, hold a journal only where it is off their middle
            self._begin = self._within_films(self._seated, self._rigid()[:, 1] * -_FAR)
            self.is_held = self._holds(self._linear(turning, self._begin))

    @property
    def has_contacts(self) -> bool:
        """Whether there is a clearance contact."""
        return len(self.pinned) > 0

    @property
    def support_dofs(self) -> np.ndarray:
        """The deflections where springs, then interfaces stand."""
        at = [2 * (e.node - 1) for e in interfaces(self.rotor)]
        return np.concatenate([self.structure.springs.dof, np.array(at, int)])

    @property
    def nodes(self) -> np.ndarray:
        """Positions of the nodes along the shaft [m]."""
        return np.array(self.rotor.nodes)

    def at(self, speed: float) -> Linear:
        """Return the machine at a speed [rad/s], linearized where gravity holds it; where nothing
        does, or all laws are linear, at no displacement. Raises `LinearError` if Newton's method
        finds no equilibrium."""
        needs_rest = (self._acts & self._is_curved).any() and self.holds_at(speed)
        return self.loaded(speed) if needs_rest else self.at_zero_load(speed)

    def at_zero_load(self, speed: float) -> Linear:
        """Return the machine at a speed [rad/s] linearized at no displacement."""
        return self._linear(speed, np.zeros(self.expand.shape[1]), abs(speed))

    def vibrating(self, linear: Linear, frequency: float) -> Linear:
        """Return the machine where it rests, the states of its laws, such as the tilts of pads,
        following a vibration of a frequency [rad/s]; those of `at` follow at that of rotation."""
        if not self._follows:
            return linear
        result = self._linear(linear.speed, linear.rest, frequency, linear.states)
        return result._replace(pull=linear.pull)

    def loaded(self, speed: float, loads: np.ndarray | None = None) -> Linear:
        """Return the machine at a speed [rad/s] linearized where gravity and `loads` hold it;
        loads: x, y of every dof, shape (2 size,) [N, N.m]."""
        if not self.holds_at(speed):
            raise LinearError(self.why_not_held())
        given = self.weight if loads is None else self.weight + loads
        force = self.expand.T @ given
        for begin in (lambda: self._near, lambda: self._begin, lambda: self._above(speed, force)):
            near = begin()
            linear = None if near is None else self._rested(speed, force, near)
            if linear is not None:
                self._near = linear.rest
                at, names = to_complex(self._across @ linear.rest), self.supports.interfaces
                check_films(self.rotor, names, speed, at, linear.laws.force, self.laws)
                return self.vibrating(linear, abs(speed))
        raise LinearError(f"no static equilibrium at {speed:g} rad/s was found")

    def _above(self, speed: float, force: np.ndarray) -> np.ndarray:
        """Return where a force holds the machine at a somewhat higher speed, from far above on: oil
        films are thicker and less curved there."""
        near = self._begin
        for times in _ABOVE:
            linear = self._rested(times * speed, force, near)
            near = near if linear is None else linear.rest
        return near

    def _rested(self, speed: float, force: np.ndarray, rest: np.ndarray) -> Linear | None:
        """Return the machine linearized where a force holds it, looked for from `rest` on by
        Newton's method; None where that finds nothing."""
        before, states, last, share = math.inf, None, np.zeros_like(rest), 1.0
        for _ in range(_ITERATIONS):
            linear = self._linear(speed, rest, 0.0, states)
            states = linear.states
            # Newton's step to where the tangents lead, not by what is left: that is small numbers
            # of large ones where the shaft is stiff
            of_laws = linear.laws.force - to_complex(self._tangent(linear.laws.by_d, rest))
            result, pull = linear.factorized()(force + self._across.T @ in_plane(of_laws))
            step = self._within_films(rest, result) - rest
            change, size = (np.abs(x).max(initial=0.0) for x in (step, rest + step))
            # to and fro where a film begins to carry, with a slope without bound: less of a step
            returns = change >= 0.5 * before and step @ last < 0.0
            share = 0.5 * share if returns else min(1.0, 1.2 * share)
            rest, last = rest + share * step, step
            if change <= _CHANGE * size or (change <= _STEADY * size and change >= 0.5 * before):
                return linear._replace(rest=rest, pull=pull)
            before = change
        return None

    def cross_coupling(self, stiffness: Mapping[int, float]) -> np.ndarray:
        """Return what F_x = -q y, F_y = q x add to K, as numbers of the system; stiffness: q [N/m]
        by node (from 1)."""
        places, x = self.system.places, self._unknown[[4 * (node - 1) for node in stiffness]]
        q, x = np.array(list(stiffness.values()))[x >= 0], x[x >= 0]
        return places.numbers(x, x + 1, q) - places.numbers(x + 1, x, q)

    def rotor_matrices(self) -> tuple[sp.csc_array, sp.csc_array, sp.csc_array]:
        """Return M, K and G of the unknowns, shape (N, N), without what the laws and the shaft's
        strain add."""
        M, K, G = (
            self.system.places.matrix(numbers) for numbers in (self._M, self._K, self._gyroscopic)
        )
        return M, K, G

    def holds_at(self, speed: float) -> bool:
        """Return whether the machine is held at a speed [rad/s]: oil films hold it if it turns."""
        return self._is_held_at_rest or (self.is_held and speed != 0.0)

    def _within_films(self, rest: np.ndarray, result: np.ndarray) -> np.ndarray:
        """Return a result of Newton's method no further from `rest` than a share of the clearance
        of each film, whose force grows without limit beyond it."""
        moved = np.abs(to_complex(self._across @ (result - rest)))
        bounded = (self._lengths > 0.0) & (moved > 0.0)
        share = np.min(_SHARE * self._lengths[bounded] / moved[bounded], initial=1.0)
        return result if share == 1.0 else rest + share * (result - rest)

    @property
    def weight(self) -> np.ndarray:
        """Gravity's force, x, y of every dof, shape (2 size,) [N, N.m]."""
        s = self.structure
        g = s.weight[0] / s.mass_sum[0]  # the housings fall as the shaft does
        m_x, m_y = interpreted(masses)(s.housings)
        return in_plane(np.concatenate([s.weight, m_x * g.real + 1j * m_y * g.imag, [0.0]]))

    def _kappa(self, speed: float) -> float:
        numbers = self.structure.numbers[0]
        return numbers.kappa_v * speed + numbers.kappa_h * math.copysign(speed != 0, speed)

    def _strain(self, speed: float) -> Strain:
        """Return the contribution of the shaft's strain."""
        numbers = self.structure.numbers[0]
        by_d = interpreted(elastic_share)(numbers.eta_h) * np.eye(2) - self._kappa(speed) * TURN
        by_v = numbers.eta_v * np.eye(2)
        return Strain(by_d, by_v, float(numbers.kappa_h), speed)

    def _linear(
        self,
        speed: float,
        at: np.ndarray,
        frequency: float = 0.0,
        states: np.ndarray | None = None,
    ) -> Linear:
        """Return the matrices linearized at the displacements `at`, what the laws' states do being
        that of a vibration of a frequency [rad/s]; states: what they were before, None: at the
        start of a run."""
        K = self._K
        D = self._D + speed * self._gyroscopic
        m = len(self._acts)
        laws = Tangents(np.zeros(m, complex), np.zeros((m, 2, 2)), np.zeros((m, 2, 2)))
        if self._acts.any():
            d = to_complex(self._across @ at)
            result = self.laws.tangents(d, speed, frequency, states=states)
            laws = Tangents(*(np.where(self._acts, t.T, 0.0).T for t in result))
            K, D = K - self._between(laws.by_d), D - self._between(laws.by_v)
        none, own = np.zeros(self.system.B.shape[0]), self.laws.states.copy()
        return Linear(speed, self.system, self._M, D, K, self._strain(speed), at, none, laws, own)

    def _tangent(self, tangents: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return the matrix of tangents by interface, x and y in turn."""
        d = (self._across @ u).reshape(-1, 2)
        return np.einsum("jab,jb->ja", tangents, d).ravel()

    def loads(
        self, linear: Linear, u: np.ndarray, pull: np.ndarray, force: np.ndarray, omega: float
    ) -> np.ndarray:
        """Return the loads on springs, then on interfaces, in x and y, shape (springs + interfaces,
        2) [N].

        The machine moves as Re(u exp(i omega t)), its elements pulling with `pull`, under `force`,
        x, y of every dof; at omega = 0 it rests.
        """
        s = self.structure
        whole = self.expand @ u
        motion = np.column_stack([whole[::2], whole[1::2]])
        factor = s.springs.stiffness + 1j * omega * s.springs.damping
        springs = factor[:, None] * motion[s.springs.dof]
        tangents = linear.laws.by_d + 1j * omega * linear.laws.by_v
        acting = -self._tangent(tangents, u).reshape(-1, 2).astype(complex)
        if omega == 0.0:
            acting = -in_plane(linear.laws.force).reshape(-1, 2).astype(complex)
        if self.contacts == PINNED and len(self.pinned):
            acting[self.pinned] = self._reactions(linear.speed, whole, pull, force, omega, acting)
        return np.concatenate([springs, acting])

    def _reactions(self, speed, whole, pull, force, omega, acting) -> np.ndarray:
        """Return the forces on the pins, which balance all others, shape (pins, 2)."""
        full = self._full
        M, D, K = (
            full.matrix(numbers) @ whole
            for numbers in (full.M, full.C + speed * full.gyroscopic, full.K)
        )
        left = force - full.strained.T @ pull - K - 1j * omega * D
        left = left + omega**2 * M - self.across.T @ acting.ravel()
        rows = np.column_stack([2 * self.pinned, 2 * self.pinned + 1]).ravel()
        across = self.across[rows].toarray().T[:-2]  # ground's rows aside
        return np.linalg.lstsq(across, left[:-2], rcond=None)[0].reshape(-1, 2)

    def _holds(self, linear: Linear) -> bool:
        """Return whether the stiffness resists every motion as a rigid body."""
        soft = _SOFT * self.structure.numbers[0].lowest_omega ** 2
        rigid = self._rigid()
        solve = self.system.factorized(linear.own_K + soft * linear.own_M, linear.strain.by_d)
        moved, _ = solve(soft * (linear.M @ rigid))
        return bool((np.abs(moved).max(axis=0) < 0.5 * np.abs(rigid).max(axis=0)).all())

    def _rigid(self) -> np.ndarray:
        """Return the shaft's motions as a rigid body: to the right, upwards, tilted in each of both
        planes; shape (unknowns, 4)."""
        nodes, size = self.nodes, self.across.shape[1] // 2
        n = 2 * len(nodes)
        motions = np.zeros((2 * size, 4))
        for plane in range(2):
            motions[plane : 2 * n : 4, plane] = 1.0
            motions[plane : 2 * n : 4, 2 + plane] = nodes - nodes.mean()
            motions[2 + plane : 2 * n : 4, 2 + plane] = 1.0
        return np.asarray(self.expand.T @ motions)

    def why_not_held(self) -> str:
        """Return one line about the supports that hold the machine and those that do not."""
        held = len(self.supports.springs) + int(self._acts.sum())
        if self.contacts == PINNED:
            held += len(self.pinned)
        if held < 2:
            return (
                f"the machine is not held: with its contacts {self.contacts} it has {held} "
                "bearings or supports, and moves as a rigid body; at least 2 nodes must be held"
            )
        result = (
            f"the machine is not held: where it is at rest, its contacts {self.contacts}, its "
            f"{held} bearings and supports have no stiffness against a motion as a rigid body"
        )
        if self.rotor.gravity == 0.0 and (self._acts & self._is_curved).any():
            result += (
                "; gravity is 0, and in the middle of its clearance a film without preload has "
                "none: give the machine gravity, or its pads preload"
            )
        return result
