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

    from ..linear.acceptance import CriticalMap, StabilityLevel1, StabilityLevel2, UnbalanceCheck
    from ..linear.answers import Campbell, Modes, Static, UnbalanceResponse
    from ..linear.frequency_answers import FrequencyResponse


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
        harmonic : float or sequence of float
            Multiples of the speed that excite, for critical speeds [1].

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

    def unbalance_check(
        self, low: float, high: float, probes: Sequence[int], **options: Any
    ) -> UnbalanceCheck:
        """Response to unbalance held against API 617 and 684 in an operating range.

        Parameters
        ----------
        low, high : float
            Minimum and maximum continuous speed [rad/s].
        probes : sequence of int
            Nodes (from 1) with probes.
        unbalances : sequence of (int, float, float), optional
            Node (from 1), amount [kg.m] and angle [rad] of each unbalance. By default the machine's
            own.
        clearances : mapping of int to float, optional
            Radial clearances [m] of seals by their nodes (from 1).
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        UnbalanceCheck
            Critical speeds with amplification factors and separation margins, levels at the probes,
            clearances, with a table and a picture.

        Raises
        ------
        LinearError
            If the range, a node or a clearance cannot be.
        """
        from ..linear.acceptance import unbalance_check

        return unbalance_check(self.rotor, low, high, probes, **options)

    def critical_map(
        self, stiffness: Sequence[float] | np.ndarray | None = None, **options: Any
    ) -> CriticalMap:
        """Undamped critical speeds over the stiffness of the bearings.

        Parameters
        ----------
        stiffness : sequence of float, optional
            Ascending stiffnesses of every bearing [N/m]. By default two decades on either side of
            the bearings' own.
        count : int
            Number of lines, the lowest ones.
        synchronous : bool
            False for natural frequencies at standstill instead of forward critical speeds.
        rigid_pedestals : bool
            Whether housings are taken as ground.
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        CriticalMap
            The lines and the bearings' own stiffness, with a table and a picture.

        Raises
        ------
        LinearError
            If the stiffnesses do not ascend from above 0, or the machine has no bearing.
        """
        from ..linear.acceptance import critical_map

        return critical_map(self.rotor, stiffness, **options)

    def stability(
        self, speed: float, level: int = 1, **options: Any
    ) -> StabilityLevel1 | StabilityLevel2:
        """Stability of the first forward mode by API 617 and 684.

        Parameters
        ----------
        speed : float
            Maximum continuous speed [rad/s], above 0.
        level : int
            1 for the logarithmic decrement over the cross coupling, 2 for what each seal does.
        node : int, optional
            With level 1, node (from 1) of the cross coupling. By default midway between the
            bearings.
        anticipated : float
            With level 1, the cross coupling that is expected, QA [N/m].
        cross_couplings : mapping of int to float, optional
            With level 2, cross coupling [N/m] by node (from 1).
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        StabilityLevel1 or StabilityLevel2
            Logarithmic decrements and thresholds, with a table and a picture.

        Raises
        ------
        LinearError
            If the speed or a node cannot be.
        InputError
            If the level is neither 1 nor 2.
        """
        from ..linear.acceptance import level_1, level_2

        if level not in (1, 2):
            raise InputError(f"level = {level}: must be 1 or 2")
        if level == 1:
            return level_1(self.rotor, speed, **options)
        return level_2(self.rotor, speed, **options)

    def frequency_response(
        self,
        frequencies: Sequence[float] | np.ndarray,
        force: int,
        nodes: Sequence[int],
        **options: Any,
    ) -> FrequencyResponse:
        """Displacements of nodes by a force on a node, over the frequency.

        Parameters
        ----------
        frequencies : sequence of float
            Frequencies of the force [rad/s], above 0.
        force : int
            Node (from 1) of the force.
        nodes : sequence of int
            Nodes (from 1) whose displacement is asked for.
        speed : float
            Speed of rotation [rad/s].
        contacts : str, optional
            `open` or `pinned`. By default open where the machine is held without its contacts.

        Returns
        -------
        FrequencyResponse
            Complex receptances [m/N], with a table and a picture.

        Raises
        ------
        LinearError
            If a frequency or a node cannot be.
        """
        from ..linear.frequency_answers import frequency_response

        return frequency_response(self.rotor, frequencies, force, nodes, **options)

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
