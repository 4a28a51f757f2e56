"""Pictures of what integrators do to one oscillation: paper B's Figure 1 and two beside it."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from papers.integrators import spectral
from papers.integrators.spectral import Method
from rotor_fmu.plotting.figure_style import new_figure, save

# Okabe and Ito with a grey in the place of the yellow, which is too faint for a line.
_COLOURS = (
    "#d55e00",
    "#0072b2",
    "#009e73",
    "#cc79a7",
    "#56b4e9",
    "#e69f00",
    "#000000",
    "#8a8a8a",
)
_DASHES = ("-", (0, (5, 1.6)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))
_LABEL_GAP = 0.045
_RHO_TOP = 1.3
_SLOW = 0.4


def write_figures(
    methods: Mapping[str, Method], xi: float, dt_over_t: float | None, out: Path
) -> list[Path]:
    """Draw three pictures into the folder `out` and return their paths.

    xi: physical damping ratio [1]; dt_over_t: a user's own step over the period, marked, or None.
    """
    pictures = {
        "figure_1_spectral_radius.png": spectral_radius(methods, xi, dt_over_t),
        "numerical_damping.png": numerical_damping(methods, xi, dt_over_t),
        "period_elongation.png": period_elongation(methods, xi, dt_over_t),
    }
    return [save(figure, out / name) for name, figure in pictures.items()]


def spectral_radius(
    methods: Mapping[str, Method], xi: float = 0.0, dt_over_t: float | None = None
) -> Figure:
    """Spectral radius against dt/T, from 0.01 to 100 (paper B, Figure 1)."""
    figure, axes = _new_figure(methods)
    x = np.geomspace(0.01, 100, 600)
    axes.axhspan(1, _RHO_TOP, color="#f3e3dc", lw=0)
    axes.text(0.0108, _RHO_TOP - 0.03, "grows: unstable", va="top", color="#8c3d0a", fontsize=9)
    curves = _curves(methods, x, lambda m, w: spectral.spectral_radius(m, w, xi))
    axes.set_xscale("log")
    axes.set_ylim(0, _RHO_TOP)
    axes.set_ylabel(r"Spectral radius $\rho$ [1]")
    caption = "Paper B, Figure 1: what one step leaves of an oscillation"
    return _finished(figure, axes, x, curves, caption, xi, dt_over_t)


def numerical_damping(
    methods: Mapping[str, Method], xi: float = 0.0, dt_over_t: float | None = None
) -> Figure:
    """Damping that the integrator adds to a slow oscillation, in percent of critical."""
    figure, axes = _new_figure(methods)
    x = _slow(dt_over_t)
    curves = _curves(methods, x, lambda m, w: 100 * spectral.numerical_damping(m, w, xi))
    axes.axhline(0, color="#555555", lw=0.8)
    axes.set_ylim(*_limits(curves, -4, 16))
    axes.set_ylabel("Numerical damping ratio [% of critical]")
    caption = "What the integrator adds to the damping of a slow oscillation"
    return _finished(figure, axes, x, curves, caption, xi, dt_over_t)


def period_elongation(
    methods: Mapping[str, Method], xi: float = 0.0, dt_over_t: float | None = None
) -> Figure:
    """How much too long the period comes out, in percent."""
    figure, axes = _new_figure(methods)
    x = _slow(dt_over_t)
    curves = _curves(methods, x, lambda m, w: 100 * spectral.period_elongation(m, w, xi))
    axes.axhline(0, color="#555555", lw=0.8)
    axes.set_ylim(*_limits(curves, -20, 60))
    axes.set_ylabel("Period elongation [%]")
    caption = "How much too long the period of a slow oscillation comes out"
    return _finished(figure, axes, x, curves, caption, xi, dt_over_t)


def _slow(dt_over_t: float | None) -> np.ndarray:
    """dt/T of oscillations that a step is short enough to follow, the user's among them."""
    return np.linspace(0.002, max(_SLOW, 1.1 * min(dt_over_t or 0, 1)), 300)


