"""Undamped critical speed map (API 684): the critical speeds of the rotor over the stiffness of its
bearings, all alike and isotropic, and the stiffness that the bearings have themselves.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..arguments import numbers, switch
from ..machine.rotor import Rotor
from ..structure.assembly import assemble
from ..structure.structure import total_mass
from .forward_branches import ForwardBranches
from .linear_machine import LinearError
from .modes import check_count
from .undamped import UndampedMachine

_MODES = 4
_SAMPLES = 60  # speeds at which the bearings' own stiffness is listed
_FAR = 1e-20, 1e4  # of a stiffness that is rigid: what is softer or stiffer changes nothing more
_ALIKE = 1e-9  # relative difference of two stiffnesses that are one


class BearingStiffness(NamedTuple):
    """The stiffness that a bearing has itself along one axis, `x` or `y`, over the speed [rad/s];
    stiffness [N/m]."""

    bearing: str
    axis: str
    speed: np.ndarray
    stiffness: np.ndarray


class Crossing(NamedTuple):
    """Where the stiffness of a bearing along an axis meets a line of the map: the mode from 0, the
    stiffness [N/m] and the critical speed [rad/s]."""

    bearing: str
    axis: str
    mode: int
    stiffness: float
    speed: float


@dataclass(frozen=True)
class CriticalMap:
    """Undamped critical speeds of s stiffnesses and m modes.

    stiffness: of every bearing, shape (s,) [N/m]; speeds: forward critical speeds, or natural
    frequencies at standstill where `synchronous` is false, ascending, shape (s, m) [rad/s], NaN
    where there are fewer or bearings do not hold the machine against what pulls; where pedestals
    differ in x and y each line is followed by its shape, is NaN where it clearly whirls backward
    (see `forward_branches`), and is there if it is among those asked for at any stiffness;
    bearings: names of what the stiffness replaces; own: their own; crossings: where it meets lines;
    rigid: the first critical speed on rigid supports, housings included [rad/s].
    """

    stiffness: np.ndarray
    speeds: np.ndarray
    synchronous: bool
    bearings: tuple[str, ...]
    own: tuple[BearingStiffness, ...]
    crossings: tuple[Crossing, ...]
    rigid: float


def critical_map(
    rotor: Rotor,
    stiffness: Sequence[float] | np.ndarray,
    *,
    count: int = _MODES,
    synchronous: bool = True,
    rigid_pedestals: bool = False,
    contacts: str | None = None,
) -> CriticalMap:
    """Return the undamped critical speed map of a machine without its seals.

    stiffness: ascending ones of the bearings [N/m], at least 2; count: how many of the lowest ones
    at each stiffness lie on lines; synchronous: whether the rotor turns at its critical speeds,
    with gyroscopic moments, otherwise natural frequencies at standstill are given; rigid_pedestals:
    whether housings are taken as ground; contacts: `open`, they do not act, or `pinned`, they are
    bearings too, by default open where the machine is held without them. Raises `LinearError` if
    the stiffnesses do not ascend from above 0 or are beyond all reason for the rotor, or it has no
    bearing.
    """
    values = np.array(numbers("stiffness", stiffness))
    ascends = len(values) > 1 and values[0] > 0 and (np.diff(values) > 0).all()
    if not ascends or not np.isfinite(values).all():
        raise LinearError("stiffness: must be at least 2 finite values, ascending from above 0")
    check_count(count)
    machine = UndampedMachine(rotor, contacts, switch("rigid_pedestals", rigid_pedestals))
    count, synchronous = min(count, machine.mass.shape[0]), switch("synchronous", synchronous)
    low, high = (share * machine.rigid_stiffness for share in _FAR)
    for value in values[[0, -1]]:
        if not low <= value <= high:
            raise LinearError(
                f"stiffness = {value:g} N/m: must be from {low:.2g} to {high:.2g} N/m"
            )
    held = values[[machine.is_held(k) for k in values]]
    if not len(held):
        raise LinearError("the machine is not held by its bearings against what pulls")
    solve: Callable[[float], np.ndarray] = partial(machine.natural_frequencies, count=count)
    branches = None
    if synchronous and machine.is_circular:
        solve = partial(machine.forward_criticals, count=count)
    elif synchronous:
        solve = branches = ForwardBranches(machine, held, count)

    @cache
    def lines(k: float) -> np.ndarray:
        """Return the lines' critical speeds [rad/s], NaN where there are fewer."""
        found = solve(k)[: None if branches else count]
        return np.append(found, np.full(max(count - len(found), 0), np.nan))

    speeds = np.array([lines(k) for k in held])
    if branches is not None:
        speeds[:, : branches.is_backward.shape[1]][branches.is_backward] = np.nan
    softer = np.full((len(values) - len(held), speeds.shape[1]), np.nan)
    speeds = np.concatenate([softer, speeds])
    known = speeds[speeds > 0.0]
    beside = np.zeros(1)  # or from below to above the critical ones, spaced as the map's axis is
    if len(known):
        beside = np.geomspace(0.5 * known.min(), 1.1 * known.max(), _SAMPLES)
    own = _own_stiffness(machine, beside)
    return CriticalMap(
        stiffness=values,
        speeds=speeds,
        synchronous=synchronous,
        bearings=tuple(machine.bearings),
        own=own,
        crossings=tuple(_crossings(machine, lines, own, values, speeds)),
        rigid=first_rigid_critical(rotor, machine.contacts),
    )


