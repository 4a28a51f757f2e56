"""The text and the tables of the page, which need no script."""

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from html import escape
from typing import Any

import numpy as np

from .. import vibration
from ..cells import cell, column_head, html_table
from ..display import current, shown_speed
from ..run_status import FAILED, OK, has_failed
from ..runs.peaks import largest_row, start_up
from ..runs.recording import Recording
from ..runs.summary import dissipated, touching
from ..runs.synchronous_response import synchronous_response
from ..runs.verify_run import table_of
from ..vibration import TooFewTurns

_UM = 1e-6  # [m], in which signals are recorded and resampled here
_SUMMARY = {
    "solver_s": "time of the run [s]",
    "steps": "steps",
    "rejected": "steps rejected",
    "newton_per_step": "iterations a step",
    "h_min": "shortest step [s]",
    "h_max": "longest step [s]",
    "energy_residual": "energy error of the integrator over energy dissipated [1]",
}


def notices(run: Recording, why: str | None, shown: int) -> str:
    """Return the notices at the page's head: how far a failed run came, why, and warnings; shown:
    places in the pictures, none where there are none and `why` says so."""
    said = []
    if has_failed(run.status):
        reason, reached = run.status.removeprefix(FAILED), "no step"
        if len(run.t):
            reached = f"t = {run.t[-1]:.4g} s at {_speed(run, -1)} {current().speed_unit}"
        said.append(f"{run.name} stopped before its end. It came to {reached}: {reason}")
    elif run.status != OK:
        said.append(f"{run.name} is {run.status}")
    for message in dict.fromkeys(map(str, run.about.get("messages", ()))):
        if message not in run.status:
            said.append(f"{run.name}: {message}")
    if why:
        said.append(f"{run.name} has no pictures over speed: {why}")
    elif shown < len(run.places):
        said.append(
            f"{run.name}: the pictures are of the {shown} of {len(run.places)} places that move "
            "most; the tables have all"
        )
    return notices_html(said)


def notices_html(said: Iterable[object]) -> str:
    """Return notices at the head of a page as HTML."""
    return "\n".join(notice_html(text) for text in said)


def notice_html(text: object, mark: str = "") -> str:
    """Return a notice as HTML; mark: a further class that `page.css` has."""
    return f'<p class="{f"notice {mark}".strip()}">{escape(str(text))}</p>'


def _speed(run: Recording, at: int) -> str:
    omega = _omega(run, at)
    return shown_speed(omega) if omega else "0"


def _omega(run: Recording, at: int) -> float:
    # rounding leaves something of a shaft that stands
    return float(run.w[at]) if abs(run.w[at]) > 1e-9 else 0.0


def tables(run: Recording, summary: Mapping[str, Any], runs: int = 1) -> str:
    """Return the tables of a run: responses of its places, contacts, sinks, the solver's work."""
    of = f"{run.name}: " if runs > 1 else ""
    made = [_ran(run, summary, of), _verification(run, of)]
    with suppress(TooFewTurns):
        made.append(_places(run, of))
    made += [_contacts(run, of), _sinks(run, of)]
    return "\n".join(text for text in made if text)


def _ran(run: Recording, summary: Mapping[str, Any], of: str) -> str:
    status = "failed" if has_failed(run.status) else run.status
    rows: list[Sequence[object]] = [["status", status]]
    if len(run.t):
        speeds = f"speed, from and to [{current().speed_unit}]"
        rows += [
            ["reached [s]", run.t[-1]],
            [speeds, f"{_speed(run, 0)} to {_speed(run, -1)}"],
            ["turns", float(np.abs(np.diff(run.phi)).sum()) / (2 * math.pi)],
        ]
    rows.append(["samples", len(run.t)])
    rows += [[text, summary[name]] for name, text in _SUMMARY.items() if name in summary]
    units = run.parameter_units()
    for name, value in run.about.get("parameters", {}).items():
        shown = current().of_si(units.get(name, "1"))
        given = value if shown.factor == 1 else value * shown.factor
        rows.append([column_head(f"{name}, as set", shown.unit), given])
    for name, ends in run.about.get("loads", {}).items():
        shown = current().of_si(units.get(name, "1"))
        given = [cell(shown.factor * end) for end in dict.fromkeys(ends)]
        rows.append([column_head(f"{name}, as given", shown.unit), " to ".join(given)])
    return table(f"{of}the run", ["", ""], rows)


def _verification(run: Recording, of: str) -> str:
    figures = run.about.get("verification")
    if not figures:
        return ""
    compared = table_of(figures)
    return table(f"{of}{compared.title}", compared.heads, compared.rows)


def _places(run: Recording, of: str) -> str:
    d = current()
    small = d.small_unit
    heads = [
        *("place", f"1x, largest [{d.amplitude_unit}]", f"at [{d.speed_unit}]"),
        *("amplification [1]", f"x [{small} pp]", f"y [{small} pp]", f"S_max [{small} 0-p]"),
    ]
    rows, begin = [], start_up(run.t, run.w)
    for place in run.places:
        once = synchronous_response(run, place)
        direct = vibration.displacement_of(run.resampled(place))
        largest = [  # a block that begins in the start-up has its transient
            float(size[largest_row(direct.begin, size, begin)]) * d.small * _UM
            for size in (direct.x_pp, direct.y_pp, direct.s_max)
        ]
        factor = _amplification(once.resonance)
        peak, speed = once.major * d.amplitude, once.speed * d.speed
        rows.append([place.label, peak, speed, factor, *largest])
    title = f"{of}responses after the start-up (API RP 684, ISO 20816-1)"
    return table(title, heads, rows) if rows else ""


def _amplification(resonance: vibration.Resonance | None) -> float | str:
    """Return the factor of a resonance, marked where the run passed it too quickly."""
    if resonance is None:
        return math.nan
    if resonance.is_fast:
        return f"> {cell(resonance.amplification)}, passed too fast"
    return resonance.amplification


def _contacts(run: Recording, of: str) -> str:
    d = current()
    heads = [
        *("contact", f"largest force [{d.force_unit}]", f"at [{d.speed_unit}]"),
        "touches [% of the time]",
    ]
    rows, shares = [], touching(run)
    for contact in run.contacts if shares else ():
        at = int(np.argmax(np.nan_to_num(contact.peak)))
        speed = _omega(run, at) * d.speed if contact.peak[at] > 0 else math.nan
        share = 100 * shares[contact.name]
        rows.append([contact.label, contact.peak[at] * d.force, speed, share])
    return table(f"{of}contacts", heads, rows) if rows else ""


def _sinks(run: Recording, of: str) -> str:
    losses = {name: float(column[-1]) for name, column in run.losses.items() if len(column)}
    whole = dissipated(losses.values())
    if not whole:
        return ""
    rows = [[name, lost, 100 * lost / whole] for name, lost in losses.items()]
    return table(f"{of}energy dissipated", ["sink", "energy [J]", "share [%]"], rows)


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table as HTML, in a box that scrolls; heads that are all empty are left out."""
    return f'<div class="table">{html_table(caption, heads, rows)}</div>'
