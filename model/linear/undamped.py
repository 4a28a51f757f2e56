"""The undamped machine on isotropic bearings of any stiffness, its seals left out.

A linear bearing whose stiffness is negative, such as the magnetic pull of a motor, holds nothing:
it keeps its own stiffness.

A motion u exp(i Omega t) of it at the speed Omega satisfies

    K u = Omega^2 (M - i G) u,    with the gyroscopic matrix G of Omega G u',

so that all its synchronous critical speeds come from one eigenvalue problem, without iteration;
without G it gives the natural frequencies at standstill.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from ..contact.wall import ContactQuantities
from ..machine.rotor import Rotor
from ..parts.base import GROUND, InterfaceElement, Part, SpringElement
from ..parts.linear_bearing import LinearBearing, Seal
from ..structure.strain_solver import Solve, StrainedMatrices
from ..structure.structure import total_mass
from .linear_machine import LinearError, LinearMachine, shared_machine
from .linearization import OPEN, PINNED, check_contacts
from .orbit import AT_REST, lengths_of_nodes
from .real_matrices import Between, differences, x_and_y
from .support_loads import support_loads

_REAL = 1e-6  # share of an eigenvalue below which its imaginary part is rounding
_APART = 1e-9  # of a matrix: what is smaller is rounding, and couples nothing
# motion of x and y: forward circles, and in either plane
_FORWARD = np.array([1.0, -1j]) / np.sqrt(2.0)
_ACROSS, _UP = np.array([1.0, 0.0]), np.array([0.0, 1.0])
_RIGID = 1e8  # of the rotor's mass times its lowest frequency squared
_DENSE = 100  # unknowns of a plane up to which all eigenvalues cost less than a few
_RESTARTS = 60  # of Arnoldi's method: thin discs take about ten, all eigenvalues cost a hundred
_SOFT = 1e-14  # of that: of a bearing that has no stiffness, so that shapes are those without it


class Synchronous(NamedTuple):
    """Synchronous modes with a stiffness of all bearings [N/m], ascending: critical speeds [rad/s]
    and forwardness (see `Modes`), shape (m,); shapes by the unknowns, (N, m), and their modal
    masses."""

    stiffness: float
    speeds: np.ndarray
    forwardness: np.ndarray
    shapes: np.ndarray
    norms: np.ndarray


class UndampedMachine:
    """The undamped machine, whose bearings have any stiffness.

    contacts: `open` or `pinned`, where clearance contacts are bearings too; None: open where the
    machine is held without them; rigid_pedestals: whether housings are taken as ground. Raises
    `LinearError` where there is no bearing. mass: the mass matrix of the unknowns, sparse.
    """

    def __init__(self, rotor: Rotor, contacts: str | None, rigid_pedestals: bool) -> None:
        check_contacts(contacts)
        self.contacts = contacts or shared_machine(rotor).contacts
        bare = without_seals(rotor)
        self._loaded = machine = shared_machine(bare, self.contacts)
        if self.contacts != OPEN:
            machine = shared_machine(bare, OPEN)
        named = bearings_of(bare, self.contacts)
        names = (*machine.supports.springs, *machine.supports.interfaces)
        held = [i for i, name in enumerate(names) if name in named]
        pulls = {where: pull for where, part in bare.named_parts() if (pull := pull_of(part))}
        if not (held or pulls):
            raise LinearError("the machine has no bearing: add one that holds the shaft")
        self.bearings = {names[i]: named[names[i]] for i in held}
        pulling = [i for i, name in enumerate(names) if name in pulls]
        self._pulls = np.array([pulls[names[i]] for i in pulling])
        self._held = np.array(held + pulling)
        self.own_stiffness = cache(self._own_stiffness)
        self._set_matrices(machine, rigid_pedestals)
        mass = total_mass(machine.structure)
        self.rigid_stiffness = _RIGID * mass * float(machine.structure.numbers[0].lowest_omega) ** 2
        self._nodes, self._lengths = len(rotor.nodes), lengths_of_nodes(np.array(rotor.nodes))

    def _set_matrices(self, machine: LinearMachine, rigid_pedestals: bool) -> None:
        """Set the matrices of the unknowns, without housings where these are ground; K without
        springs to ground, and apart from what the shaft's strain adds to it."""
        s = machine.structure
        ground = machine.expand.shape[0] // 2 - 1
        n = 2 * len(s.static_load) if rigid_pedestals else machine.expand.shape[1]
        of_springs = [(dof, ground) for dof in s.springs.dof]
        of_interfaces = [
            (dof, ground if rigid_pedestals else end % (ground + 1))
            for dof, end in zip(s.interfaces.dof, s.interfaces.end, strict=True)
        ]
        across = (differences(ground + 1, of_springs + of_interfaces) @ machine.expand)[:, :n]
        M, K, gyroscopic = (matrix[:n, :n] for matrix in machine.rotor_matrices())
        if len(of_springs):
            springs = across[: 2 * len(of_springs)]
            own = sp.diags_array(np.repeat(s.springs.stiffness, 2))
            K = K - springs.T @ own @ springs
        K = K.tocoo()
        rows = x_and_y(self._held)
        self._between = Between(across[rows], K.row, K.col)
        self._pulled = across[rows[2 * len(self.bearings) :]]
        places = self._between.places
        self.mass, self._gyroscopic = M, gyroscopic
        self._K = places.numbers(K.row, K.col, K.data)
        self._elastic = machine.elastic
        self._system = StrainedMatrices(places, machine.system.B[:, :n], machine.system.stiffness)

    def is_held(self, stiffness: float) -> bool:
        """Return whether bearings of this stiffness [N/m] hold the machine against what pulls."""
        if not len(self._pulls) or not self.bearings:
            return bool(self.bearings)
        pulled = self._pulled.toarray()
        try:
            yields = pulled @ self._solver(stiffness, 0.0)(pulled.T)[0]
        except LinearError:  # not even without what pulls
            return False
        share = np.sqrt(np.repeat(-self._pulls, 2))
        return bool(np.linalg.eigvalsh(share[:, None] * yields * share).max() < 1.0)

    @property
    def is_circular(self) -> bool:
        """Whether all modes are circles: no pedestal differs in x and y."""
        if not self._is_long:
            return _half(self._synchronous(self.rigid_stiffness), _FORWARD)[1]
        motion = np.outer(_some(self.mass.shape[0] // 2), _FORWARD).ravel()
        moved = self._moving(self.rigid_stiffness)(motion).reshape(-1, 2)
        within, beside = moved @ _FORWARD.conj(), moved @ _FORWARD
        return bool(np.abs(beside).max() < _APART * np.abs(within).max())

    def forward_criticals(self, stiffness: float, count: int) -> np.ndarray:
        """Return the `count` lowest forward critical speeds, fewer where there are fewer, ascending
        [rad/s], with this stiffness of all bearings [N/m], of a machine whose modes are circles."""
        found = self._along(_FORWARD, self._moving(stiffness), count) if self._is_long else None
        if found is None:
            found = _solve(_half(self._synchronous(stiffness), _FORWARD)[0], 2 * self._nodes)
        return found[0][:count]

    def _along(
        self, motion: np.ndarray, move: Callable[[np.ndarray], np.ndarray], count: int
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Return `_lowest` for motion along (x, y) = `motion` at every dof."""

        def along(w: np.ndarray) -> np.ndarray:
            moved = move(np.outer(w, motion).ravel())
            return np.asarray(moved.reshape(-1, 2) @ motion.conj())

        return _lowest(along, self.mass.shape[0] // 2, 2 * self._nodes, count)

    def synchronous(self, stiffness: float, count: int) -> Synchronous:
        """Return the `count` lowest synchronous modes, or more, with this stiffness of all bearings
        [N/m], whichever way they whirl."""
        found, nodes = None, 4 * self._nodes
        if self._is_long:
            found = _lowest(self._moving(stiffness), self.mass.shape[0], nodes, count)
        speeds, shapes = found or _solve(self._synchronous(stiffness), nodes)
        x, y = (shapes[axis:nodes:4] for axis in (0, 1))
        turning, against = (self._lengths @ np.abs(x + s * 1j * y) ** 2 for s in (1, -1))
        norms = np.sum(shapes.conj() * (self.mass @ shapes), axis=0).real
        forwardness = (turning - against) / (turning + against)
        return Synchronous(stiffness, speeds, forwardness, shapes, norms)

    @property
    def _is_long(self) -> bool:
        return bool(self.mass.shape[0] // 2 > _DENSE)

    def _synchronous(self, stiffness: float) -> np.ndarray:
        """Return K^-1 (M - i G)."""
        return self._inverse(stiffness, self.mass.toarray() - 1j * self._gyroscopic.toarray())

    def _moving(self, stiffness: float, turns: float = 1.0) -> Callable[[np.ndarray], np.ndarray]:
        """Return the function that applies K^-1 (M - i G) to a motion, turns = 0: K^-1 M."""
        solve, mass = self._solver(stiffness), (self.mass - 1j * turns * self._gyroscopic).tocsr()

        def move(motion: np.ndarray) -> np.ndarray:
            force = mass @ motion
            return solve(force.real)[0] + 1j * solve(force.imag)[0]

        return move

    def natural_frequencies(self, stiffness: float, count: int) -> np.ndarray:
        """Return the `count` lowest natural frequencies at standstill, or more, fewer where there
        are fewer, ascending [rad/s], with this stiffness of all bearings [N/m]; of two planes that
        are alike those of one."""
        if self._is_long:
            planes, move = [_ACROSS, _UP][: 2 - self.is_circular], self._moving(stiffness, 0.0)
            found = [each for plane in planes if (each := self._along(plane, move, count))]
            if len(found) == len(planes):
                return np.sort(np.concatenate([speeds for speeds, _ in found]))
        inverse = self._inverse(stiffness, self.mass.toarray().astype(complex))
        across, up = (
            _solve(_half(inverse, plane)[0], 2 * self._nodes)[0] for plane in (_ACROSS, _UP)
        )
        # what is found are inverse squares: those of high frequencies are rounding of the largest
        least = _APART * np.max(up**-2, initial=0.0)
        if len(across) == len(up) and np.allclose(across**-2, up**-2, rtol=0.0, atol=least):
            return across
        return np.sort(np.concatenate([across, up]))

    def _own_stiffness(self, speed: float) -> np.ndarray:
        """Return the direct stiffness in x and y of each bearing [N/m] where gravity holds the
        machine at a speed [rad/s], shape (bearings, 2); of a pinned contact that of the wall under
        its load there. NaN where nothing is found that holds it."""
        try:
            by_d = self._loaded.at(speed).laws.by_d
            interfaces = -np.diagonal(by_d, axis1=1, axis2=2)
            # of a film that nothing loads the cross coupling alone is more than rounding
            least = _APART * np.abs(by_d).max(axis=(1, 2), initial=0.0)[:, None]
            interfaces = np.where(np.abs(interfaces) > least, interfaces, 0.0)
        except LinearError:
            interfaces = np.full((len(self._loaded.supports.interfaces), 2), np.nan)
        springs = self._loaded.structure.springs.stiffness
        result = np.concatenate([np.column_stack([springs, springs]), interfaces])
        result = result[self._held[: len(self.bearings)]]
        for i, part in enumerate(self.bearings.values()):
            if isinstance(part, ContactQuantities):
                result[i] = part.k if part.exponent == 1.0 else self._wall(i, part, speed)
        return result

    def _wall(self, i: int, part: ContactQuantities, speed: float) -> float:
        """Return the slope of the elastic force of bearing i, a wall, under its load [N/m]."""
        machine, m = self._loaded, part.exponent
        try:
            linear = machine.loaded(speed)
        except LinearError:
            return np.nan
        loads = support_loads(machine, linear, machine.static_load)
        load = float(np.linalg.norm(loads[self._held[i]]))
        return float(m * part.k ** (1.0 / m) * load ** (1.0 - 1.0 / m))

    def planar_shapes(self, speed: float) -> np.ndarray:
        """Return deflections and slopes of the modes at standstill along the nodes, the largest
        deflection 1, by ascending frequency, shape (m, n, 2) [1, 1/m]; with the mean of both direct
        stiffnesses that each bearing has at a speed [rad/s]."""
        own = np.minimum(self.own_stiffness(speed).mean(axis=1), self.rigid_stiffness)
        own[own == 0.0] = _SOFT * self.rigid_stiffness
        inverse = self._inverse(own, self.mass.toarray().astype(complex))
        _, shapes = _solve(_half(inverse, _ACROSS)[0], 2 * self._nodes)
        both = shapes[: 2 * self._nodes].T.reshape(-1, self._nodes, 2)
        return np.array([(s / s[np.argmax(np.abs(s[:, 0])), 0]).real for s in both])

    def _inverse(self, stiffness: float | np.ndarray, mass: np.ndarray) -> np.ndarray:
        """Return K^-1 times a mass matrix, with the stiffness in x and y of each bearing [N/m]."""
        solve = self._solver(stiffness)
        return solve(mass.real)[0] + 1j * solve(mass.imag)[0]

    def _solver(self, stiffness: float | np.ndarray, pulling: float = 1.0) -> Solve:
        """Return the solver with K, with the stiffness in x and y of each bearing [N/m], and that
        share of what pulls; `LinearError` where nothing holds the machine."""
        own = np.append(np.broadcast_to(stiffness, len(self.bearings)), pulling * self._pulls)
        each = own[:, None, None] * np.eye(2)
        try:
            return self._system.factorized(self._K + self._between(each), self._elastic)
        except RuntimeError as error:
            raise LinearError("the machine is not held by its bearings") from error


def _half(matrix: np.ndarray, motion: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return the part of a matrix for motion along (x, y) = `motion` at every dof, and whether it
    leads to no other motion."""
    size = len(matrix) // 2
    blocks = matrix.reshape(size, 2, size, 2)
    other = np.array([-motion[1].conj(), motion[0].conj()])
    within, beside = (np.einsum("a,iajb,b->ij", m.conj(), blocks, motion) for m in (motion, other))
    return within, bool(np.abs(beside).max() < _APART * np.abs(within).max())


def _some(size: int) -> np.ndarray:
    """Return a motion in which there is something of every mode."""
    return np.random.default_rng(1).standard_normal(size)


def _lowest(
    move: Callable[[np.ndarray], np.ndarray], size: int, nodes: int, count: int
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return `_solve` of the matrix that a function applies, at least the `count` lowest; None
    where all eigenvalues have to be computed for that."""
    operator = LinearOperator((size, size), move, dtype=complex)
    wanted = 2 * count + 4
    while wanted < size // 3:
        try:
            values, shapes = eigs(operator, wanted, v0=_some(size), which="LR", maxiter=_RESTARTS)
        except ArpackNoConvergence:
            break
        found = _criticals(values, shapes, nodes)
        if len(found[0]) >= count:
            return found
        wanted *= 2
    return None


def _solve(inverse: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, ascending [rad/s], and shapes of K^-1 M; nodes: their unknowns, which are
    the first: a mode in which they rest is of housings alone, and none of the rotor."""
    values, shapes = scipy.linalg.eig(inverse)
    return _criticals(values, shapes, nodes)


def _criticals(values: np.ndarray, shapes: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    moves = np.abs(shapes[:nodes]).max(axis=0) > AT_REST * np.abs(shapes).max(axis=0)
    is_critical = moves & (values.real > 0) & (np.abs(values.imag) < _REAL * np.abs(values))
    speeds = values.real[is_critical] ** -0.5
    order = np.argsort(speeds)
    return speeds[order], shapes[:, is_critical][:, order]


def bearings_of(rotor: Rotor, contacts: str) -> dict[str, Part]:
    """Return the parts that support the shaft of a machine without seals, by their names."""
    supports = [where for where, _ in rotor.elements_of_kind(SpringElement)]
    for where, interface in rotor.elements_of_kind(InterfaceElement):
        if contacts == PINNED if interface.law.has_wall else interface.ring == GROUND:
            supports.append(where)
    parts = {where: part for where, part in rotor.named_parts() if where in supports}
    return {where: part for where, part in parts.items() if not pull_of(part)}


def pull_of(part: Part) -> float:
    """Return the mean stiffness of a linear bearing that pulls the shaft outwards at all its speeds
    [N/m], which is negative; 0 of any other part."""
    if not isinstance(part, LinearBearing):
        return 0.0
    stiffness = np.add(part.kxx, part.kyy) / 2
    return float(stiffness.mean()) if (stiffness < 0.0).all() else 0.0


def without_seals(rotor: Rotor) -> Rotor:
    """Return the machine without its seals."""
    return replace(rotor, parts=tuple(p for p in rotor.parts if not isinstance(p, Seal)))
