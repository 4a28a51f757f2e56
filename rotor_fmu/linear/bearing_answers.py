"""Bearings by themselves, for Python: the curves of `model.bearing_curves`, which a notebook
shows as a table and a picture."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from ..cells import five_digits
from ..display import current, speed_with_unit
from ..model import bearing_curves
from ..model.bearing_curves.journal_bearing import ANGLES
from ..plotting.colors import BLUE, ORANGE, PURPLE
from ..plotting.figure_style import empty_figure, entitle, new_panels, style
from ..tables import Table
from .bearing_columns import (
    coefficient_columns,
    draw_coefficients,
    draw_lines,
    in_clearance,
    parted,
    shown_span,
    speed_and_load,
    varies_load,
    what_varies,
)
from .displayed import Displayed, answer_of
from .linear_plots import plain_ticks
from .linear_tables import shown_either_way, whirls_where


class BearingCurves(Displayed, bearing_curves.BearingCurves):
    """`model.bearing_curves.BearingCurves`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each speed; the threshold of stability in the heading."""
        d = current()
        fast = np.abs(self.speeds)
        whirl = np.divide(self.whirl, fast, out=0.0 * fast, where=fast != 0.0)
        columns = [
            *speed_and_load(self),
            ("e/c [1]", self.eccentricity),
            ("attitude [deg]", np.degrees(self.attitude)),
            (f"film [{d.small_word}]", self.film * d.small),
            (f"p max [{d.pressure_unit}]", self.pressure * d.pressure),
            *coefficient_columns(self),
            (f"torque [{d.torque_unit}]", self.torque * d.torque),
            (f"critical mass [{d.mass_unit}]", self.critical_mass * d.mass),
            ("whirl [1]", whirl),
            ("off 2D [%]", 100 * self.plane_error),
        ]
        if np.ptp(self.viscosity) > 0.0 or self.temperature is not None:
            columns.append(("viscosity [mPa.s]", 1e3 * self.viscosity))
        if self.temperature is not None:
            columns.append(("oil [degC]", self.temperature))
        return Table.of(f"{self.bearing}: {self._stability()}", columns)

    def _stability(self) -> str:
        """Return which mass whirls, and where; one may leave an equilibrium that holds no mass at
        all without a whirl."""
        d = current()
        whirls = "whirls" if self.critical_mass.all() else "is unstable"
        if varies_load(self):
            shown = [f"{load * d.force:.6g} {d.force_unit}" for load in self.turns]
            loads = np.hypot(*self.load.T)
            least = int(loads.argmin())
            is_first = self.critical_mass[least] < self.mass * loads[least] / loads[0]
            where = whirls_where(bool(is_first), shown, whirls)
            return f"a mass that weighs its load {where}"
        if self.mass == 0.0:
            return "it bears no load"
        mass = f"a mass of {five_digits(self.mass * d.mass)} {d.mass_unit} on it"
        if self.threshold is None:
            return f"{mass} does not whirl"
        if not len(self.turns):
            return f"{mass} {whirls} already above {shown_either_way(self.threshold)}"
        turns = [shown_either_way(speed) for speed in self.turns]
        return f"{mass} {whirls_where(self.threshold not in self.turns, turns, whirls)}"

    def figure(self) -> Figure:
        """Draw the journal's locus in its clearance, the pressure around it, and stiffness and
        damping over the speed; of pads that tilt also how far they do and what they bear."""
        tilts = self.tilts.shape[1] > 0
        figure, panels = new_panels(8.4, 10.9 if tilts else 7.4, 3 if tilts else 2, 2)
        locus, around, *over_speed = panels
        x, y = self.x / self.clearance, self.y / self.clearance
        d, (varied, unit, what) = current(), what_varies(self)
        locus.plot(*parted(varied, x, y)[1:], "-", color=BLUE, lw=1.4)
        for i, color in ((0, BLUE), (len(x) - 1, ORANGE)):
            label = f"{five_digits(varied[i])} {unit}"
            locus.plot(x[i], y[i], "o", color=color, label=label)
            around.plot(np.degrees(ANGLES), self.around[i] * d.pressure, color=color, label=label)
            if i == 0 or tilts:
                self._draw_pads(locus, i, color if tilts else "black")
            if len(x) == 1:
                break
        in_clearance(locus, "Journal at rest in its clearance")
        around.set_xlabel("Angle from the right, anticlockwise [deg]")
        around.set_xticks(range(0, 361, 90))
        around.set_ylabel(f"Pressure [{d.pressure_unit}]")
        entitle(around, "Film in the middle of its length", 9)
        around.legend(frameon=False, fontsize=8)
        mark = "o-" if len(x) < 3 else "-"
        draw_coefficients(over_speed, self, mark)
        if tilts:
            self._draw_pads_over(over_speed[2:], varied, mark)
            for first, last, pivot, *_ in self.pads:
                spans = np.degrees([first, last]) % 360.0
                turned = spans if spans[0] < spans[1] else [spans[0], 360.0, 0.0, spans[1]]
                for begin, end in zip(turned[::2], turned[1::2], strict=True):
                    around.axvspan(begin, end, color="0.92", lw=0)
                around.axvline(np.degrees(pivot) % 360.0, color="0.6", lw=0.8, ls="--")
        for axes in over_speed:
            axes.set_xlabel(f"{what} [{unit}]")
            for turn in self.turns * (d.force if what == "Load" else d.speed):
                axes.axvline(turn, color=PURPLE, lw=1.2, ls=":")
        entitle(figure, self.table().title)
        return figure

    def _draw_pads(self, axes: Axes, i: int, color: str) -> None:
        """Draw how far the journal may go: where it would touch each pad as that stands in row i,
        and the pads' pivots."""
        moved = np.zeros((len(self.pads), 2))
        moved[: self.tilts.shape[1]] = self.tilts[i] / self.clearance
        for n, ((first, last, pivot, clearance, x, y), (tilt, give)) in enumerate(
            zip(self.pads, moved, strict=True), 1
        ):
            theta = np.linspace(first, last, max(2, round(np.degrees(last - first))))
            centre = complex(x, y) + (1j * tilt - give) * np.exp(1j * pivot)
            e = np.exp(1j * np.append(theta, pivot))
            *surface, at = (clearance - (centre * e.conj()).real) * e
            axes.plot(np.real(surface), np.imag(surface), color=color, lw=1.2)
            if self.tilts.shape[1]:
                axes.plot(at.real, at.imag, "^", ms=4, color=color)
                if i == 0:
                    axes.annotate(f"{n}", (1.18 * at.real, 1.18 * at.imag), fontsize=8, ha="center")

    def _draw_pads_over(self, panels: Sequence[Axes], over: np.ndarray, mark: str) -> None:
        d = current()
        for axes, values, name in (
            (panels[0], 1e3 * self.tilts[:, :, 0] / self.journal_radius, "Tilt [mrad]"),
            (panels[1], self.pad_loads * d.force, f"Load of a pad [{d.force_unit}]"),
        ):
            labels = [f"pad {n}" for n in range(1, values.shape[1] + 1)]
            draw_lines(axes, over, values.T, labels, mark)
            axes.set_ylabel(name)


