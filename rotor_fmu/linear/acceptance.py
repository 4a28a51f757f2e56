"""The critical speeds of API 617 and 684, for Python and the command line: the objects of
`model.linear`, which a notebook shows as a table and a picture."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, cycle
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..display import current, range_with_unit, speed_with_unit
from ..model import linear
from ..model.linear.amplification import DAMPED
from ..model.linear.critical_map import BearingStiffness
from ..model.linear.unbalance_check import ProbeCritical
from ..model.one_thread import on_one_thread
from ..plotting.colors import BLUE, DASHED, DOTTED, GREEN, GREY, LABEL, LIMIT, ORANGE
from ..plotting.figure_style import annotate, entitle, legend_below, new_figure
from ..tables import Table
from .displayed import Displayed, Machine, answer_of, displayed, of_machine, rotor_of
from .linear_plots import grouped, plain_ticks, shade

_MET = {True: "yes", False: "NO"}
_PRINTED, _SEEN = 1e-6, 1e-2  # shares by which stiffnesses differ in a table, and in a picture
_ROOM = 0.06  # of the height of a picture, for the words below the line of critical damping
_WIDEST = 80  # characters in a line of a label, as wide as the picture
_DASHES: tuple[Any, ...] = ("-", DASHED, DOTTED, (0, (6, 2, 1, 2)), (0, (9, 3)))


class CriticalMap(Displayed, linear.CriticalMap):
    """`model.linear.CriticalMap`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each crossing of a line by a bearing's own stiffness,
        bearings of the same stiffness together."""
        what = "Undamped forward critical speeds"
        if not self.synchronous:
            what = "Natural frequencies at standstill"
        title = (
            f"{what} where a bearing has the stiffness that all have; first critical speed on "
            f"rigid supports {speed_with_unit(self.rigid)}"
        )
        if not self.crossings:
            title += "; no bearing's own stiffness meets a line within the map"
        d = current()
        heads = (
            *("of", "mode", f"stiffness [{d.stiffness_unit}]"),
            *("critical [rad/s]", f"[{d.speed_unit}]"),
        )
        rows = [
            (
                *(_label_of(lines), c.mode + 1, float(c.stiffness) * d.stiffness),
                *(float(c.speed), float(c.speed) * d.speed),
            )
            for lines in self._own_lines(_PRINTED)
            for c in self.crossings
            if (c.bearing, c.axis) == (lines[0].bearing, lines[0].axis)
        ]
        return Table(title, heads, rows)

    def figure(self) -> Figure:
        """Draw the critical speeds over the stiffness, and the bearings' own stiffness."""
        figure, axes = new_figure(6.8, 5.2)
        d = current()
        stiffness = self.stiffness * d.stiffness
        for mode in range(self.speeds.shape[1]):
            axes.plot(stiffness, self.speeds[:, mode] * d.speed, color=BLUE, lw=1.6)
            last = self.speeds[-1, mode]
            if np.isfinite(last):
                at, aside = (stiffness[-1], last * d.speed), (4 + 9 * (mode % 2), 0)
                annotate(axes, f"{mode + 1}", at, aside, va="center", color=BLUE)
        # those of a bearing, which may lie on each other, differ in colour and dashes
        dashes = {"x": cycle(_DASHES), "y": cycle(_DASHES[1:] + _DASHES[:1])}
        for lines in self._own_lines(_SEEN):
            own = lines[0]
            inside = (own.stiffness >= self.stiffness[0]) & (own.stiffness <= self.stiffness[-1])
            if not inside.any():
                continue
            color = ORANGE if own.axis == "x" else GREEN
            over = np.where(inside, own.stiffness, np.nan) * d.stiffness
            ls, label = next(dashes[own.axis]), fill(_label_of(lines), _WIDEST)
            axes.plot(over, own.speed * d.speed, color=color, ls=ls, lw=1.4, label=label)
        for c in self.crossings:
            at = c.stiffness * d.stiffness, c.speed * d.speed
            axes.plot(*at, "o", color="black", mfc="white", ms=4.5)
        low, high = np.nanmin(self.speeds), np.nanmax(self.speeds)
        axes.set(xscale="log", yscale="log", ylim=(low * d.speed * 0.8, high * d.speed * 1.25))
        axes.set_xlim(stiffness[0], stiffness[-1])
        plain_ticks(axes.xaxis)
        plain_ticks(axes.yaxis)
        axes.set_xlabel(f"Stiffness of every bearing [{d.stiffness_unit}]")
        what, unit = "natural frequency at standstill", d.frequency_unit
        if self.synchronous:
            what, unit = "critical speed", d.speed_unit
        axes.set_ylabel(f"Undamped {what} [{unit}]")
        legend_below(figure)
        entitle(axes, self.titled("Undamped critical speed map"))
        return figure

    def _own_lines(self, alike: float) -> list[list[BearingStiffness]]:
        """Return the bearings' own stiffnesses, those together that differ by less than a share."""

        def are_alike(own: BearingStiffness, first: BearingStiffness) -> bool:
            return np.allclose(own.stiffness, first.stiffness, rtol=alike, equal_nan=True)

        return grouped(self.own, are_alike)


