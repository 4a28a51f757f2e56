"""The machine to scale, as its parts say that they are drawn."""

from __future__ import annotations

import io
from collections.abc import Callable

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from ..model.machine.rotor import Rotor
from ..model.protocol.part import Shape

_SHAFT, _BODY, _HOUSING = "#bbbbbb", "#56b4e9", "#e69f00"


def machine_picture(rotor: Rotor) -> bytes:
    """The machine to scale as a PNG, for the importing tool's icon."""
    figure = Figure(figsize=(6.0, 2.6), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set_axis_off()
    axes.set_aspect("equal")
    draw_machine(axes, rotor)
    axes.autoscale_view()
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def draw_machine(axes: Axes, rotor: Rotor) -> None:
    """Draw the shaft and, over it, what every part says of its outline; lengths in m."""
    nodes = rotor.nodes
    for z, section in zip(nodes, rotor.sections, strict=False):
        ends = ((z, section.outer_left / 2), (z + section.length, section.outer_right / 2))
        corners = [*ends, *((end, -radius) for end, radius in reversed(ends))]
        axes.add_patch(Polygon(corners, facecolor=_SHAFT, edgecolor="black", lw=1.0))
    shapes = [(nodes[part.node - 1], s) for part in rotor.parts for s in part.outline()]
    tallest = max((s.outer for _, s in shapes), default=0.05 * rotor.length)
    size = max(tallest, 0.05 * rotor.length)
    for z, shape in shapes:
        _DRAWN[shape.role](axes, z, shape, size, rotor.length)


def _body(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    left, height = z + shape.left, 2 * shape.outer
    block = Rectangle((left, -shape.outer), shape.width, height, facecolor=_BODY, edgecolor="black")
    axes.add_patch(block)


def _housing(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    width = 0.06 * length
    for side in (1, -1):
        low = side * (shape.inner + 0.01 * length)
        block = Rectangle(
            (z - width / 2, low), width, side * 0.24 * size, facecolor=_HOUSING, edgecolor="black"
        )
        axes.add_patch(block)
    _ground(axes, z, shape.inner + 0.01 * length + 0.24 * size, size, width)


def _spring(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    _ground(axes, z, shape.outer, size, 0.06 * length)


def _ground(axes: Axes, z: float, high: float, size: float, width: float) -> None:
    """A spring, as a dashed line, down to the ground."""
    low = max(size, high + 0.1 * size)
    axes.plot([z, z], [-low, -high], color="black", lw=1.0, ls=(0, (2, 1)))
    axes.plot([z - width, z + width], [-low, -low], color="black", lw=2.0)


_DRAWN: dict[str, Callable[[Axes, float, Shape, float, float], None]] = {
    "body": _body,
    "housing": _housing,
    "spring": _spring,
}
