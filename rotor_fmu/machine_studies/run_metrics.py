"""The metrics of a run in time: what its windows come to, a function a kind; those of whole turns
are in `held_metrics`."""

import math
from functools import partial

import numpy as np

from ..model.contact.wall import ContactQuantities
from ..studies.study import Cell
from ..vibration import TooFewRows, TooFewTurns, displacement, order_track
from . import held_metrics
from .metric import (
    ROUNDING,
    ListAxis,
    Metric,
    MetricKind,
    bin_middles,
    declared,
    edges_of,
    is_whole,
)
from .run_excitation import Excitation, Window
from .run_kinds import STEPS

KINDS: dict[str, MetricKind] = {**held_metrics.KINDS}
_kind = partial(declared, KINDS)
DIRECTIONS = ("up", "down")
_AFTER = {"after": 0.0}
_MOST_PASSED = 32  # orders are passed in turns resampled at 64 angles at least


def cell(metric: Metric, windows: list[Window], how: Excitation) -> Cell:
    """Return the cell of a finished run."""
    if metric.kind.name == "jump":
        return metric.kind.make(metric, windows)
    made = [metric.kind.make(metric, window) for window in windows]
    if metric.kind.axis is not None:
        return np.concatenate(made).tolist()
    numbers = [float(number) for number in made]
    return numbers if how.kind.name == STEPS.name else numbers[0]


def axis_of(metric: Metric, how: Excitation, is_varied: bool) -> ListAxis | None:
    """Return the axis of the cell's list, None of a number; is_varied: whether the held speeds
    differ from run to run."""
    if metric.kind.axis is not None:
        return metric.kind.axis(metric, how)
    if metric.kind.name == "jump" or how.kind.name != STEPS.name:
        return None
    return ListAxis("held speed", () if is_varied else tuple(how.speeds.tolist()), "rad/s")


def check(metric: Metric, how: Excitation) -> None:
    """Raise `InputError` for a metric that does not suit the excitation of the runs."""
    kind = metric.kind
    if kind.held and (how.kind.name not in kind.held or how.numbers["measure"]):
        of_kind = " or ".join(kind.held)
        raise metric.error(
            f"{kind.said} needs runs at constant speed in whole turns, of the kind {of_kind}"
        )
    if kind.varying and how.kind.holds_speeds:
        raise metric.error(f"{kind.said} needs runs whose speed varies continuously")
    if (after := metric.option("after")) and after < 0:
        raise metric.error(f"after = {after:g} s: must be >= 0")
    if kind.check is not None:
        kind.check(metric, how)


def _late(metric: Metric, window: Window) -> slice:
    """Return the rows from `after` on in the window; none where it ends before."""
    t = window.steps.t
    return slice(int(np.searchsorted(t, t[0] + metric.option("after"))), None)


def _late_values(metric: Metric, window: Window) -> tuple[np.ndarray, np.ndarray]:
    late = _late(metric, window)
    return window.steps.t[late], window.steps.quantity(metric.of)[late]


def _averaged(t: np.ndarray, values: np.ndarray) -> float:
    """Return the average by the trapezoidal rule over all steps; nan if there are none."""
    return float(np.trapezoid(values, t) / (t[-1] - t[0])) if len(t) > 1 else math.nan


@_kind("largest absolute value of {of}", optional=_AFTER)
def _peak(metric: Metric, window: Window) -> float:
    values = np.abs(_late_values(metric, window)[1])
    return float(values.max()) if len(values) else math.nan


def _check_along(metric: Metric, how: Excitation) -> None:
    if metric.of.endswith(".r"):
        raise metric.error(f"{metric.of}: vibration is peak-to-peak along an axis, as PART.x")


@_kind(
    "largest peak-to-peak value in 16 turns of {of}",
    optional=_AFTER,
    check=_check_along,
    also=("phi",),
    is_fine=True,
)
def _peak_to_peak(metric: Metric, window: Window) -> float:
    """Return the vibration as ISO 20816-1 has it, wherever the shaft lies; nan without a turn."""
    t, values = _late_values(metric, window)
    phi = window.steps.columns["phi"][_late(metric, window)]
    try:
        return float(displacement(t, phi, values).x_pp.max())
    except (TooFewRows, TooFewTurns):
        return math.nan


@_kind("root of the mean square over time of {of}", optional=_AFTER)
def _rms(metric: Metric, window: Window) -> float:
    t, values = _late_values(metric, window)
    return math.sqrt(_averaged(t, values**2))


