"""The measuring points of a recording: places that move, contacts, sinks of energy."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ..errors import InputError
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.quantities import QuantityError
from . import Synchronous, synchronous


class Recording(Protocol):
    """The recording of a run, as `runs.recording` has it: t, shape (n,) [s], columns by name, shape
    (n,), SI units, and what was run."""

    @property
    def t(self) -> np.ndarray:
        """Times [s]."""

    @property
    def columns(self) -> Mapping[str, np.ndarray]:
        """Quantities by name."""

    @property
    def about(self) -> Mapping[str, Any]:
        """Machine, toml, parameters, status, messages."""


@dataclass(frozen=True)
class MeasuringPoint:
    """A place that moves: its name in the machine, x + i y, shape (n,) [m], and the radius of the
    clearance about it [m], None where it has none."""

    name: str
    z: np.ndarray
    clearance: float | None

    @property
    def label(self) -> str:
        """Its name as a sentence has it: `disc 3`."""
        return spoken(self.name)

    @property
    def motion(self) -> float:
        """Mean distance from the mean position, root of the mean square [m]."""
        known = self.z[np.isfinite(self.z)]  # not what diverged in the end
        return float(np.std(known)) if len(known) else 0.0


@dataclass(frozen=True)
class Touch:
    """A contact: its name, angle psi [rad] and normal force fn [N], shape (n,)."""

    name: str
    psi: np.ndarray
    fn: np.ndarray

    @property
    def label(self) -> str:
        """Its name as a sentence has it."""
        return spoken(self.name)


class Recorded:
    """A recording as a person looks at it.

    name: of the run; about: its description.
    """

    def __init__(self, recording: Recording, name: str) -> None:
        for needed in ("phi", "w"):
            if needed not in recording.columns:
                raise InputError(
                    f"{name}: its recording has no {needed}, which is needed to count turns"
                )
        self.name, self.columns = name, recording.columns
        self.t = recording.t
        self.phi, self.w = recording.columns["phi"], recording.columns["w"]
        self.about = recording.about
        self._resampled: dict[str, Synchronous] = {}

    @cached_property
    def rotor(self) -> Rotor | None:
        """The machine, if the recording holds it."""
        try:
            return parse_rotor(str(self.about["toml"]))
        except (KeyError, QuantityError):
            return None

    @cached_property
    def places(self) -> tuple[MeasuringPoint, ...]:
        """Everything with a horizontal and a vertical displacement, in the machine's order."""
        columns = self.columns
        names = [n.removesuffix(".x") for n in columns if n.endswith(".x")]
        return tuple(
            MeasuringPoint(
                name, columns[f"{name}.x"] + 1j * columns[f"{name}.y"], self._clearance(name)
            )
            for name in names
            if f"{name}.y" in columns
        )

    @cached_property
    def touches(self) -> tuple[Touch, ...]:
        """Every contact, in the machine's order."""
        columns = self.columns
        names = [n.removesuffix(".fn") for n in columns if n.endswith(".fn")]
        return tuple(
            Touch(name, columns[f"{name}.psi"], columns[f"{name}.fn"])
            for name in names
            if f"{name}.psi" in columns
        )

    @property
    def losses(self) -> dict[str, np.ndarray]:
        """Energy dissipated since the start by sink, shape (n,) [J]."""
        return {
            name.removeprefix("energy.").removesuffix("_loss"): column
            for name, column in self.columns.items()
            if name.startswith("energy.") and name.endswith("_loss")
        }

    @property
    def status(self) -> str:
        """How the run ended."""
        return str(self.about.get("status", "ok"))

    def place(self, name: str | None = None) -> MeasuringPoint:
        """Return a place by its name; None: the one of the shaft that moves most, or else the
        journal that does."""
        if name is not None:
            return _named(name, self.places, "place")
        if not self.places:
            raise InputError(f"{self.name}: its recording has no place with x and y")
        of_contacts = {touch.name for touch in self.touches}  # x, y relative to the housing
        absolute = [p for p in self.places if p.name not in of_contacts]
        return max(absolute or self.places, key=lambda place: place.motion)

    def touch(self, name: str | None = None) -> Touch:
        """Return a contact by its name; None: the one that is pressed most."""
        if name is not None:
            return _named(name, self.touches, "contact")
        if not self.touches:
            raise InputError(f"{self.name}: its recording has no contact")
        return max(self.touches, key=lambda touch: float(np.nan_to_num(touch.fn).sum()))

    def resampled(self, place: MeasuringPoint) -> Synchronous:
        """Return a place's motion over whole turns, x + i y in µm; raises `TooFewTurns`."""
        if place.name not in self._resampled:
            self._resampled[place.name] = synchronous(self.t, self.phi, place.z * 1e6, turns=4)
        return self._resampled[place.name]

    def _clearance(self, name: str) -> float | None:
        given: Any = self.about.get("parameters", {})
        if f"{name}.clearance" in given:
            return float(given[f"{name}.clearance"])
        parts = dict(self.rotor.named_parts()) if self.rotor else {}
        clearance = getattr(parts.get(name), "clearance", None)
        return None if clearance is None else float(clearance)


def spoken(name: str) -> str:
    """Return `disc[3].x` as `disc 3 x`."""
    return name.replace("[", " ").replace("]", "").replace(".", " ")


def hertz(speed: Any) -> Any:
    """Return Hz of rad/s."""
    return speed / (2 * math.pi)


def _named(name: str, known: Sequence[Any], what: str) -> Any:
    for item in known:
        if item.name == name:
            return item
    names = [item.name for item in known]
    near = difflib.get_close_matches(name, names, 1, 0.0)
    hint = f"did you mean {near[0]}?" if near else "there is none"
    raise InputError(f"--place {name}: the recording has no such {what}; {hint}")
