"""The machine linearized at any place and speed, as sparse real matrices.

The unknowns are x, y in turn of every deflection and slope of the shaft, then of the housings:

    M u'' + D u' + K u = f,   D = C + Omega G - dF/dd',   K = K_shaft + springs + kappa K_c - dF/dd

in motions slower than the rotation; in faster ones hysteresis is another (`system_at_speed`).
A clearance contact is open (as if it were not there), or pinned (the journal moves as its housing
does). The laws of all other interfaces are linearized at the place given.
"""

import math
from collections.abc import Mapping

import numpy as np
import scipy.sparse as sp

from ..arguments import check_one_of
from ..kernels.kernel import interpreted
from ..laws_at_rest.oil import machine_with_oil
from ..laws_at_rest.tangents import LawsAtRest, Tangents
from ..machine.rotor import Rotor
from ..parts.housing import masses
from ..structure.assembly import assemble
from ..structure.parameters import elastic_share, lengths_of
from ..structure.strain_solver import StrainedMatrices
from .own_states import OwnStates
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
from .supports import are_linear, interfaces, not_held, rigid_motions, seat, supports, unsprung
from .system_at_speed import Linear, LinearError, Strain

OPEN, PINNED = "open", "pinned"
CONTACTS = (OPEN, PINNED)
_SOFT = 1e-7  # of the lowest elastic frequency, squared: what is softer is not held
_SHARE = 0.2  # of a film's clearance, that a step of Newton's method moves its journal
_FAR = 1e9  # what is more than any displacement [m]
_WAYS = (1, 1j, -1, -1j)  # right, up, left, down


def check_contacts(contacts: object) -> None:
    """Raise `LinearError` for a word about contacts, which may be None, that is not known."""
    if contacts is not None:
        check_one_of(f"contacts = {contacts}", contacts, CONTACTS, LinearError)


