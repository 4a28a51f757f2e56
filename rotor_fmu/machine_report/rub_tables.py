"""Tables of the check of clearances with contacts."""

import math

from ..display import current
from ..linear.linear_tables import Table
from .rub_check import RubCheck


def closings_table(rub: RubCheck) -> Table:
    """Return a table with one row for each clearance that the linear response closes."""
    d = current()
    small, unit = d.small, d.small_word
    quantities = (f"{name} [{unit}]" for name in ("clearance", "sag", "amplitude"))
    heads = ("contact", *quantities, "closed from", "to")
    rows = [
        (
            c.name,
            c.clearance * small,
            c.sag * small,
            c.amplitude * small,
            c.begin * d.speed,
            c.end * d.speed,
        )
        for c in rub.closings
    ]
    title = f"Clearances that the linear response closes [{d.speed_unit}]"
    if all(math.isnan(c.begin) for c in rub.closings):
        title = "Contacts that hold the machine: its linear response takes them as closed"
    return Table(title, heads, rows)


def runs_table(rub: RubCheck) -> Table:
    """Return a table with one row for each contact of each run."""
    d = current()
    heads = (
        *("run", "contact", f"first touch [{d.speed_unit}]", "last touch", "touches [%]"),
        *("in the range [%]", f"largest force [{d.force_unit}]", "status"),
    )
    rows = [
        (
            run.direction,
            c.name,
            c.first * d.speed,
            c.last * d.speed,
            100 * c.share,
            100 * c.share_in_range,
            c.force * d.force,
            run.status,
        )
        for run in rub.runs
        for c in run.contacts
    ]
    return Table("Runs with contacts", heads, rows)
