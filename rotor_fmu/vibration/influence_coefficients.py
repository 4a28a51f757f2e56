"""Balancing by influence coefficients (ISO 21940-12): what unbalances in the correction planes take
away the vibration at the measuring points.

The once-per-revolution vibration at m measuring points and speeds is a complex vector v. A trial
unbalance u_k in the correction plane k changes it to v_k, so that the influence coefficients are

    A_jk = (v_kj - v_j) / u_k,

and the correction unbalances w, those for which v + A w is smallest in the sense of least squares.
Planes whose effects are alike at all measuring points cannot be told apart, as two planes by x and
y of one node of a machine whose bearings are the same all round. The smallest of the unbalances
that do the same is taken then: the rounding that differs is no reason for large ones. What is small
is so beside the trial unbalances and their effects, as the error of a measurement is: a plane in
which ten thousand times as much unbalance is needed counts like the others.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError, shown_value

# Share of the largest singular value of the effects of the trial unbalances below which one is an
# error of the measured vibration.
_RANK_TOLERANCE = 1e-4


class Correction(NamedTuple):
    """The result of balancing with m measurements and p correction planes: influence coefficients,
    complex of shape (m, p) [m/(kg.m)]; correction unbalances, complex of shape (p,) [kg.m]; the
    vibration that they should leave, complex of shape (m,) [m]; numerical rank of the influence
    coefficients."""

    influence: np.ndarray
    unbalances: np.ndarray
    expected: np.ndarray
    rank: int


def correction(
    initial: Sequence[complex] | np.ndarray,
    trials: Sequence[Sequence[complex]] | np.ndarray,
    unbalances: Sequence[complex] | np.ndarray,
) -> Correction:
    """Return influence coefficients, correction unbalances and the vibration expected.

    initial: once-per-revolution vibration without a trial unbalance, complex of shape (m,) [m];
    trials: the same with the trial unbalance of each plane in turn, shape (p, m) [m]; unbalances:
    the trial unbalances, complex of shape (p,) [kg.m]; each is removed before the next. Raises
    `InputError` if a value is not a finite number, the shapes do not fit, a trial unbalance is 0,
    or there are fewer measurements than planes.
    """
    v, seen = _finite("initial", initial), np.atleast_2d(_finite("trials", trials))
    u = _finite("unbalances", unbalances)
    if v.ndim != 1 or seen.shape != (len(u), len(v)):
        raise InputError(
            f"trials: shape {seen.shape}, must be {(len(u), len(v))}: a row for each of "
            f"{len(u)} trial unbalances, a column for each of {len(v)} measurements"
        )
    if (u == 0).any():
        raise InputError("a trial unbalance is 0: it must not be")
    enough_measurements(len(v), len(u))
    effects = (seen - v).T
    shares, _, rank, _ = np.linalg.lstsq(effects, -v, rcond=_RANK_TOLERANCE)
    return Correction(effects / u, shares * u, v + effects @ shares, int(rank))


def _finite(name: str, values: Any) -> np.ndarray:
    """Return an argument as complex numbers; `InputError` for others, as of a missing reading."""
    try:
        result = np.asarray(values, complex)
    except (TypeError, ValueError):
        result = np.array(np.nan)
    if not np.isfinite(result).all():
        raise InputError(f"{shown_value(name, values)}: must be finite numbers, complex or real")
    return result


def once_per_turn(phi: np.ndarray, signal: np.ndarray) -> complex:
    """Return the component that turns with the shaft, of a signal over its angle [rad], by least
    squares with the mean and two harmonics, so that it takes no even spacing."""
    turning = np.exp(1j * np.outer(phi, range(-2, 3)))
    return complex(2 * np.linalg.lstsq(turning, signal, rcond=None)[0][3])


def enough_measurements(measurements: int, planes: int) -> None:
    """Raise `InputError` where there are fewer measurements than correction planes."""
    if measurements < planes:
        raise InputError(
            f"{measurements} measurements for {planes} planes: there must be at least as many"
        )
