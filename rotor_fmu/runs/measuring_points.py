"""What is measured in a run: places that move, contacts, and how their names are shown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError, is_one_of, meant

_EQUAL = 0.02  # relative difference of two places' motions that are taken to be equal


@dataclass(frozen=True)
class MeasuringPoint:
    """A place that moves: its name in the machine, x + i y, shape (n,) [m], and the radius of the
    clearance about it [m], None where it has none."""

    name: str
    z: np.ndarray
    clearance: float | None = None

    @property
    def label(self) -> str:
        """Its name in a sentence: `disc 3`."""
        return display_name(self.name)

    @property
    def motion(self) -> float:
        """Root of the mean square distance from the mean position [m]."""
        known = self.z[np.isfinite(self.z)]  # not what diverged in the end
        return float(np.std(known)) if len(known) else 0.0


@dataclass(frozen=True)
class ContactSignals:
    """A contact: its name, angle psi [rad], NaN of surfaces that touch through a film, which have
    none recorded, normal force fn [N], and its largest value of all steps over the last revolution
    [N], fn itself where that was not recorded; shape (n,)."""

    name: str
    psi: np.ndarray
    fn: np.ndarray
    peak: np.ndarray

    @property
    def has_angle(self) -> bool:
        """Whether its angle was recorded."""
        return not len(self.psi) or not np.isnan(self.psi).all()

    @property
    def label(self) -> str:
        """Its name in a sentence."""
        return display_name(self.name)


def display_name(name: str) -> str:
    """Return `disc[3].x` as `disc 3 x`."""
    return name.replace("[", " ").replace("]", "").replace(".", " ")


def points_of(columns: Mapping[str, np.ndarray]) -> tuple[MeasuringPoint, ...]:
    """Return everything with a horizontal and a vertical displacement, in the machine's order."""
    names = [name.removesuffix(".x") for name in columns if name.endswith(".x")]
    return tuple(
        MeasuringPoint(name, columns[f"{name}.x"] + 1j * columns[f"{name}.y"])
        for name in names
        if f"{name}.y" in columns
    )


def probe_that_moves_most(columns: Mapping[str, np.ndarray]) -> str | None:
    """Return the name of the place that stands for a machine: of all whose amplitude or velocity is
    observed the one that moves most, None where there is none."""
    probes = [
        point
        for point in points_of(columns)
        if {f"{point.name}.x_amp", f"{point.name}.vx"} & columns.keys()
    ]
    return moves_most(probes).name if probes else None


def moves_most(points: Sequence[MeasuringPoint]) -> MeasuringPoint:
    """Return the point that moves most, the last of several that move as much."""
    return points[last_of_the_largest([point.motion for point in points])]


def last_of_the_largest(motions: Sequence[float]) -> int:
    """Return the position of the largest motion, the last of several that are as large: a sensor
    rather than the bearing or the disc at its node."""
    least = (1 - _EQUAL) * max(motions)
    return max(i for i, motion in enumerate(motions) if motion >= least)


def named(name: str, known: Sequence[Any], what: str) -> Any:
    """Return the point or contact of this name; `InputError` with what may be meant otherwise."""
    names = [item.name for item in known]
    if is_one_of(name, names):
        return known[names.index(name)]
    raise InputError(f"place = {name}: the recording has no such {what}; {meant(name, names)}")