class DamperCurves(Displayed, bearing_curves.DamperCurves):
    """`model.bearing_curves.DamperCurves`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each orbit; in the heading where the ring rests."""
        d = current()
        columns = (
            ("orbit e/c [1]", self.orbit),
            (f"film's stiffness [{d.stiffness_unit}]", self.stiffness * d.stiffness),
            (f"damping [{d.damping_unit}]", self.damping * d.damping),
            (f"p max [{d.pressure_unit}]", self.pressure * d.pressure),
            ("power [W]", self.power),
        )
        (kxx, kxy), (kyx, kyy) = self.K * d.stiffness
        (cxx, cxy), (cyx, cyy) = self.C * d.damping
        what = "there with its cage" if self.cage.any() else "there"
        title = (
            f"{self.bearing}: rests at e/c = {self.eccentricity:.4g} under "
            f"{np.hypot(*self.load) * d.force:.4g} {d.force_unit}; {what} kxx {kxx:.4g}, "
            f"kxy {kxy:.4g}, kyx {kyx:.4g}, kyy {kyy:.4g} {d.stiffness_unit}, "
            f"cxx {cxx:.4g}, cxy {cxy:.4g}, cyx {cyx:.4g}, cyy {cyy:.4g} {d.damping_unit}\n"
            f"Centred circular orbits at {speed_with_unit(self.frequency)}"
        )
        return Table.of(title, columns)

    def figure(self) -> Figure:
        """Draw the ring at rest, and stiffness, damping and largest pressure over the orbit."""
        figure, (place, pressure, stiffness, damping) = new_panels(8.4, 7.4, 2, 2)
        circle = np.exp(1j * ANGLES)
        place.plot(circle.real, circle.imag, color="black", lw=1.2)
        place.plot(self.x / self.clearance, self.y / self.clearance, "o", color=BLUE)
        d = current()
        load = f"{np.hypot(*self.load) * d.force:.4g} {d.force_unit}"
        in_clearance(place, f"Ring at rest under {load}")
        for axes, values, name in (
            (pressure, self.pressure * d.pressure, f"Largest pressure [{d.pressure_unit}]"),
            (stiffness, self.stiffness * d.stiffness, f"Stiffness [{d.stiffness_unit}]"),
            (damping, self.damping * d.damping, f"Damping of the film [{d.damping_unit}]"),
        ):
            axes.plot(self.orbit, values, "-", color=BLUE, lw=1.4)
            axes.set(xlabel="Orbit over the clearance [1]", ylabel=name, xlim=(0.0, 1.0))
            if values.any():  # a full film is not stiff
                axes.set_yscale("log")
                plain_ticks(axes.yaxis)
        springs = {"spring": self.spring, "cage in x": self.cage[0], "cage in y": self.cage[1]}
        if self.cage[0] == self.cage[1]:
            springs = {"spring": self.spring, "cage": self.cage[0]}
        for (name, spring), dashes in zip(springs.items(), ("--", ":", "-."), strict=False):
            if spring > 0.0:
                at = spring * d.stiffness
                stiffness.axhline(at, color=ORANGE, lw=1.2, ls=dashes, label=name)
                stiffness.lines[0].set_label("film")
                stiffness.legend(frameon=False, fontsize=8)
        orbits = f"centred circular orbits at {speed_with_unit(self.frequency)}"
        entitle(figure, f"{self.bearing}: {orbits}")
        return figure


