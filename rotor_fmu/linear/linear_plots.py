"""Pictures of linear analyses."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.interpolate import BPoly

from ..display import current, frequency_unit, shown_speed
from ..model.linear.campbell import Campbell
from ..model.linear.modes import BACKWARD, FORWARD, MIXED, PLANAR, Modes
from ..model.linear.static import Static
from ..model.linear.unbalance import UnbalanceResponse
from ..plotting.figure_style import BLUE, GREEN, GREY, ORANGE, PlainFigure
from ..plotting.labels import write_labels
from .linear_tables import turns

PURPLE, RANGE = "#cc79a7", "#56b4e9"
COLORS = (BLUE, ORANGE, GREEN, PURPLE, "#e69f00", "#56b4e9", "black", GREY)
_WHIRL = {FORWARD: BLUE, BACKWARD: ORANGE, MIXED: GREEN, PLANAR: GREY}
_MOST_SHAPES = 6
_REACH = 4.0  # of the line of the excitation: frequencies that are shown
_FINE = 12  # points an element of a curve through the nodes


def new_figure(
    width: float, height: float, rows: int, columns: int = 1, **options: Any
) -> tuple[Figure, np.ndarray]:
    """Return a figure with a grid of axes, shape (rows, columns); size in inches."""
    figure = PlainFigure(figsize=(width, height), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(rows, columns, squeeze=False, **options)
    for axes in grid.flat:
        style(axes)
    return figure, grid


def style(axes: Axes) -> None:
    """Give axes the common style."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)


