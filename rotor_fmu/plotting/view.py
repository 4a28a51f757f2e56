"""The view that a picture shows, and the common parts of all pictures of signals."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .. import vibration
from ..display import current
from ..vibration.measuring_points import Recorded
from .figure_style import PlainFigure


class View:
    """The view that a picture shows: a run, the name of a place or contact (None: the one that
    moves, or is pressed, most), a speed [rad/s] (None: that of the largest 1x), and whether
    amplitudes are peak-to-peak."""

    def __init__(
        self,
        run: Recorded,
        place: str | None = None,
        speed: float | None = None,
        is_pp: bool = False,
    ) -> None:
        self.run, self.name, self.is_pp = run, place, is_pp or current().is_pp
        self._speed = speed

    @property
    def signal(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """t, phi, z of the place."""
        return self.run.t, self.run.phi, self.run.place(self.name).z

    @property
    def speed(self) -> float:
        """Speed at which orbit and spectrum are taken [rad/s]."""
        if self._speed is not None:
            return self._speed
        track = vibration.order_track(*self.signal, (1.0,))
        return float(track.speed[np.nanargmax(track.major())])

    @property
    def scale(self) -> float:
        """Factor from m 0-p to the unit of the axis."""
        return current().small * (2 if self.is_pp else 1)

    @property
    def unit(self) -> str:
        """Unit of the axis."""
        return f"{current().small_unit} {'pp' if self.is_pp else '0-p'}"

    @property
    def machine(self) -> str:
        """The machine's name, or, where none was recorded, the run's."""
        return str(self.run.about.get("machine") or self.run.name)

    def title(self, axes: Axes, text: str) -> None:
        """Heading of a picture."""
        # names are text, whatever stands in them
        axes.set_title(f"{self.machine}: {text}", loc="left", fontsize=10, parse_math=False)


def parted(speed: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return a curve over the speed that is not drawn across a reversal."""
    return np.where(np.concatenate([[False], speed[1:] * speed[:-1] < 0]), np.nan, values)


def two(even: bool = False) -> tuple[Figure, tuple[Axes, Axes]]:
    """Return a picture of two parts over one axis; even: of equal heights."""
    figure = PlainFigure(figsize=(6.8, 5.4), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1) if even else (2, 1))
    for axes in (above, below):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
    return figure, (above, below)
