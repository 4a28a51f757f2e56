"""Where bodies can touch: openings as functions of a handful of relative displacements p = B^T q.

A contact force lambda acts on p along the opening's gradient N = ds/dp. Flat stops have a constant
one; a journal in a round stop has s = clearance - |p|, whose gradient turns with the journal.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np


class Contacts(Protocol):
    """m contacts between k relative displacements p."""

    @property
    def B(self) -> np.ndarray:
        """p = B^T q, shape (n, k)."""

    @property
    def compliance(self) -> np.ndarray:
        """Of a penalty law, shape (m,) [m/N]; 0 for a hard stop."""

    def openings(self, p: np.ndarray) -> np.ndarray:
        """s [m], shape (m,)."""

    def gradient(self, p: np.ndarray) -> np.ndarray:
        """N = ds/dp, shape (k, m)."""

    def bend(self, p: np.ndarray, p_dot: np.ndarray) -> np.ndarray:
        """What the acceleration of s has besides N^T p'' [m/s2], shape (m,)."""


@dataclass(frozen=True)
class FlatStops:
    """s = opening + p: each relative displacement has a stop of its own; opening [m], (m,)."""

    B: np.ndarray
    opening: np.ndarray
    compliance: np.ndarray

    def openings(self, p: np.ndarray) -> np.ndarray:
        """See `Contacts`."""
        return self.opening + p

    def gradient(self, p: np.ndarray) -> np.ndarray:
        """See `Contacts`."""
        return np.eye(len(p))

    def bend(self, p: np.ndarray, p_dot: np.ndarray) -> np.ndarray:
        """See `Contacts`."""
        return np.zeros(len(p))


@dataclass(frozen=True)
class RoundStops:
    """s = clearance - |(x, y)|: p holds x and y of one journal after another; clearance [m], (m,).

    At the very centre the direction is taken as downwards.
    """

    B: np.ndarray
    clearance: np.ndarray
    compliance: np.ndarray

    def openings(self, p: np.ndarray) -> np.ndarray:
        """See `Contacts`."""
        return self.clearance - np.hypot(p[::2], p[1::2])

    def gradient(self, p: np.ndarray) -> np.ndarray:
        """See `Contacts`."""
        m = len(self.clearance)
        r = np.hypot(p[::2], p[1::2])
        ex = np.divide(p[::2], r, out=np.zeros(m), where=r > 0)
        ey = np.divide(p[1::2], r, out=np.full(m, -1.0), where=r > 0)
        N = np.zeros((2 * m, m))
        N[2 * np.arange(m), np.arange(m)] = -ex
        N[2 * np.arange(m) + 1, np.arange(m)] = -ey
        return N

    def bend(self, p: np.ndarray, p_dot: np.ndarray) -> np.ndarray:
        """See `Contacts`; minus the square of the speed along the wall over the radius."""
        r = np.hypot(p[::2], p[1::2])
        along = np.divide(p[::2] * p_dot[1::2] - p[1::2] * p_dot[::2], r, where=r > 0, out=0 * r)
        return -np.divide(along**2, r, where=r > 0, out=0 * r)
