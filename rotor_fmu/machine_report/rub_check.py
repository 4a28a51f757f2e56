"""The check of clearances continued into contact: where the linear response closes a clearance, or
is not reached since the machine is unstable, it is run up and down with its contacts, and the runs
say what the rub does."""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from ..api.machine import Machine
from ..api.result import Result
from ..api.simulate import simulate
from ..display import current
from ..model.linear.amplification import with_tops
from ..model.linear.places import PlacedAmount
from ..model.linear.supports import touching, walls
from ..model.linear.unbalance import SteadyWhirl, steady_whirl
from ..model.linear.unbalance_check import close_speeds, highest_of_interest
from ..model.linear.unbalance_peaks import gaps, major_axis
from ..model.machine.rotor import Rotor
from ..model.message_templates import Message
from ..model.parts.base import ProbeElement
from ..model.structure.assembly import assemble
from ..model.structure.reduction_offer import reduction_offer
from ..run_status import has_failed, on_numbers, status_of
from ..runs.measuring_points import bearings_of, last_of_the_largest
from .closings import Closing, closings_of, orbit_across
from .swept_amplitude import amplitude_over_speed
from .unbalanced import with_unbalances

_TURNS = 1200.0  # of a run up or down
_SETTLING = 60.0  # turns at the first speed, before the run begins, and at the highest one
_FIRST = 0.1  # of the highest speed: where a run begins
_POINTS = 800
_LASTING = 0.02  # of the turns in the range, from which a rub lasts
_ENDLESS = 1000.0  # times the amplitude of a run, above which that of a response is not told
_NARROW = 0.01  # of the highest speed: what a run passes of a range that is a single speed


class ContactRun(NamedTuple):
    """A contact in a run: its name, the speeds of its first and last touch [rad/s], the shares of
    time that it touches in the operating range and in the whole run [1], of the turns in the range
    the share in which it touches [1], the largest normal force [N]; all NaN of a run that failed
    before it had settled. What bounces once a turn rubs all the time, touching hardly ever."""

    name: str
    first: float
    last: float
    share_in_range: float
    share: float
    turns_in_range: float
    force: float


class RubRun(NamedTuple):
    """A run with contacts: `run-up` or `run-down`; its status; what it says of its numbers; of the
    place that moves most, the speed [rad/s] and the amplitude there [m], shape (n,); what each
    contact did."""

    direction: str
    status: str
    messages: list[Message]
    speed: np.ndarray
    amplitude: np.ndarray
    contacts: tuple[ContactRun, ...]


