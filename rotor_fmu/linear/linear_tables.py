"""Tables of linear analyses: as text, as HTML for notebooks, and as numbers for JSON."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..cells import cell
from ..display import current, speed_with_unit
from ..model.linear.campbell import Campbell
from ..model.linear.modes import Modes
from ..model.linear.static import Static
from ..model.linear.unbalance import UnbalanceResponse

# properties that stand beside the fields of a result
_DERIVED = (
    *("damped", "natural", "damping_ratio", "log_dec", "whirl", "forwardness", "major"),
    *("amplification", "is_one_sided", "is_met", "ratio", "is_level_2_required"),
    *("residual", "conclusion"),
)
_MOST_SPEEDS = 12  # of a table of the response
_ROUNDING = 1e-10  # of the largest amplitude: a smaller one does not peak


class Table(NamedTuple):
    """A heading, columns with units, rows of numbers and words."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[object]]

    def text(self) -> str:
        """Return the table as text in columns, for a terminal."""
        shown = [list(self.heads), *([cell(value) for value in row] for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
        lines = [
            "  ".join(text.rjust(width) for text, width in zip(row, widths, strict=True))
            for row in shown
        ]
        return "\n".join([self.title, *lines])

    def html(self) -> str:
        """Return the table as HTML, for a notebook."""
        heads = "".join(f"<th>{html.escape(head)}</th>" for head in self.heads)
        rows = "".join(
            "<tr>" + "".join(f"<td>{html.escape(cell(value))}</td>" for value in row) + "</tr>"
            for row in self.rows
        )
        title = f"<caption>{html.escape(self.title)}</caption>"
        return f"<table>{title}<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"


def turns(speed: float, contacts: str) -> str:
    """Return the state of a machine in a heading."""
    return f"{speed_with_unit(speed)} ({speed:.5g} rad/s), contacts {contacts}"


def modes_table(result: Modes) -> Table:
    """Return a table with one row for each mode."""
    d = current()
    heads = (
        *("mode", f"f_d [{d.frequency_unit}]", f"f_n [{d.frequency_unit}]", "omega_d [rad/s]"),
        *("damping", "log dec", "whirl"),
    )
    columns = zip(
        result.damped,
        result.natural,
        result.damping_ratio,
        result.log_dec,
        result.whirl,
        strict=True,
    )
    rows = [
        (
            *(i, float(damped) * d.speed, float(natural) * d.speed, float(damped)),
            *(_clean(zeta), _clean(decrement), whirl),
        )
        for i, (damped, natural, zeta, decrement, whirl) in enumerate(columns, 1)
    ]
    title = f"Modes at {turns(result.speed, result.contacts)}"
    if not result.is_sound.all():
        numbers = ", ".join(str(i + 1) for i in np.flatnonzero(~result.is_sound))
        title += (
            f"; of mode {numbers} rounding leaves residuals up to {np.max(result.residuals):.1g}: "
            "its stiffnesses and masses lie too far apart"
        )
    return Table(title, heads, rows)


def _clean(ratio: float) -> float:
    """Return a damping with rounding errors set to 0."""
    return 0.0 if abs(ratio) < 1e-10 else float(ratio)


def campbell_table(result: Campbell) -> Table:
    """Return a table with one row for each critical speed; the threshold of stability in the
    heading."""
    d = current()
    heads = ("mode", "order", "speed [rad/s]", f"[{d.speed_unit}]", "log dec", "whirl")
    rows = [
        (c.mode + 1, c.harmonic, c.speed, c.speed * d.speed, _clean(c.log_dec), c.whirl)
        for c in result.critical
    ]
    low, high = result.speeds[[0, -1]] * d.speed
    between = f"{low:.5g} and {high:.5g} {d.speed_unit}"
    stability = "stable at all of them"
    if result.threshold is not None:
        already = "already at" if result.threshold == result.speeds[0] else "above"
        stability = f"unstable {already} {speed_with_unit(result.threshold)} "
        stability += f"({result.threshold:.6g} rad/s)"
    orders = ", ".join(f"{order:g}" for order in result.harmonics)
    harmonic = "" if result.harmonics == (1.0,) else f" of {orders} times the speed"
    title = f"Critical speeds{harmonic} between {between}, contacts {result.contacts}; {stability}"
    return Table(title, heads, rows)


def static_table(result: Static) -> Table:
    """Return a table with one row for each node, then a row for the load on each support."""
    d = current()
    small, force = d.small_word, d.force_unit
    heads = (
        *("where", f"z [{d.length_unit}]", f"x [{small}]", f"y [{small}]"),
        *(f"load x [{force}]", f"load y [{force}]"),
    )
    nodes = [
        (f"node {i}", z * d.length, x * d.small, y * d.small, "", "")
        for i, (z, x, y) in enumerate(zip(result.z, result.x, result.y, strict=True), 1)
    ]
    housings = [
        (f"housing {name}", "", x * d.small, y * d.small, "", "")
        for name, x, y in zip(result.housings, result.housing_x, result.housing_y, strict=True)
    ]
    loads = [
        (f"on {name}", "", "", "", float(x) * d.force, float(y) * d.force)
        for name, x, y in zip(result.supports, result.load_x, result.load_y, strict=True)
    ]
    rows = [tuple(_rounded(cell) for cell in row) for row in (*nodes, *housings, *loads)]
    return Table(f"At rest, {turns(result.speed, result.contacts)}", heads, rows)


def _rounded(cell: object) -> object:
    return (0.0 if abs(cell) < 1e-9 else float(cell)) if isinstance(cell, float) else cell


def unbalance_table(result: UnbalanceResponse, nodes: Sequence[int]) -> Table:
    """Return the rows of speed and node (from 1): at every speed where they are few, else where the
    largest semi-axis of a node peaks."""
    d = current()
    unit = d.amplitude_words
    heads = (
        *("node", "speed [rad/s]", f"[{d.speed_unit}]"),
        *(f"{name} [{unit}]" for name in ("x", "y", "major", "minor")),
        *("phase x [deg]", "phase y [deg]"),
    )
    moves = result.major > _ROUNDING * result.major.max(axis=1, keepdims=True)
    rows = [
        (
            node,
            float(result.speeds[i]),
            float(result.speeds[i]) * d.speed,
            *(float(of[i, node - 1]) * d.amplitude for of in (np.abs(result.x), np.abs(result.y))),
            *(float(of[i, node - 1]) * d.amplitude for of in (result.major, result.minor)),
            *(math.degrees(of[i, node - 1]) for of in (result.phase_x, result.phase_y)),
        )
        for node in nodes
        for i in _peaks(np.where(moves, result.major, 0.0)[:, node - 1])
    ]
    what = "" if len(result.speeds) <= _MOST_SPEEDS else " where it peaks"
    return Table(f"Response to unbalance{what}, contacts {result.contacts}", heads, rows)


def _peaks(major: np.ndarray) -> Sequence[int]:
    """Return the places where an amplitude peaks, or all of a few."""
    if len(major) <= _MOST_SPEEDS:
        return range(len(major))
    inner = np.flatnonzero((major[1:-1] > major[:-2]) & (major[1:-1] >= major[2:])) + 1
    return inner.tolist() if len(inner) else [int(np.argmax(major))]


def numbers(result: Any) -> dict[str, object]:
    """Return all numbers of a linear analysis, in SI units, for JSON: complex numbers as [real,
    imaginary]."""
    fields = {name: getattr(result, name) for name in result.__dataclass_fields__}
    for name in _DERIVED:
        if hasattr(result, name):
            fields[name] = getattr(result, name)
    return {name: _plain(value) for name, value in fields.items()}


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        return [_plain(item) for item in value.tolist()]
    if hasattr(value, "__dataclass_fields__"):
        return numbers(value)
    if hasattr(value, "_asdict"):
        return {name: _plain(item) for name, item in value._asdict().items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
