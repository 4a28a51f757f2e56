"""A branch of periodic motions: its points with their stability, and its bifurcations.

At a fold the curve turns in the parameter. At other bifurcations Floquet multipliers cross the unit
circle: at -1 the period doubles, a complex pair begins a torus (Neimark-Sacker), at +1 another
branch passes through.
"""

from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

import numpy as np

from .arclength import CurvePoint
from .balance import Orbit
from .floquet import multipliers
from .fourier import amplitudes, last_share
from .harmonic_count import Accuracy
from .method_switch import PeriodicEquations
from .shooting import Shooting

BIFURCATIONS = FOLD, DOUBLING, TORUS, BRANCHING, GRAZING = (
    "fold",
    "period doubling",
    "Neimark-Sacker",
    "branch point",
    "grazing",
)
CLOSED = "the branch is closed"
UNFINISHED = "unfinished: "
_MOST = f"{UNFINISHED}{{}} steps were taken, the most in one direction"
NO_MOTION = np.zeros((0, 0))
UNIT = 1.0 + 1e-6  # a multiplier beyond is outside the unit circle


def why_ended(value: float, low: float, high: float, most: int) -> str:
    """Return why a curve over [low, high] that was not lost ends at a value, after at most `most`
    steps."""
    return _MOST.format(most) if low < value < high else "end of the range"


class Solution(NamedTuple):
    """A point of a branch: value of the parameter, the orbit, complex amplitudes of all dofs, x and
    y in turn, shape (H + 1, 2 size) [m, rad], Floquet multipliers, the largest first (for a
    self-excited motion without the trivial one), whether the motion is stable, relative amplitude
    of the highest harmonics, Newton's corrections."""

    value: float
    orbit: Orbit
    motion: np.ndarray
    multipliers: np.ndarray
    is_stable: bool
    last_share: float
    corrections: tuple[float, ...]


class Bifurcation(NamedTuple):
    """A bifurcation: its kind, value of the parameter, orbit and motion as of a `Solution`,
    multiplier that crosses the unit circle (nan at grazing, where it jumps, and where multipliers
    are not computed), and the index of the branch point before it."""

    kind: str
    value: float
    orbit: Orbit
    motion: np.ndarray
    multiplier: complex
    behind: int


@dataclass
class Branch:
    """The points and the bifurcations, each in their order along the curve, and why the branch ends
    at either side."""

    points: list[Solution] = field(default_factory=list)
    bifurcations: list[Bifurcation] = field(default_factory=list)
    ends: tuple[str, str] = ("", "")


def solution(problem: PeriodicEquations, point: CurvePoint, accuracy: Accuracy) -> Solution:
    """Return the motion at a point of the curve."""
    orbit = problem.split(point.x, point.value)
    result = np.zeros(0, complex)
    if accuracy.has_stability:
        result = stability_multipliers(problem, point, orbit)
    stable = bool(len(result) == 0 or np.abs(result[0]) <= UNIT)
    share = last_share(orbit.b)
    made = Solution(point.value, orbit, NO_MOTION, result, stable, share, point.corrections)
    return with_motion(problem, made)


_M = TypeVar("_M", Solution, Bifurcation)


def with_motion(problem: PeriodicEquations, result: _M) -> _M:
    """Return the result with the amplitudes of all dofs, which follow from its orbit."""
    orbit = result.orbit
    parts = problem.dynamic_stiffness(result.value, orbit.omega)
    machine = problem.machine_at(result.value)
    return result._replace(motion=machine.expanded(parts, amplitudes(orbit.b)))


def stability_multipliers(
    problem: PeriodicEquations, point: CurvePoint, orbit: Orbit
) -> np.ndarray:
    """Return the multipliers that decide on stability, the largest first."""
    if isinstance(problem, Shooting):
        return problem.multipliers(point.x, point.value)
    values = multipliers(problem.machine_at(point.value), orbit).values
    if problem.is_autonomous:
        return np.delete(values, np.argmin(np.abs(values - 1.0)))
    return values
