"""The undamped machine on isotropic bearings of any stiffness, its seals left out.

A motion u exp(i Omega t) of it at the speed Omega satisfies

    K u = Omega^2 (M - i G) u,    with the gyroscopic matrix G of Omega G u',

so that all its synchronous critical speeds come from one eigenvalue problem, without iteration;
without G it gives the natural frequencies at standstill.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg

from ..machine.rotor import Rotor
from ..parts.base import GROUND, Interface, Part, Spring
from ..parts.linear_bearing import LinearBearing, Seal
from ..parts.support import Support
from .machine import OPEN, PINNED, LinearError, LinearMachine

_REAL = 1e-6  # share of an eigenvalue below which its imaginary part is rounding
_APART = 1e-9  # of a matrix: what is smaller couples nothing
# motion of x and y: forward circles, and in either plane
_FORWARD = np.array([1.0, -1j]) / np.sqrt(2.0)
_ACROSS, _UP = np.array([1.0, 0.0]), np.array([0.0, 1.0])
_RIGID = 1e8  # of the rotor's mass times its lowest frequency squared


class UndampedMachine:
    """The undamped machine, whose bearings have any stiffness.

    contacts: `open` or `pinned`, where clearance contacts are bearings too; None: open where the
    machine is held without them; rigid_pedestals: whether housings are taken as ground. Raises
    `LinearError` where there is no bearing.
    """

    def __init__(self, rotor: Rotor, contacts: str | None, rigid_pedestals: bool) -> None:
        self.contacts = LinearMachine(rotor, contacts).contacts
        machine = LinearMachine(rotor, OPEN)
        named = _bearings(rotor, self.contacts)
        names = (*machine.supports.springs, *machine.supports.interfaces)
        held = [i for i, name in enumerate(names) if name in named]
        if not held:
            raise LinearError("the machine has no bearing whose stiffness could be varied")
        self.bearings = {names[i]: named[names[i]] for i in held}
        self._matrices = machine.undamped(held, rigid_pedestals)
        mass = float(machine.structure.mass_sum[::2].sum())
        self.rigid_stiffness = _RIGID * mass * float(machine.structure.numbers[0].lowest_omega) ** 2
        self._nodes = len(rotor.nodes)

    def forward_criticals(self, stiffness: float) -> np.ndarray:
        """Return the forward critical speeds, ascending [rad/s], with this stiffness of all
        bearings [N/m]."""
        matrices = self._matrices
        inverse = self._inverse(stiffness, matrices.M - 1j * matrices.gyroscopic)
        forward, is_apart = _half(inverse, _FORWARD)
        if is_apart:
            return _solve(forward)[0]
        speeds, shapes = _solve(inverse)
        x, y = shapes[::2], shapes[1::2]
        turning, against = (np.sum(np.abs(x + s * 1j * y) ** 2, axis=0) for s in (1, -1))
        return speeds[turning > against]

    def natural_frequencies(self, stiffness: float) -> np.ndarray:
        """Return the natural frequencies at standstill, ascending [rad/s], with this stiffness of
        all bearings [N/m]; of two planes that are alike those of one."""
        inverse = self._inverse(stiffness, self._matrices.M.astype(complex))
        planes = [_half(inverse, plane)[0] for plane in (_ACROSS, _UP)]
        speeds = [_solve(plane)[0] for plane in planes]
        if np.abs(planes[0] - planes[1]).max() < _APART * np.abs(planes[0]).max():
            return speeds[0]
        return np.sort(np.concatenate(speeds))

    def planar_shapes(self, speed: float) -> np.ndarray:
        """Return the deflections of the modes at standstill along the nodes, the largest 1, by
        ascending frequency, shape (m, n); with the mean of both direct stiffnesses that each
        bearing has at a speed [rad/s]."""
        own = np.array([np.mean(direct_stiffness(b, speed)) for b in self.bearings.values()])
        own = np.minimum(own, self.rigid_stiffness)
        inverse = self._inverse(own, self._matrices.M.astype(complex))
        _, shapes = _solve(_half(inverse, _ACROSS)[0])
        w = shapes[: 2 * self._nodes : 2].T
        return np.array([(s / s[np.argmax(np.abs(s))]).real for s in w])

    def _inverse(self, stiffness: float | np.ndarray, mass: np.ndarray) -> np.ndarray:
        """Return K^-1 times a mass matrix."""
        each = np.broadcast_to(stiffness, len(self.bearings))
        return self._matrices.over_stiffness(mass, each)


def _half(matrix: np.ndarray, motion: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return the part of a matrix for motion along (x, y) = `motion` at every dof, and whether it
    leads to no other motion."""
    size = len(matrix) // 2
    blocks = matrix.reshape(size, 2, size, 2)
    other = np.array([-motion[1].conj(), motion[0].conj()])
    within, beside = (np.einsum("a,iajb,b->ij", m.conj(), blocks, motion) for m in (motion, other))
    return within, bool(np.abs(beside).max() < _APART * np.abs(within).max())


def _solve(inverse: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, ascending [rad/s], and shapes of K^-1 M."""
    values, shapes = scipy.linalg.eig(inverse)
    is_critical = (values.real > 0) & (np.abs(values.imag) < _REAL * np.abs(values))
    speeds = values.real[is_critical] ** -0.5
    order = np.argsort(speeds)
    return speeds[order], shapes[:, is_critical][:, order]


def _bearings(rotor: Rotor, contacts: str) -> dict[str, Part]:
    """Return by their names the parts that hold the machine, seals aside."""
    result = {}
    for where, part in rotor.named_parts():
        if isinstance(part, Seal):
            continue
        for element in part.elements(where, rotor.material.density):
            is_contact = isinstance(element, Interface) and element.law.has_wall
            is_of_ring = isinstance(element, Interface) and element.ring != GROUND
            holds = isinstance(element, Spring | Interface) and not (is_contact or is_of_ring)
            if holds or (is_contact and contacts == PINNED):
                result[where] = part
    return result


def direct_stiffness(part: Part, speed: float) -> tuple[float, float]:
    """Return the stiffness of a bearing in x and y at a speed [rad/s], without what couples them
    [N/m]; of a clearance contact that of the wall."""
    if isinstance(part, LinearBearing):
        K, _ = part.matrices(speed)
        return float(K[0, 0]), float(K[1, 1])
    value = part.stiffness if isinstance(part, Support) else getattr(part, "k", np.nan)
    return float(value), float(value)
