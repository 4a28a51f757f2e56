"""The recording of a run at the solver's own steps, in memory and as a file."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..files import unfinished
from ..short_repr import ShortRepr


@dataclass(frozen=True, repr=False)
class Recording(ShortRepr):
    """Quantities of a run at the solver's own steps.

    t, shape (n,) [s], growing; columns: by the names of `observed_names`, the angle of rotation
    `phi` [rad] and the speed `w` [rad/s] among them, shape (n,); units: by name; about: description
    of the run, as JSON values (machine, toml, parameters, status, messages).
    """

    t: np.ndarray
    columns: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    about: Mapping[str, Any]

    def save(self, path: Path) -> None:
        """Write a file of NumPy arrays, whole or not at all; a motion hardly compresses."""
        head = {"names": list(self.columns), "units": dict(self.units), "about": dict(self.about)}
        values = np.array(list(self.columns.values()))
        with unfinished(path) as part:
            np.savez(part, t=self.t, values=values, head=json.dumps(head))


def load_recording(path: Path) -> Recording:
    """Read what `Recording.save` wrote; `InputError` for any other file."""
    try:
        with np.load(path) as data:
            head = json.loads(str(data["head"]))
            columns = dict(zip(head["names"], data["values"], strict=True))
            return Recording(data["t"], columns, head["units"], head["about"])
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile) as error:
        raise InputError(f"{path}: is no recording of a run") from error
