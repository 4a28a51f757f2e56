"""Tables of the check of clearances with contacts."""

from __future__ import annotations

import math

from ..display import current
from ..linear.linear_tables import Table
from .rub_check import RubCheck


def _rpm(omega: float) -> float:
    return float(omega) * 30 / math.pi


def closings_table(rub: RubCheck) -> Table:
    """Return a table with one row for each clearance that the linear response closes."""
    small, unit = current().small, current().small_word
    quantities = (f"{name} [{unit}]" for name in ("clearance", "sag", "amplitude"))
    heads = ("contact", *quantities, "closed from", "to")
    rows = [
        (
            c.name,
            c.clearance * small,
            c.sag * small,
            c.amplitude * small,
            _rpm(c.begin),
            _rpm(c.end),
        )
        for c in rub.closings
    ]
    title = "Clearances that the linear response closes [rev/min]"
    if all(math.isnan(c.begin) for c in rub.closings):
        title = "Contacts that hold the machine: its linear response takes them as closed"
    return Table(title, heads, rows)


def runs_table(rub: RubCheck) -> Table:
    """Return a table with one row for each contact of each run."""
    heads = (
        *("run", "contact", "first touch [rev/min]", "last touch", "touches [%]"),
        *("in the range [%]", "largest force [N]", "status"),
    )
    rows = [
        (
            run.direction,
            c.name,
            _rpm(c.first),
            _rpm(c.last),
            100 * c.share,
            100 * c.share_in_range,
            c.force,
            run.status,
        )
        for run in rub.runs
        for c in run.contacts
    ]
    return Table("Runs with contacts", heads, rows)