@_kind("mean over time of {of}", optional=_AFTER, least=_rms)
def _mean(metric: Metric, window: Window) -> float:
    t, values = _late_values(metric, window)
    if not metric.is_direction:
        return _averaged(t, values)
    mean = math.atan2(_averaged(t, np.sin(values)), _averaged(t, np.cos(values)))
    return mean % math.tau if (values >= 0).all() else mean


def _around(metric: Metric, window: Window, at: int) -> np.ndarray:
    """Return the steps' values within half a turn of a row of them."""
    phi = window.steps.columns["phi"]
    return window.steps.quantity(metric.of)[np.abs(phi - phi[at]) <= math.pi]


def _size_around(metric: Metric, window: Window, at: int) -> float:
    """Return the root mean square of a turn, since what vibrates may be 0 at an instant."""
    return float(np.sqrt(np.mean(_around(metric, window, at) ** 2)))


def _last_size(metric: Metric, window: Window) -> float:
    return _size_around(metric, window, -1)


@_kind("value at the end of {of}", also=("phi",), least=_last_size)
def _last(metric: Metric, window: Window) -> float:
    return float(window.steps.quantity(metric.of)[-1])


def _passage(metric: Metric, window: Window) -> tuple[int, float] | None:
    """Return the row before the speed is first passed, and the share of the step until then; None
    if it never is."""
    speed = window.steps.columns["w"]
    w = speed - metric.option("speed")
    w[np.abs(w) <= ROUNDING * np.abs(speed).max()] = 0.0  # a run may end at the speed
    passed = np.flatnonzero(w[1:] * w[:-1] <= 0)
    if not len(passed):
        return None
    at = int(passed[0])
    return at, float(w[at] / (w[at] - w[at + 1])) if w[at] != w[at + 1] else 0.0


def _passed_size(metric: Metric, window: Window) -> float:
    passage = _passage(metric, window)
    return _size_around(metric, window, passage[0]) if passage else 0.0


@_kind(
    "value when the speed first passes {speed:g} rad/s, of {of}",
    "speed",
    also=("w", "phi"),
    least=_passed_size,
    varying=True,
)
def _value(metric: Metric, window: Window) -> float:
    """Return the value at a speed, linear between two steps; nan if it is never passed."""
    passage, values = _passage(metric, window), window.steps.quantity(metric.of)
    if passage is None:
        return math.nan
    at, share = passage
    rise = values[at + 1] - values[at]
    return float(
        values[at] + share * (math.remainder(rise, math.tau) if metric.is_direction else rise)
    )


def _bin_axis(metric: Metric, how: Excitation) -> ListAxis:
    return ListAxis(f"{metric.name} speed", bin_middles(metric.option("bins")), "rad/s")


@_kind(
    "largest absolute value in each bin of the speed of {of}",
    "bins",
    axis=_bin_axis,
    also=("w",),
    varying=True,
)
def _amplitude(metric: Metric, window: Window) -> np.ndarray:
    edges = edges_of(metric.option("bins"))
    values, w = np.abs(window.steps.quantity(metric.of)), window.steps.columns["w"]
    at = np.digitize(w, edges) - 1
    at[w == edges[-1]] = len(edges) - 2  # the last bin has both of its ends
    largest = np.full(len(edges) - 1, math.nan)
    inside = (at >= 0) & (at < len(largest))
    np.fmax.at(largest, at[inside], values[inside])
    return largest


def _check_passing(metric: Metric, how: Excitation) -> None:
    order = metric.option("order")
    if not 0 < order < _MOST_PASSED or not is_whole(2 * order):
        raise metric.error(
            f"order = {order:g}: must be a multiple of 0.5 from 0.5 to {_MOST_PASSED - 0.5:g}"
        )


def _passed_spread(metric: Metric, window: Window) -> float:
    passage = _passage(metric, window)
    return float(_around(metric, window, passage[0]).std()) if passage else 0.0


@_kind(
    "amplitude of order {order:g} where {speed:g} rad/s is first passed, 0-p, of {of}",
    "order",
    "speed",
    check=_check_passing,
    least=_passed_spread,
    also=("w", "phi"),
    varying=True,
    is_fine=True,
)
def _passing(metric: Metric, window: Window) -> float:
    """Return the amplitude of an order by revolution-synchronous resampling, from the block of
    turns nearest to the first passage of the speed; nan where it is not passed, or in steps too
    long for the order."""
    phi, order = window.steps.columns["phi"], metric.option("order")
    try:
        track = order_track(window.steps.t, phi, window.steps.quantity(metric.of), [order])
    except TooFewTurns:
        return math.nan
    apart = track.speed - metric.option("speed")
    is_one_way = track.speed[1:] * track.speed[:-1] > 0
    passed = np.flatnonzero((apart[1:] * apart[:-1] <= 0) & is_one_way)
    if not len(passed):
        return math.nan
    at = passed[0] + int(abs(apart[passed[0] + 1]) < abs(apart[passed[0]]))
    return float(abs(track.x(order)[at]))


