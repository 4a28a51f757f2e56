"""Texts beside points of a picture, so that none covers another, a point, a curve or the legend."""

from collections.abc import Iterable, Sequence
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D, Bbox

from .colors import GREY
from .figure_style import PlainFigure, annotate

_SIZE = 8.0  # of the font [pt]
_MARK = 3.0  # half a point's mark [pt]
_NEAR = 5.0  # from a point to its text [pt]
_FAR = tuple(11.0 * i for i in range(8))  # further away, where there is no room [pt]


def write_labels(
    axes: Axes,
    labels: Sequence[tuple[float, float, str, bool]],
    marks: Sequence[tuple[float, float]] = (),
    curves: Sequence[Line2D] = (),
) -> None:
    """Write texts beside points, the limits of the axes being set: each as near as there is room,
    and with a line to its point where that is far.

    labels: x and y of a point in the data's units, its text, and whether this stands better to the
    right and below than to the left and above; marks: other points that no text covers; curves:
    lines that none crosses.
    """
    figure = axes.figure
    assert isinstance(figure, PlainFigure)
    figure.place_axes()
    to_points = 72.0 / figure.dpi
    legend = axes.get_legend()
    taken = [] if legend is None else [_scaled(legend.get_window_extent(), to_points)]
    room = _scaled(axes.get_window_extent(), to_points)
    places = [axes.transData.transform((x, y)) * to_points for x, y, *_ in (*labels, *marks)]
    taken += [Bbox.from_bounds(x - _MARK, y - _MARK, 2 * _MARK, 2 * _MARK) for x, y in places]
    scale, halo = Affine2D().scale(to_points), [withStroke(linewidth=2.5, foreground="white")]
    paths = [(of.get_transform() + scale).transform_path(of.get_path()) for of in curves]
    for (x, y, text, is_right), place in zip(labels, places, strict=False):
        width, height = _size_of(axes, text) * to_points
        boxes = [
            (far, Bbox.from_bounds(place[0] + dx, place[1] + dy, width, height))
            for far, (dx, dy) in _offsets(width, height, is_right)
        ]
        far, box = next((each for each in boxes if _is_free(each[1], taken, paths, room)), boxes[0])
        taken.append(box)
        aside = box.x0 - place[0], box.y0 - place[1]
        line = {"arrowstyle": "-", "color": GREY, "lw": 0.6} if far else None
        look = {"fontsize": _SIZE, "va": "bottom", "path_effects": halo, "arrowprops": line}
        annotate(axes, text, (x, y), aside, **look)


def _size_of(axes: Axes, text: str) -> np.ndarray:
    """Return the width and height of a text [pixels]."""
    drawn = axes.text(0.0, 0.0, text, fontsize=_SIZE)
    size = np.array(drawn.get_window_extent().size)
    drawn.remove()
    return size


def _offsets(
    width: float, height: float, is_right: bool
) -> Iterable[tuple[float, tuple[float, float]]]:
    """Return how far from usual, and the offsets of a text's lower left corner, the best first."""
    for far in _FAR:
        right, left = _NEAR, -_NEAR - width
        below, above = -height - far, 1.0 + far
        better = [(right, below), (left, above)]
        others = [(left, below), (right, above)]
        yield from product([far], [*(better if is_right else better[::-1]), *others])


def _scaled(box: Bbox, factor: float) -> Bbox:
    return Bbox(box.get_points() * factor)


def _is_free(box: Bbox, taken: Sequence[Bbox], paths: Sequence[Path], room: Bbox) -> bool:
    inside = room.x0 <= box.x0 and box.x1 <= room.x1 and room.y0 <= box.y0 and box.y1 <= room.y1
    crossed = any(path.intersects_bbox(box, filled=False) for path in paths)
    return inside and not crossed and not any(box.overlaps(other) for other in taken)
