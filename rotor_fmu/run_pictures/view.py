"""The view that a picture shows, and the common parts of all pictures of signals."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from .. import vibration
from ..display import Display, current, range_with_unit, speed_with_unit
from ..errors import InputError, number
from ..plotting.figure_style import entitle, new_panels
from ..runs.measuring_points import MeasuringPoint
from ..runs.peaks import largest_row, start_up
from ..runs.recording import Recording

# Positions of a contact angle and their labels.
ANGLES = ([0, 90, 180, 270, 360], ["0 right", "90 top", "180 left", "270 bottom", "360"])
_AS_GOOD = 0.01  # of the highest speed: how far a chosen speed may lie beyond those of a run
_CONSTANT = 1e-6  # of a speed: a range that is less than this is rounding
_STANDS = 1e-8  # in the unit that is shown: of what is slower rounding may be all
_NEAR_STANDSTILL = 0.4  # of the highest speed: a run that comes so near is drawn down to standstill


class TurnsShown(NamedTuple):
    """Consecutive turns of a run: the recorded rows within them, how many turns there are (0 where
    the shaft stands: all rows), their mean speed [rad/s], and when they begin and end [s]."""

    rows: np.ndarray
    turns: int
    speed: float
    begin: float
    end: float


@dataclass(frozen=True)
class View:
    """The view that a picture shows.

    run: the recording; name: of a place or contact, None for the one that moves most, or is pressed
    most; chosen_speed [rad/s]: None for that of the largest 1x after the start-up; time [s]: in the
    place of a speed; wants_pp: whether amplitudes are peak-to-peak whatever the units in which they
    are shown; heading: what titles begin with, by default the machine's name.
    """

    run: Recording
    name: str | None = None
    chosen_speed: float | None = None
    wants_pp: bool = False
    time: float | None = None
    heading: str = ""

    @property
    def place(self) -> MeasuringPoint:
        """The place that moves."""
        return self.run.place(self.name)

    @property
    def signal(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """t, phi, z of the place."""
        return self.run.t, self.run.phi, self.place.z

    @property
    def speed(self) -> float:
        """Speed at which orbit and spectrum are taken [rad/s], without a chosen one that of the
        largest 1x, or of the largest displacement in a run of too few turns for that; `InputError`
        for a chosen one that the run never had."""
        if self.chosen_speed is not None:
            chosen = number("speed", self.chosen_speed)
            known = self.run.w[np.isfinite(self.run.w)]
            low, high = known.min(initial=np.inf), known.max(initial=-np.inf)
            reach = _AS_GOOD * max(abs(low), abs(high))
            if len(known) and not low - reach <= chosen <= high + reach:
                shown = f"{speed_with_unit(chosen)} ({chosen:g} rad/s)"
                raise InputError(f"speed = {shown}: the run turns {range_with_unit(low, high)}")
            return chosen
        begin = start_up(self.run.t, self.run.w)
        try:
            track = vibration.order_track(*self.signal, (1.0,))
        except vibration.TooFewTurns as error:  # for 1x, though not for every picture
            if isinstance(error, vibration.TooFewRows) or not len(self.run.t):
                raise
            z = self.place.z
            return float(self.run.w[largest_row(self.run.t, np.abs(z - z[0]), begin)])
        return float(track.speed[largest_row(track.t, track.major(), begin)])

    def turns(self, count: int) -> TurnsShown:
        """Return consecutive turns about the time, or else nearest to the speed; fewer where the
        run has fewer."""
        t, phi = self.run.t, self.run.phi
        is_known = np.isfinite(t) & np.isfinite(phi)
        turns = vibration.turns_of(t[is_known], phi[is_known])
        count = min(count, turns.longest)
        if self.time is None:
            turns.needs(1)
            first = turns.nearest(self.speed, count)
        elif count:
            first = turns.nearest_in_time(self.time, count)
        else:
            return TurnsShown(np.flatnonzero(is_known), 0, 0.0, float(t[0]), float(t[-1]))
        begin, end = float(turns.begin[first]), float(turns.end[first + count - 1])
        rows = np.flatnonzero(is_known & (t >= begin) & (t <= end))
        speed = float(turns.speed_of(np.array([first]), count)[0])
        return TurnsShown(rows, count, speed, begin, end)

    @property
    def shown(self) -> Display:
        """The units in which the picture is shown."""
        return replace(current(), is_pp=self.wants_pp or current().is_pp)

    def title(self, axes: Axes, text: str, pad: float | None = None) -> None:
        """Write the heading of a picture."""
        heading = self.heading or self.run.machine
        entitle(axes, f"{heading}: {text}", pad=pad)


def broken_at_reversals(speed: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return a curve over the speed that is not drawn across a reversal."""
    return np.where(np.concatenate([[False], speed[1:] * speed[:-1] < 0]), np.nan, values)


def two_over_speed(heights: tuple[float, float] = (2, 1)) -> tuple[Figure, np.ndarray]:
    """Return a picture of two parts over one axis of speeds; heights: relative to each other."""
    figure, axes = new_panels(6.8, 5.4, 2, share_x=True, heights=heights)
    axes[1].set_xlabel(current().speed_label)
    return figure, axes


def widened(limits: tuple[float | None, float | None]) -> tuple[float, float]:
    """Return limits of speeds, 1 % about a speed that is constant to rounding."""
    low, high = (0.0 if end is None else end for end in limits)
    size = max(abs(low), abs(high))
    if abs(high - low) > _CONSTANT * size:
        return low, high
    reach = 0.01 * size or 1.0
    return low - reach, high + reach


def speed_axis(axes: Axes, speed: np.ndarray) -> None:
    """Label an axis of speeds, in the unit that is shown, and let it end at tens, or at ones,
    tenths, ... where the shaft is slower than that: down to standstill, unless the run stays far
    from it."""
    axes.set_xlabel(current().speed_label)
    highest = float(np.abs(speed).max(initial=0.0))
    # rounding leaves something of a shaft that stands
    step = min(10.0 ** math.floor(math.log10(highest)), 10.0) if highest > _STANDS else 10.0
    tens = np.round(speed / step, 9) if len(speed) else np.array([6.0])
    ends = float(tens.min()), float(tens.max())
    if min(ends) < _NEAR_STANDSTILL * max(ends) or ends[0] == ends[1]:
        ends = min(ends[0], 0.0), max(ends[1], 0.0)
    low = math.floor(ends[0])
    axes.set_xlim(step * low, step * (math.ceil(ends[1]) or (low == 0)))


def angle_axis(axes: Axes, label: str) -> None:
    """Make the upward axis one of contact angles [deg]."""
    axes.set_yticks(*ANGLES)
    axes.set(ylim=(0, 360), ylabel=f"Contact angle ψ{label} [deg]")


def displacement_axes(axes: Axes, place: MeasuringPoint) -> None:
    """Make both axes displacements of a place on one scale, with its clearance, if any."""
    unit = current().small_unit
    if place.clearance is not None:
        radius = place.clearance * current().small
        ring = Circle((0, 0), radius, fill=False, color="#000000", lw=1, ls=(0, (5, 3)))
        ring.set_label(f"clearance, {radius:.4g} {unit}")
        axes.add_patch(ring)
        axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel(f"Horizontal displacement of {place.label} [{unit}]")
    axes.set_ylabel(f"Vertical displacement [{unit}]")