def _curve(
    z: np.ndarray, w: np.ndarray, slope: np.ndarray, shear: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the bent shaft as its elements bend between the nodes; z in the unit that is shown.

    slope: rotations of the sections at the nodes; shear: of each element, deflection by shear over
    that by bending [1].
    """
    fine = np.unique(np.concatenate([np.linspace(a, b, _FINE) for a, b in pairwise(z)]))
    return fine * current().length, deflection(z, w, slope, shear)(fine)


def deflection(z: np.ndarray, w: np.ndarray, slope: np.ndarray, shear: Sequence[float]) -> BPoly:
    """Return the deflection between nodes: each element's own cubic, that of a Timoshenko beam,
    whose sections turn by less than its axis slopes where it shears."""
    length = np.diff(z)
    phi = np.asarray(shear if len(shear) == len(length) else np.zeros(len(length)))
    chord = np.diff(w) / length
    # of the cubic: the slope of the axis at the ends is the section's rotation and the shear's
    angle = (chord - (slope[:-1] + slope[1:]) / 2) * phi / (1 + phi)
    left, right = slope[:-1] + angle, slope[1:] + angle
    third = length / 3
    return BPoly([w[:-1], w[:-1] + third * left, w[1:] - third * right, w[1:]], z)


def titled(name: str, text: str) -> str:
    """Return the title of a picture of a machine."""
    return f"{name}: {text}" if name else text


def _speed(omega: float) -> float:
    return float(omega) * current().speed


def modes_figure(result: Modes, name: str = "", shear: Sequence[float] = ()) -> Figure:
    """Draw the shapes of the lowest modes: each plane at the instant of its largest deflection."""
    shown = min(_MOST_SHAPES, len(result.eigenvalues))
    columns = 2 if shown > 1 else 1
    rows = max(1, -(-shown // columns))
    figure, grid = new_figure(4.2 * columns, 0.9 + 1.75 * rows, rows, columns, sharex=True)
    for i, axes in enumerate(grid.flat):
        if i >= shown:
            axes.set_visible(False)
            continue
        axes.axhline(0, color=GREY, lw=0.8)
        for w, slope, color, label, dashes in (
            (result.x[i], result.slope_x[i], BLUE, "x", "-"),
            (result.y[i], result.slope_y[i], ORANGE, "y", (0, (4, 2))),
        ):
            turn = np.exp(-1j * np.angle(w[np.argmax(np.abs(w))]))
            axes.plot(
                *_curve(result.z, (w * turn).real, (slope * turn).real, shear),
                color=color,
                lw=1.6,
                ls=dashes,
                label=label,
            )
            axes.plot(result.z * current().length, (w * turn).real, "o", color=color, ms=3)
        axes.margins(y=0.08)
        zeta = result.damping_ratio[i]
        axes.set_title(
            f"{i + 1}: {shown_speed(result.damped[i])} {frequency_unit()}, {result.whirl[i]}, "
            f"damping {0.0 if abs(zeta) < 1e-10 else zeta:.2g}",
            loc="left",
            fontsize=9,
        )
        if i + columns >= shown:
            axes.set_xlabel(f"Along the shaft z [{current().length_unit}]")
            axes.tick_params(labelbottom=True)
        if i % columns == 0:
            axes.set_ylabel("Shape [1]")
    if shown:
        figure.legend(*grid.flat[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    figure.suptitle(
        titled(name, f"Modes at {turns(result.speed, result.contacts)}"),
        fontsize=10,
        x=0.01,
        ha="left",
    )
    return figure


def campbell_figure(
    result: Campbell, name: str = "", operating: tuple[float, float] | None = None
) -> Figure:
    """Draw frequencies with the excitation and their intersections, and logarithmic decrements;
    operating: the range [rad/s], which is shaded."""
    figure, grid = new_figure(6.8, 6.6, 2, 1, sharex=True, height_ratios=(2, 1))
    above, below = grid[:, 0]
    speed = result.speeds * current().speed
    frequency = result.damped * current().speed
    shade(grid[:, 0], operating)
    for mode in range(frequency.shape[1]):
        for axes, values in ((above, frequency[:, mode]), (below, result.log_dec[:, mode])):
            _whirling(axes, speed, values, [of[mode] for of in result.whirl])
    for order in result.harmonics:
        above.plot(speed, order * np.abs(speed), color="black", lw=1.0, ls=(0, (4, 3)))
    for c in result.critical:
        place = _speed(c.speed), c.harmonic * _speed(c.speed)
        above.plot(*place, "o", color="black", mfc="white", ms=5)
    below.axhline(0, color="black", lw=1.0)
    if result.threshold is not None:
        for axes in (above, below):
            axes.axvline(_speed(result.threshold), color=PURPLE, lw=1.2, ls=":")
        below.annotate(
            f"unstable above {shown_speed(result.threshold)} {current().speed_unit}",
            (_speed(result.threshold), 0.97),
            xycoords=("data", "axes fraction"),
            xytext=(-4, 0),
            textcoords="offset points",
            va="top",
            ha="right",
            fontsize=8,
            color=PURPLE,
        )
    seen = {word for words in result.whirl[1:] for word in words if word}
    handles = [Line2D([], [], color=c, lw=1.6, label=w) for w, c in _WHIRL.items() if w in seen]
    orders = ", ".join(f"{order:g}" for order in result.harmonics)
    label = "1x, the speed" if result.harmonics == (1.0,) else f"{orders} times the speed"
    handles.append(Line2D([], [], color="black", lw=1.0, ls=(0, (4, 3)), label=label))
    above.legend(handles=handles, framealpha=0.9, edgecolor="none", loc="upper left", fontsize=8)
    highest = 1.05 * np.nanmax(frequency, initial=0.0)
    # not so far that the line of the speed, and what it meets, becomes flat
    reach = max(_REACH * max(result.harmonics) * np.abs(speed).max(), 1.3 * np.nanmin(frequency))
    above.set_ylim(0, max(min(highest, reach), 1e-9))
    above.set_xlim(speed[0], speed[-1])
    above.set_ylabel(f"Frequency [{frequency_unit()}]")
    below.set_ylabel("Logarithmic decrement [1]")
    finite = result.log_dec[np.isfinite(result.log_dec)]
    if len(finite) and np.abs(finite).max() < 1e-8:
        below.set_ylim(-1, 1)
    elif len(finite) and finite.max() > 3:
        below.set_ylim(min(-0.1, 1.1 * finite.min()), 3)
    below.set_xlabel(current().speed_label)
    above.set_title(
        titled(name, f"Campbell diagram, contacts {result.contacts}"), loc="left", fontsize=10
    )
    at = [(_speed(c.speed), c.harmonic) for c in result.critical]
    words = [(shown_speed(c.speed), c.whirl == FORWARD) for c in result.critical]
    write_labels(above, [(x, n * x, *word) for (x, n), word in zip(at, words, strict=True)])
    return figure


def shade(panels: Sequence[Axes] | np.ndarray, operating: tuple[float, float] | None) -> None:
    """Shade the operating range [rad/s] of axes over the speed."""
    if operating is not None:
        for axes in panels:
            axes.axvspan(_speed(operating[0]), _speed(operating[1]), color=RANGE, alpha=0.25, lw=0)


def _whirling(axes: Axes, speed: np.ndarray, values: np.ndarray, whirl: Sequence[str]) -> None:
    """A line in pieces of the colour of its whirl."""
    for i in range(len(speed) - 1):
        # a mode at rest whirls neither way: its first piece has the colour of what it becomes
        word = whirl[i + 1] if whirl[i] in ("", PLANAR) else whirl[i]
        axes.plot(speed[i : i + 2], values[i : i + 2], color=_WHIRL.get(word, GREY), lw=1.6)


def unbalance_figure(
    result: UnbalanceResponse,
    nodes: Sequence[int],
    name: str = "",
    operating: tuple[float, float] | None = None,
) -> Figure:
    """Draw semi-axes and phases of nodes (from 1) over the speed; operating: the range [rad/s],
    which is shaded."""
    figure, grid = new_figure(6.8, 6.0, 2, 1, sharex=True, height_ratios=(2, 1))
    above, below = grid[:, 0]
    speed = result.speeds * current().speed
    shade(grid[:, 0], operating)
    mark = "o" if len(speed) < 3 else ""
    for node, color in zip(nodes, COLORS, strict=False):
        at = node - 1
        above.plot(
            speed,
            result.major[:, at] * current().amplitude,
            marker=mark,
            color=color,
            lw=1.8,
            ls="-",
            label=f"node {node}",
        )
        for values, dashes in ((result.x, (0, (4, 2))), (result.y, (0, (1, 1.5)))):
            above.plot(
                speed, np.abs(values[:, at]) * current().amplitude, color=color, lw=1.0, ls=dashes
            )
        for values, dashes in ((result.phase_x, (0, (4, 2))), (result.phase_y, (0, (1, 1.5)))):
            phase = np.degrees(values[:, at])
            phase[1:][np.abs(np.diff(phase)) > 180] = np.nan
            phase[result.speeds == 0] = np.nan
            below.plot(speed, phase, marker=mark, color=color, lw=1.2, ls=dashes)
    handles, _ = above.get_legend_handles_labels()
    for label, style, width in (
        ("major semi-axis", "-", 1.8),
        ("x", (0, (4, 2)), 1.0),
        ("y", (0, (1, 1.5)), 1.0),
    ):
        handles.append(Line2D([], [], color=GREY, lw=width, ls=style, label=label))
    above.legend(handles=handles, frameon=False, fontsize=8, loc="best")
    above.set_ylim(bottom=0)
    above.set_ylabel(f"Amplitude [{current().amplitude_unit}]")
    below.set_ylabel("Phase to the mark [deg]")
    below.set_ylim(-185, 185)
    below.set_yticks([-180, -90, 0, 90, 180])
    below.set_xlabel(current().speed_label)
    title = f"Steady response to unbalance, contacts {result.contacts}"
    above.set_title(titled(name, title), loc="left", fontsize=10)
    return figure


def static_figure(result: Static, name: str = "", shear: Sequence[float] = ()) -> Figure:
    """Draw the deflection along the shaft, with the loads on the supports beside their names."""
    figure, grid = new_figure(6.8, 3.8, 1)
    axes = grid[0, 0]
    axes.axhline(0, color=GREY, lw=0.8)
    z, y = _curve(result.z, result.y * current().small, result.slope_y * current().small, shear)
    axes.plot(z, y, color=BLUE, lw=1.8, label="y")
    axes.plot(result.z * current().length, result.y * current().small, "o", color=BLUE, ms=3.5)
    if np.abs(result.x).max(initial=0) > 1e-3 * np.abs(result.y).max(initial=0):
        axes.plot(
            *_curve(result.z, result.x * current().small, result.slope_x * current().small, shear),
            color=ORANGE,
            lw=1.5,
            ls=(0, (4, 2)),
            label="x",
        )
        axes.legend(frameon=False, fontsize=8)
    for place, support, load in zip(result.support_z, result.supports, result.load_y, strict=True):
        if load == 0.0:
            continue  # a contact that is open
        at = int(np.argmin(np.abs(result.z - place)))
        axes.annotate(
            f"{support}\n{abs(load) * current().force:.4g} {current().force_unit}",
            (place * current().length, result.y[at] * current().small),
            xytext=(0, -34 if load <= 0 else 34),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=8,
            arrowprops={"arrowstyle": "->", "color": "black", "lw": 0.9},
            bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85},
        )
    axes.margins(x=0.08, y=0.3)
    axes.set_xlabel(f"Along the shaft z [{current().length_unit}]")
    axes.set_ylabel(f"Deflection [{current().small_unit}]")
    state = turns(result.speed, result.contacts)
    axes.set_title(titled(name, f"At rest under gravity, {state}"), loc="left", fontsize=10)
    return figure
