"""Pictures of a run-down: the paper's figures 3 to 6 and 9 to 15."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import BLUE, GREY, ORANGE, new_figure, save
from .run_down import PEAKS_AFTER, Run, last_index

SPEED_LABEL = "Rotational speed $n$ [Hz]"
_PSI_TICKS = (
    [0, 90, 180, 270, 360],
    ["0 (right)", "90 (top)", "180 (left)", "270 (bottom)", "360"],
)


def _speed_axis(axes: Axes, run: Run) -> None:
    axes.set_xlabel(SPEED_LABEL)
    highest = float(run.hz.max()) if len(run.hz) else 60.0
    axes.set_xlim(0, 10 * math.ceil(highest / 10) or 10)


def amplitude(run: Run, axis: str, caption: str, reference: Run | None = None) -> Figure:
    """Largest displacement of the last disc over a revolution against speed; axis: `x` or `y`."""
    figure, axes = new_figure()
    disc = last_index(run, "disc")
    curves = [(run, "this run", BLUE, 1.0)]
    if reference is not None:
        curves.insert(0, (reference, "converged", GREY, 2.5))
    for shown, label, color, width in curves:
        values = shown.columns[f"disc[{disc}].{axis}_amp"] * 1e6
        late = np.flatnonzero(shown.t > PEAKS_AFTER)
        if len(late):
            at = late[np.argmax(values[late])]
            label += f": {values[at]:.0f} µm at {shown.hz[at]:.1f} Hz"
        axes.plot(shown.hz, values, color=color, lw=width, label=label)
    axes.legend(frameon=False, loc="upper right")
    _speed_axis(axes, run)
    axes.set_ylim(bottom=0)
    direction = "Horizontal" if axis == "x" else "Vertical"
    axes.set_ylabel(f"{direction} amplitude of disc {disc} [µm]")
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def contact_angle(run: Run, caption: str) -> Figure:
    """Contact angle of the last bearing against speed, one point a communication step."""
    figure, axes = new_figure()
    bearing = last_index(run, "bearing")
    psi = np.degrees(run.columns[f"bearing[{bearing}].psi"])
    axes.plot(run.hz, psi, ".", color=BLUE, ms=2.2, mew=0, rasterized=True)
    _speed_axis(axes, run)
    axes.set_yticks(*_PSI_TICKS)
    axes.set_ylim(0, 360)
    axes.set_ylabel(f"Contact angle $\\psi$ of bearing {bearing} [deg]")
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def orbit(run: Run, at_hz: float, caption: str, width_hz: float = 0.15) -> Figure:
    """Path of the last disc's centre while the speed is within width_hz of at_hz."""
    figure, axes = new_figure(5.4, 5.0)
    disc = last_index(run, "disc")
    near = (np.abs(run.hz - at_hz) <= width_hz) & (run.t > PEAKS_AFTER)
    x, y = (run.columns[f"disc[{disc}].{axis}"][near] * 1e6 for axis in "xy")
    axes.plot(x, y, "-", color=BLUE, lw=0.8, marker=".", ms=2.5)
    rest = float(run.columns[f"disc[{disc}].y"][0]) * 1e6
    axes.plot(0, rest, "+", color=ORANGE, ms=10, mew=1.5)
    axes.annotate("rest", (0, rest), xytext=(7, -4), textcoords="offset points", color=ORANGE)
    axes.set_aspect("equal")
    if len(x):
        half = 0.55 * max(np.ptp(x), np.ptp(y), 1.0)
        for set_limits, values in ((axes.set_xlim, x), (axes.set_ylim, y)):
            middle = (values.min() + values.max()) / 2
            set_limits(middle - half, middle + half)
    axes.set_xlabel(f"Horizontal displacement of disc {disc} [µm]")
    axes.set_ylabel("Vertical displacement [µm]")
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def step_length(run: Run, caption: str) -> Figure:
    """Length of the last step before each communication point against speed."""
    figure, axes = new_figure()
    axes.plot(run.hz[1:], run.columns["solver.h_last"][1:] * 1e3, ".", color=BLUE, ms=2.5, mew=0)
    _speed_axis(axes, run)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("Step length [ms]")
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def error_indicator(run: Run, caption: str) -> Figure:
    """Relative error of the last step before each communication point against speed."""
    figure, axes = new_figure()
    axes.semilogy(run.hz[1:], run.columns["solver.error"][1:], ".", color=BLUE, ms=2.5, mew=0)
    _speed_axis(axes, run)
    axes.set_ylabel("Relative error indicator [1]")
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def write_run_down(
    run: Run, figures: Mapping[str, Any], name: str, is_adaptive: bool, out: Path
) -> list[Path]:
    """The pictures of one run-down in the folder `out`; figures: its `summary`."""
    if not len(run.t):
        return []
    pictures = {
        "x": amplitude(run, "x", f"{name}: horizontal amplitude through the run-down"),
        "y": amplitude(run, "y", f"{name}: vertical amplitude through the run-down"),
    }
    if last_index(run, "bearing"):
        pictures["psi"] = contact_angle(run, f"{name}: where the journal touches its bearing")
    if figures["x_peak_hz"] is not None:
        peak = figures["x_peak_hz"]
        pictures["orbit"] = orbit(run, peak, f"{name}: orbit at the horizontal peak, {peak:.1f} Hz")
    if is_adaptive:
        pictures["error"] = error_indicator(run, f"{name}: error indicator")
        pictures["h"] = step_length(run, f"{name}: step length")
    return [save(figure, out / f"run_down_{key}.png") for key, figure in pictures.items()]
