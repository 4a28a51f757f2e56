"""Synchronous critical speeds over the stiffness of the bearings, where pedestals that differ in x
and y couple forward and backward whirl: each followed by its shape.

A mode is then no circle, and may whirl forward with one stiffness and backward with another. It
counts where it does not clearly whirl backward: unbalance drives what whirls either way.
"""

import math

import numpy as np

from .following import Following
from .undamped import Synchronous, UndampedMachine

_BACKWARD = -0.5  # forwardness below which a mode clearly whirls backward
_MORE = 8  # modes followed beyond four times those asked for, since they change places


class ForwardBranches:
    """The critical speeds over ascending stiffnesses [N/m] that at any of them are among the
    `count` lowest that do not clearly whirl backward, in the order of the first stiffness. One that
    does so at a single stiffness amid others is none."""

    def __init__(self, machine: UndampedMachine, stiffness: np.ndarray, count: int) -> None:
        self._machine = machine
        self._most = 4 * count + _MORE
        self._following = Following(
            lambda modes: modes.speeds,
            self._likeness,
            lambda a, b: self._modes(math.sqrt(a.stiffness * b.stiffness)),
        )
        first = self._modes(stiffness[0])
        places = np.arange(min(len(first.speeds), self._most))
        self._places = {float(stiffness[0]): (first, places)}
        seen = [self._followed(k) for k in stiffness]
        counts = np.array([modes.forwardness[places] > _BACKWARD for modes, places in seen])
        # at one stiffness amid others alone a backward mode grazes the bound, which is no line
        beside = np.pad(counts, ((1, 1), (0, 0)), constant_values=True)
        lines = np.flatnonzero((counts & (beside[:-2] | beside[2:])).any(axis=0))
        speeds = np.array([modes.speeds[places[lines]] for modes, places in seen])
        speeds[~counts[:, lines]] = np.inf
        lower = (speeds[:, None, :] < speeds[:, :, None]).sum(axis=2)
        self._kept = lines[((lower < count) & counts[:, lines]).any(axis=0)]
        self.is_backward = ~counts[:, self._kept]

    def __call__(self, stiffness: float) -> np.ndarray:
        """Return the critical speeds with a stiffness [N/m], shape (lines,) [rad/s]."""
        modes, places = self._followed(stiffness)
        return modes.speeds[places[self._kept]]

    def _modes(self, stiffness: float) -> Synchronous:
        return self._machine.synchronous(float(stiffness), self._most + _MORE)

    def _followed(self, stiffness: float) -> tuple[Synchronous, np.ndarray]:
        """Return the modes with a stiffness, and the places in them of those that are followed."""
        to = float(stiffness)
        if to not in self._places:
            near = min(self._places, key=lambda k: abs(math.log(k / to)))
            start, places = self._places[near]
            end = self._modes(to)
            self._places[to] = end, self._following.onward(start, end, places)
        return self._places[to]

    def _likeness(self, a: Synchronous, b: Synchronous) -> np.ndarray:
        """Return the modal assurance criterion, weighted by mass, of all shapes of a and b."""
        norms = np.sqrt(np.outer(a.norms, b.norms))
        return np.abs(a.shapes.conj().T @ (self._machine.mass @ b.shapes) / norms) ** 2
