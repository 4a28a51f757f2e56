"""Frequency responses and the sensitivity of control loops, for Python and the command line."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..cells import five_digits
from ..display import Shown, current
from ..errors import InputError, meant, read_text, toml_tables
from ..model.linear import frequency_response as model
from ..model.linear.places import MOVED, Place
from ..model.machine.rotor import Rotor
from ..model.machine.table_reader import make
from ..model.one_thread import on_one_thread
from ..model.parts.base import PortElement, ProbeElement
from ..model.parts.base_and_start import Base
from ..model.parts.port import Sensor
from ..model.quantities import STANDARD_GRAVITY, check_all
from ..plotting.colors import DASHED, DOTTED, GREY, LIMIT, colors_of
from ..plotting.figure_style import annotate, entitle, legend_below, new_figure, new_panels
from ..tables import Table
from .displayed import Displayed, Machine, answer_of, displayed
from .linear_plots import plain_ticks
from .linear_tables import degrees_of, is_rounding, peaks, state_in_words

ZONES = "ABCD"
_LEVEL = 1e-6  # of a sensitivity: what it changes by over all frequencies where it is the same


class FrequencyResponse(Displayed, model.FrequencyResponse):
    """`model.linear.frequency_response.FrequencyResponse`, shown."""

    @property
    def shown_nodes(self) -> tuple[str, ...]:
        """The places of the displacements in words."""
        return tuple(map(_shown, self.nodes, self.offsets))

    @property
    def excitation(self) -> str:
        """The force in words, with its place, or that the base moves."""
        if isinstance(self.force, str):
            return "an acceleration of the base"
        return f"a force on node {_shown(self.force, self.force_offset)}"

    @property
    def quantity(self) -> str:
        """What is drawn, without its unit."""
        is_of_base = isinstance(self.force, str)
        return "Displacement by force" if not is_of_base else "Displacement relative to the base"

    @property
    def per(self) -> Shown:
        """How what excites is shown: a force in its unit, an acceleration in g."""
        if isinstance(self.force, str):
            return Shown(1.0 / STANDARD_GRAVITY, "g")
        return current().of_si("N")

    def table(self) -> Table:
        """Return a table with one row for each resonance of each node."""
        d = current()
        heads = (
            *("node", "direction", f"[{d.frequency_unit}]", f"{d.small_word}/{self.per.unit}"),
            "phase [deg]",
        )
        rows = [
            (
                *(node, f"{axis} by {axis}", float(self.frequencies[at]) * d.speed),
                *(abs(values[at]) * d.small / self.per.factor, degrees_of(values[at])),
            )
            for k, node in enumerate(self.shown_nodes)
            for i, axis in enumerate("xy")
            for values in (self.receptance[:, k, i, i],)
            for at in peaks(np.abs(values))
        ]
        state = state_in_words(self.speed, self.contacts)
        title = f"Frequency response to {self.excitation} where it peaks, {state}"
        return Table(title, heads, rows)

    def figure(self) -> Figure:
        """Draw sizes and phases of x by x and y by y, and the size of y by x."""
        figure, (above, below) = new_panels(6.8, 6.0, 2, share_x=True, heights=(2, 1))
        d = current()
        frequency, places = self.frequencies * d.speed, self.shown_nodes
        handles, ways = [], dict[str, Any]()
        for k, (node, color) in enumerate(zip(places, colors_of(len(places)), strict=True)):
            handles.append(Line2D([], [], color=color, lw=1.3, label=f"node {node}"))
            for (i, j), dashes in (((0, 0), "-"), ((1, 1), DASHED), ((1, 0), DOTTED)):
                values = self.receptance[:, k, i, j]
                if i != j and is_rounding(values, self.receptance):
                    continue
                way = f"{'xy'[i]} by {'xy'[j]}"
                ways[way] = dashes
                size, label = np.abs(values) * d.small / self.per.factor, f"node {node}: {way}"
                above.plot(frequency, size, color=color, lw=1.3, ls=dashes, label=label)
                if i == j:
                    phase = np.angle(values)
                    known = np.isfinite(phase)
                    phase[known] = np.degrees(np.unwrap(phase[known]))
                    below.plot(frequency, phase, color=color, lw=1.2, ls=dashes)
        handles += [Line2D([], [], color=GREY, lw=1.3, ls=s, label=w) for w, s in ways.items()]
        above.set_yscale("log")
        plain_ticks(above.yaxis)
        above.set_ylabel(f"{self.quantity} [{d.small_unit}/{self.per.unit}]")
        below.set(ylabel="Phase [deg]", xlabel=d.frequency_label)
        legend_below(figure, 6, handles)
        state = state_in_words(self.speed, self.contacts)
        entitle(figure, self.titled(f"Response to {self.excitation}, {state}"))
        return figure


@dataclass(frozen=True, repr=False)
class Sensitivity(Displayed, model.Sensitivity):
    """`model.linear.frequency_response.Sensitivity`, shown.

    zones: largest sensitivities of zones A, B and C [1], as the user gave them, empty without.
    """

    zones: tuple[float, ...] = ()

    def zone(self, largest: float) -> str:
        """Return the zone of a loop's largest sensitivity [1], `A` to `D`; `-` without bounds."""
        return ZONES[int(np.searchsorted(self.zones, largest))] if self.zones else "-"

    def table(self) -> Table:
        """Return a table with one row for each loop and axis."""
        size = np.abs(self.sensitivity)
        largest, at, d = size.max(axis=0), size.argmax(axis=0), current()
        title = f"Sensitivity of the control loops at {state_in_words(self.speed, 'open')}"
        low, high = (five_digits(float(end) * d.speed) for end in self.frequencies[[0, -1]])
        title += f", largest from {low} to {high} {d.frequency_unit}"
        is_end = (at == 0) | (at == len(size) - 1)
        if (is_end & (largest > (1.0 + _LEVEL) * size.min(axis=0))).any():
            title += "; it is largest at an end of that range, beyond which it may be larger"
        if not self.is_stable:
            title += "; THE CLOSED LOOP IS UNSTABLE, so that these numbers mean nothing"
        columns = (
            ("loop", self.loops),
            ("largest", largest),
            ("[dB]", 20 * np.log10(largest)),
            (f"at [{d.frequency_unit}]", self.frequencies[at] * d.speed),
            ("zone", [self.zone(each) for each in largest]),
        )
        return Table.of(title, columns)

    def figure(self) -> Figure:
        """Draw the size of each sensitivity over the frequency, with the bounds of the zones."""
        figure, axes = new_figure(6.8, 4.4)
        frequency, size = self.frequencies * current().speed, np.abs(self.sensitivity)
        colors = colors_of(len(self.loops))
        for k, (name, color) in enumerate(zip(self.loops, colors, strict=True)):
            dashes = "-" if name.endswith("x") else DASHED
            axes.plot(frequency, size[:, k], color=color, ls=dashes, lw=1.4, label=name)
        for bound, names in zip(self.zones, ("A | B", "B | C", "C | D"), strict=False):
            axes.axhline(bound, color="black", lw=0.9, ls=LIMIT)
            within = {"xycoords": ("axes fraction", "data"), "ha": "right"}
            annotate(axes, names, (1.0, bound), (-2, 2), **within)
        axes.set(xscale="log", yscale="log", xlim=(frequency[0], frequency[-1]))
        plain_ticks(axes.xaxis)
        plain_ticks(axes.yaxis)
        axes.set(xlabel=current().frequency_label, ylabel="Sensitivity [1]")
        axes.legend(framealpha=0.9, edgecolor="none", fontsize=8)
        title = f"Sensitivity (ISO 14839-3) at {state_in_words(self.speed, 'open')}"
        entitle(axes, self.titled(title))
        return figure


