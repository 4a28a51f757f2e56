"""Modes, shown as a table and as a picture of each plane."""

import numpy as np
from matplotlib.figure import Figure

from ..display import current, shown_speed
from ..model import linear
from ..plotting.figure_style import BLUE, DASHED, GREY, ORANGE, entitle, new_panels
from .displayed import Displayed
from .linear_plots import curve, dotted, shapes_in_grid, titled
from .linear_tables import Table, clean_damping, turns


class Modes(Displayed, linear.Modes):
    """`model.linear.Modes`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each mode."""
        d = current()
        title = f"Modes at {turns(self.speed, self.contacts)}"
        if len(self.growing):
            title += f"; UNSTABLE: a motion grows without oscillating, {self.growing[0]:.4g} 1/s"
        is_doubtful = ~self.is_sound & self.is_held
        if is_doubtful.any():
            title += (
                f"; of mode {_numbers(is_doubtful)} rounding leaves residuals up to "
                f"{np.max(self.residuals[is_doubtful]):.1g}:"
                " its stiffnesses and masses lie too far apart"
            )
        if not self.is_held.all():
            title += f"; nothing holds mode {_numbers(~self.is_held)}, of frequency 0 but rounding"
        if self.is_of_housings.any():
            title += f"; in mode {_numbers(self.is_of_housings)} housings move alone"
        columns = (
            ("mode", range(1, len(self.damped) + 1)),
            (f"f_d [{d.frequency_unit}]", self.damped * d.speed),
            (f"f_n [{d.frequency_unit}]", self.natural * d.speed),
            ("omega_d [rad/s]", self.damped),
            ("damping", np.where(self.is_held, clean_damping(self.damping_ratio), np.nan)),
            ("log dec", np.where(self.is_held, clean_damping(self.log_dec), np.nan)),
            ("whirl", self.whirl),
        )
        return Table.of(title, columns)

    def motion(self, mode: int) -> str:
        """Return in a word or two how a mode, counted from 0, moves."""
        return f"{self.whirl[mode]}{', housings alone' if self.is_of_housings[mode] else ''}"

    def figure(self) -> Figure:
        """Draw the shapes of the lowest modes: each plane at the instant of its largest
        deflection."""
        shown, rows, columns = shapes_in_grid(len(self.eigenvalues))
        figure, panels = new_panels(4.2 * columns, 0.9 + 1.75 * rows, rows, columns, share_x=True)
        for i, axes in enumerate(panels):
            if i >= shown:
                axes.set_visible(False)
                continue
            axes.axhline(0, color=GREY, lw=0.8)
            for w, slope, color, label, dashes in (
                (self.x[i], self.slope_x[i], BLUE, "x", "-"),
                (self.y[i], self.slope_y[i], ORANGE, "y", DASHED),
            ):
                turn = np.exp(-1j * np.angle(w[np.argmax(np.abs(w))]))
                bent = curve(self.z, (w * turn).real, (slope * turn).real, self.shear)
                axes.plot(*bent, color=color, lw=1.6, ls=dashes, label=label)
                at = dotted(len(w))
                axes.plot(
                    self.z[at] * current().length, (w[at] * turn).real, "o", color=color, ms=3
                )
            axes.margins(y=0.08)
            frequency = f"{shown_speed(self.damped[i])} {current().frequency_unit}"
            damping = f"damping {clean_damping(self.damping_ratio[i]):.2g}"
            damping = damping if self.is_held[i] else "held by nothing"
            entitle(axes, f"{i + 1}: {frequency}, {self.motion(i)}, {damping}", 9)
            if i + columns >= shown:
                axes.set_xlabel(f"Along the shaft z [{current().length_unit}]")
                axes.tick_params(labelbottom=True)
            if i % columns == 0:
                axes.set_ylabel("Shape [1]")
        if shown:
            figure.legend(
                *panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2
            )
        title = f"Modes at {turns(self.speed, self.contacts)}"
        entitle(figure, titled(self.machine_name, title))
        return figure


def _numbers(are: np.ndarray) -> str:
    """Return the numbers, from 1, of the modes that are something."""
    return ", ".join(str(i + 1) for i in np.flatnonzero(are))
