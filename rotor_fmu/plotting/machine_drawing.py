"""The picture of the machine to scale, from the outlines of its parts."""

from collections.abc import Callable
from functools import lru_cache, partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.ticker import FuncFormatter, MaxNLocator

from ..display import current
from ..model.machine.rotor import Rotor
from ..model.parts.base import Shape
from .colors import LABEL
from .figure_style import empty_figure, entitle
from .notebook import png

_LINE = 0.035  # height of a line of names, of the machine's size
_MOST_NUMBERS = 250  # of nodes
_STEPS = [digit * 10**power for power in range(9) for digit in (1, 2, 5)]
_MOST_EDGES = 100  # of elements, beyond which thinner ones leave the shaft grey
_LAYER = "#dddddd"
_Dashes = str | tuple[int, tuple[int, int]]
_SHAFT, _BODY, _HOUSING, _PORT = "#bbbbbb", "#56b4e9", "#e69f00", "#d55e00"


@lru_cache(maxsize=4)  # an FMU is compared with what it would hold, and then built
def machine_picture(rotor: Rotor) -> bytes:
    """Return a picture of the machine to scale as a PNG, for the importing tool's icon."""
    figure = empty_figure(6.0, 2.6, dpi=100)
    axes = figure.add_subplot()
    axes.set_axis_off()
    axes.set_aspect("equal")
    draw_machine(axes, rotor)
    axes.autoscale_view()
    return png(figure)


def machine_figure(rotor: Rotor) -> Figure:
    """Draw the machine to scale, in mm, its nodes numbered and its parts named."""
    figure = empty_figure(9.0, 4.2)
    axes = figure.add_subplot()
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_aspect("equal", adjustable="datalim")
    low, high = draw_machine(axes, rotor)
    line = _LINE * max(rotor.length, 2 * (high - low))
    named = [
        (rotor.nodes[node - 1], name)
        for name, part in rotor.named_parts()
        if (node := getattr(part, "node", 0)) > 0
    ]
    numbers = [(rotor.nodes[i - 1], str(i)) for i in _numbered(rotor)]
    for z, name, row in _rows(named, 0.34 * line):
        _label(axes, z, high, high + line * (1 + row), name, 9)
    rows = _rows(numbers, 0.34 * line)
    for z, name, row in rows:
        _label(axes, z, low, low - line * (1 + row), name, 8)
    deepest = max(row for _, _, row in rows)
    place = rotor.nodes[0] - 1.2 * line, low - line
    axes.annotate("node", place, ha="right", va="center", fontsize=8, color=LABEL)
    axes.update_datalim([(rotor.nodes[0] - 3 * line, low - line * (2 + deepest))])
    drawn = axes.dataLim
    figure.set_figheight(min(8.0, max(2.8, 9.0 * drawn.height / drawn.width + 1.2)))
    axes.autoscale_view()
    shown = current()
    lengths = FuncFormatter(lambda value, _: f"{value * shown.length:.6g}")
    axes.xaxis.set_major_formatter(lengths)
    axes.xaxis.set_major_locator(_RoundIn(shown.length))
    axes.yaxis.set_visible(False)
    axes.set_xlabel(f"Along the shaft z [{shown.length_unit}], radii to the same scale")
    entitle(axes, rotor.name)
    return figure


def _numbered(rotor: Rotor) -> list[int]:
    """Return the nodes (from 1) whose numbers are written: all, or of very many those at round
    steps, with both ends and the nodes of parts."""
    count = len(rotor.nodes)
    step = next(k for k in _STEPS if count <= k * _MOST_NUMBERS)
    parts = {getattr(part, "node", 0) for part in rotor.parts}
    return sorted({1, count, *(n for n in parts if n > 0), *range(step, count + 1, step)})


class _RoundIn(MaxNLocator):
    """Ticks at round numbers of a unit, of which one m is `length`."""

    def __init__(self, length: float) -> None:
        super().__init__(9)
        self._length = length

    def tick_values(self, vmin: float, vmax: float) -> list[float]:
        """Return the places of the ticks [m]."""
        ticks = super().tick_values(vmin * self._length, vmax * self._length)
        return [float(tick) / self._length for tick in ticks]


def _label(axes: Axes, z: float, edge: float, height: float, text: str, size: int) -> None:
    """A name on a thin line that leads to its node."""
    axes.plot([z, z], [edge, height], color=LABEL, lw=0.5)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 0.8}
    side = "bottom" if height > edge else "top"
    axes.annotate(text, (z, height), ha="center", va=side, fontsize=size, bbox=box)


def _rows(labels: list[tuple[float, str]], width: float) -> list[tuple[float, str, int]]:
    """Return the names with the lowest row in which they do not overlap; width: of a letter."""
    ends: list[float] = []
    placed = []
    for z, name in sorted(labels, key=lambda label: label[0]):
        half = 0.5 * width * (len(name) + 1)
        row = next((i for i, end in enumerate(ends) if end <= z - half), len(ends))
        ends[row : row + 1] = [z + half]
        placed.append((z, name, row))
    return placed


