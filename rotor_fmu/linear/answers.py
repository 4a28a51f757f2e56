"""Linear analyses of a machine, for Python: the objects of `model.linear`, which a notebook shows
as a table and a picture.

    from rotor_fmu.linear.answers import campbell, modes

    modes("machine.toml", 300.0).log_dec

A machine is a `Rotor`, or the path of its file.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..cells import five_digits
from ..display import current, shown_speed
from ..model import linear
from ..model.linear.modes import FORWARD
from ..model.machine.rotor import Rotor
from ..model.one_thread import on_one_thread
from ..operating_speeds import operating_speeds
from ..plotting.colors import BLUE, DASHED, DOTTED, GREY, LIMIT, ORANGE, PURPLE, colors_of
from ..plotting.figure_style import broken_at_turns, entitle, legend_below, new_figure, new_panels
from ..plotting.labels import write_labels
from ..tables import Table
from .displayed import Displayed, Machine, answer_of, displayed, rotor_of
from .linear_plots import FAINT, WHIRL_COLORS, curve, dotted, draw_whirling, shade
from .linear_tables import (
    clean_damping,
    peaks,
    shown_either_way,
    state_in_words,
    whirls_where,
    without_rounding,
)
from .mode_answers import Modes

_REACH = 4.0  # of the line of the excitation: frequencies that are shown
_DECREMENTS = 3.0  # logarithmic, of either sign, that are shown
MOST_SPEEDS = 12  # of a table of the response
_ROUNDING = 1e-10  # of the largest amplitude: a smaller one does not peak


class Campbell(Displayed, linear.Campbell):
    """`model.linear.Campbell`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each critical speed, headed by the stability."""
        d = current()
        heads = ["mode", "order", "speed [rad/s]", f"[{d.speed_unit}]", "log dec", "whirl"]
        rows: list[tuple[object, ...]] = [
            (c.mode + 1, c.harmonic, c.speed, c.speed * d.speed, clean_damping(c.log_dec), c.whirl)
            for c in self.critical
        ]
        damped = [c.is_critically_damped for c in self.critical]
        if any(damped):
            heads.append("damped")
            marked = zip(rows, damped, strict=True)
            rows = [(*row, "critically" if is_damped else "") for row, is_damped in marked]
        low, high = self.speeds[[0, -1]] * d.speed
        between = f"{five_digits(low)} and {five_digits(high)} {d.speed_unit}"
        harmonic = "" if self.harmonics == (1.0,) else f" of {self._orders} times the speed"
        what = "Critical speeds" if rows else "No critical speed"
        title = f"{what}{harmonic} between {between}, contacts {self.contacts}"
        if any(damped):
            title += f", {sum(damped)} of them critically damped (AF below 2.5)"
        return Table(f"{title}; {self.stability}", heads, rows)

    @property
    def stability(self) -> str:
        """At which speeds the machine is unstable, in words."""
        if self.threshold is None:
            return "stable at all these speeds"
        if not self.turns:
            return f"unstable already at {shown_either_way(self.threshold)}"
        turns = [shown_either_way(speed) for speed in self.turns]
        return whirls_where(self.threshold not in self.turns, turns, "unstable")

    @property
    def _orders(self) -> str:
        return ", ".join(f"{order:g}" for order in self.harmonics)

    def figure(self, operating: tuple[float, float] | None = None) -> Figure:
        """Draw frequencies with the excitation and their intersections, and logarithmic decrements;
        operating: the range [rad/s], which is shaded."""
        figure, panels = new_panels(6.8, 6.6, 2, share_x=True, heights=(2, 1))
        above, below = panels
        speed, frequency = self.speeds * current().speed, self.damped * current().speed
        shade(panels, operating)
        for mode, whirl in enumerate(zip(*self.whirl, strict=True)):
            for axes, values in ((above, frequency), (below, self.log_dec)):
                draw_whirling(axes, speed, values, mode, whirl, self.has_peak[:, mode])
        for order in self.harmonics:
            above.plot(speed, order * np.abs(speed), color="black", lw=1.0, ls=LIMIT)
        places = [(_speed(c.speed), c.harmonic * abs(_speed(c.speed))) for c in self.critical]
        for place, critical in zip(places, self.critical, strict=True):
            color = GREY if critical.is_critically_damped else "black"
            above.plot(*place, "o", color=color, mfc="white", ms=5)
        below.axhline(0, color="black", lw=1.0)
        whole = () if self.threshold is None else (self.threshold,)
        for turn in self.turns or whole:
            for axes in panels:
                axes.axvline(_speed(turn), color=PURPLE, lw=1.2, ls=":")
        seen = {word for words in self.whirl[1:] for word in words if word}
        handles = [
            Line2D([], [], color=c, lw=1.6, label=w) for w, c in WHIRL_COLORS.items() if w in seen
        ]
        if (np.isfinite(frequency) & ~self.has_peak).any():
            label = "damping ratio above 0.71: no peak"
            handles.append(Line2D([], [], color=GREY, lw=1.6, alpha=FAINT, label=label))
        if any(c.is_critically_damped for c in self.critical):
            dots: Any = {"marker": "o", "ls": "", "color": GREY, "mfc": "white", "ms": 5}
            handles.append(Line2D([], [], label="critically damped: AF below 2.5", **dots))
        label = "1x, the speed" if self.harmonics == (1.0,) else f"{self._orders} times the speed"
        handles.append(Line2D([], [], color="black", lw=1.0, ls=LIMIT, label=label))
        if self.threshold is not None:
            handles.append(Line2D([], [], color=PURPLE, lw=1.2, ls=":", label=self.stability))
        # lines run all over the axes
        legend_below(figure, 5 if len(handles) < 6 else 3, handles)
        highest = 1.05 * np.nanmax(frequency, initial=0.0)
        # not so far that the line of the speed, and what it meets, becomes flat
        reach = max(_REACH * max(self.harmonics) * np.abs(speed).max(), 1.3 * np.nanmin(frequency))
        above.set(ylim=(0, max(min(highest, reach), 1e-9)), xlim=(speed[0], speed[-1]))
        above.set_ylabel(current().frequency_label)
        below.set(xlabel=current().speed_label, ylabel="Logarithmic decrement [1]")
        finite = self.log_dec[np.isfinite(self.log_dec)]
        if len(finite) and np.abs(finite).max() < 1e-8:
            below.set_ylim(-1, 1)
        elif np.abs(finite).max(initial=0.0) > _DECREMENTS:
            # beyond, motions hardly oscillate, and all others would lie on the zero line
            low, high = 1.1 * finite.min(), 1.1 * finite.max()
            below.set_ylim(max(min(-0.1, low), -_DECREMENTS), min(max(0.1, high), _DECREMENTS))
        entitle(above, self.titled(f"Campbell diagram, contacts {self.contacts}"))
        words = [(shown_speed(c.speed), c.whirl == FORWARD) for c in self.critical]
        write_labels(above, [(*at, *word) for at, word in zip(places, words, strict=True)])
        return figure


def _speed(omega: float) -> float:
    return float(omega) * current().speed


class UnbalanceResponse(Displayed, linear.UnbalanceResponse):
    """`model.linear.UnbalanceResponse`, shown at the nodes with the largest orbits."""

    def table(self, nodes: Sequence[int] | None = None) -> Table:
        """Return the rows of speed and node (from 1): at every speed where they are few, else where
        the largest semi-axis of a node peaks."""
        d = current()
        moves = self.major >= _ROUNDING * self.major.max(axis=1, keepdims=True)
        size = np.where(moves, self.major, 0.0)
        places = [
            (i, node - 1)
            for node in nodes or self.nodes()
            for i in self._shown_of(node, size[:, node - 1])
        ]
        i, j = np.reshape(places, (-1, 2)).astype(int).T
        amplitudes = {"x": np.abs(self.x), "y": np.abs(self.y)}
        amplitudes |= {"major": self.major, "minor": self.minor}
        columns = (
            ("node", j + 1),
            ("speed [rad/s]", self.speeds[i]),
            (f"[{d.speed_unit}]", self.speeds[i] * d.speed),
            *(
                (f"{name} [{d.amplitude_words}]", of[i, j] * d.amplitude)
                for name, of in amplitudes.items()
            ),
            ("phase x [deg]", np.degrees(self.phase_x[i, j])),
            ("phase y [deg]", np.degrees(self.phase_y[i, j])),
        )
        what = "" if self._is_few else " where it peaks, or is largest"
        return Table.of(f"Response to unbalance{what}, contacts {self.contacts}", columns)

    @property
    def _is_few(self) -> bool:
        return len(self.speeds) <= MOST_SPEEDS

    def _shown_of(self, node: int, size: np.ndarray) -> Sequence[int]:
        """Return the places of the speeds at which the table shows a node (from 1)."""
        if self._is_few:
            return range(len(size))
        if node not in self.peaks:
            return peaks(size)
        found = np.searchsorted(self.speeds, self.peaks[node])
        return found[size[found] > 0.0].tolist() or [int(np.argmax(size))]

    def figure(
        self, nodes: Sequence[int] | None = None, operating: tuple[float, float] | None = None
    ) -> Figure:
        """Draw semi-axes and phases of nodes (from 1); operating: a range [rad/s], shaded."""
        figure, panels = new_panels(6.8, 6.0, 2, share_x=True, heights=(2, 1))
        above, below = panels
        speed, scale = self.speeds * current().speed, current().amplitude
        shade(panels, operating)
        mark = "o" if len(speed) < 3 else ""
        nodes = nodes or self.nodes()
        for node, color in zip(nodes, colors_of(len(nodes)), strict=True):
            at = node - 1
            label = f"node {node}"
            major = self.major[:, at] * scale
            above.plot(speed, major, marker=mark, color=color, lw=1.8, label=label)
            for x, dashes in ((self.x, DASHED), (self.y, DOTTED)):
                above.plot(speed, np.abs(x[:, at]) * scale, color=color, lw=1.0, ls=dashes)
            for angle, dashes in ((self.phase_x, DASHED), (self.phase_y, DOTTED)):
                known = np.where(self.speeds == 0, np.nan, angle[:, at])
                below.plot(*broken_at_turns(speed, known), color=color, lw=1.2, ls=dashes)
                below.plot(speed, np.degrees(known), marker=mark, color=color, ls="")
        handles, _ = above.get_legend_handles_labels()
        styles = (("major semi-axis", "-", 1.8), ("x", DASHED, 1.0), ("y", DOTTED, 1.0))
        handles += [Line2D([], [], color=GREY, lw=w, ls=s, label=label) for label, s, w in styles]
        above.legend(handles=handles, frameon=False, fontsize=8, loc="best")
        above.set_ylim(bottom=0)
        above.set_ylabel(f"Amplitude [{current().amplitude_unit}]")
        below.set(xlabel=current().speed_label, ylabel="Phase to the mark [deg]", ylim=(-185, 185))
        below.set_yticks([-180, -90, 0, 90, 180])
        entitle(above, self.titled(f"Steady response to unbalance, contacts {self.contacts}"))
        return figure


class Static(Displayed, linear.Static):
    """`model.linear.Static`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each node, then a row for the load on each support."""
        d = current()
        small, force = d.small_word, d.force_unit
        heads = (
            *("where", f"z [{d.length_unit}]", f"x [{small}]", f"y [{small}]"),
            *(f"load x [{force}]", f"load y [{force}]"),
        )
        moved = (self.x, self.y, self.housing_x, self.housing_y)
        x, y, housing_x, housing_y = without_rounding(d.small, *moved)
        load_x, load_y = without_rounding(d.force, self.load_x, self.load_y)
        at = zip((self.z * d.length).tolist(), x, y, strict=True)
        housings = zip(self.housings, housing_x, housing_y, strict=True)
        rows = [
            *((f"node {i}", *place, "", "") for i, place in enumerate(at, 1)),
            *((f"housing {name}", "", *of, "", "") for name, *of in housings),
            *(
                (f"on {name}", "", "", "", *of)
                for name, *of in zip(self.supports, load_x, load_y, strict=True)
            ),
        ]
        return Table(self._title(), heads, rows)

    def _title(self) -> str:
        return f"At rest, {state_in_words(self.speed, self.contacts)}"

    def figure(self) -> Figure:
        """Draw the deflection along the shaft, with the loads on the named supports: x, y of those
        across which a load acts, else their size."""
        figure, axes = new_figure(6.8, 3.8)
        d = current()
        curves = [axes.axhline(0, color=GREY, lw=0.8)]
        bent = curve(self.z, self.y * d.small, self.slope_y * d.small, self.shear)
        curves += axes.plot(*bent, color=BLUE, lw=1.8, label="y")
        at_nodes = dotted(len(self.z))
        axes.plot(self.z[at_nodes] * d.length, self.y[at_nodes] * d.small, "o", color=BLUE, ms=3.5)
        if np.abs(self.x).max(initial=0) > 1e-3 * np.abs(self.y).max(initial=0):
            bent = curve(self.z, self.x * d.small, self.slope_x * d.small, self.shear)
            curves += axes.plot(*bent, color=ORANGE, lw=1.5, ls=DASHED, label="x")
            axes.legend(frameon=False, fontsize=8)
        axes.margins(x=0.08, y=0.3)
        labels, reach = [], 0.1 * np.ptp(axes.get_ylim())
        marks = [*zip(self.z * d.length, self.y * d.small, strict=True)]
        loads = zip(self.support_z, self.supports, self.load_x, self.load_y, strict=True)
        for place, support, across, load in loads:
            if across == load == 0.0:
                continue  # a contact that is open
            node = int(np.argmin(np.abs(self.z - place)))
            at, y = place * d.length, self.y[node] * d.small
            tail = at, y + (-reach if load < 0 else reach)
            arrow = {"arrowstyle": "->", "color": "black", "lw": 0.9}
            if load:
                axes.annotate("", (at, y), tail, arrowprops=arrow)
            marks += [(at, (y + tail[1]) / 2)]
            words = five_digits(abs(load) * d.force)
            if abs(across) > 1e-3 * abs(load):
                words = f"x {five_digits(across * d.force)}, y {five_digits(load * d.force)}"
            labels.append((*tail, f"{support} {words} {d.force_unit}", load < 0))
        axes.set_xlabel(f"Along the shaft z [{d.length_unit}]")
        axes.set_ylabel(f"Deflection [{d.small_unit}]")
        entitle(axes, self.titled(self._title()))
        write_labels(axes, labels, marks, curves)
        return figure


campbell = answer_of(Campbell, linear.campbell)
unbalance_response = answer_of(UnbalanceResponse, linear.unbalance_response)
response_with_peaks = answer_of(UnbalanceResponse, linear.response_with_peaks)


def usual_speed(rotor: Rotor, contacts: str | None = None, afloat: float | None = None) -> float:
    """Return the speed of an answer of one speed [rad/s]: 0, or, if its oil films bear the machine,
    `afloat`, by default its rated one."""
    if not linear.needs_to_turn(rotor, contacts):
        return 0.0
    return afloat or operating_speeds(rotor).rated


@on_one_thread
def modes(machine: Machine, speed: float | None = None, **options: Any) -> Modes:
    """Return `model.linear.modes` of a machine, by default at its `usual_speed`."""
    rotor = rotor_of(machine)
    if speed is None:
        speed = usual_speed(rotor, options.get("contacts"))
    return displayed(Modes, linear.modes, rotor, speed, **options)


@on_one_thread
def static(
    machine: Machine, speed: float | None = None, afloat: float | None = None, **options: Any
) -> Static:
    """Return `model.linear.static` of a machine, by default at its `usual_speed`."""
    rotor = rotor_of(machine)
    if speed is None:
        speed = usual_speed(rotor, options.get("contacts"), afloat)
    return displayed(Static, linear.static, rotor, speed, **options)
