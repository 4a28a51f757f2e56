"""The recording of a run at the solver's own steps, in memory and as a file."""

import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..files import unfinished
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.parts.base import ReleaseElement
from ..model.quantities import QuantityError
from ..run_status import OK
from ..short_repr import ShortRepr
from ..vibration import Synchronous, synchronous
from .measuring_points import (
    ContactSignals,
    MeasuringPoint,
    bearings_of,
    moves_most,
    named,
    points_of,
    probe_that_moves_most,
)

RECORDING = "recording.npz"  # in the folder of a run


@dataclass(frozen=True, repr=False)
class Recording(ShortRepr):
    """Quantities of a run at the solver's own steps.

    t, shape (n,) [s], growing; columns: by the names of `observed_names`, the angle of rotation
    `phi` [rad] and the speed `w` [rad/s] among them, shape (n,); units: by name; about: description
    of the run, as JSON values (machine, toml, parameters, status, messages); name: of the run, such
    as its folder's.
    """

    t: np.ndarray
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    about: Mapping[str, Any]
    name: str = ""

    def save(self, path: Path) -> None:
        """Write a file of NumPy arrays, whole or not at all; a motion hardly compresses."""
        head = {"names": list(self.columns), "units": dict(self.units), "about": dict(self.about)}
        values = np.array(list(self.columns.values()))
        with unfinished(path) as part:
            np.savez(part, t=self.t, values=values, head=json.dumps(head))

    def named(self, name: str) -> "Recording":
        """Return the same recording under another name."""
        return replace(self, name=name)

    @property
    def phi(self) -> np.ndarray:
        """Angle of rotation [rad]."""
        return self.columns["phi"]

    @property
    def w(self) -> np.ndarray:
        """Speed of rotation [rad/s]."""
        return self.columns["w"]

    def check_rotation(self) -> None:
        """Raise `InputError` where the angle or the speed of rotation was not recorded."""
        for name in ("phi", "w"):
            if name not in self.columns:
                raise InputError(
                    f"{self._called}: its recording has no {name}, which is needed to count turns"
                )

    @property
    def _called(self) -> str:
        return self.name or "the run"

    @property
    def status(self) -> str:
        """How the run ended; see `run_status`."""
        return str(self.about.get("status", OK))

    @property
    def machine(self) -> str:
        """Name of the machine, of the run where the recording does not hold it."""
        return str(self.about.get("machine") or self.name)

    @cached_property
    def rotor(self) -> Rotor | None:
        """The machine, if the recording holds it."""
        try:
            return parse_rotor(str(self.about["toml"]))
        except (KeyError, QuantityError):
            return None

    @cached_property
    def is_released(self) -> bool:
        """Whether the machine, where it is known, begins in the air and not at rest."""
        return self.rotor is not None and bool(self.rotor.elements_of_kind(ReleaseElement))

    @property
    def shown_units(self) -> str:
        """The units that the machine's file asks to be shown, empty for the usual ones."""
        return self.rotor.units if self.rotor else ""

    @cached_property
    def places(self) -> tuple[MeasuringPoint, ...]:
        """Everything with a horizontal and a vertical displacement, in the machine's order."""
        return tuple(
            replace(point, clearance=self._clearance(point.name))
            for point in points_of(self.columns, bearings_of(self.rotor))
        )

    @property
    def shaft_places(self) -> Sequence[MeasuringPoint]:
        """The places whose displacements are absolute; where there is none, the journals."""
        journals = {contact.name for contact in self.contacts}  # x, y relative to the housing
        return [p for p in self.places if p.name not in journals] or self.places

    @cached_property
    def contacts(self) -> tuple[ContactSignals, ...]:
        """Every contact, in the machine's order."""
        columns = self.columns
        names = [name.removesuffix(".fn") for name in columns if name.endswith(".fn")]
        unknown = np.full(len(self.t), np.nan)
        found = []
        for name in names:
            psi, fn = columns.get(f"{name}.psi", unknown), columns[f"{name}.fn"]
            found.append(ContactSignals(name, psi, fn, columns.get(f"{name}.fn_peak", fn)))
        return tuple(found)

    @property
    def losses(self) -> dict[str, np.ndarray]:
        """Energy dissipated since the start by sink, the largest first, shape (n,) [J]."""
        found = {
            name.removeprefix("energy.").removesuffix("_loss"): column
            for name, column in self.columns.items()
            if name.startswith("energy.") and name.endswith("_loss")
        }
        return dict(sorted(found.items(), key=lambda sink: -sink[1][-1:].sum()))

    @property
    def sinks(self) -> dict[str, np.ndarray]:
        """Of the losses those that are not 0 at the end; all where none is."""
        losses = self.losses
        return {name: energy for name, energy in losses.items() if energy[-1] != 0.0} or losses

    def check_losses(self) -> None:
        """Raise `InputError` where no energy that was dissipated was recorded."""
        if not self.losses:
            raise InputError(
                f"{self._called}: its recording has no energy that was dissipated, such as "
                "energy.friction_loss"
            )

    def place(self, name: str | None = None) -> MeasuringPoint:
        """Return a place by its name; None: the probe that moves most, without probes whatever else
        of the shaft does, or else the journal. Raises `InputError` for an unknown name."""
        if name is None:
            name = self.probe
        if name is not None:
            return named(name, self.places, "place")
        if not self.places:
            raise InputError(f"{self._called}: its recording has no place with x and y")
        return moves_most(self.shaft_places)

    @property
    def probe(self) -> str | None:
        """The name of the probe that moves most, None where there is none."""
        return probe_that_moves_most(self.columns, bearings_of(self.rotor))

    def contact(self, name: str | None = None, *, with_angle: bool = False) -> ContactSignals:
        """Return a contact by its name; None: the one with the largest mean force; with_angle: of
        those whose angle was recorded. Raises `InputError` for an unknown name."""
        known = [contact for contact in self.contacts if contact.has_angle or not with_angle]
        if not known:
            what = "contact angle" if self.contacts else "contact"
            raise InputError(f"{self._called}: its recording has no {what}")
        if name is not None:
            return named(name, known, "contact")
        return max(known, key=lambda contact: float(np.nan_to_num(contact.fn).sum()))

    def resampled(self, place: MeasuringPoint) -> Synchronous:
        """Return a place's motion over whole turns, x + i y in µm; raises `TooFewTurns`."""
        if place.name not in self._resampled:
            self._resampled[place.name] = synchronous(self.t, self.phi, place.z * 1e6, turns=4)
        return self._resampled[place.name]

    @cached_property
    def _resampled(self) -> dict[str, Synchronous]:
        return {}

    def parameter_units(self) -> dict[str, str]:
        """Return the SI units of what may be set in the run's machine, none where the recording
        does not hold it, and of what a study varied."""
        varied: dict[str, str] = self.about.get("parameter_units", {})
        if self.rotor is None:
            return varied
        from ..fmi.interface import interface

        return {v.name: v.unit for v in interface(self.rotor) if v.unit} | varied

    def _clearance(self, name: str) -> float | None:
        given: Mapping[str, Any] = self.about.get("parameters", {})
        if f"{name}.clearance" in given:
            return float(given[f"{name}.clearance"])
        parts = dict(self.rotor.named_parts()) if self.rotor else {}
        clearance = getattr(parts.get(name), "clearance", None)
        return None if clearance is None else float(clearance)


def load_recording(path: Path) -> Recording:
    """Read what `Recording.save` wrote, named after its folder; `InputError` for other files."""
    try:
        with np.load(path) as data:
            head = json.loads(str(data["head"]))
            columns = dict(zip(head["names"], data["values"], strict=True))
            name = path.resolve().parent.name
            return Recording(data["t"], columns, head["units"], head["about"], name)
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: is not a recording of a run") from error
