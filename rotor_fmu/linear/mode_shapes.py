"""Mode shapes in three dimensions: the shaft at one instant, and the orbits of its nodes."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.interpolate import CubicHermiteSpline

from ..figure_style import BLUE, GREEN, GREY, ORANGE, PlainFigure
from ..model.linear.modes import BACKWARD, FORWARD, MIXED, Modes
from .linear_tables import hertz, turns

_COLORS = {FORWARD: BLUE, BACKWARD: ORANGE, MIXED: GREEN}
_MOST_SHAPES = 6
_ANGLES = np.linspace(0.0, 2 * math.pi, 49)
_FINE = 12  # points an element of the shaft's line
_GAP = 0.93  # of a turn: an orbit ends before it closes, so that its sense can be seen


def mode_shapes_figure(result: Modes) -> Figure:
    """Draw the lowest modes in space: each node's orbit, open where it begins again, with a dot at
    its begin, and the shaft through the dots."""
    shown = min(_MOST_SHAPES, len(result.eigenvalues))
    columns = 2 if shown > 1 else 1
    rows = max(1, -(-shown // columns))
    figure = PlainFigure(figsize=(4.6 * columns, 0.6 + 2.9 * rows), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    for i in range(shown):
        axes = figure.add_subplot(rows, columns, i + 1, projection="3d")
        color = _COLORS.get(result.whirl[i], GREY)
        z = result.z * 1e3
        turn = np.exp(1j * _ANGLES * _GAP)
        for node in range(len(z)):
            x, y = ((w[i, node] * turn).real for w in (result.x, result.y))
            axes.plot(np.full(len(turn), z[node]), x, y, color=color, lw=0.9, alpha=0.7)
        axes.plot(z, 0 * z, 0 * z, color=GREY, lw=0.8)
        fine = np.unique(np.concatenate([np.linspace(a, b, _FINE) for a, b in pairwise(result.z)]))
        line = [
            CubicHermiteSpline(result.z, w[i].real, slope[i].real)(fine)
            for w, slope in ((result.x, result.slope_x), (result.y, result.slope_y))
        ]
        axes.plot(fine * 1e3, *line, color="black", lw=1.6)
        axes.plot(z, result.x[i].real, result.y[i].real, "o", color="black", ms=2.5)
        axes.set_ylim(-1.05, 1.05)
        axes.set_zlim(-1.05, 1.05)
        axes.set_box_aspect((2.4, 1, 1), zoom=1.25)
        axes.view_init(elev=18, azim=-62)
        axes.set_yticks([])
        axes.set_zticks([])
        axes.tick_params(labelsize=7, pad=-2)
        axes.set_xlabel("z [mm]", fontsize=7, labelpad=-4)
        axes.set_title(
            f"{i + 1}: {hertz(result.damped[i]):.4g} Hz, {result.whirl[i]}", fontsize=9, y=0.98
        )
    figure.suptitle(
        f"Mode shapes at {turns(result.speed, result.contacts)}; x across, y up",
        fontsize=10,
        x=0.01,
        ha="left",
    )
    return figure


def shapes_for_page(result: Modes) -> dict[str, object]:
    """Return the shapes as numbers for the page's own drawing: z [mm], and of each mode its
    frequency [Hz], whirl, logarithmic decrement and complex x, y of the nodes."""
    return {
        "z": (result.z * 1e3).tolist(),
        "modes": [
            {
                "hertz": hertz(result.damped[i]),
                "whirl": result.whirl[i],
                "log_dec": float(result.log_dec[i]),
                "x": [result.x[i].real.tolist(), result.x[i].imag.tolist()],
                "y": [result.y[i].real.tolist(), result.y[i].imag.tolist()],
            }
            for i in range(len(result.eigenvalues))
        ],
    }
