"""What `rf.response` returns: branches of periodic motions, with tables and pictures."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..display import current, in_its_units
from ..errors import InputError
from ..model.message_templates import Message
from ..model.periodic.arclength import NotConverged
from ..model.periodic.branch import FOLD, TORUS, Bifurcation, Solution
from ..model.periodic.folds import FoldCurve
from ..model.periodic.problem import Note
from ..model.periodic.queries import folds_over, motions_at, persists_in_time
from ..model.periodic.starting_points import Persistence
from ..plotting.notebook import png
from ..runs.settings_text import known_parameter
from ..tables import Table
from .curves import ResponseCurves

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class ResponseResult(ResponseCurves):
    """What `rf.response` returns, beside the curves; a notebook shows the picture."""

    def __repr__(self) -> str:
        count = len(self.branches)
        return (
            f"ResponseResult({len(self.points)} points over {self.parameter}, {count} "
            f"branch{'es' if count != 1 else ''})"
        )

    @property
    def is_stopped(self) -> bool:
        """Whether the search was interrupted."""
        return self._response.is_stopped

    @property
    def notes(self) -> tuple[Message, ...]:
        """What is to be said of the branches, in the units that are shown."""
        shown = self.axis.factor, self.axis.word
        notes = self._response.notes
        return tuple(n.shown(*shown) if isinstance(n, Note) else n for n in notes)

    def at(self, value: float) -> list[Solution]:
        """All motions at a value of the parameter, exact, stable ones and others."""
        return motions_at(self._response, value)

    def check(self, point: Solution, turns: int = 50) -> Persistence:
        """Start the integrator on a motion: whether it stays there for so many turns."""
        return persists_in_time(self._response, point, turns)

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
        known_parameter("", name, self._response.rotor)
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

    @property
    def shown_units(self) -> str:
        """The units that table and pictures show, of the machine's file."""
        return self._response.rotor.units

    @in_its_units
    def figure(self, names: Sequence[str] | None = None) -> "Figure":
        """Amplitudes over the parameter: stable full, unstable dashed, bifurcations marked."""
        from .response_plots import response_figure

        return response_figure(self, names)

    @in_its_units
    def fold_figure(self, name: str, folds: FoldCurve) -> "Figure":
        """The map of jumps: the parameter at the fold over another one, `name`."""
        from .response_plots import fold_figure

        unit = self._response.rotor.numbers()[name].quantity.unit
        return fold_figure(self, name, unit, folds)

    @in_its_units
    def table(self) -> Table:
        """A row a bifurcation, and the ends of the branches."""
        axis, rows, d = self.axis, list[tuple[object, ...]](), current()
        for i, branch in enumerate(self.branches, 1):
            for b in branch.bifurcations:
                value, frequency = float(b.value) * axis.factor, float(b.orbit.omega) * d.speed
                whirl = (frequency,) if self.is_whirl else ()
                rows.append((i, b.kind, value, *whirl, _crossing(b), b.orbit.H))
        over = f"{self.parameter} [{axis.word}]"
        whirls = (f"whirl [{d.frequency_unit}]",) if self.is_whirl else ()
        heads = ("branch", "bifurcation", over, *whirls, "crossing multiplier", "harmonics")
        counts = ", ".join(
            f"{i}: {len(b.points)} points, {sum(p.is_stable for p in b.points)} stable, "
            f"{b.ends[0]} to {b.ends[1]}"
            for i, b in enumerate(self.branches, 1)
        )
        of_branches = f"branch {counts}" if counts else "no branch"
        if counts and not rows:
            of_branches += "; no bifurcation"
        return Table(f"Periodic response over {self.parameter}; {of_branches}", heads, rows)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The numbers for JSON.

        parameter, unit: what the response is over; bifurcations: each with its branch (from 1),
        kind, value of the parameter, frequency omega [rad/s] and crossing multiplier; branches:
        each with its ends in words, and, point by point, the value, whether the motion is stable,
        its number of harmonics, and r_amp, the largest distance from the mean [m], of each probe;
        notes: what was not found, or is to be known.
        """
        return {
            "parameter": self.parameter,
            "unit": self.unit,
            "bifurcations": [
                {
                    "branch": i,
                    "kind": b.kind,
                    "value": b.value,
                    "omega": b.orbit.omega,
                    "multiplier": [float(b.multiplier.real), float(b.multiplier.imag)],
                }
                for i, branch in enumerate(self.branches, 1)
                for b in branch.bifurcations
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

    def _repr_png_(self) -> bytes:
        return png(self.figure())


def _crossing(bifurcation: Bifurcation) -> float | str:
    """Return the multiplier of a bifurcation, both of a pair, as a table shows it."""
    crossing = bifurcation.multiplier
    if bifurcation.kind != TORUS:
        return crossing.real
    return f"{crossing.real:.4g} ± {abs(crossing.imag):.4g}i"
