"""Clearances that a machine's linear response to unbalance closes, and between which speeds."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..linear.answers import static
from ..model.linear.amplification import with_tops
from ..model.linear.linearization import OPEN
from ..model.linear.orbit import farthest, semi_axes
from ..model.linear.supports import touching, walls
from ..model.linear.unbalance import SteadyWhirl
from ..model.linear.unbalance_peaks import Gap, gaps
from ..model.machine.rotor import Rotor

_OverSpeed = Callable[[float], Any]


class Closing(NamedTuple):
    """A clearance that the linear response closes: the contact, its clearance [m]; where the most
    of it is taken, the static distance from the middle and the major semi-axis of the orbit about
    there [m]; and the speeds between which it is closed [rad/s]; NaN where the contact holds the
    machine and is always closed."""

    name: str
    clearance: float
    sag: float
    amplitude: float
    begin: float
    end: float


def closings_of(
    rotor: Rotor, whirl: SteadyWhirl, scale: float, speeds: np.ndarray, high: float
) -> list[Closing]:
    """Return the clearances that a response times a factor closes at some of these speeds [rad/s];
    high: the highest continuous speed, at which a machine on oil films is at rest [rad/s]."""
    contacts = walls(rotor)
    if whirl.machine.contacts != OPEN:
        held = gaps(whirl.machine, contacts)
        return [Closing(gap.name, gap.clearance, *4 * (math.nan,)) for gap in held]
    lying = static(rotor, afloat=high)
    of_nodes, of_housings = lying.x + 1j * lying.y, lying.housing_x + 1j * lying.housing_y
    at_rest = np.concatenate([np.repeat(of_nodes, 2), of_housings, [0.0]])  # last: ground
    found = []
    for gap in gaps(whirl.machine, touching(rotor)):
        is_open = gap.name in contacts  # nothing of it bears; a film's journal rises with the speed
        rest = partial(_across, gap, 1.0, (lambda speed: at_rest) if is_open else whirl.rest)
        motion = partial(_across, gap, scale, whirl.at)
        found.append(_closing(gap, rest, motion, speeds, is_open))
    return [each for each in found if each]


def _across(gap: Gap, scale: float, of: Callable[[float], np.ndarray], speed: float) -> Any:
    """Return how the ends of a gap are displaced against each other, times a factor, at a speed."""
    at = of(speed)
    return scale * (at[gap.dof] - at[gap.end])


def orbit_across(gap: Gap, scale: float, whirl: SteadyWhirl, speed: float) -> float:
    """Return the major semi-axis of the orbit of a gap's ends against each other, times a factor,
    at a speed [rad/s] in m."""
    return float(semi_axes(*_across(gap, scale, whirl.at, speed))[0])


def _closing(
    gap: Gap, rest: _OverSpeed, motion: _OverSpeed, speeds: np.ndarray, is_open: bool
) -> Closing | None:
    """Return where a motion closes a gap, if it does; rest, motion: of its ends against each other,
    x + i y and complex amplitudes of x and y, at a speed [m]; is_open: whether nothing in the gap
    bears. A journal that rests on its wall behind a film is not moved there; a shaft that lies in
    an open contact touches whether it is or not."""

    def sag(speed: float) -> float:
        return float(abs(rest(speed)))

    def taken(speed: float) -> float:
        return farthest(rest(speed), *motion(speed))

    def free(speed: float) -> float:
        return gap.clearance - taken(speed)

    peaked = with_tops([taken], speeds)
    peaked = peaked[[is_open or sag(speed) < gap.clearance for speed in peaked]]
    left = np.array([free(speed) for speed in peaked])
    closed = np.flatnonzero(left <= 0.0)
    if not len(closed):
        return None
    begin, end = (_meeting(free, peaked, int(closed[i]), side) for i, side in ((0, -1), (-1, 1)))
    most = float(peaked[left.argmin()])
    size = float(semi_axes(*motion(most))[0])
    return Closing(gap.name, gap.clearance, sag(most), size, begin, end)


def _meeting(free: Callable[[float], float], speeds: np.ndarray, i: int, side: int) -> float:
    """Return the speed [rad/s] at which a clearance closes between the i-th of speeds, where it is
    closed, and its neighbour on a side; the i-th itself if it has none."""
    if not 0 <= i + side < len(speeds):
        return float(speeds[i])
    return float(brentq(free, speeds[i], speeds[i + side], xtol=1e-9 * speeds[i]))
