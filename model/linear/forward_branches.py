"""Synchronous critical speeds over the stiffness of the bearings, where pedestals that differ in x
and y couple forward and backward whirl: each followed by its shape.

A mode is then no circle, and may whirl forward with one stiffness and backward with another. It
counts where it does not clearly whirl backward: unbalance drives what whirls either way.
"""

import math

import numpy as np
from scipy.optimize import linear_sum_assignment

from .undamped import Synchronous, UndampedMachine

_BACKWARD = -0.5  # forwardness below which a mode clearly whirls backward
_MORE = 8  # modes followed beyond four times those asked for, since they change places
_ALIKE = 0.7  # shapes less alike than this are looked at again half-way
_HALVINGS = 5


class ForwardBranches:
    """The critical speeds over ascending stiffnesses [N/m], `count` of those that somewhere do not
    clearly whirl backward, in the order that they have at the first stiffness."""

    def __init__(self, machine: UndampedMachine, stiffness: np.ndarray, count: int) -> None:
        self._machine = machine
        first = self._modes(stiffness[0])
        places = np.arange(min(len(first.speeds), 4 * count + _MORE))
        self._places = {float(stiffness[0]): (first, places)}
        counts = np.array([self._forwardness(k) > _BACKWARD for k in stiffness])
        self._kept = np.flatnonzero(counts.any(axis=0))[:count]
        self.is_backward = ~counts[:, self._kept]

    def __call__(self, stiffness: float) -> np.ndarray:
        """Return the critical speeds with a stiffness [N/m], shape (count or fewer,) [rad/s]."""
        modes, places = self._followed(stiffness)
        return modes.speeds[places[self._kept]]

    def _forwardness(self, stiffness: float) -> np.ndarray:
        modes, places = self._followed(stiffness)
        return modes.forwardness[places]

    def _modes(self, stiffness: float) -> Synchronous:
        return self._machine.synchronous(float(stiffness))

    def _followed(self, stiffness: float) -> tuple[Synchronous, np.ndarray]:
        """Return the modes with a stiffness, and the places in them of those that are followed."""
        to = float(stiffness)
        if to not in self._places:
            near = min(self._places, key=lambda k: abs(math.log(k / to)))
            start, places = self._places[near]
            end = self._modes(to)
            self._places[to] = end, self._onward(start, end, places, 0)
        return self._places[to]

    def _onward(self, a: Synchronous, b: Synchronous, places: np.ndarray, depth: int) -> np.ndarray:
        """Return the places in `b` of the modes that have `places` in `a`."""
        left, norms = a.shapes[:, places], np.sqrt(np.outer(a.norms[places], b.norms))
        alike = np.abs(left.conj().T @ self._machine.mass @ b.shapes / norms) ** 2
        far = np.abs(np.log(b.speeds[None, :] / a.speeds[places][:, None]))
        rows, result = linear_sum_assignment(1 - alike + np.minimum(far, 1.0))
        if depth == _HALVINGS or (alike[rows, result] > _ALIKE).all():
            return result
        middle = self._modes(math.sqrt(a.stiffness * b.stiffness))
        half = self._onward(a, middle, places, depth + 1)
        return self._onward(middle, b, half, depth + 1)
