"""A machine: what its file says, its picture, and the linear answers about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.march.tape import recordable
from ..model.quantities import QuantityError
from ..runs.job import load_rotor
from .pictures import png, shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..linear.answers import Campbell, Modes, Static, UnbalanceResponse


@dataclass(frozen=True)
class Machine:
    """A machine, as `load` and `parse` make it; a notebook shows its picture.

    rotor: its shaft and parts; toml: its file, from which FMUs are built.

    >>> import rotor_fmu as rf
    >>> rig = rf.load()
    >>> rig
    Machine('zigulic2003': 8 nodes, 0.33 m; 2 bearing, 3 disc, 1 coupling)
    """

    rotor: Rotor = field(repr=False)
    toml: str = field(repr=False)

    @property
    def name(self) -> str:
        """What the file calls it."""
        return self.rotor.name

    @property
    def units(self) -> dict[str, str]:
        """What a run can record, in the order of its names, with the unit of each.

        >>> import rotor_fmu as rf
        >>> rf.load().units["disc[3].x"]
        'm'
        """
        return {str(entry.name): entry.output.unit for entry in recordable(self.rotor)}

    @property
    def parameters(self) -> dict[str, float]:
        """What `simulate` can change, and its value in the file, SI.

        >>> import rotor_fmu as rf
        >>> rf.load().parameters["bearing[1].clearance"]
        5e-05
        """
        return {str(name): value for name, _, value in self.rotor.parameters()}

    def modes(self, speed: float = 0.0, **options: Any) -> Modes:
        """Natural frequencies, damping and shapes at a speed [rad/s] (`model.linear.modes`).

        >>> import rotor_fmu as rf
        >>> found = rf.load().modes(contacts="pinned")
        >>> [f"{omega:.0f} rad/s" for omega in found.natural[:2]]
        ['186 rad/s', '204 rad/s']
        """
        from ..linear.answers import modes

        return modes(self.rotor, speed, **options)

    def campbell(self, speeds: Sequence[float] | np.ndarray, **options: Any) -> Campbell:
        """Frequencies over speeds [rad/s], critical speeds and the threshold of stability
        (`model.linear.campbell`)."""
        from ..linear.answers import campbell

        return campbell(self.rotor, speeds, **options)

    def unbalance_response(
        self, speeds: Sequence[float] | np.ndarray, **options: Any
    ) -> UnbalanceResponse:
        """Steady response to the unbalances at speeds [rad/s]
        (`model.linear.unbalance_response`)."""
        from ..linear.answers import unbalance_response

        return unbalance_response(self.rotor, speeds, **options)

    def static(self, speed: float = 0.0, **options: Any) -> Static:
        """Deflection and loads under gravity (`model.linear.static`)."""
        from ..linear.answers import static

        return static(self.rotor, speed, **options)

    def show(self) -> Figure:
        """The machine to scale, in mm."""
        from ..fmi.packing.machine_picture import machine_figure

        return shown(machine_figure(self.rotor))

    def __repr__(self) -> str:
        kinds = [part.KIND for part in self.rotor.parts]
        parts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
        return (
            f"Machine({self.name!r}: {len(self.rotor.nodes)} nodes, "
            f"{self.rotor.length:.3g} m; {parts})"
        )

    def _repr_png_(self) -> bytes:
        return png(self.show())


def load(path: Path | str | None = None) -> Machine:
    """Read a machine's file, ours or one that ROSS saved; without a path, the test rig of paper A.

    Raises `InputError` for a file that cannot be read or tells an impossible machine.

    >>> import rotor_fmu as rf
    >>> rf.load().name
    'zigulic2003'
    """
    try:
        toml, rotor = load_rotor(None if path is None else Path(path))
    except InputError as error:
        raise InputError(str(error).removeprefix("--rotor ")) from error
    return Machine(rotor, toml)


def parse(toml: str) -> Machine:
    """A machine from the text of its file; raises `InputError`.

    >>> import rotor_fmu as rf
    >>> rf.parse(rf.load().toml.replace("clearance = 50e-6", "clearance = -1e-6"))
    Traceback (most recent call last):
        ...
    rotor_fmu.errors.InputError: bearing[1].clearance = -1e-06 m: must be > 0 and finite
    """
    try:
        return Machine(parse_rotor(toml), toml)
    except QuantityError as error:
        raise InputError(str(error)) from error