frequency_response = answer_of(FrequencyResponse, model.frequency_response)


@on_one_thread
def sensitivity(
    machine: Machine, *arguments: Any, zones: Sequence[float] = (), **options: Any
) -> Sensitivity:
    """Return `model.linear.frequency_response.sensitivity` of a machine; zones: the largest
    sensitivities of zones A, B and C [1]."""
    kind = partial(Sensitivity, zones=tuple(zones))
    return displayed(kind, model.sensitivity, machine, *arguments, **options)


def _shown(node: int, offset: float) -> str:
    """Return a place in words, after "node"."""
    d = current()
    return f"{node} {offset * d.length:+.4g} {d.length_unit}" if offset else str(node)


def excitation_of(rotor: Rotor, text: str, option: str) -> Place | str:
    """Return the place of a force, as `place_of`, or `base` of the base, whatever its name."""
    if text == MOVED or isinstance(dict(rotor.named_parts()).get(text), Base):
        return MOVED
    return place_of(rotor, text, option, (MOVED,))


def observed_places(rotor: Rotor) -> list[Place]:
    """Return the places of a machine's sensors along its shaft; without any, of all its parts whose
    motion the FMU tells."""
    probes = [name for name, _ in rotor.elements_of_kind(ProbeElement)]
    sensors = [name for name, part in rotor.named_parts() if isinstance(part, Sensor)]
    return sorted({place_of(rotor, name, "") for name in sensors or probes})


