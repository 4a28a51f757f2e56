"""A machine: its file, its picture, and its linear analyses."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..machine_file.reading import si_text
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.quantities import QuantityError
from ..model.simulation import RotorWarning
from ..model.time_loop.recorder import recordable
from ..runs.job import load_rotor
from .pictures import png, shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..linear.answers import Campbell, Modes, Static, UnbalanceResponse


@dataclass(frozen=True)
class Machine:
    """A machine, as `load` and `parse` return it; a notebook shows its picture.

    Attributes
    ----------
    rotor : Rotor
        Shaft and parts.
    toml : str
        The text of its file, from which FMUs are built.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> rig = rf.load()
    >>> rig
    Machine('zigulic2003': 8 nodes, 0.33 m; 2 bearing, 3 disc, 1 coupling)
    """

    rotor: Rotor = field(repr=False)
    toml: str = field(repr=False)

    @property
    def name(self) -> str:
        """Name of the machine in its file.

        Returns
        -------
        str
            The name.
        """
        return self.rotor.name

    @property
    def units(self) -> dict[str, str]:
        """Signals that a run can record, with the unit of each.

        Returns
        -------
        dict of str to str
            Unit by name, in the order of the signals.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> rf.load().units["disc[3].x"]
        'm'
        """
        return {str(entry.name): entry.output.unit for entry in recordable(self.rotor)}

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters that `simulate` can change, with their values in the file.

        Returns
        -------
        dict of str to float
            Value by name, in SI units.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> rf.load().parameters["bearing[1].clearance"]
        5e-05
        """
        return {str(name): value for name, _, value in self.rotor.parameters()}

    def modes(self, speed: float = 0.0, **options: Any) -> Modes:
        """Return the natural frequencies, damping and shapes at a speed.

        Parameters
        ----------
        speed : float
            Speed of rotation [rad/s].
        count : int
            Number of modes, the lowest ones.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        Modes
            Eigenvalues [1/s] and shapes, with a table and a picture.

        Raises
        ------
        LinearError
            If the speed is not finite, or `contacts` is another word.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> found = rf.load().modes(contacts="pinned")
        >>> [f"{omega:.0f} rad/s" for omega in found.natural[:2]]
        ['186 rad/s', '204 rad/s']
        """
        from ..linear.answers import modes

        return modes(self.rotor, speed, **options)

    def campbell(self, speeds: Sequence[float] | np.ndarray, **options: Any) -> Campbell:
        """Return the frequencies over speeds, critical speeds and the threshold of stability.

        Parameters
        ----------
        speeds : sequence of float
            At least two ascending speeds of rotation [rad/s].
        count : int
            Number of modes, the lowest ones.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.
        harmonic : float
            Multiple of the speed that excites, for critical speeds [1].

        Returns
        -------
        Campbell
            Eigenvalues [1/s], critical speeds and threshold [rad/s], with a table and a picture.

        Raises
        ------
        LinearError
            If the speeds do not ascend, or `contacts` is another word.
        """
        from ..linear.answers import campbell

        return campbell(self.rotor, speeds, **options)

    def unbalance_response(
        self, speeds: Sequence[float] | np.ndarray, **options: Any
    ) -> UnbalanceResponse:
        """Steady response to unbalances over speeds.

        Parameters
        ----------
        speeds : sequence of float
            Speeds of rotation [rad/s].
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.
        unbalances : sequence of (int, float, float), optional
            Node (from 1), amount [kg.m] and angle from the shaft's mark [rad] of each unbalance. By
            default the machine's own.

        Returns
        -------
        UnbalanceResponse
            Complex amplitudes [m] and loads on the supports [N], with a table and a picture.

        Raises
        ------
        LinearError
            If a speed or a node cannot be, or `contacts` is another word.
        """
        from ..linear.answers import unbalance_response

        return unbalance_response(self.rotor, speeds, **options)

    def static(self, speed: float = 0.0, **options: Any) -> Static:
        """Deflection and loads on the supports under gravity.

        Parameters
        ----------
        speed : float
            Speed of rotation [rad/s], on which bearings may depend.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.
        loads : sequence of (int, float, float)
            Node (from 1), force to the right and force upwards [N] of each further load.

        Returns
        -------
        Static
            Displacements [m], slopes [rad] and loads [N], with a table and a picture.

        Raises
        ------
        LinearError
            If nothing holds the machine, or a node cannot be, or `contacts` is another word.
        """
        from ..linear.answers import static

        return static(self.rotor, speed, **options)

    def show(self) -> Figure:
        """Draw the machine to scale, in mm.

        Returns
        -------
        matplotlib.figure.Figure
            The drawing.
        """
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


def _ask(question: str) -> None:
    warnings.warn(RotorWarning(question), stacklevel=4)


def load(path: Path | str | None = None) -> Machine:
    """Read a machine's file, one of this project's or one that ROSS saved.

    Parameters
    ----------
    path : Path or str, optional
        The file. By default the test rig of paper A.

    Returns
    -------
    Machine
        The machine.

    Raises
    ------
    InputError
        If the file cannot be read or describes an impossible machine.

    Warns
    -----
    RotorWarning
        If a value is probably meant in another unit.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> rf.load().name
    'zigulic2003'
    """
    try:
        toml, rotor = load_rotor(None if path is None else Path(path), _ask)
    except InputError as error:
        raise InputError(str(error).removeprefix("--rotor ")) from error
    return Machine(rotor, toml)


def parse(toml: str) -> Machine:
    """Make a machine from the text of its file.

    Parameters
    ----------
    toml : str
        The text, in TOML.

    Returns
    -------
    Machine
        The machine.

    Raises
    ------
    InputError
        If the text describes an impossible machine.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> rf.parse(rf.load().toml.replace("clearance = 50e-6", "clearance = -1e-6"))
    Traceback (most recent call last):
        ...
    rotor_fmu.errors.InputError: bearing[1].clearance = -1e-06 m: must be > 0 and finite
    """
    try:
        plain = si_text(toml)
        return Machine(parse_rotor(plain), plain)
    except QuantityError as error:
        raise InputError(str(error)) from error
