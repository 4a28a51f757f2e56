"""What is measured in a run: places that move, contacts, and how their names are shown."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import InputError, is_one_of, meant
from ..model.machine.rotor import Rotor
from ..model.parts.base import InterfaceElement

_EQUAL = 0.02  # relative difference of two places' motions that are taken to be equal


@dataclass(frozen=True)
class MeasuringPoint:
    """A place that moves: its name in the machine, x + i y, shape (n,) [m], the radius of the
    clearance about it [m], None where it has none, and whether it is a bearing or a seal."""

    name: str
    z: np.ndarray
    clearance: float | None = None
    is_bearing: bool = False

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


def bearings_of(rotor: Rotor | None) -> frozenset[str]:
    """Return the names of a machine's bearings, seals and contacts; none of an unknown one."""
    found = rotor.elements_of_kind(InterfaceElement) if rotor else []
    return frozenset(name for name, _ in found)


def points_of(
    columns: Mapping[str, np.ndarray], bearings: Collection[str] = ()
) -> tuple[MeasuringPoint, ...]:
    """Return everything with a horizontal and a vertical displacement, in the machine's order;
    bearings: names of those that are bearings."""
    names = [name.removesuffix(".x") for name in columns if name.endswith(".x")]
    return tuple(
        MeasuringPoint(
            name, columns[f"{name}.x"] + 1j * columns[f"{name}.y"], is_bearing=name in bearings
        )
        for name in names
        if f"{name}.y" in columns
    )


def probe_that_moves_most(
    columns: Mapping[str, np.ndarray], bearings: Collection[str] = ()
) -> str | None:
    """Return the name of the place that stands for a machine: of all whose amplitude or velocity is
    observed the one that moves most, None where there is none; bearings: names of bearings."""
    probes = [
        point
        for point in points_of(columns, bearings)
        if {f"{point.name}.x_amp", f"{point.name}.vx"} & columns.keys()
    ]
    return moves_most(probes).name if probes else None


def moves_most(points: Sequence[MeasuringPoint]) -> MeasuringPoint:
    """Return the point that moves most, of several that move as much as `last_of_the_largest`."""
    return points[last_of_the_largest([(p.motion, p.is_bearing) for p in points])]


def last_of_the_largest(places: Sequence[tuple[float, bool]]) -> int:
    """Return the position of the place that moves most. Of several that move as much it is the last
    one that is no bearing: a sensor rather than the disc at its node, a disc rather than a seal.

    places: the motion of each, and whether it is a bearing.
    """
    least = (1 - _EQUAL) * max(motion for motion, _ in places)
    as_large = (i for i, (motion, _) in enumerate(places) if motion >= least)
    return max(as_large, key=lambda i: (not places[i][1], i))


def named(name: str, known: Sequence[Any], what: str) -> Any:
    """Return the point or contact of this name; `InputError` with what may be meant otherwise."""
    names = [item.name for item in known]
    if is_one_of(name, names):
        return known[names.index(name)]
    raise InputError(f"place = {name}: the recording has no such {what}; {meant(name, names)}")