def draw_machine(axes: Axes, rotor: Rotor) -> tuple[float, float]:
    """Draw the shaft and, over it, the outline of every part; lengths in m. Returns the lowest and
    the highest position drawn."""
    nodes = rotor.nodes
    edge = 0.8 * min(1.0, _MOST_EDGES / len(rotor.sections))
    for z, section in zip(nodes, rotor.sections, strict=False):
        ends = z, z + section.length
        for layer in sorted(section.layers, key=lambda layer: -layer.outer_left):
            _tube(axes, ends, (layer.outer_left, layer.outer_right), _LAYER, edge)
        _tube(axes, ends, (section.outer_left, section.outer_right), _SHAFT, edge)
        if section.bore_left or section.bore_right:
            _tube(axes, ends, (section.bore_left, section.bore_right), "white", edge)
    shapes = [
        (nodes[node - 1], shape if shape.outer else shape._replace(outer=_radius(rotor, node)))
        for part in rotor.parts
        if (node := getattr(part, "node", 0)) > 0
        for shape in part.outline()
    ]
    layers = [layer for section in rotor.sections for layer in section.all_layers]
    thickest = max(max(s.outer_left, s.outer_right) for s in layers) / 2
    tallest = max((s.outer for _, s in shapes), default=thickest)
    size = max(tallest, 0.05 * rotor.length)
    for z, shape in shapes:
        _DRAWN[shape.role](axes, z, shape, size, rotor.length)
    axes.plot([nodes[0], nodes[-1]], [0, 0], color="black", lw=0.6, ls=(0, (8, 2, 1, 2)))
    drawn = axes.dataLim
    return drawn.y0 - 0.1 * size, drawn.y1


def _tube(
    axes: Axes, z: tuple[float, float], diameters: tuple[float, float], color: str, edge: float
) -> None:
    """A cylinder or cone about the axis; edge: width of its line [pt]."""
    ends = list(zip(z, (d / 2 for d in diameters), strict=True))
    corners = [*ends, *((end, -radius) for end, radius in reversed(ends))]
    axes.add_patch(Polygon(corners, facecolor=color, edgecolor="black", lw=edge))


def _radius(rotor: Rotor, node: int) -> float:
    """Return the larger radius of the shaft on both sides of a node (from 1) [m]."""
    left = rotor.sections[max(node - 2, 0)]
    right = rotor.sections[min(node, len(rotor.nodes) - 1) - 1]
    return max(left.outer_right, right.outer_left) / 2


def _block(
    axes: Axes, corner: tuple[float, float], width: float, height: float, color: str
) -> None:
    axes.add_patch(Rectangle(corner, width, height, facecolor=color, edgecolor="black"))


def _body(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    _block(axes, (z + shape.left, -shape.outer), shape.width, 2 * shape.outer, _BODY)


def _stator(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    width = 0.06 * length
    for side in (1, -1):
        low = side * (shape.inner + 0.01 * length)
        _block(axes, (z - width / 2, low), width, side * 0.24 * size, _HOUSING)
    high = shape.inner + 0.01 * length + 0.24 * size
    _ground(axes, z, high, size, width, _SPRING if shape.role == "housing" else "-")


def _spring(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    _ground(axes, z, shape.outer, size, 0.06 * length, _SPRING)


def _pedestal(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    width, high = 0.06 * length, 0.14 * size
    top = shape.outer + 0.25 * size
    axes.plot([z, z], [-top, -shape.outer], color="black", lw=1.0, ls=_SPRING)
    _block(axes, (z - width / 2, -top - high), width, high, _HOUSING)
    _ground(axes, z, top + high, size, width, _SPRING)


def _ground(axes: Axes, z: float, high: float, size: float, width: float, line: _Dashes) -> None:
    """Draw the connection to ground: springs dashed."""
    low = max(size, high + 0.1 * size)
    axes.plot([z, z], [-low, -high], color="black", lw=1.0, ls=line)
    axes.plot([z - width, z + width], [-low, -low], color="black", lw=2.0)


def _force(
    axes: Axes, z: float, shape: Shape, size: float, length: float, from_: float = 1.0
) -> None:
    """Draw an arrow to the shaft from above, or with from_ = -1 from below."""
    tip, half = shape.outer, 0.008 * length
    axes.plot([z, z], [from_ * (tip + half), from_ * (tip + 0.05 * length)], color=_PORT, lw=2.0)
    back = from_ * (tip + 2 * half)
    head = [(z, from_ * tip), (z - half, back), (z + half, back)]
    axes.add_patch(Polygon(head, color=_PORT))


def _gauge(axes: Axes, z: float, shape: Shape, size: float, length: float) -> None:
    radius = 0.006 * length
    middle = z, shape.outer + 1.5 * radius
    axes.add_patch(Circle(middle, radius, facecolor="white", edgecolor=_PORT))


_SPRING = (0, (2, 1))
_DRAWN: dict[str, Callable[[Axes, float, Shape, float, float], None]] = {
    "body": _body,
    "housing": _stator,
    "stator": _stator,
    "spring": _spring,
    "pedestal": _pedestal,
    "force": _force,
    "lift": partial(_force, from_=-1.0),
    "gauge": _gauge,
}
