"""Modes, shown as a table, as a picture of each plane, and in three dimensions."""

import math

import numpy as np
from matplotlib.figure import Figure

from ..display import current, shown_speed
from ..model import linear
from ..plotting.colors import BLUE, DASHED, GREY, ORANGE
from ..plotting.figure_style import empty_figure, entitle, legend_below, new_panels
from ..tables import Table
from .displayed import Displayed
from .linear_plots import WHIRL_COLORS, curve, dotted, shapes_in_grid
from .linear_tables import clean_damping, state_in_words

_ANGLES = np.linspace(0.0, 2 * math.pi, 49)
_GAP = 0.93  # of a turn: an orbit ends before it closes, so that its sense can be seen


class Modes(Displayed, linear.Modes):
    """`model.linear.Modes`, shown."""

    def table(self) -> Table:
        """Return a table with one row for each mode."""
        d = current()
        title = self.titled_state("Modes")
        if len(self.growing):
            title += f"; UNSTABLE: a motion grows without oscillating, {self.growing[0]:.4g} 1/s"
        if not self.is_sound.all():
            title += (
                f"; of mode {_numbers(~self.is_sound)} rounding leaves residuals up to "
                f"{np.max(self.residuals):.1g}:"
                " its stiffnesses and masses lie too far apart"
            )
        if self.is_of_housings.any():
            title += f"; in mode {_numbers(self.is_of_housings)} housings move alone"
        columns = (
            ("mode", range(1, len(self.damped) + 1)),
            (f"f_d [{d.frequency_unit}]", self.damped * d.speed),
            (f"f_n [{d.frequency_unit}]", self.natural * d.speed),
            ("omega_d [rad/s]", self.damped),
            ("damping ratio", clean_damping(self.damping_ratio)),
            ("log dec", clean_damping(self.log_dec)),
            ("whirl", self.whirl),
        )
        return Table.of(title, columns)

    def titled_state(self, what: str) -> str:
        """Return what is shown with where it holds, and whether motions are not among it."""
        title = f"{what} at {state_in_words(self.speed, self.contacts)}"
        unheld = "; motions of frequency 0, which nothing holds, are not shown"
        return title if self.is_held else title + unheld

    def caption(self, mode: int, damping: str = "") -> str:
        """Return in words which mode this is, counted from 0, how it moves, and its damping."""
        frequency = f"{shown_speed(self.damped[mode])} {current().frequency_unit}"
        housings = "housings alone" if self.is_of_housings[mode] else ""
        words = (frequency, self.whirl[mode], housings, damping)
        return f"{mode + 1}: {', '.join(filter(None, words))}"

    def figure(self) -> Figure:
        """Draw the lowest modes' shapes, each plane at the instant of its largest deflection."""
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
                z = self.z[at] * current().length
                axes.plot(z, (w[at] * turn).real, "o", color=color, ms=3)
            axes.margins(y=0.08)
            damping = f"damping {clean_damping(self.damping_ratio[i]):.2g}"
            entitle(axes, self.caption(i, damping), 9)
            if i + columns >= shown:
                axes.set_xlabel(f"Along the shaft z [{current().length_unit}]")
                axes.tick_params(labelbottom=True)
            if i % columns == 0:
                axes.set_ylabel("Shape [1]")
        if shown:
            legend_below(figure, 2, panels[0].get_legend_handles_labels()[0])
        entitle(figure, self.titled(self.titled_state("Modes")))
        return figure


def _numbers(are: np.ndarray) -> str:
    """Return the numbers, from 1, of the modes that are something."""
    return ", ".join(str(i + 1) for i in np.flatnonzero(are))


def mode_shapes_figure(result: Modes) -> Figure:
    """Draw the lowest modes in space: orbits of nodes (see `dotted`), open where they begin again,
    with a dot at their begin, and the shaft through the dots, bent as its elements bend."""
    shown, rows, columns = shapes_in_grid(len(result.eigenvalues))
    figure = empty_figure(4.6 * columns, 0.6 + 2.9 * rows)
    for i in range(shown):
        axes = figure.add_subplot(rows, columns, i + 1, projection="3d")
        color = WHIRL_COLORS[result.whirl[i]]
        z = result.z * current().length
        turn = np.exp(1j * _ANGLES * _GAP)
        marked = dotted(len(z))
        for node in marked:
            x, y = ((w[i, node] * turn).real for w in (result.x, result.y))
            axes.plot(np.full(len(turn), z[node]), x, y, color=color, lw=0.9, alpha=0.7)
        axes.plot(z, 0 * z, 0 * z, color=GREY, lw=0.8)
        fine, x = curve(result.z, result.x[i].real, result.slope_x[i].real, result.shear)
        _, y = curve(result.z, result.y[i].real, result.slope_y[i].real, result.shear)
        axes.plot(fine, x, y, color="black", lw=1.6)
        at = z[marked], result.x[i, marked].real, result.y[i, marked].real
        axes.plot(*at, "o", color="black", ms=2.5)
        widest = 1.05 * max(np.abs(each).max() for each in (result.x[i], result.y[i], x, y))
        axes.set_ylim(-(widest or 1.0), widest or 1.0)  # 0 where housings move alone
        axes.set_zlim(*axes.get_ylim())
        axes.set_box_aspect((2.4, 1, 1), zoom=1.25)
        for drawn in axes.lines:  # the box is larger than what the picture has kept for it
            drawn.set_clip_on(False)
            drawn.set_in_layout(False)
        axes.view_init(elev=18, azim=-62)
        axes.set_yticks([])
        axes.set_zticks([])
        axes.tick_params(labelsize=7, pad=-2)
        axes.set_xlabel(f"z [{current().length_unit}]", fontsize=7, labelpad=-4)
        axes.set_title(result.caption(i), fontsize=9, y=0.98)
    title = result.titled_state("Mode shapes")
    entitle(figure, result.titled(f"{title}; x across, y up"))
    return figure


def shapes_for_page(result: Modes) -> dict[str, object]:
    """Return the shapes as numbers for the page's own drawing: z [mm], which nodes (from
    0) are marked, and of each mode its caption with the logarithmic decrement, its whirl and
    complex x, y of the nodes."""
    log_decs = clean_damping(result.log_dec)
    return {
        "z": (result.z * 1e3).tolist(),
        "marked": dotted(len(result.z)).tolist(),
        "modes": [
            {
                "caption": result.caption(i, f"log dec {log_decs[i]:.3g}"),
                "whirl": result.whirl[i],
                "x": [result.x[i].real.tolist(), result.x[i].imag.tolist()],
                "y": [result.y[i].real.tolist(), result.y[i].imag.tolist()],
            }
            for i in range(len(result.eigenvalues))
        ],
    }
