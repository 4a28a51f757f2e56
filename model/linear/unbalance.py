"""Steady response to unbalance: the harmonic problem solved exactly, anisotropic bearings included.

An unbalance U = m e exp(i phase) pulls with U Omega^2 exp(i Omega t) in x + i y, so that the real
equations have the complex amplitudes Omega^2 U in x, -i Omega^2 U in y; a residual bow pulls in the
same way with the shaft's stiffness, whatever the speed (Nicholas, Gunter and Allaire 1976):

    (K + i Omega D - Omega^2 M) u = f,   u(t) = Re(u exp(i Omega t))
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, lru_cache, partial
from typing import NamedTuple

import numpy as np

from ..arguments import numbers, rows
from ..kernels.kernel import interpreted
from ..machine.rotor import Rotor
from ..structure.parameters import elastic_share
from ..structure.structure import Structure
from . import orbit
from .linear_machine import shared_machine
from .linearization import check_contacts
from .modes import checked_speed
from .places import AnyPlace, Place, PlacedAmount, as_place
from .real_matrices import to_complex
from .static import check_node
from .support_loads import support_loads
from .system_at_speed import LinearError

_ROUNDING = 1e-14  # of unbalances at a node: a smaller sum of them is none
_CREEPING = 1e-4  # of the lowest elastic frequency: a speed whose response is that of all below


@dataclass(frozen=True)
class UnbalanceResponse:
    """Steady whirl at s speeds [rad/s] of n nodes: complex amplitudes, x(t) = Re(x exp(i Omega t)),
    whose angles are measured from the shaft's mark.

    contacts: `open` or `pinned`; z: positions of the nodes [m]; x, y: shape (s, n) [m]; housings:
    names, housing_x, housing_y, shape (s, housings) [m]; supports: names of the supports; load_x,
    load_y: the load on each, shape (s, supports) [N]; peaks: speeds at which the orbits of nodes
    (from 1) peak, where these were looked for [rad/s]. Where nothing damps a peak amplitudes are
    infinite there.
    """

    speeds: np.ndarray
    contacts: str
    z: np.ndarray
    x: np.ndarray
    y: np.ndarray
    housings: tuple[str, ...]
    housing_x: np.ndarray
    housing_y: np.ndarray
    supports: tuple[str, ...]
    load_x: np.ndarray
    load_y: np.ndarray
    peaks: Mapping[int, tuple[float, ...]] = field(default_factory=dict)

    @property
    def forward(self) -> np.ndarray:
        """Forward whirl component, complex of shape (s, n) [m]."""
        return orbit.forward_part(self.x, self.y)

    @property
    def backward(self) -> np.ndarray:
        """Backward whirl component, complex of shape (s, n) [m]."""
        return orbit.backward_part(self.x, self.y)

    @property
    def major(self) -> np.ndarray:
        """Major semi-axes of the orbits, shape (s, n) [m]."""
        return orbit.semi_axes(self.x, self.y)[0]

    @property
    def minor(self) -> np.ndarray:
        """Minor semi-axes, negative where a node whirls backward, shape (s, n) [m]."""
        return orbit.semi_axes(self.x, self.y)[1]

    @property
    def phase_x(self) -> np.ndarray:
        """Angle by which x leads the shaft's mark, a lag always negative, shape (s, n) [rad]."""
        return self._lead(self.x)

    @property
    def phase_y(self) -> np.ndarray:
        """Angle by which y leads the shaft's mark, of a circle -pi / 2 more than x, and pi / 2 more
        at negative speeds [rad]."""
        return self._lead(self.y)

    def nodes(self) -> list[int]:
        """Return up to three nodes (from 1) with the largest finite orbits, ascending."""
        finite = np.where(np.isinf(self.major), 0.0, self.major)
        largest = np.argsort(-finite.max(axis=0, initial=0.0), kind="stable")[:3]
        return sorted((largest + 1).tolist())

    def _lead(self, vector: np.ndarray) -> np.ndarray:
        return np.angle(vector) * np.where(self.speeds < 0, -1.0, 1.0)[:, None]


def unbalance_response(
    rotor: Rotor,
    speeds: Sequence[float] | np.ndarray,
    *,
    contacts: str | None = None,
    unbalances: Sequence[PlacedAmount] | None = None,
) -> UnbalanceResponse:
    """Return the steady response at speeds [rad/s] to the machine's unbalances and bows, or to
    unbalances given instead.

    unbalances: (node from 1 or `Place`, amount [kg.m], angle from the shaft's mark [rad]);
    contacts: `open` or `pinned`; None: open where the machine is held without them. Raises
    `LinearError`.
    """
    return steady_whirl(rotor, contacts, unbalances).response(speeds)


def steady_whirl(
    rotor: Rotor, contacts: str | None = None, unbalances: Sequence[PlacedAmount] | None = None
) -> "SteadyWhirl":
    """Return the `SteadyWhirl` of a machine under its unbalances, or under those given instead; see
    `unbalance_response` for these and `contacts`. The last one is kept: a response and its checks
    are about the same speeds."""
    check_contacts(contacts)
    if unbalances is not None:
        listed = rows("unbalances", unbalances, "(node, amount, angle)")
        unbalances = tuple((_place(rotor, at), a, phase) for at, a, phase in listed)
    return _kept(rotor, contacts, unbalances)


def _place(rotor: Rotor, at: AnyPlace) -> Place:
    place = as_place(at)
    return Place(check_node(rotor, place.node), place.offset)


