"""A rotor in round hard stops: the rotor's own matrices with paper B's contact in its bearings.

The penalty law of the bearings gives way to a frictionless wall at the same clearance, so that
IMPACT=AVERAGE TIME, which is made for hard contacts, can be tried on a rotor.
Unknowns, real: x of the rotor's nodes and housings, then y; see `structure.Structure`.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.contact.wall import ContactQuantities
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.schemes.family import Scheme
from rotor_fmu.model.step.excitation import Spin, add_applied, spin_of
from rotor_fmu.model.structure import assembly

from papers.dense_machine import X, Y, clearance_contacts, contact_picks, in_plane, rest

from .stepping.contacts import RoundStops
from .stepping.failures import ImpactError
from .stepping.march import Run, march
from .stepping.stepper import Instant, Stepper
from .stepping.structure import Solver

# Stiffness [N/m] that puts a journal at rest on its wall but for the rounding errors.
_RIGID = 1e13
# A journal that crosses its clearance within so many increments is carried by the integrator.
_CROSSING = 2


@dataclass(frozen=True)
class RunDown:
    """A rotor whose speed falls linearly from `speed` [rad/s] by `rate` [rad/s2]."""

    rotor: Rotor
    speed: float
    rate: float

    def spin(self, t: float) -> Spin:
        """Rotation at time t [s]."""
        omega = self.speed + self.rate * t
        return spin_of(omega, self.rate, t * (self.speed + 0.5 * self.rate * t))


class JournalStructure:
    """See `structure.Structure`; the matrices change with the speed of rotation."""

    is_constant = False

    def __init__(self, run_down: RunDown) -> None:
        self._run_down = run_down
        # the housings' springs and dampers stay, their contact becomes a wall
        machine = assembly.assemble(run_down.rotor)
        self._machine = machine
        numbers = machine.numbers[0]
        if numbers.kappa_v or numbers.kappa_h:
            raise ImpactError("rotating internal damping: not with hard stops; set it to false")
        clearance = clearance_contacts(machine).clearance.copy()
        if not len(clearance):
            raise ImpactError("bearing: none given, at least 1 is needed to be a hard stop")
        if not run_down.rotor.discs:
            raise ImpactError("disc: none given, at least 1 is needed, whose motion is shown")
        picks = contact_picks(machine)
        n, self.size = len(machine.static_load), picks.shape[1]
        size = self.size
        planes = zip(in_plane(machine, X), in_plane(machine, Y), strict=True)
        self._M, self._C, self._K = (_both_planes(x, y) for x, y in planes)
        self._G = np.zeros((2 * size, 2 * size))
        self._G[:n, size : size + n] = to_dense(machine.G)
        self._G[size : size + n, :n] = -to_dense(machine.G)
        self._weight = np.zeros(2 * size)
        self._weight[size + n :] = -machine.housings.mass * numbers.gravity
        B = np.zeros((2 * size, 2 * len(picks)))
        B[:size, ::2] = B[size:, 1::2] = picks.T
        self.contacts = RoundStops(B, clearance, np.zeros(len(picks)))
        weight = float(np.abs(machine.static_load.imag).sum())
        self.energy_scale = weight * float(clearance.max())

    def load(self, t: float) -> np.ndarray:
        """See `structure.Structure`: weight and unbalance."""
        machine = self._machine
        n = len(machine.static_load)
        applied = np.zeros(n, dtype=complex)
        none = np.zeros(len(machine.load_dof), dtype=complex)
        add_applied(machine, self._run_down.spin(t), none, applied)
        f = self._weight.copy()
        f[:n] += applied.real
        f[self.size : self.size + n] += applied.imag
        return f

    def inertia(self, a: np.ndarray) -> np.ndarray:
        """See `structure.Structure`."""
        return self._M @ a

    def internal(self, q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        """See `structure.Structure`; gyroscopic terms included."""
        spin = self._run_down.spin(t)
        turned = spin.omega * v + 0.5 * spin.alpha * q
        return self._C @ v + self._K @ q + self._G @ turned

    def step_solver(self, m: float, c: float, k: float, t: float) -> Solver:
        """See `structure.Structure`."""
        spin = self._run_down.spin(t)
        turning = c * spin.omega + 0.5 * k * spin.alpha
        return _factorized(m * self._M + c * self._C + k * self._K + turning * self._G)

    def mass_solver(self) -> Solver:
        """See `structure.Structure`."""
        return _factorized(self._M)

    def energy(self, q: np.ndarray, v: np.ndarray) -> float:
        """Kinetic energy of the vibration, elastic energy and potential of the weight [J]."""
        weight = self._weight.copy()
        weight[self.size : self.size + len(self._machine.static_load)] += (
            self._machine.static_load.imag
        )
        return float(0.5 * (v @ self._M @ v + q @ self._K @ q) - weight @ q)

    def at_rest(self) -> np.ndarray:
        """Displacements at rest under the weight, journals on the bottom of their stops."""
        rotor = self._run_down.rotor
        contacts = [w for w, p in rotor.named_parts() if isinstance(p, ContactQuantities)]
        still = rest(rotor.with_values({f"{where}.k": _RIGID for where in contacts}))[:-1]
        return np.r_[still.real, still.imag]

    @property
    def last_disc(self) -> tuple[int, int]:
        """Unknowns of the last disc's displacement, x and y."""
        dof = 2 * (self._run_down.rotor.discs[-1].node - 1)
        return dof, self.size + dof