@dataclass(frozen=True)
class RubCheck:
    """What happens where the response closes a clearance, or the machine is unstable.

    low, high: operating range [rad/s]; is_stable: whether the machine comes to its response there;
    can_touch: whether it has a contact; scale: factor on the unbalances [1]; closings: clearances
    that the linear response closes; place: the part whose motion is shown, speed, linear: its
    linear amplitude over the speed [rad/s], [m]; runs: with contacts, none of a stable machine
    where nothing closes; films: contacts that are the surfaces behind oil films.
    """

    low: float
    high: float
    is_stable: bool
    can_touch: bool
    scale: float
    closings: tuple[Closing, ...]
    place: str
    speed: np.ndarray
    linear: np.ndarray
    runs: tuple[RubRun, ...]
    films: tuple[str, ...] = ()

    @property
    def carries(self) -> bool:
        """Whether contacts hold the machine, so that the linear response takes them as closed."""
        return bool(self.closings) and all(math.isnan(c.begin) for c in self.closings)

    @property
    def touched(self) -> list[ContactRun]:
        """What contacts did that touched in a run."""
        return [c for run in self.runs for c in run.contacts if c.share > 0]

    @property
    def conclusion(self) -> str:
        """What the runs say, in a sentence or two."""
        if not self.can_touch:
            more = "" if self.is_stable else "; `rotor-fmu run-up` says by how much it whirls"
            return f"The machine has no contact to run with{more}."
        if not (self.closings or self.runs):
            return "The linear response closes no contact; no run with contacts was needed."
        for run in self.runs:
            if has_failed(run.status):
                return f"The {run.direction} with contacts {run.status}."
        touched = self.touched
        size = max(float(run.amplitude.max(initial=0.0)) for run in self.runs)
        largest_linear = float(self.linear.max(initial=0.0))
        far, linear = (
            f"{float(f'{each * current().small:.3g}'):g} {current().small_word} 0-p"
            for each in (size, largest_linear)
        )
        if largest_linear > _ENDLESS * size:  # at a critical speed that hardly anything damps
            linear = f"more than {_ENDLESS:g} times that"
        grow = any(message.code == "unstable" for run in self.runs for message in run.messages)
        if not touched and (grow or not self.is_stable):
            return (
                f"In the runs with contacts the machine whirls by up to {far}, and touches nothing."
            )
        if not touched:
            return (
                "The linear response closes a clearance, but the runs pass without touching: at "
                "this rate of the speed the resonance has no time to build up, or oil films bear "
                "more than their linearized ones."
            )
        lasting = [c for c in touched if c.turns_in_range > _LASTING]
        largest = max(touched, key=lambda c: c.force)
        force = f"{largest.force * current().force:.4g} {current().force_unit}"
        force = f"The largest contact force is {force}, of {largest.name}."
        if self.carries:
            return (
                f"Contacts carry the machine: in the runs {self.place} whirls by up to {far}, in "
                f"the linear response, which takes them as closed, by {linear}. {force}"
            )
        rubs = [c for c in lasting or touched if c.name not in self.films]
        behind_films = [c for c in lasting or touched if c.name in self.films]
        is_inside = any(c.turns_in_range > 0 for c in touched)
        but = f", but not {'for long ' if is_inside else ''}in the operating range"
        said = []
        if rubs:
            where = f"The rub lasts in the operating range {self._how(rubs)}"
            said.append(where if lasting else f"The machine rubs{but}")
        if behind_films:
            names = ", ".join(dict.fromkeys(c.name for c in behind_films))
            where = f" in the operating range {self._how(behind_films)}"
            said.append(
                f"Surfaces touch through oil films{where if lasting else f'{but} ({names})'}"
            )
        return " ".join([*(f"{each}." for each in said), force])

    def _how(self, contacts: Sequence[ContactRun]) -> str:
        """Return which contacts last, and in which directions."""
        names = dict.fromkeys(c.name for c in contacts)
        up, down = (
            max((c.turns_in_range for c in run.contacts if c.name in names), default=0.0) > _LASTING
            for run in self.runs
        )
        how = "in both directions" if up and down else "only running up"
        if down and not up:
            how = "only running down: it depends on where the motion comes from"
        return f"({', '.join(names)}), {how}"


def rub_check(
    rotor: Rotor,
    low: float,
    high: float,
    unbalances: Sequence[PlacedAmount] | None = None,
    scale: float = 1.0,
    say: Callable[[str], None] = lambda text: None,
    is_stable: bool = True,
) -> RubCheck:
    """Return what the machine does where its response to unbalance closes a clearance, or is not
    reached.

    low, high: operating range [rad/s]; unbalances: (node from 1 or place, amount [kg.m], angle
    [rad]), None: the machine's own; scale: factor on them; say: is given what takes long;
    is_stable: whether the machine comes to its response up to `high`.
    """
    machine = with_unbalances(rotor, unbalances, scale)
    top = max(high, rotor.operation.trip_speed or 1.25 * high)
    whirl = steady_whirl(rotor, None, unbalances)
    close = close_speeds(rotor, highest_of_interest(rotor, high))
    first = max(_FIRST * top, close[0])
    close = np.unique([first, *close[(close > first) & (close < top)], top])
    closings = closings_of(rotor, whirl, scale, close, high)
    probes: dict[str, Callable[[float], float]] = {
        name: _scaled(scale, whirl, 2 * of.node - 2, 2 * of.node - 1, of.offset)
        for name, of in rotor.elements_of_kind(ProbeElement)
    }
    if not probes:  # a machine none of whose parts is seen to move but in its contacts
        probes = {
            gap.name: partial(orbit_across, gap, scale, whirl)
            for gap in gaps(whirl.machine, touching(rotor))
        }
    speeds = with_tops(list(probes.values()), close)
    seen = {name: np.array([size(s) for s in speeds]) for name, size in probes.items()}
    bearings = bearings_of(rotor)
    largest = [(float(sizes.max()), name in bearings) for name, sizes in seen.items()]
    place = [*seen][last_of_the_largest(largest)] if seen else ""
    linear = seen.get(place, np.zeros(len(speeds)))
    runs: tuple[RubRun, ...] = ()
    can_touch = bool(touching(rotor))
    if closings or (can_touch and not is_stable):
        say(f"run-up and run-down with contacts, {_TURNS:g} turns each: may take minutes")
        runs = _up_and_down(machine, top, (low, high), place)
    shown = place, speeds, linear
    known = low, high, is_stable, can_touch, scale, tuple(closings)
    films = tuple(name for name in touching(rotor) if name not in walls(rotor))
    return RubCheck(*known, *shown, runs, films)


