"""Curves, orbits and sections of the branches of periodic motions that `rf.response` finds."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..display import Shown, current
from ..errors import InputError, check_one_of, known_name
from ..model.linear.linear_machine import shared_machine
from ..model.linear.supports import touching
from ..model.linear.unbalance_peaks import gaps
from ..model.machine.rotor import Rotor
from ..model.parts.base import ProbeElement
from ..model.periodic.branch import Bifurcation, Solution
from ..model.periodic.problem import Response
from .vertices import pieces

_LARGEST = 4096  # points of a period that `orbit` gives at most
# What a motion of a place has, and its unit.
ONCE_A_TURN = ("x_1x", "y_1x", "x_1x_phase", "y_1x_phase")
QUANTITIES = ("r_amp", "x_amp", "y_amp", *ONCE_A_TURN, "x", "y")
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


class ResponseCurves:
    """Periodic motions of a machine over a parameter, and what each place does in them.

    parameter: its name, unit: of its values; branches: see `model.periodic.branch`.
    """

    def __init__(self, result: Response) -> None:
        self._response = result
        self.parameter = result.task.name
        self.branches = result.branches
        self.probes = probes(result.rotor)

    @property
    def machine(self) -> str:
        """Name of the machine."""
        return self._response.rotor.name

    @property
    def is_whirl(self) -> bool:
        """Whether the motions are self-excited, of frequencies of their own."""
        return self._response.task.is_whirl

    @property
    def unit(self) -> str:
        """Of the parameter."""
        return self._response.unit

    @property
    def axis(self) -> Shown:
        """How the parameter is shown."""
        return current().of_si(self.unit)

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
        shaft's mark (of a self-excited whirl 0 and NaN); x, y, the means. Raises `InputError` for
        an unknown name.
        """
        if name not in self.probes and name.rpartition(".")[0] in self.probes:
            name, _, quantity = name.rpartition(".")
        known_name("", name, self.probes)
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
        x, y = ({name: both[k] for name, both in places.items()} for k in (0, 1))
        return OrbitSeries(t, x, y)

    def section(self, name: str, side: str) -> list[SectionLine]:
        """x or y (side) of a place [m] each time the keyphasor's mark passes, along the branches:
        lines that are stable or not, one a turn of a period. Raises `InputError` for self-excited
        whirl, which the mark meets at any phase."""
        if self.is_whirl:
            raise InputError(f"{name}.{side}: a self-excited whirl has no section once a turn")
        lines = []
        for branch in self.branches:
            turns = branch.points[0].orbit.turns if branch.points else 0
            for motions, is_stable in pieces(branch):
                over = np.array([m.value for m in motions])
                values = [self.series(m, name, turns)["xy".index(side)] for m in motions]
                lines += [SectionLine(over, line, is_stable) for line in np.array(values).T]
        return lines

    def amplitude(self, point: Solution | Bifurcation, name: str, quantity: str = "r_amp") -> float:
        """A quantity of a probe, as `curve` has them, of a motion [m, rad]."""
        return self.quantities(point, name)[quantity]

    def quantities(self, point: Solution | Bifurcation, name: str) -> dict[str, float]:
        """Return all quantities of a probe, as `curve` has them, of a motion [m, rad]."""
        X = self._amplitudes(point, name)
        # of a circle 512 have half of the range to 2e-5
        samples = 64 * 2 ** math.ceil(math.log2(max(8, len(X) / 8)))
        x, y = self.series(point, name, samples)
        mean = X[0].real
        is_once = not self.is_whirl and len(X) > point.orbit.turns
        once = X[point.orbit.turns] if is_once else np.zeros(2, complex)
        phase = np.full(2, np.nan) if self.is_whirl else np.angle(once)
        sizes = np.hypot(x - mean[0], y - mean[1]).max(), np.ptp(x) / 2, np.ptp(y) / 2
        values = (*sizes, *np.abs(once), *phase, *mean)
        return {q: float(v) for q, v in zip(QUANTITIES, values, strict=True)}

    def series(
        self, point: Solution | Bifurcation, name: str, samples: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """x and y of a place over a period of a motion, from the keyphasor's mark on, each of shape
        (samples,) [m]."""
        X = self._amplitudes(point, name)
        # harmonics that the samples cannot tell apart are added first
        alike = np.zeros((math.ceil(len(X) / samples), samples, 2), complex)
        alike.reshape(-1, 2)[: len(X)] = X
        result = samples * np.fft.ifft(alike.sum(axis=0), axis=0).real
        return result[:, 0], result[:, 1]

    def _amplitudes(self, point: Solution | Bifurcation, name: str) -> np.ndarray:
        dof, slope, offset = self.probes[name]
        at = np.array([0, 1])
        return point.motion[:, 2 * dof + at] + offset * point.motion[:, 2 * slope + at]


def probes(rotor: Rotor) -> dict[str, tuple[int, int, float]]:
    """Names of the places that are observed, with dof, slope and offset [m]; of a machine without
    any, those of its contacts, where the other end of the gap, minus once, is in the slope's place.
    """
    observed = rotor.elements_of_kind(ProbeElement)
    if found := {where: (2 * p.node - 2, 2 * p.node - 1, p.offset) for where, p in observed}:
        return found
    return {
        gap.name: (gap.dof, gap.end, -1.0) if gap.end >= 0 else (gap.dof, gap.dof, 0.0)
        for gap in gaps(shared_machine(rotor), touching(rotor))
    }
