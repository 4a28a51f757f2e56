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
from ..parts.base import Interface, Part, Spring
from ..parts.linear_bearing import LinearBearing, Seal
from ..parts.support import Support
from .machine import OPEN, PINNED, LinearError, LinearMachine

_REAL = 1e-6  # share of an eigenvalue below which its imaginary part is rounding
_ALIKE = 1e-7  # relative distance of two frequencies that are one
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
        speeds, shapes = self._solve(stiffness, matrices.M - 1j * matrices.gyroscopic)
        x, y = shapes[::2], shapes[1::2]
        forward, backward = (np.sum(np.abs(x + s * 1j * y) ** 2, axis=0) for s in (1, -1))
        return speeds[forward > backward]

    def natural_frequencies(self, stiffness: float) -> np.ndarray:
        """Return the natural frequencies at standstill, ascending [rad/s], with this stiffness of
        all bearings [N/m]; those of two planes that are alike once."""
        speeds, _ = self._solve(stiffness, self._matrices.M.astype(complex))
        return speeds[np.diff(speeds, prepend=0.0) > _ALIKE * speeds]

    def planar_shapes(self, speed: float) -> np.ndarray:
        """Return the deflections of the modes at standstill along the nodes, the largest 1, by
        ascending frequency, shape (m, n); with the mean of both direct stiffnesses that each
        bearing has at a speed [rad/s]."""
        own = np.array([np.mean(direct_stiffness(b, speed)) for b in self.bearings.values()])
        own = np.minimum(own, self.rigid_stiffness)
        matrices = self._matrices
        flat = matrices.M.astype(complex)
        flat[1::2] = 0.0  # motion in y is left out
        speeds, shapes = self._solve(own, flat)
        w = shapes[: 4 * self._nodes : 4].T
        return np.array([(s / s[np.argmax(np.abs(s))]).real for s in w[: len(speeds)]])

    def _solve(
        self, stiffness: float | np.ndarray, mass: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return frequencies, ascending [rad/s], and the shapes that belong to them."""
        each = np.broadcast_to(stiffness, len(self.bearings))
        inverse, shapes = scipy.linalg.eig(self._matrices.over_stiffness(mass, each))
        smallest = _REAL * np.abs(inverse).max() * _REAL
        is_critical = (inverse.real > smallest) & (np.abs(inverse.imag) < _REAL * np.abs(inverse))
        speeds = inverse.real[is_critical] ** -0.5
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
            holds = isinstance(element, Spring | Interface) and not is_contact
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
