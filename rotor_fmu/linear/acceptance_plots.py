"""Pictures of the checks of API 617 and 684."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ..display import current, speed_with_unit
from ..model.linear.amplification import DAMPED
from ..model.linear.critical_map import BearingStiffness, CriticalMap
from ..model.linear.stability_levels import LEAST_LOG_DEC, StabilityLevel1, StabilityLevel2
from ..model.linear.unbalance_check import ProbeCritical, UnbalanceCheck
from ..plotting.figure_style import BLUE, GREEN, GREY, ORANGE
from .linear_plots import PURPLE, new_figure, shade, titled

_DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))


def critical_map_figure(result: CriticalMap) -> Figure:
    """Draw the critical speeds over the stiffness, and the bearings' own stiffness."""
    figure, grid = new_figure(6.8, 5.2, 1)
    axes, d = grid[0, 0], current()
    stiffness = result.stiffness * d.stiffness
    for mode in range(result.speeds.shape[1]):
        axes.plot(stiffness, result.speeds[:, mode] * d.speed, color=BLUE, lw=1.6)
        last = result.speeds[-1, mode]
        if np.isfinite(last):
            axes.annotate(
                f"{mode + 1}",
                (stiffness[-1], last * d.speed),
                xytext=(4 + 9 * (mode % 2), 0),  # neighbours side by side
                textcoords="offset points",
                va="center",
                fontsize=8,
                color=BLUE,
            )
    for lines, dashes in zip(_own_lines(result), _DASHES * len(result.own), strict=False):
        own = lines[0]
        inside = (own.stiffness >= result.stiffness[0]) & (own.stiffness <= result.stiffness[-1])
        color = ORANGE if own.axis == "x" else GREEN
        label = ", ".join(f"{each.bearing} k{each.axis}{each.axis}" for each in lines)
        over = np.where(inside, own.stiffness, np.nan) * d.stiffness
        axes.plot(over, own.speed * d.speed, color=color, ls=dashes, lw=1.4, label=label)
    for crossing in result.crossings:
        at = crossing.stiffness * d.stiffness, crossing.speed * d.speed
        axes.plot(*at, "o", color="black", mfc="white", ms=4.5)
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = np.nanmin(result.speeds), np.nanmax(result.speeds)
    axes.set_ylim(low * d.speed * 0.8, high * d.speed * 1.25)
    axes.set_xlim(stiffness[0], stiffness[-1])
    for axis in (axes.xaxis, axes.yaxis):
        plain_ticks(axis)
    axes.set_xlabel(f"Stiffness of every bearing [{d.stiffness_unit}]")
    what = "critical speed" if result.synchronous else "natural frequency at standstill"
    axes.set_ylabel(f"Undamped {what} [{d.speed_unit if result.synchronous else d.frequency_unit}]")
    if result.own:
        figure.legend(loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    axes.set_title(_named(result, "Undamped critical speed map"), loc="left", fontsize=10)
    return figure


def _own_lines(result: CriticalMap) -> list[list[BearingStiffness]]:
    """Return the bearings' own stiffnesses, those of the same values together."""
    lines: list[list[BearingStiffness]] = []
    for own in result.own:
        for others in lines:
            if np.allclose(own.stiffness, others[0].stiffness, rtol=1e-6):
                others.append(own)
                break
        else:
            lines.append([own])
    return lines


def _named(result: object, text: str) -> str:
    """Return a title with the name of the machine that a result is of."""
    return titled(getattr(result, "machine_name", ""), text)


def plain_ticks(axis: Axis) -> None:
    """Write the numbers at a logarithmic axis without formulas, which these figures do not draw."""
    axis.set_major_formatter(
        FuncFormatter(lambda value, _: f"{value:.6g}".replace("e+0", "e").replace("e+", "e"))
    )
    low, high = axis.get_view_interval()
    if high < 100 * low:  # so that there are numbers within one decade
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_minor_formatter(NullFormatter())


def peaks_figure(criticals: Sequence[ProbeCritical], name: str = "") -> Figure:
    """Draw the amplification factors of peaks over the speed."""
    figure, axes = _factors()
    for critical in criticals:
        _mark(axes, critical, BLUE)
    axes.set_xlabel(current().speed_label)
    axes.set_title(titled(name, "Critical speeds (circles x, squares y)"), loc="left", fontsize=10)
    axes.set_xlim(left=0)
    plain_ticks(axes.yaxis)
    return figure


def _mark(axes: Axes, critical: ProbeCritical, color: str) -> None:
    at = critical.peak.speed * current().speed, critical.peak.amplification
    axes.plot(*at, "o" if critical.axis == "x" else "s", color=color, ms=5, mfc="white")


def unbalance_check_figure(result: UnbalanceCheck) -> Figure:
    """Draw the amplification factors over the speed, with the separation that each critical speed
    needs beside the operating range."""
    figure, axes = _factors()
    shade([axes], (result.low, result.high))
    for critical in result.criticals:
        peak, needs = critical.peak, critical.margin
        if needs is None or not np.isfinite(peak.amplification):
            continue
        color = GREEN if needs.is_met else ORANGE
        at = peak.speed * current().speed, peak.amplification
        _mark(axes, critical, color)
        if needs.required:
            # as far as the required separation reaches towards the range
            end = result.high if peak.speed > result.high else -result.low
            if result.low <= peak.speed <= result.high:
                continue
            to = (peak.speed - needs.required * end) * current().speed
            axes.plot([at[0], to], [at[1], at[1]], color=color, lw=1.4)
    axes.set_xlabel(current().speed_label)
    axes.set_title(
        _named(result, "Critical speeds with the separations that they need\n")
        + "circles x, squares y; orange: too near to the operating range, which is shaded",
        loc="left",
        fontsize=9,
    )
    axes.set_xlim(left=0)
    plain_ticks(axes.yaxis)
    return figure


def _factors() -> tuple[Figure, Axes]:
    """Return axes of amplification factors over the speed."""
    figure, grid = new_figure(6.8, 4.0, 1)
    axes = grid[0, 0]
    axes.axhline(DAMPED, color=GREY, lw=1.0, ls=(0, (4, 3)))
    axes.annotate(
        "critically damped below",
        (1.0, DAMPED),
        xycoords=("axes fraction", "data"),
        xytext=(-2, -3),
        textcoords="offset points",
        ha="right",
        va="top",
        fontsize=8,
        color="#555555",
    )
    axes.set_yscale("log")
    axes.set_ylabel("Amplification factor [1]")
    return figure, axes


def level_1_figure(result: StabilityLevel1) -> Figure:
    """Draw the logarithmic decrement over the cross coupling, with QA and Q0."""
    figure, grid = new_figure(6.8, 4.0, 1)
    axes, d = grid[0, 0], current()
    over = result.stiffness * d.stiffness
    if not np.allclose(result.log_dec, result.first_log_dec, rtol=1e-6):
        axes.plot(over, result.first_log_dec, color=GREY, lw=1.2, label="first forward mode")
    axes.plot(over, result.log_dec, color=BLUE, lw=1.8)
    axes.axhline(0, color="black", lw=1.0)
    axes.axhline(
        LEAST_LOG_DEC, color=GREY, lw=1.0, ls=(0, (4, 3)), label=f"least, {LEAST_LOG_DEC:g}"
    )
    if result.anticipated:
        at = result.anticipated * d.stiffness
        axes.axvline(at, color=GREEN, lw=1.3, label="QA, anticipated")
    if result.threshold is not None:
        at = result.threshold * d.stiffness
        axes.axvline(at, color=ORANGE, lw=1.3, ls=":", label="Q0, unstable above")
    axes.set_xlim(*(result.stiffness[[0, -1]] * d.stiffness))
    axes.set_xlabel(f"Cross-coupled stiffness at node {result.node} [{d.stiffness_unit}]")
    axes.set_ylabel("Logarithmic decrement [1]")
    axes.set_title(
        _named(result, f"Least of the forward modes at {speed_with_unit(result.speed)}"),
        loc="left",
        fontsize=10,
    )
    axes.legend(framealpha=0.9, edgecolor="none", fontsize=8)
    return figure


def level_2_figure(result: StabilityLevel2) -> Figure:
    """Draw the logarithmic decrement of each case."""
    figure, grid = new_figure(6.8, 1.4 + 0.35 * len(result.cases), 1)
    axes = grid[0, 0]
    names = [case.name for case in result.cases]
    values = [case.log_dec for case in result.cases]
    colors = [GREEN if value >= LEAST_LOG_DEC else PURPLE for value in values]
    axes.barh(names, values, color=colors, height=0.6)
    axes.axvline(LEAST_LOG_DEC, color="black", lw=1.0, ls=(0, (4, 3)))
    axes.axvline(0, color="black", lw=1.0)
    axes.invert_yaxis()
    for at, value in enumerate(values):
        axes.annotate(
            f"{value:.3g}",
            (max(value, 0.0), at),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    axes.margins(x=0.12)
    axes.set_xlabel(
        f"Least logarithmic decrement of the forward modes [1]; dashed: {LEAST_LOG_DEC:g}"
    )
    title = f"Stability level 2 at {speed_with_unit(result.speed)}"
    axes.set_title(_named(result, title), loc="left", fontsize=10)
    return figure
