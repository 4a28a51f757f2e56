"""The choice between harmonic balance and shooting at a point of a curve."""

import numpy as np

from .arclength import CurvePoint
from .balance import HarmonicBalance, Orbit
from .fourier import last_share, resized
from .harmonic_count import Accuracy, transferred, with_enough_harmonics, with_fewer_harmonics
from .newton import NotConverged
from .shooting import Shooting

_BACK_BELOW = 0.3  # of the share of the highest harmonics with which a motion is balanced again
_AHEAD = 1e-4  # of the length of a curve: a difference by which its tangent is taken over

PeriodicEquations = HarmonicBalance | Shooting


def suitable_equations(
    problem: PeriodicEquations, point: CurvePoint, orbit: Orbit, accuracy: Accuracy, is_end: bool
) -> tuple[PeriodicEquations, CurvePoint, bool]:
    """Return the equations that suit a point with this orbit, the point in their unknowns, and
    whether it has too few harmonics."""
    if isinstance(problem, Shooting):
        few = last_share(resized(orbit.b, accuracy.most)) < _BACK_BELOW * accuracy.share
        if few and not is_end:
            balance = problem.balance.modified(accuracy.most)
            try:
                return balance, in_other_equations(problem, point, balance, orbit), False
            except NotConverged:
                pass
        return problem, point, False
    balance = problem
    try:
        balance, point = with_enough_harmonics(balance, point, accuracy, is_end)
        is_coarse = balance.last_share(point.x) > accuracy.share
    except NotConverged:  # with more harmonics: it is followed with those that it has
        is_coarse = True
    if not is_end:
        balance, point = with_fewer_harmonics(balance, point, accuracy)
    return balance, point, is_coarse


def as_shooting(
    problem: PeriodicEquations, point: CurvePoint, orbit: Orbit
) -> tuple[Shooting, CurvePoint]:
    """Return shooting equations for a motion at which harmonic balance fails, and the point in
    their unknowns; raises `NotConverged` if the equations are shooting already, and for
    self-excited whirl."""
    if isinstance(problem, Shooting) or problem.is_autonomous:
        raise NotConverged()
    other = Shooting(problem, orbit)
    return other, in_other_equations(problem, point, other, orbit)


def in_other_equations(
    problem: PeriodicEquations, point: CurvePoint, other: PeriodicEquations, orbit: Orbit
) -> CurvePoint:
    """Return a point of the curve, with its orbit, in the unknowns of other equations; raises
    `NotConverged`."""
    far = point.value + _AHEAD * problem.scale * point.tangent_value
    ahead = problem.split(point.x + _AHEAD * point.tangent, far)
    x = other.join(orbit)
    plane = np.append((other.join(ahead) - x) / _AHEAD, point.tangent_value)
    plane /= np.linalg.norm(plane)
    return transferred(other, x, point, plane)
