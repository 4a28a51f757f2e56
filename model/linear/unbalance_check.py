"""The response to unbalance held against API 617 and 684: critical speeds with amplification
factors and separation margins, vibration at the probes, clearances."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ..arguments import check_positive, listed, mapped, number
from ..machine.rotor import Rotor
from .amplification import DAMPED, Margin, Peak, largest, margin, peaks
from .linear_machine import LinearError
from .linearization import OPEN
from .modes import checked_speed
from .places import PlacedAmount
from .static import check_node, lowest_speed
from .supports import walls
from .unbalance import SteadyWhirl, steady_whirl
from .unbalance_peaks import Gap, damped_criticals, gaps, major_axis, with_criticals
from .unbalance_placement import vibration_limit

SPEEDS = 301  # of a grid, that critical speeds are looked for from
# Of the maximum continuous speed, the end of the range of interest: critical speeds are looked for
# beyond the largest margin that may be required, 26 %, with their points of half the power.
OF_INTEREST = 1.5
_ROUNDING = 1e-10  # of the largest displacement: a smaller one has no peaks
_TURNS = math.radians(15.0)  # of the phase across a peak, less than which no mode is there
_ACROSS = 15  # speeds at which that is looked at
_CLEARANCE = 0.75  # of a clearance, which the motion may take


@dataclass(frozen=True)
class ProbeCritical:
    """A critical speed as a probe shows it: node (from 1), axis `x` or `y`, the peak (amplitude 0-p
    [m]); margin: its separation from the operating range, None where no range was given."""

    node: int
    axis: str
    peak: Peak
    margin: Margin | None


@dataclass(frozen=True)
class ProbeLevel:
    """The largest motion of a node (from 1) in the operating range, of the major axis: peak-to-peak
    [m], and the speed of it [rad/s]."""

    node: int
    peak_to_peak: float
    speed: float


@dataclass(frozen=True)
class ClearanceLevel:
    """How much of a radial clearance [m] the motion takes at most between standstill and the trip
    speed: the part's name, amplitude 0-p of the major axis under the unbalance [m] and the speed of
    it [rad/s]; scaled: the amplitude once the unbalance is scaled up until the probes reach their
    limit [m]."""

    name: str
    clearance: float
    amplitude: float
    speed: float
    scaled: float

    @property
    def is_met(self) -> bool:
        """Whether the scaled motion takes at most 75 % of the clearance."""
        return self.scaled <= _CLEARANCE * self.clearance


@dataclass(frozen=True)
class UnbalanceCheck:
    """The response of a machine to unbalance in its operating range, against API 617 and 684.

    contacts: `open` or `pinned`; criticals: critical speeds of the probes, by ascending speed;
    probes: the largest motion of each; clearances: how far each is used up;
    low, high: minimum and maximum continuous speed [rad/s]; top: up to which critical speeds are
    looked for [rad/s]; unbalances: (node from 1 or `Place`,
    amount [kg.m], angle [rad]), None: the machine's own; limit: of vibration at the probes,
    peak-to-peak [m]; scale: factor on the unbalance with which the probes reach that limit [1].
    """

    contacts: str
    low: float
    high: float
    top: float
    unbalances: tuple[PlacedAmount, ...] | None
    criticals: tuple[ProbeCritical, ...]
    probes: tuple[ProbeLevel, ...]
    limit: float
    scale: float
    clearances: tuple[ClearanceLevel, ...]

    @property
    def is_met(self) -> bool:
        """Whether margins, vibration at the probes and clearances are as required."""
        return (
            all(critical.margin.is_met for critical in self.criticals if critical.margin)
            and all(probe.peak_to_peak <= self.limit for probe in self.probes)
            and all(clearance.is_met for clearance in self.clearances)
        )


def unbalance_check(
    rotor: Rotor,
    low: float,
    high: float,
    probes: Sequence[int],
    *,
    unbalances: Sequence[PlacedAmount] | None = None,
    clearances: Mapping[int, float] | None = None,
    contacts: str | None = None,
) -> UnbalanceCheck:
    """Return the response to unbalance held against API 617 and 684.

    rotor: the clearances of its open contacts are checked, all up to its trip speed, or to `high`
    where it has none; low, high: minimum and maximum continuous speed [rad/s]; probes: nodes (from
    1) with probes; unbalances: node (from 1), amount [kg.m] and angle [rad] of each, by default the
    machine's; clearances: radial ones [m] of seals by their nodes (from 1); contacts: `open` or
    `pinned`, by default open where the machine is held without them. Raises `LinearError` if the
    range, a node or a clearance cannot be, or no unbalance acts.
    """
    low, high = number("low", low), number("high", high)
    if not (0 < low <= high < math.inf):
        raise LinearError(f"operating range = {low:g} to {high:g} rad/s: must ascend from above 0")
    checked_speed(high, "high")
    probes = listed("probes", probes, "nodes")
    whirl = _driven_whirl(rotor, contacts, unbalances)
    checked = _gaps(rotor, whirl, mapped("clearances", clearances))
    trip = max(high, rotor.operation.trip_speed or high)
    top = highest_of_interest(rotor, high)
    speeds = close_speeds(rotor, top, contacts)
    modes = damped_criticals(rotor, _grid(rotor, top, contacts), contacts)
    criticals = [
        replace(critical, margin=margin(critical.peak, low, high))
        for critical in _criticals(whirl, probes, speeds, modes)
    ]
    limit = vibration_limit(high)
    within = np.unique(np.append(speeds[(speeds > low) & (speeds < high)], [low, high]))
    levels = [_level(whirl, node, within) for node in probes]
    largest = max((level.peak_to_peak for level in levels), default=0.0)
    scale = limit / largest if largest > 0 else math.inf
    to_trip = np.append(speeds[speeds < trip], trip)
    return UnbalanceCheck(
        contacts=whirl.machine.contacts,
        low=low,
        high=high,
        top=top,
        unbalances=None if unbalances is None else tuple(unbalances),
        criticals=tuple(criticals),
        probes=tuple(levels),
        limit=limit,
        scale=scale,
        clearances=tuple(_clearance_level(whirl, gap, to_trip, scale) for gap in checked),
    )


def highest_of_interest(rotor: Rotor, high: float) -> float:
    """Return the highest speed of interest [rad/s], for critical speeds or clearances; high: the
    maximum continuous one."""
    return max(OF_INTEREST * high, rotor.operation.trip_speed or high)


def critical_peaks(
    rotor: Rotor,
    top: float,
    nodes: Sequence[int],
    *,
    unbalances: Sequence[PlacedAmount] | None = None,
    contacts: str | None = None,
) -> tuple[ProbeCritical, ...]:
    """Return the peaks of x and y of nodes (from 1) up to the speed `top` [rad/s], negative where
    the shaft turns backward, by ascending speed, with their amplification factors; see
    `unbalance_check` for the rest."""
    check_positive("speed", abs(checked_speed(top)), "rad/s", LinearError)
    whirl = _driven_whirl(rotor, contacts, unbalances)
    nodes = listed("nodes", nodes, "nodes")
    speeds = close_speeds(rotor, top, contacts)
    modes = damped_criticals(rotor, _grid(rotor, top, contacts), contacts)
    return tuple(_criticals(whirl, nodes, speeds, modes))


def _driven_whirl(
    rotor: Rotor, contacts: str | None, unbalances: Sequence[PlacedAmount] | None
) -> SteadyWhirl:
    """Return `steady_whirl`; raises `LinearError` where no unbalance drives it."""
    whirl = steady_whirl(rotor, contacts, unbalances)
    if not whirl.is_driven:
        raise LinearError(
            "no unbalance acts, so that there is no response to check: give the machine one, "
            "or place those of API 617 for a mode"
        )
    return whirl


def _criticals(
    whirl: SteadyWhirl, nodes: Sequence[int], speeds: np.ndarray, modes: Sequence[float]
) -> list[ProbeCritical]:
    """Return the peaks of nodes over speeds; modes: the damped critical speeds [rad/s]."""
    result = []
    for node in nodes:
        check_node(whirl.machine, node)
        for axis in (0, 1):
            seen = peaks(partial(_amplitude, whirl, node, axis), speeds)
            of_modes = (peak for peak in seen if _is_of_a_mode(whirl, node, axis, peak, modes))
            result += [ProbeCritical(node, "xy"[axis], peak, None) for peak in of_modes]
    return sorted(result, key=lambda c: (float(f"{c.peak.speed:.6g}"), c.node, c.axis))


def _is_of_a_mode(
    whirl: SteadyWhirl, node: int, axis: int, peak: Peak, modes: Sequence[float]
) -> bool:
    """Return whether a mode resonates at a peak of a node in x or y: a damped critical speed lies
    between its half-power points, or the phase turns there, by 90 deg where a mode is alone. Where
    neither is so the response of other modes has a largest value before an antiresonance, which is
    no critical speed by API 684; modes: the damped critical speeds [rad/s]."""
    low, high = peak.between
    is_sharp = peak.amplification >= DAMPED and low < high
    if not is_sharp or any(low <= speed <= high for speed in modes):
        return True
    motion = [whirl.at(speed)[2 * (node - 1), axis] for speed in np.linspace(low, high, _ACROSS)]
    return float(np.ptp(np.unwrap(np.angle(motion)))) > _TURNS


def close_speeds(rotor: Rotor, top: float, contacts: str | None = None) -> np.ndarray:
    """Return speeds from 0 to `top` so close together that no peak lies between them: those of a
    grid, and more of them about the damped critical speeds."""
    close = with_criticals(rotor, _grid(rotor, top, contacts), contacts)
    return close[close != 0.0]


def _grid(rotor: Rotor, top: float, contacts: str | None) -> np.ndarray:
    return np.linspace(lowest_speed(rotor, top, contacts), top, SPEEDS)


def _amplitude(whirl: SteadyWhirl, node: int, axis: int, speed: float) -> float:
    """Return the amplitude of a node in x or y [m]."""
    motion = np.abs(whirl.at(speed))
    result = float(motion[2 * (node - 1), axis])
    return result if result > _ROUNDING * motion[::2].max() else 0.0


def _level(whirl: SteadyWhirl, node: int, speeds: np.ndarray) -> ProbeLevel:
    speed, major = largest(partial(major_axis, whirl, 2 * (node - 1), -1, 0.0), speeds)
    return ProbeLevel(node, 2 * major, speed)


def _gaps(rotor: Rotor, whirl: SteadyWhirl, clearances: Mapping[int, float]) -> list[Gap]:
    """Return the clearances [m] of seals, given by their nodes (from 1), and of open contacts."""
    result = []
    for node, clearance in clearances.items():
        if not (0 < number(f"clearances: {node}", clearance) < math.inf):
            raise LinearError(f"clearance of node {node} = {clearance:g} m: must be > 0")
        dof = 2 * (check_node(whirl.machine, node) - 1)
        result.append(Gap(f"node {node}", clearance, dof, -1))
    if whirl.machine.contacts == OPEN:
        result += gaps(whirl.machine, walls(rotor))
    return result


def _clearance_level(
    whirl: SteadyWhirl, gap: Gap, speeds: np.ndarray, scale: float
) -> ClearanceLevel:
    speed, major = largest(gap.size(whirl), speeds)
    scaled = max(scale, 1.0) * major if major else 0.0
    return ClearanceLevel(gap.name, gap.clearance, major, speed, scaled)