def _new_figure(methods: Mapping[str, Method]) -> tuple[Figure, Axes]:
    return new_figure(6.8 + 0.075 * max(map(len, methods)), 4.6)


def _curves(
    methods: Mapping[str, Method], x: np.ndarray, value: Callable[[Method, float], float]
) -> dict[str, np.ndarray]:
    return {
        name: np.array([value(method, 2 * math.pi * ratio) for ratio in x])
        for name, method in methods.items()
    }


def _limits(curves: Mapping[str, np.ndarray], lowest: float, highest: float) -> tuple[float, float]:
    """Of an axis that shows zero and the curves, but nothing beyond lowest and highest."""
    values = np.concatenate(list(curves.values()))
    values = values[np.isfinite(values)]
    low = max(float(values.min(initial=0.0)), lowest)
    high = min(float(values.max(initial=0.1)), highest)
    return low - 0.03 * (high - low), high


def _finished(
    figure: Figure,
    axes: Axes,
    x: np.ndarray,
    curves: Mapping[str, np.ndarray],
    caption: str,
    xi: float,
    dt_over_t: float | None,
) -> Figure:
    styles: dict[str, dict[str, Any]] = {}
    for k, (name, y) in enumerate(curves.items()):
        dash = _DASHES[(k + k // len(_COLOURS)) % len(_DASHES)]
        styles[name] = {"color": _COLOURS[k % len(_COLOURS)], "ls": dash, "lw": 1.8}
        axes.plot(x, y, **styles[name])
    axes.set_xlim(0.01 if axes.get_xscale() == "log" else 0, x[-1])
    axes.set_xlabel(r"Step over period $\Delta t\,/\,T$ [1]")
    damped = rf" ($\xi$ = {xi:g})" if xi else ""
    marked = dt_over_t if dt_over_t is not None and x[0] <= dt_over_t <= x[-1] else None
    axes.set_title(caption + damped, loc="left", fontsize=10, pad=6 if marked is None else 18)
    _label(axes, curves, styles)
    if marked is not None:
        _mark(axes, marked)
    return figure


def _label(
    axes: Axes, curves: Mapping[str, np.ndarray], styles: Mapping[str, Mapping[str, Any]]
) -> None:
    """Name each curve in the right margin, as near the height at which it ends as there is room."""
    low, high = axes.get_ylim()
    last = {name: y[np.isfinite(y)][-1:] for name, y in curves.items()}
    ends = {name: (float(y[0]) - low) / (high - low) if len(y) else 0.0 for name, y in last.items()}
    names = sorted(ends, key=lambda name: -ends[name])
    gap = min(_LABEL_GAP, 1 / len(names))
    heights = [min(max(ends[name], 0.0), 0.98) for name in names]
    for k in range(1, len(names)):
        heights[k] = min(heights[k], heights[k - 1] - gap)
    heights[-1] = max(heights[-1], 0.0)
    for k in reversed(range(len(names) - 1)):
        heights[k] = max(heights[k], heights[k + 1] + gap)
    for name, height in zip(names, heights, strict=True):
        place: dict[str, Any] = {"transform": axes.transAxes, "clip_on": False}
        axes.plot([1.015, 1.085], [height, height], **place, **styles[name])
        axes.text(1.1, height, name, va="center", fontsize=9, **place)


def _mark(axes: Axes, dt_over_t: float) -> None:
    """The user's own case: a line, named above the axes, where no curve can cross the name."""
    grey = "#555555"
    axes.axvline(dt_over_t, color=grey, lw=1.2, ls=":")
    axes.annotate(
        f"yours: {dt_over_t:.3g}",
        (dt_over_t, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0, 3),
        textcoords="offset points",
        ha="center",
        fontsize=9,
        color=grey,
    )