def place_of(rotor: Rotor, text: str, option: str, others: Sequence[str] = ()) -> Place:
    """Return the node (from 1) of a number, or the place where the part of a name has its port or
    its probe; `InputError` otherwise; others: words that may be meant too."""
    probes, ports = rotor.elements_of_kind(ProbeElement), rotor.elements_of_kind(PortElement)
    beyond = {name: e.offset for name, e in probes} | {name: e.offset for name, e in ports}
    named = {name: part.node for name, part in rotor.named_parts() if hasattr(part, "node")}
    if text in named:
        return Place(int(named[text]), beyond.get(text, 0.0))
    if text.isdecimal() and 1 <= int(text) <= len(rotor.nodes):
        return Place(int(text))
    raise InputError(
        f"{option} {text}: must be a node from 1 to {len(rotor.nodes)}, or a part's name; "
        f"{meant(text, [*others, *named])}"
    )


def read_loops(option: str, path: Path, rotor: Rotor) -> list[model.ControlLoop]:
    """Return the control loops of a file, tables `[[loop]]` with the quantities of `ControlLoop`,
    sensor and magnet as nodes or as names of parts; `InputError` for anything else."""
    tables = toml_tables(f"{option} {path}", read_text(option, path))
    for key in tables.keys() - {"loop"}:
        raise InputError(f"{option} {path}: {key}: unknown; only [[loop]] may be there")
    listed = tables.get("loop")
    if not isinstance(listed, list) or not listed or not all(isinstance(t, dict) for t in listed):
        raise InputError(f"{option} {path}: no [[loop]] is there; at least one is needed")
    loops = [_loop(f"{option} {path}: loop[{i}]", of, rotor) for i, of in enumerate(listed, 1)]
    names = [loop.name for loop in loops]
    for i, name in enumerate(names):
        if name in names[:i]:
            raise InputError(f"{option} {path}: loop[{i + 1}].name = {name!r}: another has it")
    return loops


def _loop(where: str, table: dict[str, Any], rotor: Rotor) -> model.ControlLoop:
    places = {
        key: place_of(rotor, str(table[key]), f"{where}.{key} =")
        for key in ("sensor", "magnet")
        if key in table
    }
    name = {"name": where.rpartition(": ")[2]}
    loop: model.ControlLoop = make(model.ControlLoop, where, name | table | places)
    check_all(where, loop)
    return loop
