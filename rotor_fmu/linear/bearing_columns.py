"""What the answers of all kinds of bearings share: columns of tables, panels, and how it is said
where a mass whirls."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ..display import current
from ..model import bearing_curves
from ..plotting.colors import colors_of
from ..plotting.figure_style import entitle
from .linear_tables import without_rounding

_BESIDE = 4  # lines in a row of a legend

Curves = bearing_curves.BearingCurves | bearing_curves.RingCurves | bearing_curves.RollingCurves


def varies_load(result: Curves) -> bool:
    """Return whether the loads vary at one speed, and not the speed."""
    return len(result.speeds) > 1 and bool(result.speeds[0] == result.speeds[-1])


def what_varies(result: Curves) -> tuple[np.ndarray, str, str]:
    """Return what varies, the speed or the load, in the unit that is shown, its unit and name."""
    d = current()
    if varies_load(result):
        return np.hypot(*result.load.T) * d.force, d.force_unit, "Load"
    return result.speeds * d.speed, d.speed_unit, "Speed"


def speed_and_load(result: Curves) -> tuple[tuple[str, np.ndarray], ...]:
    """Return the columns of speed and load, with their heads."""
    d = current()
    return (
        (f"speed [{d.speed_unit}]", result.speeds * d.speed),
        (f"load [{d.force_unit}]", np.hypot(*result.load.T) * d.force),
    )


def coefficient_columns(result: Curves) -> list[tuple[str, np.ndarray]]:
    """Return the columns of stiffness and damping, with their heads."""
    d = current()
    K, C = (
        np.reshape(without_rounding(factor, of), (-1, 4)).T
        for factor, of in ((d.stiffness, result.K), (d.damping, result.C))
    )
    heads = (
        *(f"kxx [{d.stiffness_unit}]", "kxy", "kyx", "kyy"),
        *(f"cxx [{d.damping_unit}]", "cxy", "cyx", "cyy"),
    )
    return list(zip(heads, (*K, *C), strict=True))


def shown_span(values: np.ndarray) -> str:
    """Return the range of some values as a text."""
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return low if low == high else f"{low} to {high}"


def in_clearance(axes: Axes, title: str) -> None:
    """Give a picture of the clearance its axes and title."""
    axes.set_aspect("equal")
    axes.set(xlabel="x over the clearance [1]", ylabel="y over the clearance [1]")
    entitle(axes, title, 9)


def draw_coefficients(panels: Sequence[Axes], result: Curves, mark: str) -> None:
    """Draw stiffness and damping."""
    d, over = current(), what_varies(result)[0]
    for axes, of, name in (
        (panels[0], result.K * d.stiffness, f"Stiffness [{d.stiffness_unit}]"),
        (panels[1], result.C * d.damping, f"Damping [{d.damping_unit}]"),
    ):
        letter = "k" if axes is panels[0] else "c"
        labels = [f"{letter}{pair}" for pair in ("xx", "xy", "yx", "yy")]
        draw_lines(axes, over, of.reshape(-1, 4).T, labels, mark, 2)
        axes.set_ylabel(name)


def parted(over: np.ndarray, *curves: np.ndarray) -> list[np.ndarray]:
    """Return a speed or load and curves over it, along their last axis, with a gap between both
    senses of rotation."""
    at = 1 + np.flatnonzero(over[1:] * over[:-1] < 0.0)
    return [np.insert(np.asarray(of, float), at, np.nan, axis=-1) for of in (over, *curves)]


def draw_lines(
    axes: Axes, over: np.ndarray, values: np.ndarray, labels: list[str], mark: str, group: int = 1
) -> None:
    """Draw lines, every other group of them dashed: those of the same values are seen."""
    over, values = parted(over, values)
    colors = colors_of(len(labels))
    for n, (of, label, color) in enumerate(zip(values, labels, colors, strict=True)):
        dashes = mark.replace("-", "--") if n // group % 2 else mark
        axes.plot(over, of, dashes, ms=4, color=color, lw=1.4, label=label)
    # room for the legend above or below the lines
    axes.margins(y=max(0.3, 0.15 * math.ceil(len(labels) / _BESIDE)))
    axes.legend(frameon=False, fontsize=8, ncols=_BESIDE, columnspacing=1.0)
