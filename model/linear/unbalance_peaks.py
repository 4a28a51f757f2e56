"""Speeds so close together that a response to unbalance shows all of its peaks: a lightly damped
one is narrower than the distance of speeds spaced evenly."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from ..machine.rotor import Rotor
from .amplification import at_pole, tops, with_modes, with_poles
from .campbell import CriticalSpeed, campbell
from .linear_machine import LinearMachine
from .modes import count_up_to
from .orbit import semi_axes
from .places import PlacedAmount
from .static import check_node, lowest_speed
from .unbalance import SteadyWhirl, UnbalanceResponse, steady_whirl

_MODES = 12  # at least
_POINTS = 13  # of the Campbell diagram
_AMPLITUDES = ("x", "y", "housing_x", "housing_y", "load_x", "load_y")  # of a response
_BEYOND = 1.2  # times the highest speed, that a critical speed whose flank lies below is found


class Gap(NamedTuple):
    """A radial clearance [m] with the name of what it belongs to, and the dofs whose distance
    closes it (-1: ground)."""

    name: str
    clearance: float
    dof: int
    end: int

    def size(self, whirl: SteadyWhirl) -> Callable[[float], float]:
        """Return the major semi-axis of a motion across it [m] as a function of the speed."""
        return partial(major_axis, whirl, self.dof, self.end, -1.0)


def gaps(machine: LinearMachine, names: Iterable[str]) -> list[Gap]:
    """Return the clearances of interfaces of these names, such as a machine's contacts."""
    at = dict(zip(machine.supports.interfaces, machine.structure.interfaces, strict=True))
    return [Gap(name, *(at[name][of].item() for of in ("length", "dof", "end"))) for name in names]


def with_criticals(
    rotor: Rotor, speeds: Sequence[float] | np.ndarray, contacts: str | None = None
) -> np.ndarray:
    """Return speeds [rad/s], ascending, with more of them about the damped critical speeds between,
    so that no peak of the response to unbalance lies between two."""
    at = np.unique(np.asarray(speeds, dtype=float))
    first, _ = ends = _ends(rotor, at, contacts)
    criticals = criticals_about(rotor, *ends, contacts)
    result = with_modes(at, [(c.speed, c.log_dec / (2 * math.pi)) for c in criticals])
    return result[(result >= first) | np.isin(result, at)]


def damped_criticals(
    rotor: Rotor, speeds: Sequence[float] | np.ndarray, contacts: str | None = None
) -> list[float]:
    """Return the damped critical speeds [rad/s] between the least and the largest of speeds, and
    those whose flank reaches there."""
    ends = _ends(rotor, np.unique(np.asarray(speeds, dtype=float)), contacts)
    return [critical.speed for critical in criticals_about(rotor, *ends, contacts)]


def _ends(rotor: Rotor, at: np.ndarray, contacts: str | None) -> tuple[float, float]:
    low, high = (float(end) for end in at[[0, -1]])
    return lowest_speed(rotor, high, contacts) if low == 0.0 else low, high


@lru_cache(maxsize=2)  # a response and its check look for the same ones
def criticals_about(
    rotor: Rotor, low: float, high: float, contacts: str | None
) -> tuple[CriticalSpeed, ...]:
    """Return the critical speeds between two speeds [rad/s], and those whose flank reaches there;
    see `Campbell` for `contacts`. Raises `LinearError`."""
    diagram = np.linspace(min(low, _BEYOND * low), max(high, _BEYOND * high), _POINTS)
    count = count_up_to(rotor, max(diagram, key=abs), _MODES, contacts)
    return campbell(rotor, diagram, count=count, contacts=contacts).critical


def major_axis(whirl: SteadyWhirl, dof: int, other: int, factor: float, speed: float) -> float:
    """Return the major semi-axis of the motion of a dof with a factor times that of another one
    (-1: ground), at a speed [rad/s] in m: of a node, across a gap, or beyond a node."""
    moved = whirl.at(speed)
    return float(semi_axes(*(moved[dof] + factor * moved[other]))[0])


def response_with_peaks(
    rotor: Rotor,
    speeds: Sequence[float] | np.ndarray,
    *,
    nodes: Sequence[int] = (),
    contacts: str | None = None,
    unbalances: Sequence[PlacedAmount] | None = None,
) -> UnbalanceResponse:
    """Return the response to unbalance at speeds [rad/s], ascending, and at the peaks between them
    of nodes (from 1), by default those with the largest orbits; see `unbalance_response` for the
    rest."""
    whirl = steady_whirl(rotor, contacts, unbalances)
    close = with_criticals(rotor, speeds, contacts)
    shown = nodes or whirl.response(close).nodes()
    peaks, poles = {}, set[float]()
    for node in shown:
        size = partial(major_axis, whirl, 2 * (check_node(whirl.machine, node) - 1), -1, 0.0)
        found = tops(size, close, np.array([size(at) for at in close]))
        peaks[node] = tuple(speed for _, speed, _ in found)
        poles |= {speed for _, speed, largest in found if math.isinf(largest)}
    of_peaks = (speed for of in peaks.values() for speed in of)
    at = with_poles([*close, *of_peaks], speeds, sorted(poles))
    return replace(_response(whirl, at, poles), peaks=peaks)


def _response(whirl: SteadyWhirl, speeds: np.ndarray, poles: set[float]) -> UnbalanceResponse:
    """Return the response at speeds [rad/s], infinite at those where nothing damps a resonance."""

    def amplitude(name: str, speed: float) -> np.ndarray:
        return np.asarray(getattr(whirl.response([speed]), name)[0])

    result = whirl.response(speeds)
    for i in np.flatnonzero(np.isin(speeds, list(poles))):
        for name in _AMPLITUDES:
            getattr(result, name)[i] = at_pole(partial(amplitude, name), speeds[i])
    return result
