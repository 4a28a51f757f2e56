"""Balancing by influence coefficients (ISO 21940-12): what unbalances in the correction planes take
away the vibration at the measuring points.

The once-per-revolution vibration at m measuring points and speeds is a complex vector v. A trial
unbalance u_k in the correction plane k changes it to v_k, so that the influence coefficients are

    A_jk = (v_kj - v_j) / u_k,

and the correction unbalances w, those for which v + A w is smallest in the sense of least squares.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..errors import InputError


class Correction(NamedTuple):
    """The result of balancing with m measurements and p correction planes: influence coefficients,
    complex of shape (m, p) [m/(kg.m)]; correction unbalances, complex of shape (p,) [kg.m]; the
    vibration that they should leave, complex of shape (m,) [m]."""

    influence: np.ndarray
    unbalances: np.ndarray
    expected: np.ndarray


def correction(
    initial: Sequence[complex] | np.ndarray,
    trials: Sequence[Sequence[complex]] | np.ndarray,
    unbalances: Sequence[complex] | np.ndarray,
) -> Correction:
    """Return influence coefficients, correction unbalances and the vibration expected.

    initial: once-per-revolution vibration without a trial unbalance, complex of shape (m,) [m];
    trials: the same with the trial unbalance of each plane in turn, shape (p, m) [m]; unbalances:
    the trial unbalances, complex of shape (p,) [kg.m]; each is removed before the next. Raises
    `InputError` if the shapes do not fit, a trial unbalance is 0, or there are fewer measurements
    than planes.
    """
    v, seen = np.asarray(initial, complex), np.atleast_2d(np.asarray(trials, complex))
    u = np.asarray(unbalances, complex)
    if v.ndim != 1 or seen.shape != (len(u), len(v)):
        raise InputError(
            f"trials: shape {seen.shape}, must be {(len(u), len(v))}: a row for each of "
            f"{len(u)} trial unbalances, a column for each of {len(v)} measurements"
        )
    if (u == 0).any():
        raise InputError("a trial unbalance is 0: it must not be")
    if len(v) < len(u):
        raise InputError(f"{len(v)} measurements for {len(u)} planes: there must be as many")
    influence = ((seen - v) / u[:, None]).T
    result = np.linalg.lstsq(influence, -v, rcond=None)[0]
    return Correction(influence, result, v + influence @ result)