def _label_of(lines: Sequence[BearingStiffness]) -> str:
    return ", ".join(f"{each.bearing} k{each.axis}{each.axis}" for each in lines)


class UnbalanceCheck(Displayed, linear.UnbalanceCheck):
    """`model.linear.UnbalanceCheck`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each critical speed of a probe, for each probe, and for
        each clearance."""
        d = current()
        small = d.small_word
        heads = (
            *("what", f"at [{d.speed_unit}]", small, *_half_power_heads(), "AF"),
            *("required [%]", "actual [%]", "met"),
        )
        scaled = ""
        if 1 < self.scale < math.inf:
            scaled = (
                f" of the unbalance times {self.scale:.3g}, which brings the probes to that limit"
            )
        title = (
            f"API 617 {range_with_unit(self.low, self.high)}, contacts "
            f"{self.contacts}: critical speeds ({d.amplitude_words}) with separation margins, "
            f"probes ({small} p-p) against {self.limit * d.small:.4g} {small}, clearances "
            f"({small} 0-p{scaled}) against 75 %"
        )
        return Table(title, heads, list(self._rows()))

    def _rows(self) -> Iterable[tuple[object, ...]]:
        small, speed = current().small, current().speed
        for c in self.criticals:
            node, axis, *numbers = _peak(c)
            if c.margin is not None:
                needed, there = 100 * c.margin.required, 100 * c.margin.actual
                met = _MET[c.margin.is_met] if needed else _why_none(c.peak.amplification)
                yield (f"node {node} {axis}", *numbers, needed, there, met)
        for p in self.probes:
            met = _MET[p.peak_to_peak <= self.limit]
            share = 100 * p.peak_to_peak / self.limit
            where = f"probe at node {p.node}"
            yield (where, p.speed * speed, p.peak_to_peak * small, "", "", "", 100.0, share, met)
        for g in self.clearances:
            share, met = 100 * g.scaled / g.clearance, _MET[g.is_met]
            where = f"clearance {g.name}"
            yield (where, g.speed * speed, g.scaled * small, "", "", "", 75.0, share, met)

    def figure(self) -> Figure:
        """Draw the amplification factors over the speed, with the separation that each critical
        speed needs beside the operating range."""
        text = (
            "Critical speeds with the separations that they need\n"
            "circles x, squares y; orange: too near to the operating range, which is shaded"
        )
        figure, axes = _factors(self.titled(text), 9)
        shade([axes], (self.low, self.high))
        for critical in self.criticals:
            peak, needs = critical.peak, critical.margin
            if needs is None or math.isnan(peak.amplification):
                continue
            color = GREEN if needs.is_met else ORANGE
            _mark(axes, critical, color)
            if needs.required and not self.low <= peak.speed <= self.high:
                # as far as the required separation reaches towards the range
                end = self.high if peak.speed > self.high else -self.low
                ends = np.array([peak.speed, peak.speed - needs.required * end]) * current().speed
                axes.plot(ends, 2 * [peak.amplification], color=color, lw=1.4)
        if not self.criticals:
            text = f"no critical speed up to {speed_with_unit(self.top)}"
            middle = {"xycoords": "axes fraction", "ha": "center", "color": LABEL}
            annotate(axes, text, (0.5, 0.7), (0, 0), **middle)
        axes.set_xlim(left=0)
        _finish(axes)
        return figure


