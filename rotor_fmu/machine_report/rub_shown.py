"""The check of clearances with contacts, shown: its tables and its picture."""

import math

import numpy as np
from matplotlib.figure import Figure

from ..display import current
from ..linear.linear_plots import shade
from ..plotting.colors import BLUE, DASHED, GREEN, GREY, ORANGE
from ..plotting.figure_style import entitle, new_figure
from ..tables import Table
from .rub_check import RubCheck

_HIGHEST = 3.0  # of the largest amplitude in the runs: more of the linear one is not shown


def closings_table(rub: RubCheck) -> Table:
    """Return a table with one row for each clearance that the linear response closes."""
    d = current()
    quantities = (f"{name} [{d.small_word}]" for name in ("clearance", "sag", "amplitude"))
    heads = ("contact", *quantities, "closed from", "to")
    factors = np.array([d.small] * 3 + [d.speed] * 2)
    rows = [(name, *(factors * numbers).tolist()) for name, *numbers in rub.closings]
    title = f"Clearances that the linear response closes [{d.speed_unit}]"
    if rub.carries:
        title = "Contacts that hold the machine: its linear response takes them as closed"
    return Table(title, heads, rows)


def runs_table(rub: RubCheck) -> Table:
    """Return a table with one row for each contact of each run."""
    d = current()
    seen = [(run, contact) for run in rub.runs for contact in run.contacts]
    columns = (
        ("run", [run.direction for run, _ in seen]),
        ("contact", [c.name for _, c in seen]),
        (f"first touch [{d.speed_unit}]", [c.first * d.speed for _, c in seen]),
        ("last touch", [c.last * d.speed for _, c in seen]),
        ("touches [%]", [100 * c.share for _, c in seen]),
        ("in the range [%]", [100 * c.share_in_range for _, c in seen]),
        ("turns of the range [%]", [100 * c.turns_in_range for _, c in seen]),
        (f"largest force [{d.force_unit}]", [c.force * d.force for _, c in seen]),
        ("status", [run.status for run, _ in seen]),
    )
    return Table.of("Runs with contacts", columns)


def rub_figure(rub: RubCheck) -> Figure:
    """Draw the linear amplitude over the speed beside those of the runs with contacts."""
    figure, axes = new_figure(6.8, 4.4)
    small, unit, speed = current().small, current().small_unit, current().speed
    shade([axes], (rub.low, rub.high))
    axes.plot(rub.speed * speed, rub.linear * small, color=GREY, lw=1.4, label="linear")
    for run, color, dashes in zip(rub.runs, (BLUE, ORANGE), ("-", DASHED), strict=False):
        label = f"{run.direction} with contacts"
        over = run.speed * speed
        axes.plot(over, run.amplitude * small, color=color, ls=dashes, lw=1.6, label=label)
    gaps: dict[float, list[str]] = {}
    for closing in rub.closings:
        if not math.isnan(closing.begin):
            gaps.setdefault(closing.clearance, []).append(closing.name)
    for gap, (name, *others) in sorted(gaps.items()):
        whose = f"{name} and {len(others)} more" if others else name
        label = f"clearance {gap * small:.4g} {unit} of {whose}"
        axes.axhline(gap * small, color=GREEN, lw=1.0, ls=":", label=label)
    largest = max((float(run.amplitude.max(initial=0.0)) for run in rub.runs), default=0.0)
    linear = min(float(rub.linear.max(initial=0.0)), _HIGHEST * largest)
    axes.set_ylim(0, 1.1 * small * max(largest, linear, *gaps, 1e-9))
    axes.set_xlabel(f"{current().speed_label}; the operating range is shaded")
    axes.set_ylabel(f"Amplitude of {rub.place} 0-p [{unit}]")
    axes.legend(frameon=False, fontsize=8)
    title = "In the contacts that carry the machine" if rub.carries else "Where a clearance closes"
    entitle(axes, title)
    return figure