def _scaled(
    scale: float, whirl: SteadyWhirl, dof: int, other: int, factor: float
) -> Callable[[float], float]:
    """Return `major_axis` as a function of the speed, times a factor on all unbalances."""
    return lambda speed: scale * major_axis(whirl, dof, other, factor, speed)


def _up_and_down(
    rotor: Rotor, top: float, operating: tuple[float, float], place: str
) -> tuple[RubRun, ...]:
    """Run the machine up, and down from where that has brought it, with its contacts, by as few
    component modes as do. A start at the highest speed would be a transient that outlasts the
    settling of a machine with little damping. A run-up that fails has no run-down."""
    first = _FIRST * top
    settled = _SETTLING * 2 * math.pi / first  # until the start at this speed is forgotten
    lasts = _TURNS * 4 * math.pi / (first + top)
    reached = settled + lasts
    left = reached + _SETTLING * 2 * math.pi / top
    stop = left + lasts
    offer = reduction_offer(rotor, assemble(rotor), top)
    contacts = list(touching(rotor))
    record = [f"{name}.{what}" for name in contacts for what in ("fn", "contact")]
    record += [f"{place}.{axis}" for axis in "xy"] if place else []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = simulate(
            Machine(rotor, ""),
            speed=([0.0, settled, reached, left, stop], [first, first, top, top, first]),
            tolerance=1e-3,
            parameters={"solver.reduction": offer.modes} if offer else {},
            record=record,
            per_turn=None,  # a hard contact lasts less than a 64th of a turn
            step=stop / _POINTS,
        )
    wider = max(0.0, 0.5 * (_NARROW * top - (operating[1] - operating[0])))
    passed = (operating[0] - wider, operating[1] + wider)
    messages = on_numbers(result.messages, result.codes)
    runs = []
    for direction, begin, end in (("run-up", settled, reached), ("run-down", reached, stop)):
        during = (result.t >= begin) & (result.t <= end)
        is_last = not result.t[-1] > end
        status = result.status if is_last else status_of(messages)
        speed, amplitude = amplitude_over_speed(result, place, during)
        seen = tuple(_contact_run(result, name, passed, during) for name in contacts)
        runs.append(RubRun(direction, status, messages, speed, amplitude, seen))
        if has_failed(status):
            break
    return tuple(runs)


def _contact_run(
    result: Result, name: str, passed: tuple[float, float], during: np.ndarray
) -> ContactRun:
    if np.count_nonzero(during) < 2:
        return ContactRun(name, *6 * [math.nan])
    w = np.abs(result.speed)[during]
    touches = result[f"{name}.contact"][during] > 0.5
    weight = np.gradient(result.t[during])
    inside = (w >= passed[0]) & (w <= passed[1])
    where = np.flatnonzero(touches)
    first, last = (float(w[i]) for i in where[[0, -1]]) if len(where) else (math.nan, math.nan)
    share_in_range = weight[touches & inside].sum() / max(weight[inside].sum(), 1e-300)
    share = weight[touches].sum() / weight.sum()
    turn = np.floor(np.cumsum(w * weight) / (2 * math.pi))
    turns = len(np.unique(turn[touches & inside])) / max(len(np.unique(turn[inside])), 1)
    force = result[f"{name}.fn"][during].max(initial=0.0)
    return ContactRun(name, first, last, float(share_in_range), float(share), turns, float(force))
