"""The common style of all pictures."""

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from textwrap import fill
from typing import Any, BinaryIO

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cbook import is_math_text
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, fontManager
from matplotlib.ft2font import FT2Font
from matplotlib.text import Text
from matplotlib.ticker import AutoLocator

from ..files import unfinished

# Widths of a number at an axis, of its digits and of the gap to the next, in sizes of its letters.
_ASSUMED, _DIGIT, _BETWEEN = 3.0, 0.64, 0.6  # the first one is Matplotlib's
_TITLE = 10.0  # size of a title [pt]
_WRITTEN = 0.85  # of the width of a picture, in the lines of a title
_BOXES = "Last Resort High-Efficiency"  # which Matplotlib takes last: it draws kinds of letters
# a font taken for its letters may have another weight, which is no news for a reader
logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)


class PlainFigure(Figure):
    """A figure whose texts are drawn as written: a machine's names may hold dollar signs, which
    matplotlib would read as formulas. Powers of ten at logarithmic axes are formulas."""

    def draw(self, renderer: RendererBase) -> None:
        """Draw it."""
        self._take_as_written()
        super().draw(renderer)

    def place_axes(self) -> None:
        """Give its axes the places where they are drawn, in half the time of drawing it."""
        self._take_as_written()
        engine = self.get_layout_engine()
        if engine is not None:
            engine.execute(self)
            if any(map(_has_long_title, self.axes)):  # in more lines, above axes that are narrower
                engine.execute(self)

    def _take_as_written(self) -> None:
        for axes in self.axes:
            _fit(axes.xaxis.label, self.bbox.width)
            _fit(axes.yaxis.label, self.bbox.height)
        for text in self.findobj(Text):
            # labels of ticks are empty until they are drawn for the first time
            written = text.get_text()
            text.set_parse_math(not written or "mathdefault" in written)
            if not written.isascii() and (further := _further_fonts(written)):
                text.set_fontfamily([*dict.fromkeys([*text.get_fontfamily(), *further])])


@cache
def _further_fonts(text: str) -> tuple[str, ...]:
    """Return installed fonts that have the letters of a text which the usual font lacks, such as
    those of Japanese; those that no font has are drawn as boxes."""
    printed = {ord(letter) for letter in text if letter.isprintable()}
    lacking = printed - _letters(findfont(FontProperties()))
    result = []
    for font in fontManager.ttflist if lacking else ():
        if font.name != _BOXES and lacking & (letters := _letters(font.fname)):
            result.append(font.name)
            lacking -= letters
        if not lacking:
            break
    return tuple(result)


@cache
def _letters(file: str) -> frozenset[int]:
    return frozenset(FT2Font(file).get_charmap())


def _has_long_title(axes: Axes) -> bool:
    width = _DIGIT * _TITLE * len(axes.get_title("left"))  # [pt]
    return bool(width * axes.figure.dpi > 72.0 * axes.bbox.width)


def _fit(label: Text, room: float) -> None:
    """Make a label as small as its longest word needs, the name of a part: in a room [pixels]."""
    longest = max(map(len, label.get_text().split()), default=1)
    widest = 72.0 * room / label.figure.dpi / (_DIGIT * longest)
    label.set_fontsize(min(label.get_fontsize(), widest))


class _ApartLocator(AutoLocator):
    """Ticks so far apart that numbers of six digits below them do not run into each other."""

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        """Return the places of the ticks, fewer where their numbers are long."""
        self.set_params(nbins="auto")
        ticks = super().tick_values(vmin, vmax)
        if not isinstance(self.axis, Axis):
            return ticks
        length = _ASSUMED * self.axis.get_tick_space()
        needed = _DIGIT * max(len(f"{tick:.10g}") for tick in ticks) + _BETWEEN
        if length * abs(ticks[1] - ticks[0]) < needed * abs(vmax - vmin):
            self.set_params(nbins=max(1, int(length / needed)))
            ticks = super().tick_values(vmin, vmax)
        return ticks


