"""Mode shapes in three dimensions: the shaft at one instant, and the orbits of its nodes."""

import math

import numpy as np
from matplotlib.figure import Figure

from ..display import current, shown_speed
from ..plotting.figure_style import GREY, empty_figure, entitle
from .linear_plots import WHIRL_COLORS, curve, dotted, shapes_in_grid, titled
from .linear_tables import clean_damping, turns
from .mode_answers import Modes

_ANGLES = np.linspace(0.0, 2 * math.pi, 49)
_GAP = 0.93  # of a turn: an orbit ends before it closes, so that its sense can be seen


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
        frequency = f"{shown_speed(result.damped[i])} {current().frequency_unit}"
        axes.set_title(f"{i + 1}: {frequency}, {result.motion(i)}", fontsize=9, y=0.98)
    state = turns(result.speed, result.contacts)
    entitle(figure, titled(result.machine_name, f"Mode shapes at {state}; x across, y up"))
    return figure


def shapes_for_page(result: Modes) -> dict[str, object]:
    """Return the shapes as numbers for the page's own drawing: z [mm], which nodes (from
    0) are marked, and of each mode its frequency in the unit that is shown, whirl, logarithmic
    decrement and complex x, y of the nodes."""
    return {
        "unit": current().frequency_unit,
        "z": (result.z * 1e3).tolist(),
        "marked": dotted(len(result.z)).tolist(),
        "modes": [
            {
                "frequency": float(result.damped[i]) * current().speed,
                "whirl": result.whirl[i],
                "log_dec": float(clean_damping(result.log_dec[i])),
                "x": [result.x[i].real.tolist(), result.x[i].imag.tolist()],
                "y": [result.y[i].real.tolist(), result.y[i].imag.tolist()],
            }
            for i in range(len(result.eigenvalues))
        ],
    }