@_kind("time in contact of {of}", optional=_AFTER, unit="s", outputs=("contact",), is_fine=True)
def _contact(metric: Metric, window: Window) -> float:
    late = _late(metric, window)
    closed, t = window.steps.columns[f"{metric.of}.contact"][late], window.steps.t[late]
    return float(np.trapezoid(closed, t)) if len(t) else math.nan


@_kind(
    "work of friction at a contact of {of}",
    unit="J",
    outputs=("ft", "x", "y"),
    also=("phi",),
    is_fine=True,
)
def _dissipated(metric: Metric, window: Window) -> float:
    """Return friction times the sliding distance: that of the journal's surface, R dphi, and of its
    centre along the wall."""
    force, x, y = (window.steps.columns[f"{metric.of}.{name}"] for name in ("ft", "x", "y"))
    z, contact = x + 1j * y, metric.contact
    assert contact is not None  # since it has friction
    outward = _outward(contact, 0.5 * (z[1:] + z[:-1]))
    along = (outward.conj() * np.diff(z)).imag
    slid = contact.journal_radius * np.diff(window.steps.columns["phi"]) + along
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * slid))


def _outward(contact: ContactQuantities, z: np.ndarray) -> np.ndarray:
    """Return the unit normal of the wall where a journal displaced by z points, 0 at its centre:
    that of grad(|z| - clearance), which a worn clearance turns away from z."""
    r = np.abs(z)
    half = 0.5 * (np.angle(z) - contact.wear_angle)
    steep = contact.wear_power * (np.cos(half) ** 2) ** (contact.wear_power - 1)
    by_angle = -contact.wear * steep * np.cos(half) * np.sin(half)
    gradient = z * (r - 1j * by_angle)
    return gradient / np.where(r > 0, np.abs(gradient), 1.0)


@_kind("work of friction at a contact of {of}", unit="J", outputs=("ft", "sliding"), is_fine=True)
def _slid(metric: Metric, window: Window) -> float:
    """Return friction times the sliding speed, of a contact that gives it since its wall turns."""
    force, speed = (window.steps.columns[f"{metric.of}.{name}"] for name in ("ft", "sliding"))
    return float(np.trapezoid(force * speed, window.steps.t))


def _fastest(metric: Metric, window: Window) -> float:
    return float(np.abs(window.steps.columns["w"]).max())


@_kind(
    "mean rate at which {of} turns about zero in x and y",
    unit="rad/s",
    least=_fastest,
    outputs=("x", "y"),
    also=("w",),
    is_fine=True,
)
def _whirl(metric: Metric, window: Window) -> float:
    x, y = (window.steps.columns[f"{metric.of}.{axis}"] for axis in "xy")
    angle = np.unwrap(np.arctan2(y, x))
    span = window.steps.t[-1] - window.steps.t[0]
    return float((angle[-1] - angle[0]) / span) if span > 0 else math.nan


def _check_jump(metric: Metric, how: Excitation) -> None:
    if how.kind.name != STEPS.name or len(how.speeds) < 2:
        raise metric.error("jump needs runs in steps of the speed, two at least")


@_kind(
    "speed of the largest jump of the mean of {of} on the way {way}",
    "way",
    optional={"least": 0.2},
    unit="rad/s",
    check=_check_jump,
)
def _jump(metric: Metric, windows: list[Window]) -> float:
    """Return the mean of the two neighbouring speeds between which the mean changes most, by at
    least the share `least` of the larger of both; nan where it does not."""
    means = np.array([_averaged(w.steps.t, w.steps.quantity(metric.of)) for w in windows])
    speeds = np.array([window.speed for window in windows])
    rises = np.diff(np.abs(speeds)) > 0
    chosen = rises if metric.option("way") == "up" else ~rises
    change = np.where(chosen, np.abs(np.diff(means)), 0.0)
    at = int(np.argmax(change))
    if not change[at] > metric.option("least") * np.abs(means[at : at + 2]).max():
        return math.nan
    return float(0.5 * (speeds[at] + speeds[at + 1]))
