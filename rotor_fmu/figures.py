"""Pictures of a run-down: the paper's figures 3 to 6 and 9 to 15."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .run_down import Run, last_index

BLUE, ORANGE, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#999999"  # Okabe and Ito
SPEED_LABEL = "Rotational speed $n$ [Hz]"
_PSI_TICKS = (
    [0, 90, 180, 270, 360],
    ["0 (right)", "90 (top)", "180 (left)", "270 (bottom)", "360"],
)


def new_figure(width: float = 6.4, height: float = 4.0) -> tuple[Figure, object]:
    """A figure with one pair of axes, without the global state of pyplot; size in inches."""
    figure = Figure(figsize=(width, height), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    return figure, axes


def save(figure: Figure, path: Path) -> Path:
    """Write a PNG without the date and versions that would make it differ each time."""
    figure.savefig(path, metadata={"Software": None})
    return path


def _speed_axis(axes: object, run: Run) -> None:
    axes.set_xlabel(SPEED_LABEL)
    highest = float(run.hz.max()) if len(run.hz) else 60.0
    axes.set_xlim(0, 10 * math.ceil(highest / 10) or 10)


def amplitude(run: Run, axis: str, caption: str, reference: Run | None = None) -> Figure:
    """Largest displacement of the last disc over a revolution against speed; axis: `x` or `y`."""
    figure, axes = new_figure()
    disc = last_index(run, "disc")
    name = f"disc[{disc}].{axis}_amp"
    if reference is not None:
        axes.plot(
            reference.hz, reference.columns[name] * 1e6, color=GREY, lw=2.5, label="converged"
        )
    axes.plot(run.hz, run.columns[name] * 1e6, color=BLUE, lw=1.0, label="this run")
    late = run.t > 2.0
    if late.any():
        values = np.where(late, run.columns[name], 0.0)
        at = int(np.argmax(values))
        axes.annotate(
            f"{values[at] * 1e6:.0f} µm at {run.hz[at]:.1f} Hz",
            (run.hz[at], values[at] * 1e6),
            xytext=(12, -4),
            textcoords="offset points",
            va="center",
        )
    if reference is not None:
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
    figure, axes = new_figure(4.6, 4.6)
    disc = last_index(run, "disc")
    near = (np.abs(run.hz - at_hz) <= width_hz) & (run.t > 2.0)
    x, y = (run.columns[f"disc[{disc}].{axis}"][near] * 1e6 for axis in "xy")
    axes.plot(x, y, "-", color=BLUE, lw=0.8, marker=".", ms=2.5)
    rest = float(run.columns[f"disc[{disc}].y"][0]) * 1e6
    axes.plot(0, rest, "+", color=ORANGE, ms=10, mew=1.5)
    axes.annotate("rest", (0, rest), xytext=(7, -4), textcoords="offset points", color=ORANGE)
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel(f"Horizontal displacement of disc {disc} [µm]")
    axes.set_ylabel("Vertical displacement [µm]")
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def solver_history(run: Run, name: str, label: str, caption: str, scale: float = 1.0) -> Figure:
    """A quantity of the solver against speed, one point a communication step."""
    figure, axes = new_figure()
    axes.plot(run.hz[1:], run.columns[name][1:] * scale, ".", color=BLUE, ms=2.5, mew=0)
    _speed_axis(axes, run)
    axes.set_ylim(bottom=0)
    axes.set_ylabel(label)
    axes.set_title(caption, loc="left", fontsize=10)
    return figure


def write_run_down(
    run: Run, figures: Mapping[str, object], name: str, is_adaptive: bool, out: Path
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
        pictures["error"] = solver_history(
            run, "solver.error", "Relative error indicator [1]", f"{name}: error indicator"
        )
        pictures["h"] = solver_history(
            run, "solver.h_last", "Step length [ms]", f"{name}: step length", 1e3
        )
    return [save(figure, out / f"run_down_{key}.png") for key, figure in pictures.items()]