def empty_figure(width: float, height: float, dpi: float = 150) -> Figure:
    """Return a figure without axes, without the global state of pyplot; size in inches."""
    figure = PlainFigure(figsize=(width, height), dpi=dpi, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def new_figure(width: float = 6.4, height: float = 4.0) -> tuple[Figure, Axes]:
    """Return a figure with one pair of axes; size in inches."""
    figure, axes = new_panels(width, height, 1, 1)
    return figure, axes[0]


def new_panels(
    width: float,
    height: float,
    rows: int,
    columns: int = 1,
    share_x: bool = False,
    heights: Sequence[float] | None = None,
) -> tuple[Figure, np.ndarray]:
    """Return a figure with several pairs of axes, shape (rows x columns,); size in inches; heights:
    of the rows, relative to each other."""
    figure = empty_figure(width, height)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=share_x, height_ratios=heights)
    for axes in panels.ravel():
        style(axes)
    return figure, panels.ravel()


def style(axes: Axes) -> None:
    """Give axes the common style."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.xaxis.set_major_locator(_ApartLocator())
    for axis in (axes.xaxis, axes.yaxis):
        axis.label.set_wrap(True)


def entitle(
    where: Axes | Figure, text: str, size: float = _TITLE, pad: float | None = None
) -> None:
    """Write a title at the left above axes or a figure, a long one in several lines; pad: between
    it and the axes [pt]."""
    figure = where if isinstance(where, Figure) else where.figure
    is_wrapped = not is_math_text(text)  # Matplotlib would measure it as a formula
    if not is_wrapped:
        across = 72.0 * figure.bbox.width / figure.dpi / size  # sizes of its letters
        text = fill(text, int(_WRITTEN * across / _DIGIT))
    if isinstance(where, Figure):
        title = where.suptitle(text, fontsize=size, x=0.01, ha="left", wrap=is_wrapped)
    else:
        title = where.set_title(text, loc="left", fontsize=size, pad=pad, wrap=is_wrapped)
    _fit(title, _WRITTEN * figure.bbox.width)


def legend_below(
    figure: Figure, columns: int = 3, handles: Sequence[Artist] = (), **options: Any
) -> None:
    """Write the names of the lines below a picture, if any has one: in so many columns, or in as
    many as there is room for; handles: the lines, by default all with a name."""
    handles = handles or [one for of in figure.axes for one in of.get_legend_handles_labels()[0]]
    for ncols in range(min(columns, len(handles)), 0, -1):
        style = {"frameon": False, "fontsize": 8, "ncols": ncols, **options}
        legend = figure.legend(handles=handles, loc="outside lower center", **style)
        if ncols == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def annotate(
    axes: Axes, text: str, at: tuple[Any, Any], offset: tuple[float, float], **options: Any
) -> None:
    """Write a small text beside a point; offset: from it [pt]."""
    options = {"textcoords": "offset points", "fontsize": 8, **options}
    axes.annotate(text, at, xytext=offset, **options)


def broken_at_turns(over: np.ndarray, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the curve of an angle [rad] over a quantity in degrees, which where it jumps by a turn
    runs to 180 degrees and goes on from -180, or the other way."""
    degrees = np.degrees(angle)
    jumps = np.flatnonzero(np.abs(np.diff(degrees)) > 180)
    end = np.copysign(180.0, degrees[jumps])
    share = (end - degrees[jumps]) / (degrees[jumps + 1] + 2 * end - degrees[jumps])
    where = over[jumps] + share * (over[jumps + 1] - over[jumps])
    at = np.repeat(jumps + 1, 3)
    ends = np.stack([end, np.full(len(end), np.nan), -end], axis=1).ravel()
    return np.insert(over, at, np.repeat(where, 3)), np.insert(degrees, at, ends)


@contextmanager
def placed(figure: Figure) -> Iterator[None]:
    """Place the axes of a figure that is then written without its layout engine: with it,
    Matplotlib draws the figure once more than it writes it, only to place them."""
    engine = figure.get_layout_engine()
    if isinstance(figure, PlainFigure):
        figure.place_axes()
        figure.set_layout_engine(None)
    try:
        yield
    finally:
        figure.set_layout_engine(engine)


def write_png(figure: Figure, to: BinaryIO | Path) -> None:
    """Write a PNG without the date and versions that would make it differ each time."""
    with placed(figure):
        figure.savefig(to, format="png", metadata={"Software": None})


def save(figure: Figure, path: Path) -> Path:
    """Write a PNG, whole or not at all."""
    with unfinished(path) as part:
        write_png(figure, part)
    return path
