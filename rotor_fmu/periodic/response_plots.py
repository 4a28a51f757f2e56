"""The picture of a periodic response."""

from collections.abc import Sequence
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..display import current
from ..linear.linear_plots import grouped, titled
from ..model.periodic.branch import BRANCHING, DOUBLING, FOLD, GRAZING, TORUS, UNFINISHED
from ..model.periodic.continuation import LOST
from ..model.periodic.folds import FoldCurve
from ..plotting.colors import BLUE, DASHED, GREY, colors_of
from ..plotting.figure_style import entitle, new_figure
from .curves import ResponseCurves
from .vertices import pieces

_LINE = 2e-3  # of a picture's height: less than the width of a line
_WIDEST = 70  # characters in a line of the legend
_ENDS = {why: f"the curve is {why.rstrip(': ')}" for why in (LOST, UNFINISHED)}
_MARKS = {FOLD: "o", GRAZING: "s", DOUBLING: "D", TORUS: "^", BRANCHING: "P"}


def response_figure(result: ResponseCurves, names: Sequence[str] | None = None) -> Figure:
    """Amplitudes of places over the parameter; by default of the three that move most. Places that
    move alike, such as symmetric discs, have one curve."""
    if names is None:
        largest = {n: result.curve(n).value.max(initial=0.0) for n in result.probes}
        names = sorted(sorted(largest, key=lambda n: -largest[n])[:3])
    alike = _alike(result, names)
    figure, axes = new_figure(6.8, 4.6)
    axis, small = result.axis, current().small
    handles = []
    for (name, *others), color in zip(alike, colors_of(len(alike)), strict=True):
        for branch in result.branches:
            for motions, is_stable in pieces(branch):
                at = [m.value * axis.factor for m in motions]
                value = [result.amplitude(m, name) * small for m in motions]
                style, width = ("-", 1.8) if is_stable else (DASHED, 1.2)
                axes.plot(at, value, color=color, ls=style, lw=width)
            for b in branch.bifurcations:
                y = result.amplitude(b, name) * small
                axes.plot(b.value * axis.factor, y, _MARKS[b.kind], color=color, mfc="white", ms=6)
            for end, why in zip((0, -1), branch.ends, strict=True):
                if why.startswith((LOST, UNFINISHED)) and branch.points:
                    y = result.amplitude(branch.points[end], name) * small
                    axes.plot(branch.points[end].value * axis.factor, y, "x", color=color, ms=7)
        label = fill(", ".join((name, *others)), _WIDEST)
        handles.append(Line2D([], [], color=color, lw=1.8, label=label))
    handles.append(Line2D([], [], color=GREY, lw=1.8, label="stable"))
    handles.append(Line2D([], [], color=GREY, lw=1.2, ls=DASHED, label="unstable"))
    for kind in dict.fromkeys(b.kind for b in result.bifurcations):
        handles.append(
            Line2D([], [], color=GREY, marker=_MARKS[kind], mfc="white", ls="", label=kind)
        )
    ends = [why for branch in result.branches for why in branch.ends]
    for why, label in _ENDS.items():
        if any(end.startswith(why) for end in ends):
            handles.append(Line2D([], [], color=GREY, marker="x", ls="", label=label))
    axes.legend(handles=handles, frameon=False, fontsize=8)
    axes.set_ylim(bottom=0)
    values = np.array([p.value for p in result.points]) * axis.factor
    if len(values) and np.ptp(values) > 0:
        axes.set_xlim(values.min(), values.max())
    axes.set_xlabel(f"{result.parameter} [{axis.unit}]")
    axes.set_ylabel(f"Largest distance from the mean [{current().small_unit}]")
    entitle(axes, titled(result.machine, f"periodic motions over {result.parameter}"))
    return figure


def _alike(result: ResponseCurves, names: Sequence[str]) -> list[list[str]]:
    """Return names in groups of places whose curves lie one on the other in a picture."""
    curves = {name: result.curve(name).value for name in names}
    width = _LINE * max((curve.max(initial=0.0) for curve in curves.values()), default=0.0)

    def are_alike(name: str, first: str) -> bool:
        return bool(np.abs(curves[name] - curves[first]).max(initial=0.0) <= width)

    return grouped(curves, are_alike)


def fold_figure(result: ResponseCurves, name: str, unit: str, folds: FoldCurve) -> Figure:
    """The parameter at a fold over another one, of a name and SI unit; a cross where the curve is
    lost inside the range."""
    across, up = current().of_si(unit), result.axis
    figure, axes = new_figure(6.4, 4.0)
    x, y = folds.second * across.factor, folds.first * up.factor
    axes.plot(x, y, color=BLUE, lw=1.8)
    for end, why in zip((0, -1), folds.ends, strict=True):
        if why.startswith(LOST):
            axes.plot(x[end], y[end], "x", color=BLUE, ms=7, label=_ENDS[LOST])
    if axes.lines[1:]:
        axes.legend(handles=axes.lines[1:2], frameon=False, fontsize=8)
    axes.set_xlabel(f"{name} [{across.unit}]")
    axes.set_ylabel(f"{result.parameter} of the fold [{up.unit}]")
    entitle(axes, titled(result.machine, f"fold of the response over {name}"))
    return figure
