"""Undamped critical speed map (API 684): the critical speeds of the rotor over the stiffness of its
bearings, all alike and isotropic, and the stiffness that the bearings have themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..machine.rotor import Rotor
from ..parts.base import Part
from .machine import LinearError
from .undamped import UndampedMachine, direct_stiffness

_MODES = 4
_SAMPLES = 60  # speeds at which the bearings' own stiffness is listed


class BearingStiffness(NamedTuple):
    """The stiffness that a bearing has itself in one direction, `x` or `y`, over speeds [rad/s];
    stiffness [N/m]."""

    bearing: str
    axis: str
    speed: np.ndarray
    stiffness: np.ndarray


class Crossing(NamedTuple):
    """Where the stiffness of a bearing meets a line of the map: the mode from 0, the stiffness
    [N/m] and the critical speed [rad/s]."""

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
    where there are fewer; bearings: names of what the stiffness replaces; own: the stiffness of
    these bearings; crossings: where that meets a line; rigid: the first critical speed on rigid
    bearings [rad/s].
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

    Parameters
    ----------
    rotor : Rotor
        The machine.
    stiffness : sequence of float
        Ascending stiffnesses of the bearings [N/m], at least 2.
    count : int
        Number of lines, the lowest ones.
    synchronous : bool
        Whether the rotor turns at its critical speeds, with gyroscopic moments; otherwise the
        natural frequencies at standstill are given.
    rigid_pedestals : bool
        Whether housings are taken as ground.
    contacts : str, optional
        `open`: clearance contacts do not act; `pinned`: they are bearings too. By default open
        where the machine is held without them.

    Returns
    -------
    CriticalMap
        The lines and the bearings' own stiffness.

    Raises
    ------
    LinearError
        If the stiffnesses do not ascend from above 0, or the machine has no bearing.
    """
    values = np.array(stiffness, dtype=float)
    if len(values) < 2 or not (values > 0).all() or not (np.diff(values) > 0).all():
        raise LinearError("stiffness: must be at least 2 values, ascending from above 0")
    if count < 1:
        raise LinearError(f"count = {count}: must be at least 1")
    lines = _Lines(UndampedMachine(rotor, contacts, rigid_pedestals), synchronous)
    speeds = np.array([lines(k, count) for k in values])
    top = 1.1 * float(np.nanmax(speeds, initial=0.0))
    own = _own_stiffness(lines.bearings, np.linspace(0.0, top, _SAMPLES))
    return CriticalMap(
        stiffness=values,
        speeds=speeds,
        synchronous=synchronous,
        bearings=tuple(lines.bearings),
        own=own,
        crossings=tuple(_crossings(lines, values, speeds)),
        rigid=first_rigid_critical(rotor, contacts),
    )


def first_rigid_critical(rotor: Rotor, contacts: str | None = None) -> float:
    """Return the first forward critical speed of the undamped rotor on rigid bearings [rad/s]; NaN
    where there is none."""
    machine = UndampedMachine(rotor, contacts, rigid_pedestals=True)
    speeds = machine.forward_criticals(machine.rigid_stiffness)
    return float(speeds[0]) if len(speeds) else math.nan


class _Lines:
    """The critical speeds over the stiffness, each solved for once."""

    def __init__(self, machine: UndampedMachine, is_synchronous: bool) -> None:
        self.bearings = machine.bearings
        self._solve = machine.forward_criticals if is_synchronous else machine.natural_frequencies
        self._known: dict[float, np.ndarray] = {}

    def __call__(self, stiffness: float, count: int) -> np.ndarray:
        """Return the lowest ones, shape (count,) [rad/s], NaN where there are fewer."""
        if stiffness not in self._known:
            self._known[stiffness] = self._solve(stiffness)
        speeds = self._known[stiffness][:count]
        return np.append(speeds, np.full(count - len(speeds), np.nan))


def mean_stiffness(rotor: Rotor, contacts: str | None = None) -> float:
    """Return the geometric mean of the direct stiffnesses of the bearings at standstill [N/m]."""
    bearings = UndampedMachine(rotor, contacts, rigid_pedestals=False).bearings.values()
    values = np.array([direct_stiffness(part, 0.0) for part in bearings])
    return float(np.exp(np.log(values[values > 0]).mean())) if (values > 0).any() else 1e7


def _own_stiffness(parts: dict[str, Part], speeds: np.ndarray) -> tuple[BearingStiffness, ...]:
    result = []
    for name, part in parts.items():
        both = np.array([direct_stiffness(part, speed) for speed in speeds])
        for i, axis in enumerate("xy"):
            if i == 0 or (both[:, 1] != both[:, 0]).any():
                result.append(BearingStiffness(name, axis, speeds, both[:, i]))
    return tuple(result)


def _crossings(lines: _Lines, stiffness: np.ndarray, speeds: np.ndarray) -> list[Crossing]:
    """Return where each bearing's own stiffness meets the lines."""
    result = []
    for name, part in lines.bearings.items():
        for i, axis in enumerate("xy"):
            if i == 1 and _is_isotropic(part, np.nanmax(speeds)):
                continue
            for mode in range(speeds.shape[1]):
                result += [
                    Crossing(name, axis, mode, k, float(lines(k, mode + 1)[mode]))
                    for k in _meetings(
                        stiffness,
                        speeds[:, mode],
                        _excess(lines, part, i, mode),
                    )
                ]
    return result


def _is_isotropic(part: Part, highest: float) -> bool:
    return all(len(set(direct_stiffness(part, s))) == 1 for s in np.linspace(0, highest, _SAMPLES))


def _excess(lines: _Lines, part: Part, axis: int, mode: int) -> Callable[[float, float], float]:
    """Return the function of a stiffness, and of the critical speed there if it is known: the
    logarithm of the bearing's own stiffness at that speed over it."""

    def excess(k: float, speed: float = np.nan) -> float:
        if np.isnan(speed):
            speed = lines(k, mode + 1)[mode]
        own = direct_stiffness(part, speed)[axis]
        return float(np.log(own / k)) if own > 0 else -np.inf

    return excess


def _meetings(
    stiffness: np.ndarray, speeds: np.ndarray, excess: Callable[..., float]
) -> list[float]:
    known = np.flatnonzero(np.isfinite(speeds))
    values = [excess(stiffness[i], speeds[i]) for i in known]
    return [
        brentq(excess, stiffness[a], stiffness[b], rtol=1e-12)
        for a, b, before, after in zip(known, known[1:], values, values[1:], strict=False)
        if np.isfinite([before, after]).all() and before * after <= 0 and before != 0
    ]