@dataclass(frozen=True, repr=False)
class CriticalPeaks(Displayed):
    """Critical speeds of nodes with their amplification factors, shown; criticals: by ascending
    speed."""

    criticals: tuple[ProbeCritical, ...]

    def table(self) -> Table:
        """Return a table with one row for each peak of a node."""
        d = current()
        critical = f"critical [{d.speed_unit}]"
        heads = ("node", "axis", critical, d.amplitude_words, *_half_power_heads(), "AF")
        title = "Critical speeds with their amplification factors (API 684)"
        if not self.criticals:
            title = "No critical speed: the response of these nodes has no peak there"
        return Table(title, heads, [_peak(c) for c in self.criticals])

    def figure(self) -> Figure:
        """Draw the amplification factors of peaks over the speed."""
        figure, axes = _factors(self.titled("Critical speeds (circles x, squares y)"), 10)
        for critical in self.criticals:
            _mark(axes, critical, BLUE)
        axes.update_datalim([(0.0, DAMPED)])
        # the speeds of one sense of rotation begin at 0
        ways = {critical.peak.speed < 0.0 for critical in self.criticals} or {False}
        axes.set_xlim(None if True in ways else 0.0, None if False in ways else 0.0)
        _finish(axes)
        return figure


def _peak(critical: ProbeCritical) -> tuple[object, ...]:
    peak, d = critical.peak, current()
    # N1 is the one nearer to standstill, in whichever sense the shaft turns
    n1, n2 = (peak.below, peak.above)[:: -1 if peak.speed < 0.0 else 1]
    return (
        *(critical.node, critical.axis, peak.speed * d.speed, peak.amplitude * d.amplitude),
        *(n1 * d.speed, n2 * d.speed, peak.amplification),
    )


def _half_power_heads() -> tuple[str, str]:
    unit = current().speed_unit
    return f"N1 [{unit}]", f"N2 [{unit}]"


def _why_none(amplification: float) -> str:
    if math.isnan(amplification):
        return "flat"
    return "damped" if amplification < DAMPED else "yes"


def _factors(title: str, size: float) -> tuple[Figure, Axes]:
    figure, axes = new_figure(6.8, 4.0)
    axes.axhline(DAMPED, color=GREY, lw=1.0, ls=LIMIT)
    within = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "top"}
    annotate(axes, "critically damped below", (1.0, DAMPED), (-2, -3), color=LABEL, **within)
    axes.set(yscale="log", ylabel="Amplification factor [1]", xlabel=current().speed_label)
    entitle(axes, title, size)
    return figure, axes


def _finish(axes: Axes) -> None:
    """Make room for the words in axes of amplification factors, and mark these plainly."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, (DAMPED / high**_ROOM) ** (1.0 / (1.0 - _ROOM))), high)
    plain_ticks(axes.yaxis)
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        axes.legend(handles[:1], labels[:1], loc="upper right", frameon=False, fontsize=8)


def _mark(axes: Axes, critical: ProbeCritical, color: str) -> None:
    at = critical.peak.speed * current().speed, critical.peak.amplification
    if math.isinf(critical.peak.amplification):
        axes.axvline(at[0], color=color, lw=1.2, ls=DOTTED, label="without damping, infinite")
        return
    axes.plot(*at, "o" if critical.axis == "x" else "s", color=color, ms=5, mfc="white")


@on_one_thread
def critical_map(
    machine: Machine, stiffness: Sequence[float] | np.ndarray | None = None, **options: Any
) -> CriticalMap:
    """Return `model.linear.critical_map` of a machine; by default over two decades on either side
    of the bearings' own stiffness, with eight points in each."""
    rotor = rotor_of(machine)
    if stiffness is None:
        own = linear.mean_stiffness(rotor, options.get("contacts"))
        stiffness = own * np.logspace(-2.0, 2.0, 33)
    return displayed(CriticalMap, linear.critical_map, rotor, stiffness, **options)


@on_one_thread
def critical_peaks(
    machine: Machine, top: float | Sequence[float], nodes: Sequence[int], **options: Any
) -> CriticalPeaks:
    """Return `model.linear.critical_peaks` of a machine; top: the highest speed, or one of each
    sense of rotation [rad/s]."""
    rotor = rotor_of(machine)
    tops = top if isinstance(top, Sequence) else [top]
    found = [linear.critical_peaks(rotor, each, nodes, **options) for each in tops]
    return of_machine(CriticalPeaks(tuple(chain.from_iterable(found))), rotor)


unbalance_check = answer_of(UnbalanceCheck, linear.unbalance_check)