class RingCurves(Displayed, bearing_curves.RingCurves):
    """`model.bearing_curves.RingCurves`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each speed or load."""
        d = current()
        columns = (
            *speed_and_load(self),
            (f"ring [{d.speed_unit}]", self.ring_speed * d.speed),
            ("ratio [1]", self.ratio),
            ("e/c [1]", self.eccentricity),
            ("outer e/c [1]", self.outer_eccentricity),
            *coefficient_columns(self),
            (f"torque [{d.torque_unit}]", self.torque * d.torque),
            ("power [W]", self.power),
            ("outer [W]", self.outer_power),
        )
        title = f"{self.bearing}: the ring turns at {shown_span(self.ratio)} of the rotor's speed"
        return Table.of(title, columns)

    def figure(self) -> Figure:
        """Draw journal and ring at rest, the ring's speed over the rotor's, and stiffness and
        damping over the speed or load."""
        figure, (locus, ratio, *panels) = new_panels(8.4, 7.4, 2, 2)
        d, (varied, unit, what) = current(), what_varies(self)
        mark = "o-" if len(varied) < 3 else "-"
        for x, y, label, color in (
            (self.x, self.y, "journal", BLUE),
            (self.ring_x, self.ring_y, "ring", ORANGE),
        ):
            path = parted(varied, x * d.small, y * d.small)[1:]
            locus.plot(*path, mark, ms=4, color=color, lw=1.4, label=label)
            locus.plot(x[0] * d.small, y[0] * d.small, "o", color=color)
        circle = self.outer_clearance * d.small * np.exp(1j * ANGLES)
        locus.plot(circle.real, circle.imag, color="black", lw=1.2, label="outer clearance")
        locus.set_aspect("equal")
        locus.set(xlabel=f"x [{d.small_unit}]", ylabel=f"y [{d.small_unit}]")
        entitle(locus, f"Journal and ring at rest; dots at {five_digits(varied[0])} {unit}", 9)
        locus.legend(frameon=False, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 0.92))
        ratio.plot(*parted(varied, self.ratio), mark, ms=4, color=BLUE, lw=1.4)
        ratio.set_ylabel("Speed of the ring over the rotor's [1]")
        ratio.set_ylim(bottom=0.0)
        draw_coefficients(panels, self, mark)
        for axes in (ratio, *panels):
            axes.set_xlabel(f"{what} [{unit}]")
        entitle(figure, self.table().title)
        return figure


