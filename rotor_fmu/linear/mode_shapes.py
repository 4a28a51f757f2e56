"""Mode shapes in three dimensions: the shaft at one instant, and the orbits of its nodes."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

from ..display import current, shown_speed
from ..model.linear.modes import BACKWARD, FORWARD, MIXED, Modes
from ..plotting.figure_style import BLUE, GREEN, GREY, ORANGE, empty_figure, entitle
from .linear_plots import deflection, titled
from .linear_tables import turns

_COLORS = {FORWARD: BLUE, BACKWARD: ORANGE, MIXED: GREEN}
_MOST_SHAPES = 6
_ANGLES = np.linspace(0.0, 2 * math.pi, 49)
_FINE = 12  # points an element of the shaft's line
_GAP = 0.93  # of a turn: an orbit ends before it closes, so that its sense can be seen


def mode_shapes_figure(result: Modes, name: str = "", shear: Sequence[float] = ()) -> Figure:
    """Draw the lowest modes in space: each node's orbit, open where it begins again, with a dot at
    its begin, and the shaft through the dots, bent as its elements bend; shear: see
    `linear_plots.deflection`."""
    shown = min(_MOST_SHAPES, len(result.eigenvalues))
    columns = 2 if shown > 1 else 1
    rows = max(1, -(-shown // columns))
    figure = empty_figure(4.6 * columns, 0.6 + 2.9 * rows)
    for i in range(shown):
        axes = figure.add_subplot(rows, columns, i + 1, projection="3d")
        color = _COLORS.get(result.whirl[i], GREY)
        z = result.z * current().length
        turn = np.exp(1j * _ANGLES * _GAP)
        for node in range(len(z)):
            x, y = ((w[i, node] * turn).real for w in (result.x, result.y))
            axes.plot(np.full(len(turn), z[node]), x, y, color=color, lw=0.9, alpha=0.7)
        axes.plot(z, 0 * z, 0 * z, color=GREY, lw=0.8)
        fine = np.unique(np.concatenate([np.linspace(a, b, _FINE) for a, b in pairwise(result.z)]))
        line = [
            deflection(result.z, w[i].real, slope[i].real, shear)(fine)
            for w, slope in ((result.x, result.slope_x), (result.y, result.slope_y))
        ]
        axes.plot(fine * current().length, *line, color="black", lw=1.6)
        axes.plot(z, result.x[i].real, result.y[i].real, "o", color="black", ms=2.5)
        widest = 1.05 * max(np.abs(each).max() for each in (result.x[i], result.y[i], *line))
        axes.set_ylim(-widest, widest)
        axes.set_zlim(-widest, widest)
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
        axes.set_title(f"{i + 1}: {frequency}, {result.whirl[i]}", fontsize=9, y=0.98)
    state = turns(result.speed, result.contacts)
    entitle(figure, titled(name, f"Mode shapes at {state}; x across, y up"))
    return figure


def shapes_for_page(result: Modes) -> dict[str, object]:
    """Return the shapes as numbers for the page's own drawing: z [mm], and of each mode its
    frequency in the unit that is shown, whirl, logarithmic decrement and complex x, y of the
    nodes."""
    return {
        "unit": current().frequency_unit,
        "z": (result.z * 1e3).tolist(),
        "modes": [
            {
                "frequency": float(result.damped[i]) * current().speed,
                "whirl": result.whirl[i],
                "log_dec": float(result.log_dec[i]),
                "x": [result.x[i].real.tolist(), result.x[i].imag.tolist()],
                "y": [result.y[i].real.tolist(), result.y[i].imag.tolist()],
            }
            for i in range(len(result.eigenvalues))
        ],
    }
