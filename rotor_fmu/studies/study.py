"""The definition of a study: its subject, the varied parameters, and the identity of each run."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from ..about import __version__
from ..errors import InputError
from .design import Design

Cell = float | list[float]
Tables = Mapping[str, Any]  # of a study's file
STUDY = "study.json"  # in the folder of a study


def table_of(tables: Tables, key: str) -> dict[str, Any]:
    """Return a table by its key, empty where it is left out; `InputError` for anything else."""
    table = tables.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{key} = {table!r}: must be a table")
    return table


@dataclass(frozen=True)
class Column:
    """A column of the rows: a number, or a list along a dimension.

    dimension: its name, empty of a number; coordinate: its values, empty where they only count;
    is_direction: whether it is an angle [rad] that begins anew after a turn.
    """

    name: str
    unit: str
    text: str
    dimension: str = ""
    coordinate: tuple[float, ...] = ()
    coordinate_unit: str = "1"
    is_direction: bool = False


@dataclass(frozen=True)
class Result:
    """The result of one run: its status (see `rotor_fmu.run_status`), and the cells by the names of
    the columns, none of a failed run."""

    status: str
    cells: Mapping[str, Cell]


class Model(Protocol):
    """The subject of a study; it is sent to other processes, so it must be small and picklable."""

    @property
    def identity(self) -> str:
        """Return everything besides the values that decides the result of a run."""
        ...

    @property
    def columns(self) -> tuple[Column, ...]:
        """Return the columns of each run."""
        ...

    def warm(self) -> None:
        """Prepare in this process what all runs share."""
        ...

    def run(self, values: Mapping[str, float]) -> Result:
        """One run with these values of what is varied; equal values, equal result, bit for bit."""
        ...


class Limit(NamedTuple):
    """What a number should not exceed, or, if is_least, not fall below."""

    value: float
    is_least: bool = False


@dataclass(frozen=True)
class Study:
    """A study that was checked and can begin.

    limits: by column; text: the file it was read from; units: that the
    machine's file asks to be shown.
    """

    name: str
    model: Model
    design: Design
    limits: Mapping[str, Limit] = field(default_factory=dict)
    text: str = ""
    units: str = ""

    @property
    def identity(self) -> str:
        """Hash of all that decides the rows: model, design with its seed, version."""
        identity = json.dumps([__version__, self.model.identity, self.design.identity])
        return sha256(identity.encode()).hexdigest()[:32]

    def row_id(self, values: Mapping[str, float]) -> str:
        """Return the hash of one run: of model, seed and version, and of the values."""
        identity = [__version__, self.model.identity, self.design.seed, sorted(values.items())]
        return sha256(json.dumps(identity).encode()).hexdigest()[:16]

    @property
    def about(self) -> dict[str, object]:
        """Return the description of the study for its folder."""
        return {
            "name": self.name,
            "identity": self.identity,
            "version": __version__,
            "runs": len(self.design),
            "design": self.design.description,
            "columns": [vars(column) for column in self.model.columns],
            "limits": {name: limit._asdict() for name, limit in self.limits.items()},
            "text": self.text,
            "units": self.units,
            "can_be_selected": getattr(self.model, "can_be_selected", False),
        }


def read_about(folder: Path, option: str = "") -> dict[str, Any] | None:
    """Return the description of a folder's study, None if it holds none. Raises `InputError` where
    it cannot be read; option: in which the folder was given, for the message."""
    try:
        about = json.loads((folder / STUDY).read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except (OSError, ValueError) as error:
        raise InputError(f"{option}{folder}: its study.json cannot be read") from error
    if not isinstance(about, dict):
        raise InputError(f"{option}{folder}: its study.json is that of no study")
    return about
