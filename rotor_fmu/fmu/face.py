"""What an FMU's rotor makes of it: its variables, and where they stand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from .binding import load_names
from .interface import interface
from .variables import Variable


@dataclass(frozen=True)
class Face:
    """The rotor of an FMU, its variables, and where they stand in the table.

    index: by name; observed_at: where the variables begin that the model computes; drive_at: of the
    speed or the torque; load_at: of the forces' x and y in turn.
    """

    toml: str
    is_free: bool
    rotor: Rotor
    table: tuple[Variable, ...]
    index: dict[str, int]
    observed_at: int
    drive_at: int
    load_at: tuple[int, ...]


@cache
def face(toml: str, is_free: bool) -> Face:
    """The face of an FMU with this rotor, made once for all its instances.

    is_free: whether a torque drives the rotor. Raises `QuantityError` for an impossible rotor.
    """
    rotor = parse_rotor(toml)
    table = interface(rotor, is_free)
    index = {variable.name: i for i, variable in enumerate(table)}
    return Face(
        toml,
        is_free,
        rotor,
        table,
        index,
        observed_at=next(i for i, variable in enumerate(table) if variable.is_observed),
        drive_at=index["tau_drive" if is_free else "speed"],
        load_at=tuple(index[name] for pair in load_names(rotor) for name in pair),
    )