def first_rigid_critical(rotor: Rotor, contacts: str | None = None) -> float:
    """Return the first forward critical speed of the undamped rotor on rigid supports [rad/s]; NaN
    where there is none."""
    machine = UndampedMachine(rotor, contacts, rigid_pedestals=True)
    if not machine.is_held(machine.rigid_stiffness):
        return math.nan
    speeds = machine.forward_criticals(machine.rigid_stiffness, 1)
    return float(speeds[0]) if len(speeds) else math.nan


def mean_stiffness(rotor: Rotor, contacts: str | None = None) -> float:
    """Return the geometric mean of the direct stiffnesses of the bearings [N/m], at standstill; of
    those that hold the machine only as it turns, at the first critical speed on rigid supports;
    where none has any, that on which the rotor's mass has this critical speed."""
    machine = UndampedMachine(rotor, contacts, rigid_pedestals=False)
    rigid = first_rigid_critical(rotor, contacts)
    for speed in (0.0, rigid):
        values = machine.own_stiffness(speed)
        if (values > 0).any():
            return float(np.exp(np.log(values[values > 0]).mean()))
    structure = assemble(rotor)
    lowest = np.fmin(rigid, structure.numbers[0].lowest_omega)  # that of one without such a speed
    return float(total_mass(structure) * lowest**2)


def _own_stiffness(machine: UndampedMachine, speeds: np.ndarray) -> tuple[BearingStiffness, ...]:
    """Return the stiffness that each bearing has itself, in y only where that is another one."""
    every = np.array([machine.own_stiffness(speed) for speed in speeds])
    result = []
    for name, both in zip(machine.bearings, np.moveaxis(every, 1, 0), strict=True):
        x, y = both.T
        result.append(BearingStiffness(name, "x", speeds, x))
        if not np.allclose(x, y, rtol=_ALIKE, atol=0.0, equal_nan=True):
            result.append(BearingStiffness(name, "y", speeds, y))
    return tuple(result)


def _crossings(
    machine: UndampedMachine,
    lines: Callable[[float], np.ndarray],
    own: Sequence[BearingStiffness],
    stiffness: np.ndarray,
    speeds: np.ndarray,
) -> list[Crossing]:
    """Return where each bearing's own stiffness meets the lines."""
    places = {name: i for i, name in enumerate(machine.bearings)}

    def excess(of: BearingStiffness, mode: int, k: float) -> float:
        """Return the logarithm of the bearing's own stiffness, at the critical speed with a
        stiffness k [N/m], over it; NaN where it has none."""
        at = machine.own_stiffness(float(lines(k)[mode]))
        there = at[places[of.bearing], "xy".index(of.axis)]
        return math.log(there / k) if there > 0 else math.nan

    return [
        Crossing(of.bearing, of.axis, mode, k, float(lines(k)[mode]))
        for of in own
        for mode in range(speeds.shape[1])
        for k in _meetings(stiffness, speeds[:, mode], partial(excess, of, mode))
    ]


def _meetings(
    stiffness: np.ndarray, speeds: np.ndarray, excess: Callable[[float], float]
) -> list[float]:
    values = [
        excess(k) if math.isfinite(w) else math.nan for k, w in zip(stiffness, speeds, strict=True)
    ]
    found = [
        brentq(excess, a, b, rtol=1e-12)
        for a, b, before, after in zip(stiffness, stiffness[1:], values, values[1:], strict=False)
        # one at a stiffness of the map is that of the interval that it ends, or begins the map with
        if before * after <= 0 and (before != 0 or a == stiffness[0])
    ]
    return [k for k in found if math.isfinite(excess(k))]
