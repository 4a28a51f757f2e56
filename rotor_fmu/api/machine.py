"""A machine: its file, its quantities and its picture."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError, path_of, shown_value
from ..machine_file.loading import load_rotor, si_text, warn_of_changes
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor
from ..model.simulation import RotorWarning
from ..model.time_loop.recorder import recordable
from ..plotting.notebook import png, shown
from .linear_analyses import LinearAnalyses

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..model.periodic.branch import Solution
    from ..periodic.result import ResponseResult


@dataclass(frozen=True)
class Machine(LinearAnalyses):
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

    toml: str = field(repr=False)

    @property
    def name(self) -> str:
        """Name of the machine in its file."""
        return self.rotor.name

    @property
    def units(self) -> dict[str, str]:
        """Units of the signals that a run can record, by name.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> rf.load().units["disc[3].x"]
        'm'
        """
        return {str(entry.name): entry.output.unit for entry in recordable(self.rotor)}

    @property
    def parameters(self) -> dict[str, float]:
        """Values in the file of the parameters that `simulate` can change, by name, in SI units.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> rf.load().parameters["bearing[1].clearance"]
        5e-05
        """
        return {name: of.value for name, of in self.rotor.parameters().items()}

    def show(self) -> "Figure":
        """Draw the machine to scale, in mm.

        Returns
        -------
        matplotlib.figure.Figure
            The drawing.
        """
        from ..plotting.machine_drawing import machine_figure

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


def check_machine(machine: object) -> None:
    """Raise `InputError` for what is no machine, such as the path of its file."""
    if not isinstance(machine, Machine):
        said = shown_value("machine", machine)
        raise InputError(f"{said}: must be a machine, as load or parse returns it")


def _warn(text: str) -> None:
    warnings.warn(RotorWarning(text), stacklevel=4)


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
        If a value is probably meant in another unit, or a rotor from ROSS is not the same here.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> rf.load().name
    'zigulic2003'
    """
    toml, rotor = load_rotor(None if path is None else path_of("path", path), _warn, option="")
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
    >>> rf.parse(rf.load().toml.replace("clearance = 50e-6", "clearance = -1.0"))
    Traceback (most recent call last):
        ...
    rotor_fmu.model.quantities.QuantityError: bearing[1].clearance = -1 m: must be > 0 and finite
    """
    if not isinstance(toml, str):
        raise InputError(f"{shown_value('toml', toml)}: must be the text of a machine's file")
    plain = si_text(toml)
    return Machine(parse_rotor(plain), plain)


def response(
    machine: Machine | Rotor | Path | str,
    *,
    speed: float | tuple[float, float],
    over: tuple[str, float, float] | None = None,
    parameters: Mapping[str, float | str] | None = None,
    loads: Mapping[str, float] | None = None,
    period: int = 1,
    harmonics: int = 60,
    share: float = 1e-4,
    stability: bool = True,
    step: float = 0.1,
    seeds: Sequence[float] = (),
    whirl: bool = False,
    start: "Solution | None" = None,
    branches: bool = False,
) -> "ResponseResult":
    """Compute periodic motions of a machine with its contacts, over its speed or a parameter.

    Parameters
    ----------
    machine : Machine, Path or str
        The machine, or its file.
    speed : tuple of float, or float
        Range of the speed, not through 0, or with `over` the one speed [rad/s]; negative where the
        machine turns the other way.
    over : tuple of str, float and float, optional
        Name of one of `machine.parameters` and its range, in SI units.
    parameters : mapping of str to float or str, optional
        Other values of the machine's parameters, in SI units or with their unit.
    loads : mapping of str to float, optional
        Constant forces on ports, such as `disc[2].fy` [N].
    period : int, optional
        Revolutions in a period, from 1 to 16.
    harmonics : int, optional
        Most harmonics of a motion.
    share : float, optional
        Amplitude of the highest harmonic over that of the motion, at most [1].
    stability : bool, optional
        Whether Floquet multipliers are computed.
    step : float, optional
        Longest step along the curve, by shooting as by harmonics: how far the contacts' Fourier
        series moves, in clearances, with the share of the range [1].
    seeds : sequence of float, optional
        Values of the varied quantity at which runs in time search for further branches.
    whirl : bool, optional
        Whether the machine runs without its unbalance, in a whirl of unknown frequency (dry whirl,
        oil whirl).
    start : Solution, optional
        A motion of `at` or `points` of an earlier result, from which alone branches are followed,
        with its own period.
    branches : bool, optional
        Whether branches that begin at period doublings and branch points are followed too; not with
        `whirl`.

    Returns
    -------
    ResponseResult
        Branches with their points, and bifurcations.

    Raises
    ------
    InputError
        For impossible or unknown values.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> curve = rf.response("examples/jeffcott_rub/jeffcott.toml", speed=(60, 240))
    >>> [(b.kind, round(b.value, 2)) for b in curve.bifurcations]
    [('fold', 202.21), ('grazing', 138.5)]
    """
    from ..linear.displayed import rotor_of
    from ..periodic.request import compute_response, response_request  # with SciPy

    rotor = rotor_of(machine.rotor if isinstance(machine, Machine) else machine)
    request = response_request(
        rotor,
        speed=speed,
        over=over,
        parameters=parameters,
        loads=loads,
        period=period,
        harmonics=harmonics,
        share=share,
        stability=stability,
        step=step,
        seeds=seeds,
        whirl=whirl,
        start=start,
        branches=branches,
    )
    warn_of_changes("parameters:", rotor, request.rotor, warn=_warn)
    warn_of_changes("over:", request.rotor, *request.ends(), warn=_warn)
    return compute_response(request)