def _of(at: Place, amount: float, phase: float) -> complex:
    """Return an unbalance as a complex number; `LinearError` unless it is finite."""
    if not np.isfinite([amount, phase]).all():
        raise LinearError(
            f"unbalance at node {at.node} = {amount:g} kg.m at {phase:g} rad: must be finite"
        )
    return complex(amount * np.exp(1j * phase))


def bow_pull(structure: Structure) -> np.ndarray:
    """Return the force of a machine's shaft towards its residual bows, turning with it, complex of
    every dof, housing and ground, shape (size,) [N, N.m]."""
    share = interpreted(elastic_share)(structure.numbers[0].eta_h)
    of_shaft = share * (structure.bow @ structure.bow_forces)
    return np.concatenate([of_shaft, np.zeros(len(structure.housings) + 1)])


def turning(z: np.ndarray) -> np.ndarray:
    """Return complex amplitudes in x and y, in turn, of what turns with the shaft."""
    return np.column_stack([z, -1j * z]).ravel()


class _Solved(NamedTuple):
    """A steady whirl: complex amplitudes of x and y of every dof, shape (size, 2) [m, rad]; what
    computes the loads on the supports [N], which take longer; where the unknowns are at rest."""

    amplitudes: np.ndarray
    loads: Callable[[], np.ndarray]
    rest: np.ndarray


class SteadyWhirl:
    """The steady motion of a machine, solved for once at each speed; see `steady_whirl`."""

    def __init__(
        self,
        rotor: Rotor,
        contacts: str | None,
        unbalances: tuple[tuple[Place, float, float], ...] | None,
    ) -> None:
        self.machine = machine = shared_machine(rotor, contacts)
        if unbalances is None:
            own, whole = machine.structure.unbalances, machine.structure.unbalance
            at = np.concatenate([own.dof, own.slope])
            each = np.concatenate([whole, own.offset * whole])
        else:
            whole = np.array([_of(*unbalance) for unbalance in unbalances], complex)
            places = np.array([at for at, _, _ in unbalances], float).reshape(-1, 2)
            at = 2 * (places[:, 0].astype(int) - 1)
            at = np.concatenate([at, at + 1])
            each = np.concatenate([whole, places[:, 1] * whole])
        pull, size = np.zeros((2, machine.across.shape[1] // 2), dtype=complex)
        np.add.at(pull, at, each)
        np.add.at(size, at, np.abs(each))
        pull[np.abs(pull) <= _ROUNDING * size.real] = 0.0  # they take each other away
        self._pull = turning(pull)
        self._bow = turning(bow_pull(machine.structure) if unbalances is None else 0.0 * pull)
        self._solved = cache(self._solve)

    @property
    def is_driven(self) -> bool:
        """Whether any unbalance or bow acts."""
        return bool(self._pull.any() or self._bow.any())

    def at(self, speed: float) -> np.ndarray:
        """Return the complex amplitudes of x and y of every dof at a speed [rad/s], shape (size, 2)
        [m, rad]."""
        return self._solved(float(speed)).amplitudes

    def rest(self, speed: float) -> np.ndarray:
        """Return where gravity holds the machine at a speed [rad/s], x + i y of every dof, shape
        (size,) [m, rad]; 0 where that is not looked for, all that bears it being linear."""
        x_y = self.machine.expand @ self._solved(float(speed)).rest
        return np.asarray(to_complex(x_y))

    def loads(self, speed: float) -> np.ndarray:
        """Return the complex loads on the supports in x and y at a speed [rad/s] in N."""
        return self._solved(float(speed)).loads()

    def _solve(self, speed: float) -> _Solved:
        speed = checked_speed(speed)
        machine = self.machine
        if speed == 0.0 and (self._bow.any() or not machine.is_held):  # or about its centre of mass
            return self._solve(_CREEPING * float(machine.structure.numbers[0].lowest_omega))
        if speed == 0.0:  # nothing pulls, even on journals that no film carries yet
            nothing = np.zeros((len(machine.supports.names), 2), complex)
            at_rest = np.zeros(machine.expand.shape[1])
            return _Solved(np.zeros((len(self._pull) // 2, 2), complex), lambda: nothing, at_rest)
        linear = machine.at(speed)
        force = speed**2 * self._pull + self._bow
        whirl = linear.factorized(1j * speed)(machine.expand.T @ force)
        loads = partial(support_loads, machine, linear, force, whirl)
        return _Solved((machine.expand @ whirl[0]).reshape(-1, 2), loads, linear.rest)

    def response(self, speeds: Sequence[float] | np.ndarray) -> UnbalanceResponse:
        """Return the response at speeds [rad/s], at least one."""
        speeds = numbers("speeds", speeds)
        if not speeds:
            raise LinearError("speeds: at least one must be given")
        machine = self.machine
        size = machine.across.shape[1] // 2
        whole = np.array([self.at(speed) for speed in speeds]).reshape(-1, size, 2)
        load = np.array([self.loads(speed) for speed in speeds]).reshape(len(whole), -1, 2)
        n = 2 * len(machine.nodes)
        return UnbalanceResponse(
            speeds=np.array(speeds, float),
            contacts=machine.contacts,
            z=machine.nodes,
            x=whole[:, :n:2, 0],
            y=whole[:, :n:2, 1],
            housings=machine.supports.housings,
            housing_x=whole[:, n:-1, 0],
            housing_y=whole[:, n:-1, 1],
            supports=machine.supports.names,
            load_x=load[:, :, 0],
            load_y=load[:, :, 1],
        )


_kept = lru_cache(maxsize=1)(SteadyWhirl)