def _both_planes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    size = len(x)
    full = np.zeros((2 * size, 2 * size))
    full[:size, :size], full[size:, size:] = x, y
    return full


def _factorized(matrix: np.ndarray) -> Solver:
    # its few unknowns are not worth the threads that a triangular solution would start
    inverse = np.linalg.inv(matrix)
    return lambda right: inverse @ right


@dataclass(frozen=True)
class JournalRun:
    """A run of a rotor in hard stops; run.seen has x and y of the last disc, then x and y of each
    journal relative to its housing [m]."""

    run_down: RunDown
    run: Run

    @property
    def t(self) -> np.ndarray:
        """Times [s], one an increment, the start first."""
        return self.run.t

    @property
    def disc(self) -> np.ndarray:
        """Displacement of the last disc [m], shape (k, 2)."""
        return self.run.seen[:, :2]

    @property
    def impacts(self) -> int:
        """How often a journal came to touch its wall."""
        touches = self.run.force > 0
        return int((touches[1:] & ~touches[:-1]).sum())

    @property
    def crossings(self) -> int:
        """How often a journal touched one side of its clearance and, at most two increments later,
        the opposite side."""
        count = 0
        for j in range(self.run.force.shape[1]):
            at = np.flatnonzero(self.run.force[:, j] > 0)
            p = self.run.seen[at, 2 + 2 * j : 4 + 2 * j]
            opposite = (p[1:] * p[:-1]).sum(axis=1) < -0.5 * (p[1:] ** 2).sum(axis=1)
            count += int((opposite & (np.diff(at) <= _CROSSING)).sum())
        return count


def run_journals(
    run_down: RunDown,
    scheme: Scheme,
    dt: float,
    impact: str = "no",
    t_end: float = 1.0,
    cap: int = 100_000,
    progress: Callable[[float], None] = lambda t: None,
) -> JournalRun:
    """Turn a rotor in hard stops from rest; dt, t_end [s]; see `march` for the rest."""
    structure = JournalStructure(run_down)
    q = structure.at_rest()
    start = Stepper(structure, scheme).start(0.0, q, np.zeros_like(q))
    disc, B = list(structure.last_disc), structure.contacts.B

    def observe(motion: Instant) -> tuple[float, ...]:
        return (*motion.q[disc], *(B.T @ motion.q))

    run = march(structure, scheme, start, dt, t_end, impact, observe, cap, progress)
    return JournalRun(run_down, run)
