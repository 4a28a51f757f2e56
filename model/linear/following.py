"""Modes followed by their shapes from one value of a parameter to another.

The modes of two values are paired so that shapes are most alike and frequencies nearest. Where a
mode is then not like itself, the values lie too far apart: those half-way are looked at first.
"""

from collections.abc import Callable
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from scipy.optimize import linear_sum_assignment

M = TypeVar("M")  # the modes at one value
_ALIKE = 0.85  # shapes less alike than this are looked at again half-way
_HALVINGS = 5


class Following(NamedTuple, Generic[M]):
    """How the modes of a machine are followed.

    frequencies: of the modes at one value, in their order; likeness: of all shapes at one value
    with all at another, 0 to 1; half_way: the modes between two values; unlike: likeness below
    which a mode is not the same one after all halvings.
    """

    frequencies: Callable[[M], np.ndarray]
    likeness: Callable[[M, M], np.ndarray]
    half_way: Callable[[M, M], M]
    unlike: float = 0.0

    def onward(self, a: M, b: M, places: np.ndarray, depth: int = 0) -> np.ndarray:
        """Return the places in `b` of the modes that have `places` in `a`; -1 of a lost one."""
        result, alike = self._paired(a, b, places)
        if (alike > _ALIKE).all() or depth == _HALVINGS:
            return np.where(alike >= self.unlike, result, -1)
        middle = self.half_way(a, b)
        half = self.onward(a, middle, places, depth + 1)
        return self.onward(middle, b, half, depth + 1)

    def _paired(self, a: M, b: M, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the places in `b`, and how alike the shapes are; 1 of what is lost already."""
        known = places >= 0
        result, alike = np.full(len(places), -1), np.where(known, 0.0, 1.0)
        of_a, of_b = self.frequencies(a)[places[known]], self.frequencies(b)
        if not (len(of_a) and len(of_b)):
            return result, alike
        likeness = self.likeness(a, b)[places[known]]
        far = np.abs(np.log(of_b[None, :] / of_a[:, None]))
        rows, columns = linear_sum_assignment(1 - likeness + np.minimum(far, 1.0))
        seen = np.flatnonzero(known)[rows]
        result[seen], alike[seen] = columns, likeness[rows, columns]
        return result, alike
