"""What `rf.response` returns: branches with their curves, orbits, bifurcations and pictures."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..display import Shown, current
from ..errors import InputError, check_one_of, nearest
from ..linear.linear_tables import Table
from ..model.machine.rotor import Rotor
from ..model.message_templates import Message
from ..model.parts.base import ProbeElement
from ..model.periodic.arclength import NotConverged
from ..model.periodic.branch import FOLD, Bifurcation, Solution
from ..model.periodic.folds import FoldCurve
from ..model.periodic.problem import Note, Response
from ..model.periodic.queries import folds_over, motions_at, persists_in_time
from ..model.periodic.starting_points import Persistence
from ..plotting.notebook import png
from .vertices import pieces

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LARGEST = 4096  # points of a period that `orbit` gives at most
# What a motion of a place has, and its unit.
QUANTITIES = ("r_amp", "x_amp", "y_amp", "x_1x", "y_1x", "x_1x_phase", "y_1x_phase", "x", "y")
UNITS = {name: "rad" if name.endswith("phase") else "m" for name in QUANTITIES}


class Curve(NamedTuple):
    """A quantity along the branches, n points: value of the parameter, the quantity [m, rad],
    whether the motion is stable, and the number of the branch, each of shape (n,)."""

    parameter: np.ndarray
    value: np.ndarray
    stable: np.ndarray
    branch: np.ndarray


class OrbitSeries(NamedTuple):
    """A period of a motion, n samples: t [s], and x, y of each probe [m] by its name, `disc[1]`."""

    t: np.ndarray
    x: Mapping[str, np.ndarray]
    y: Mapping[str, np.ndarray]


class SectionLine(NamedTuple):
    """A part of a Poincare section's curve, n points: the parameter and the displacement [m], each
    of shape (n,), and whether the motions are stable."""

    parameter: np.ndarray
    value: np.ndarray
    is_stable: bool


class ResponseResult:
    """Periodic motions of a machine over a parameter; a notebook shows the picture.

    parameter: its name, unit: of its values; branches: see `model.periodic.branch`.
    """

    def __init__(self, result: Response) -> None:
        self._response = result
        self.parameter = result.task.name
        self.branches = result.branches
        self.probes = probes(result.rotor)

    def __repr__(self) -> str:
        count = len(self.branches)
        return (
            f"ResponseResult({len(self.points)} points over {self.parameter}, {count} "
            f"branch{'es' if count != 1 else ''})"
        )

    @property
    def machine(self) -> str:
        """Name of the machine."""
        return self._response.rotor.name

    @property
    def is_stopped(self) -> bool:
        """Whether the search was interrupted."""
        return self._response.is_stopped

    @property
    def unit(self) -> str:
        """Of the parameter."""
        return self._response.unit

    @property
    def axis(self) -> Shown:
        """How the parameter is shown."""
        return current().of_si(self.unit)

    @property
    def notes(self) -> tuple[Message, ...]:
        """What is to be said of the branches, in the units that are shown."""
        shown = self.axis.factor, self.axis.word
        notes = self._response.notes
        return tuple(n.shown(*shown) if isinstance(n, Note) else n for n in notes)

    @property
    def points(self) -> list[Solution]:
        """Of all branches, one after another."""
        return [point for branch in self.branches for point in branch.points]

    @property
    def bifurcations(self) -> list[Bifurcation]:
        """Of all branches."""
        return [b for branch in self.branches for b in branch.bifurcations]

    def curve(self, name: str, quantity: str = "r_amp") -> Curve:
        """A quantity of a probe along the branches; name: such as `disc[3]`, or with the quantity,
        `disc[3].x_1x`.

        quantity: r_amp, the largest distance from the mean; x_amp, y_amp, half of the range; x_1x,
        y_1x, the amplitudes at the speed, with x_1x_phase, y_1x_phase, by which they lead the
        shaft's mark; x, y, the means. Raises `InputError` for an unknown name.
        """
        if name not in self.probes and name.rpartition(".")[0] in self.probes:
            name, _, quantity = name.rpartition(".")
        if name not in self.probes:
            raise InputError(f"{name}: no such place; the nearest is {nearest(name, self.probes)}")
        check_one_of(f"{name}.{quantity}", quantity, QUANTITIES)
        rows = [
            (p.value, self.quantities(p, name)[quantity], p.is_stable, i)
            for i, branch in enumerate(self.branches, 1)
            for p in branch.points
        ]
        table = np.array(rows, float).reshape(-1, 4)
        return Curve(table[:, 0], table[:, 1], table[:, 2] > 0, table[:, 3].astype(int))

    def orbit(self, i: int, samples: int = 256) -> OrbitSeries:
        """A period of the motion at point i, of all branches one after another."""
        points = self.points
        if not -len(points) <= i < len(points):
            raise InputError(f"i = {i}: must be from 0 to {len(points) - 1}")
        if not 2 <= samples <= _LARGEST:
            raise InputError(f"samples = {samples}: must be from 2 to {_LARGEST}")
        point = points[i]
        t = 2 * math.pi / abs(point.orbit.omega) * np.arange(samples) / samples
        places = {name: self.series(point, name, samples) for name in self.probes}
        return OrbitSeries(
            t, {n: s[0] for n, s in places.items()}, {n: s[1] for n, s in places.items()}
        )

    def section(self, name: str, side: str) -> list[SectionLine]:
        """x or y (side) of a place [m] each time the keyphasor's mark passes, along the branches:
        lines that are stable or not, one a turn of a period."""
        lines = []
        for branch in self.branches:
            turns = branch.points[0].orbit.turns if branch.points else 0
            for motions, is_stable in pieces(branch):
                over = np.array([m.value for m in motions])
                values = [self.series(m, name, turns)["xy".index(side)] for m in motions]
                lines += [SectionLine(over, line, is_stable) for line in np.array(values).T]
        return lines

    def at(self, value: float) -> list[Solution]:
        """All motions at a value of the parameter, exact, stable ones and others."""
        return motions_at(self._response, value)

    def check(self, point: Solution, turns: int = 50) -> Persistence:
        """Start the integrator on a motion: whether it stays there for so many turns."""
        return persists_in_time(self._response, point, turns)

    def amplitude(self, point: Solution | Bifurcation, name: str, quantity: str = "r_amp") -> float:
        """A quantity of a probe, as `curve` has them, of a motion [m, rad]."""
        return self.quantities(point, name)[quantity]

    def quantities(self, point: Solution | Bifurcation, name: str) -> dict[str, float]:
        """Return all quantities of a probe, as `curve` has them, of a motion [m, rad]."""
        X = self._amplitudes(point, name)
        samples = 64 * 2 ** math.ceil(math.log2(max(1, len(X) / 8)))
        x, y = self.series(point, name, samples)
        mean = X[0].real
        once = X[point.orbit.turns] if len(X) > point.orbit.turns else np.zeros(2, complex)
        values = (
            np.hypot(x - mean[0], y - mean[1]).max(),
            np.ptp(x) / 2,
            np.ptp(y) / 2,
            *np.abs(once),
            *np.angle(once),
            *mean,
        )
        return {q: float(v) for q, v in zip(QUANTITIES, values, strict=True)}

    def fold_curve(
        self,
        name: str,
        low: float,
        high: float,
        i: int = 0,
        *,
        report_value: Callable[[float], object] = lambda _: None,
    ) -> FoldCurve:
        """Where the i-th smooth fold lies over another parameter: the map of jumps.

        report_value: is called with the parameter's value at each of its points. Raises
        `InputError` where there is no such fold or parameter.
        """
        folds = [b for b in self.bifurcations if b.kind == FOLD]
        if not folds:
            raise InputError("the curve has no smooth fold")
        if not 0 <= i < len(folds):
            raise InputError(f"i = {i}: must be from 0 to {len(folds) - 1}, a fold of the curve")
        check_names(self._response.rotor, [name])
        try:
            return folds_over(self._response, folds[i], name, low, high, report_value)
        except NotConverged as error:
            raise InputError(f"{name}: no curve of folds begins there: {error}") from error

    def dataframe(self) -> Any:
        """A row a point: branch, parameter, whether it is stable, the largest multiplier's size,
        how many harmonics, and the quantities of every probe (pandas)."""
        import pandas as pd  # type: ignore[import-untyped,unused-ignore]

        rows = []
        for i, branch in enumerate(self.branches, 1):
            for p in branch.points:
                row = {
                    "branch": i,
                    self.parameter: p.value,
                    "stable": p.is_stable,
                    "multiplier": float(np.abs(p.multipliers[0])) if len(p.multipliers) else np.nan,
                    "harmonics": p.orbit.H,
                    "omega": p.orbit.omega,
                }
                for name in self.probes:
                    row |= {f"{name}.{q}": v for q, v in self.quantities(p, name).items()}
                rows.append(row)
        return pd.DataFrame(rows)

    def figure(self, names: Sequence[str] | None = None) -> "Figure":
        """Amplitudes over the parameter: stable full, unstable dashed, bifurcations marked."""
        from .response_plots import response_figure

        return response_figure(self, names)

    def fold_figure(self, name: str, folds: FoldCurve) -> "Figure":
        """The map of jumps: the parameter at the fold over another one, `name`."""
        from .response_plots import fold_figure

        unit = self._response.rotor.parameters()[name].quantity.unit
        return fold_figure(self, name, unit, folds)

    def table(self) -> Table:
        """A row a bifurcation, and the ends of the branches."""
        axis, rows = self.axis, list[tuple[object, ...]]()
        for i, branch in enumerate(self.branches, 1):
            for b in branch.bifurcations:
                value = float(b.value) * axis.factor
                rows.append((i, b.kind, value, float(abs(b.multiplier)), b.orbit.H))
        over = f"{self.parameter} [{axis.word}]"
        heads = ("branch", "bifurcation", over, "largest multiplier", "harmonics")
        counts = ", ".join(
            f"{i}: {len(b.points)} points, {sum(p.is_stable for p in b.points)} stable, "
            f"{b.ends[0]} to {b.ends[1]}"
            for i, b in enumerate(self.branches, 1)
        )
        return Table(f"Periodic response over {self.parameter}; branch {counts}", heads, rows)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The numbers for JSON."""
        return {
            "parameter": self.parameter,
            "unit": self.unit,
            "bifurcations": [
                {"kind": b.kind, "value": b.value, "omega": b.orbit.omega}
                for b in self.bifurcations
            ],
            "branches": [
                {
                    "ends": branch.ends,
                    "value": [p.value for p in branch.points],
                    "stable": [p.is_stable for p in branch.points],
                    "harmonics": [p.orbit.H for p in branch.points],
                    "r_amp": {
                        name: [self.quantities(p, name)["r_amp"] for p in branch.points]
                        for name in self.probes
                    },
                }
                for branch in self.branches
            ],
            "notes": self.notes,
        }

    def series(
        self, point: Solution | Bifurcation, name: str, samples: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """x and y of a place over a period of a motion, from the keyphasor's mark on, each of shape
        (samples,) [m]."""
        X = self._amplitudes(point, name)
        k = np.arange(len(X))
        angle = 2 * math.pi * np.arange(samples) / samples
        result = (np.exp(1j * np.outer(angle, k)) @ X).real
        return result[:, 0], result[:, 1]

    def _amplitudes(self, point: Solution | Bifurcation, name: str) -> np.ndarray:
        dof, slope, offset = self.probes[name]
        at = np.array([0, 1])
        return point.motion[:, 2 * dof + at] + offset * point.motion[:, 2 * slope + at]

    def _repr_png_(self) -> bytes:
        return png(self.figure())


def probes(rotor: Rotor) -> dict[str, tuple[int, int, float]]:
    """Names of the places that are observed, with dof, slope and offset [m]."""
    observed = rotor.elements_of_kind(ProbeElement)
    return {where: (2 * p.node - 2, 2 * p.node - 1, p.offset) for where, p in observed}


def check_names(rotor: Rotor, names: Iterable[str]) -> None:
    """Raise `InputError` for a name that is no quantity of the machine."""
    known = rotor.parameters()
    for name in names:
        if name not in known:
            near = nearest(name, known)
            raise InputError(f"{name}: no quantity of the machine; the nearest is {near}")