class Linearization:
    """A machine's matrices, linearized wherever it may be.

    contacts: `open` or `pinned`; None: open where the machine is held without its contacts, else
    pinned. Raises `LinearError` for another word. full: matrices of every dof; system: where those
    of its unknowns have numbers, with the shaft's strain; elastic: Z of that without damping.
    """

    def __init__(self, rotor: Rotor, contacts: str | None = None) -> None:
        check_contacts(contacts)
        self.rotor = rotor = machine_with_oil(rotor)
        self.structure = assemble(rotor)
        # to read them of a record takes longer than all that is done with them at a speed
        numbers = self.structure.numbers[0]
        self._kappa_v, self._kappa_h = float(numbers.kappa_v), float(numbers.kappa_h)
        self.elastic = interpreted(elastic_share)(numbers.eta_h) * np.eye(2)
        self._viscous = numbers.eta_v * np.eye(2)
        self._soft = float(_SOFT * numbers.lowest_omega**2)  # what of the masses is no stiffness
        self.supports = supports(rotor)
        self.full = matrices_of(rotor, self.structure)
        self.laws = LawsAtRest(self.structure.laws, self.structure.interfaces)
        self._set_contacts(contacts or OPEN)
        if contacts is None and self.has_contacts and not self.is_held:
            self._set_contacts(PINNED)

    def _set_contacts(self, contacts: str) -> None:
        s = self.structure
        self.contacts = contacts
        self.pinned = np.flatnonzero(s.interfaces.has_wall == 1)
        self._acts = s.interfaces.has_wall == 0
        self._fall = seat(self.rotor)
        falls = np.array([e.law.seat is not None for e in interfaces(self.rotor)], bool)
        self._lengths = np.where(self._acts, np.where(falls, self._fall, lengths_of(s)), 0.0)
        self._is_curved = ~are_linear(self.rotor)
        full, size = self.full, len(s.static_load) + len(s.housings) + 1
        pinned = self.pinned if contacts == PINNED else np.arange(0)
        held = zip(s.interfaces.dof[pinned], s.interfaces.end[pinned], strict=True)
        self._unknown = unknown = unknowns(size, held)
        self.expand = expansion(unknown)
        self.across = differences(size, list(zip(s.interfaces.dof, s.interfaces.end, strict=True)))
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
        self._is_held_at_rest = self._holds(self.at_zero_load(0.0))
        # elements that bear a load may be few, but there are others wherever it falls
        self._is_held_loaded = self._is_held_at_rest or (
            self._fall > 0.0
            and self._holds(*(self.linearized(0.0, self._moved(way, self._fall)) for way in _WAYS))
        )
        turning = s.numbers[0].lowest_omega
        self._is_held_turning = self._is_held_at_rest or self._holds(self.at_zero_load(turning))
        # pads that tilt, without preload, hold a journal only where it is off their middle
        if not (self._is_held_loaded or self._is_held_turning):
            fallen = [(self._moved(way, self._fall), self._moved(way, _FAR)) for way in _WAYS]
            off = (self.linearized(turning, self.within_films(*places)) for places in fallen)
            self._is_held_turning = self._holds(*off)
        self.is_held = self._is_held_loaded or self._is_held_turning

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

    def at_zero_load(self, speed: float) -> Linear:
        """Return the machine at a speed [rad/s] linearized at no displacement."""
        return self.linearized(speed, np.zeros(self.expand.shape[1]), abs(speed))

    def vibrating(self, linear: Linear, frequency: float) -> Linear:
        """Return the machine where it rests, the states of its laws, such as the tilts of pads,
        following a vibration of a frequency [rad/s]; those of `LinearMachine.at` follow at that of
        rotation."""
        if not (self.laws.follows | self.laws.whirls).any():
            return linear
        result = self.linearized(linear.speed, linear.rest, frequency, linear.states)
        return result._replace(pull=linear.pull)

    def with_own_states(self, linear: Linear, *, of_all: bool = False) -> Linear:
        """Return the machine where it rests, states that whirl by themselves (`Law.whirls`) being
        unknowns; of_all: those that else follow a vibration, such as tilts of pads, too."""
        free = self.laws.whirls | self.laws.follows if of_all else self.laws.whirls
        if not free.any():
            return linear
        d, laws = to_complex(self._across @ linear.rest), linear.laws
        stayed, own = self.laws.linearized(d, linear.speed, linear.states, free)
        numbers = (linear.own_K, laws.by_d, stayed.by_d), (linear.own_D, laws.by_v, stayed.by_v)
        K, D = (A + self._between(free[:, None, None] * (b - c)) for A, b, c in numbers)
        states = OwnStates(self._across, self._between, own)
        return linear._replace(own_K=K, own_D=D, own_states=states)

    def _moved(self, way: complex, far: float) -> np.ndarray:
        """Return the machine moved as one body in a direction, so far [m]."""
        return self._rigid()[:, :2] @ np.array([far * way.real, far * way.imag])

    def cross_coupling(self, stiffness: Mapping[int, float]) -> np.ndarray:
        """Return what F_x = -q y, F_y = q x add to K, as numbers of the system; stiffness: q [N/m]
        by node (from 1)."""
        places, x = self.system.places, self._unknown[[4 * (node - 1) for node in stiffness]]
        q, x = np.array(list(stiffness.values()))[x >= 0], x[x >= 0]
        return places.numbers(x, x + 1, q) - places.numbers(x + 1, x, q)

    def rotor_matrices(self) -> tuple[sp.csc_array, sp.csc_array, sp.csc_array]:
        """Return M, K and G of the unknowns, shape (N, N), without laws and the shaft's strain."""
        matrix = self.system.places.matrix
        return matrix(self._M), matrix(self._K), matrix(self._gyroscopic)

    def holds_at(self, speed: float) -> bool:
        """Return whether the machine is held at a speed [rad/s]: oil films hold it if it turns."""
        return self._holds_at(speed, self.static_load)

    def _holds_at(self, speed: float, force: np.ndarray) -> bool:
        """Return whether it is held under a force: in the middle of its clearance no element of a
        rolling bearing bears."""
        held = self._is_held_loaded if force.any() else self._is_held_at_rest
        return held or (self._is_held_turning and speed != 0.0)

    def within_films(self, rest: np.ndarray, result: np.ndarray) -> np.ndarray:
        """Return a result of Newton's method no further from `rest` than a share of the clearance
        of each film, whose force grows without limit beyond it."""
        moved = np.abs(to_complex(self._across @ (result - rest)))
        bounded = (self._lengths > 0.0) & (moved > 0.0)
        share = np.min(_SHARE * self._lengths[bounded] / moved[bounded], initial=1.0)
        return result if share == 1.0 else rest + share * (result - rest)

    @property
    def static_load(self) -> np.ndarray:
        """Gravity and constant forces, x, y of every dof, shape (2 size,) [N, N.m]."""
        g = self.rotor.gravity * self.rotor.down
        return in_plane(self._on_all(self.structure.static_load, g))

    @property
    def base_load(self) -> np.ndarray:
        """Forces on x, y of every dof by an acceleration of the base in x and in y, shape
        (2, 2 size) [kg, kg.m]: of all that moves, its displacements being relative to the base."""
        masses_of_dofs = self.structure.mass_sum
        return -in_plane(np.array([self._on_all(masses_of_dofs * to, to) for to in (1.0, 1j)]))

    def _on_all(self, on_shaft: np.ndarray, acceleration: complex) -> np.ndarray:
        """Return forces on the shaft's dofs, and on the housings by an acceleration [m/s2]."""
        m_x, m_y = interpreted(masses)(self.structure.housings)
        of_housings = m_x * acceleration.real + 1j * m_y * acceleration.imag
        return np.concatenate([on_shaft, of_housings, [0.0]])

    def linearized(
        self, speed: float, at: np.ndarray, frequency: float = 0.0, states: np.ndarray | None = None
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
        kappa = self._kappa_v * speed + self._kappa_h * math.copysign(speed != 0, speed)
        strain = Strain(self.elastic - kappa * TURN, self._viscous, self._kappa_h, speed)
        none, own = np.zeros(self.system.B.shape[0]), self.laws.states.copy()
        return Linear(speed, self.system, self._M, D, K, strain, at, none, laws, own)

    def tangent(self, tangents: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return tangents by interface, shape (interfaces, 2, 2), times what displacements of the
        unknowns are across each, x and y in turn, shape (2 interfaces,)."""
        d = (self._across @ u).reshape(-1, 2)
        return np.einsum("jab,jb->ja", tangents, d).ravel()

    def _holds(self, *places: Linear) -> bool:
        """Return whether the stiffness, the mean of these places, resists every rigid motion."""
        linear, soft, rigid = places[0], self._soft, self._rigid()
        own_K = sum(place.own_K for place in places) / len(places)
        solve = self.system.factorized(own_K + soft * linear.own_M, linear.strain.by_d)
        moved, _ = solve(soft * (linear.M @ rigid))
        return bool((np.abs(moved).max(axis=0) < 0.5 * np.abs(rigid).max(axis=0)).all())

    def _rigid(self) -> np.ndarray:
        """Return `rigid_motions` of the unknowns, shape (unknowns, 4)."""
        return np.asarray(self.expand.T @ rigid_motions(self.nodes, self.across.shape[1] // 2))

    def why_not_held(self) -> str:
        """Return one line about the supports that hold the machine and those that do not."""
        held = len(self.supports.springs) + int(self._acts.sum())
        held += len(self.pinned) if self.contacts == PINNED else 0
        is_unpressed = not self.static_load.any() and (self._acts & self._is_curved).any()
        gravity = self.rotor.gravity if is_unpressed else None
        return not_held(self.contacts, held, gravity, unsprung(self.rotor))
