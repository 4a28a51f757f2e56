"""What pictures of linear analyses share."""

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from scipy.interpolate import BPoly

from ..display import current
from ..model.linear.modes import BACKWARD, FORWARD, MIXED, PLANAR
from ..plotting.colors import BLUE, GREEN, GREY, ORANGE, SKY

_Item = TypeVar("_Item")
DASHED = (0, (2, 2))  # of a line upon another one
_SAME = 4e-3  # of the height of all lines: two less apart lie upon each other
WHIRL_COLORS = {FORWARD: BLUE, BACKWARD: ORANGE, MIXED: GREEN, PLANAR: GREY}
FAINT = 0.3  # opacity
_FINE = 12  # points an element of a curve through the nodes
_MOST_SHAPES = 6  # of modes in a picture
_MOST_DOTS = 60  # along a shaft: of more nodes dots and orbits are a solid area


def curve(
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


def dotted(nodes: int) -> np.ndarray:
    """Return which nodes (from 0) a picture marks: all, or of many some and both ends."""
    return np.unique(np.linspace(0, nodes - 1, min(nodes, _MOST_DOTS)).round().astype(int))


def shapes_in_grid(modes: int) -> tuple[int, int, int]:
    """Return how many modes a picture of shapes shows, in how many rows and columns."""
    shown = min(_MOST_SHAPES, modes)
    columns = 2 if shown > 1 else 1
    return shown, max(1, -(-shown // columns)), columns


def draw_whirling(
    axes: Axes,
    speed: np.ndarray,
    values: np.ndarray,
    mode: int,
    whirl: Sequence[str],
    is_clear: np.ndarray,
) -> None:
    """Draw a line in pieces of the colour of its whirl, faint where it is not clear; dashed where
    it lies on one of another colour, so that both are seen. values: shape (speeds, lines), of which
    that of this number is drawn."""
    drawn = [(line.get_color(), np.asarray(line.get_xydata())) for line in axes.lines]
    pieces = [(other, xy) for other, xy in drawn if len(xy) == 2]
    below = np.array([xy for _, xy in pieces])
    colors = np.array([other for other, _ in pieces])
    height = np.ptp(np.append(values[np.isfinite(values)], 0.0))
    near, values = _SAME * height, values[:, mode]
    for i in range(len(speed) - 1):
        # a mode at rest whirls neither way: its first piece has the colour of what it becomes
        word = whirl[i + 1] if whirl[i] in ("", PLANAR) else whirl[i]
        alpha = 1.0 if is_clear[i : i + 2].any() else FAINT
        color = WHIRL_COLORS.get(word, GREY)
        piece = speed[i : i + 2], values[i : i + 2]
        at = np.transpose(piece)
        apart = np.abs(below.reshape(-1, 2, 2) - at)
        is_near = (apart[..., 0] == 0.0) & (apart[..., 1] <= near)
        hides = bool((is_near.all(axis=1) & (colors != color)).any())
        style: Any = DASHED if hides else "solid"
        axes.plot(*piece, color=color, lw=1.6, alpha=alpha, solid_capstyle="butt", ls=style)


def grouped(items: Iterable[_Item], is_alike: Callable[[_Item, _Item], bool]) -> list[list[_Item]]:
    """Return items in groups of those that are alike the first one of each."""
    groups = list[list[_Item]]()
    for item in items:
        alike = next((group for group in groups if is_alike(item, group[0])), None)
        if alike is None:
            groups.append([item])
        else:
            alike.append(item)
    return groups


def titled(name: str, text: str) -> str:
    """Return the title of a picture of a machine."""
    return f"{name}: {text}" if name else text


def shade(panels: Sequence[Axes] | np.ndarray, operating: tuple[float, float] | None) -> None:
    """Shade the operating range [rad/s] of axes over the speed; one speed is a line."""
    if operating is not None:
        for axes in panels:
            axes.axvspan(*np.multiply(operating, current().speed), color=SKY, alpha=0.25, lw=1.5)


def plain_ticks(axis: Axis) -> None:
    """Write the numbers at a logarithmic axis without formulas, which these figures do not draw."""
    axis.set_major_formatter(
        FuncFormatter(lambda value, _: f"{value:.6g}".replace("e+0", "e").replace("e+", "e"))
    )
    low, high = axis.get_view_interval()
    if high < 100 * low:  # so that there are numbers within one decade
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_minor_formatter(NullFormatter())
