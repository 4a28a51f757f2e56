"""A metric: what is kept of a run as a cell of its row.

A quantity is an output by its name, or PART.r, the distance of PART.x and PART.y from zero.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from ..model.contact.wall import ContactQuantities
from ..studies.study import Column
from .run_excitation import Excitation

ROUNDING = 1e-9  # of a speed as a share of the highest, and of whole periods
# Kinds that a study file writes as other ones.
# Outputs that are angles which begin anew after a turn.
_DIRECTIONS = ("psi", "x_1x_phase", "y_1x_phase", "attitude", "film_angle", "bow_angle")
VARIANTS = {"passing": "order with speed", "slid": "dissipated"}


class ListAxis(NamedTuple):
    """The dimension of a list, coordinates along it, empty where they only count, and unit."""

    dimension: str
    coordinate: tuple[float, ...] = ()
    unit: str = "1"


@dataclass(frozen=True)
class MetricKind:
    """A kind of metric.

    text: its meaning, to be filled in with the options and `of`; make: returns the cell, or what a
    window adds to it; needed, optional: names of its options, the optional ones with defaults;
    unit: of its values, empty where they have that of the quantity; axis: of its lists; check:
    raises `InputError` for options that do not suit the runs; least: returns the size in a window
    to which differences of its values are relative at least, of a kind that may be 0.

    Of runs in time: outputs: those of the part that is its quantity, None where nothing is sampled;
    also: further outputs; held: kinds of runs of whose whole turns at constant speed it is made,
    empty where it is made of any time; varying: whether the speed must vary continuously; is_fine:
    whether it needs the solver's own steps.
    """

    name: str
    text: str
    make: "Callable[[Metric, Any], Any]"
    needed: tuple[str, ...] = ()
    optional: Mapping[str, Any] = field(default_factory=dict)
    unit: str = ""
    axis: "Callable[[Metric, Excitation], ListAxis] | None" = None
    check: "Callable[[Metric, Excitation], None] | None" = None
    least: "Callable[[Metric, Any], float] | None" = None
    outputs: tuple[str, ...] | None = ()
    also: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    varying: bool = False
    is_fine: bool = False

    @property
    def said(self) -> str:
        """What a study file says for it."""
        return VARIANTS.get(self.name, self.name)

    def samples(self, of: str) -> tuple[str, ...]:
        """Return the outputs that must be sampled; of: the metric's quantity or part."""
        if self.outputs is None:
            return ()
        if self.outputs:
            return (*(f"{of}.{output}" for output in self.outputs), *self.also)
        if of.endswith(".r"):
            part = of.removesuffix(".r")
            return (f"{part}.x", f"{part}.y", *self.also)
        return (of, *self.also)


def declared(kinds: dict[str, MetricKind], text: str, *needed: str, **fields: Any) -> Any:
    """Declare a function as the kind of metric of its name, in a table of kinds."""

    def decorate(make: Callable[[Metric, Any], Any]) -> Callable[[Metric, Any], Any]:
        name = make.__name__.lstrip("_")
        kinds[name] = MetricKind(name, text, make, needed, **fields)
        return make

    return decorate


@dataclass(frozen=True)
class Metric:
    """A cell of a row: the column's name, the kind, the quantity or part, and the kind's options.

    contact: the contact whose work of friction it is.
    """

    name: str
    kind: MetricKind
    of: str
    options: tuple[tuple[str, Any], ...] = ()
    contact: ContactQuantities | None = None

    @property
    def is_direction(self) -> bool:
        """Whether its values are angles that begin anew after a turn."""
        return not self.kind.unit and self.of.rpartition(".")[2] in _DIRECTIONS

    def option(self, name: str) -> Any:
        """Return an option, its default where it was not given, None where it has none."""
        return dict(self.options).get(name, self.kind.optional.get(name))

    def column(self, unit: str, axis: ListAxis | None, **shown: str) -> Column:
        """Return its column; unit: the quantity's; axis: of a list; shown: options in its text."""
        options = {**self.kind.optional, **dict(self.options), "of": self.of, **shown}
        text = self.kind.text.format(**options)
        head = Column(self.name, self.kind.unit or unit, text, *(axis or ()))
        return replace(head, is_direction=self.is_direction)

    def least_size(self, windows: Sequence[Any], unit: str, still: float) -> float:
        """Return the size to which differences of its cells are relative at least, in its unit: of
        a displacement that of a motion that is none, `still` [m]."""
        least = still if unit == "m" else 0.0
        if self.kind.least is None:
            return least
        return max(least, *(self.kind.least(self, window) for window in windows))

    def error(self, reason: str) -> InputError:
        """Return the error that says why the metric cannot be."""
        return InputError(f"keep {self.name}: {reason}")


def is_whole(number: float) -> bool:
    """Return whether a number is an integer but for rounding."""
    return abs(number - round(number)) < ROUNDING


def edges_of(bins: Mapping[str, Any]) -> np.ndarray:
    """Return the edges of bins."""
    return np.linspace(bins["from"], bins["to"], int(bins["count"]) + 1)


def bin_middles(bins: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the middles of bins."""
    edges = edges_of(bins)
    return tuple((0.5 * (edges[1:] + edges[:-1])).tolist())