class RollingCurves(Displayed, bearing_curves.RollingCurves):
    """`model.bearing_curves.RollingCurves`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each load; in the heading the cage's speed."""
        d = current()
        columns = (
            *speed_and_load(self),
            (f"x [{d.small_word}]", self.x * d.small),
            (f"y [{d.small_word}]", self.y * d.small),
            (f"largest [{d.force_unit}]", self.largest * d.force),
            ("loaded", self.loaded),
            *coefficient_columns(self),
            *(
                (
                    f"k{axis}{axis} passing [{d.stiffness_unit}]",
                    [shown_span(k[:, i, i] * d.stiffness) for k in self.K_passing],
                )
                for i, axis in enumerate("xy")
            ),
        )
        count = len(self.angles)
        title = (
            f"{self.bearing}: {count} elements, as they stand at the start; one passes "
            f"{count * self.ratio:.5g} times in a revolution"
        )
        return Table.of(title, columns)

    def figure(self) -> Figure:
        """Draw what each element carries under the last load, the stiffness as they pass, and, of
        several loads or speeds, stiffness and damping over them."""
        varied, unit, what = what_varies(self)
        last = len(varied) - 1
        rows = 2 if last else 1
        figure = empty_figure(8.4, 0.3 + 3.55 * rows)
        around = figure.add_subplot(rows, 2, 1, projection="polar")
        passing, *over = (figure.add_subplot(rows, 2, place) for place in range(2, 2 * rows + 1))
        for axes in (passing, *over):
            style(axes)
        share = 1.4 * np.pi / len(self.angles)
        d = current()
        around.bar(self.angles, self.elements[last] * d.force, share, color=BLUE)
        loads = np.hypot(*self.load.T) * d.force
        under = [f"under {load:.4g} {d.force_unit}" for load in loads]
        entitle(around, f"Load of each element [{d.force_unit}], {under[last]}", 9)
        around.tick_params(labelsize=8)
        around.yaxis.set_major_locator(MaxNLocator(4))  # more numbers run into each other
        turned = np.linspace(0.0, 1.0, self.K_passing.shape[1] + 1)
        for i, line in ((last, "-"), (0, "--"))[: 2 if last else 1]:
            for axis, color in ((0, BLUE), (1, ORANGE)):
                values = self.K_passing[i, :, axis, axis] * d.stiffness
                label = f"k{'xy'[axis]}{'xy'[axis]} {under[i]}"
                values = np.append(values, values[0])
                passing.plot(turned, values, line, color=color, lw=1.4, label=label)
        entitle(passing, "As the elements pass", 9)
        passing.set_xlabel("Cage's angle over the elements' pitch [1]")
        passing.set_ylabel(f"Stiffness [{d.stiffness_unit}]")
        passing.margins(y=0.25)
        passing.legend(frameon=False, fontsize=8, ncols=2, loc="upper left")
        if over:
            draw_coefficients(over, self, "o-" if last < 3 else "-")
        for axes in over:
            axes.set_xlabel(f"{what} [{unit}]")
        entitle(figure, self.table().title)
        return figure


bearing = answer_of(BearingCurves, bearing_curves.bearing_curves)
damper = answer_of(DamperCurves, bearing_curves.damper_curves)
floating_ring = answer_of(RingCurves, bearing_curves.ring_curves)
rolling = answer_of(RollingCurves, bearing_curves.rolling_curves)
