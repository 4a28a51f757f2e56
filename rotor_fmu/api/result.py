"""The result of a run: signals with units, evaluations, tables and pictures."""

from __future__ import annotations

import base64
import difflib
import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import InputError, optional
from ..model.machine.toml import parse_rotor
from ..model.quantities import QuantityError
from ..report.measuring_points import Recorded
from ..runs.recording import Recording, load_recording
from ..runs.run_down import Run
from ..runs.summary import PEAKS_AFTER
from ..runs.views import peak_index, why_no_peak
from .machine import Machine
from .pictures import png, shown

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    import xarray as xr
    from matplotlib.figure import Figure

    from ..vibration import FullSpectrum, Orbit, OrderTrack


class Peak(NamedTuple):
    """A peak of a displacement over the speed.

    Attributes
    ----------
    part : str
        Name of the part.
    axis : str
        `x` or `y`.
    amplitude : float
        Amplitude 0-p from rest [m].
    speed : float
        Speed of rotation [rad/s].
    t : float
        Time [s].

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> run = rf.simulate(rf.load(), speed=([0, 7], [220, 150]), tolerance=1e-2)
    >>> peak = next(peak for peak in run.peaks if peak.axis == "x")
    >>> f"{peak.part}: about {round(1e6 * peak.amplitude, -2):.0f} µm at {peak.speed:.2g} rad/s"
    'disc[1]: about 400 µm at 1.7e+02 rad/s'
    """

    part: str
    axis: str
    amplitude: float
    speed: float
    t: float


class Peaks(tuple[Peak, ...]):
    """The peaks of a run; where there is none, `why` says why, and so does printing it."""

    why: str

    def __new__(cls, peaks: Iterable[Peak], why: str = "") -> Peaks:
        """Make the peaks, or none with the reason."""
        made = super().__new__(cls, peaks)
        made.why = why
        return made

    def __repr__(self) -> str:
        return super().__repr__() if self else f"no peaks: {self.why}"


@dataclass(frozen=True, repr=False)
class Result:
    """Signals of a run by name, at the solver's own steps.

    Attributes
    ----------
    recording : Recording
        The signals, with their units and a description of the run.
    points : Run or None
        The run at its communication points, with everything that the model computes; None of a run
        that was read from its folder.
    machine : Machine or None
        The machine; None where the folder does not hold it.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> result = rf.simulate(rf.load(), speed=185.0, stop=0.5, record=["disc[3].x", "disc[3].y"])
    >>> result["disc[3].x"].shape == result.t.shape
    True
    >>> result.units
    {'phi': 'rad', 'w': 'rad/s', 'disc[3].x': 'm', 'disc[3].y': 'm'}
    >>> round(float(result.orders(orders=[1.0]).speed[-1]))
    185
    """

    recording: Recording
    points: Run | None = None
    machine: Machine | None = field(default=None)

    @property
    def t(self) -> np.ndarray:
        """Times of the rows.

        Returns
        -------
        numpy.ndarray
            Times [s], shape (n,).
        """
        return self.recording.t

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the recorded signals.

        Returns
        -------
        tuple of str
            The names, in their order.
        """
        return tuple(self.recording.columns)

    @property
    def units(self) -> dict[str, str]:
        """Units of the recorded signals.

        Returns
        -------
        dict of str to str
            Unit by name.
        """
        return {name: self.recording.units[name] for name in self.names}

    @property
    def speed(self) -> np.ndarray:
        """Speed of rotation.

        Returns
        -------
        numpy.ndarray
            Speeds [rad/s], shape (n,).
        """
        return self.recording.columns["w"]

    @property
    def status(self) -> str:
        """Status of the run.

        Returns
        -------
        str
            `ok`, `doubtful` and the codes of its warnings, or `failed` and the reason.
        """
        return str(self.recording.about.get("status", "ok"))

    @property
    def messages(self) -> tuple[str, ...]:
        """Messages of the solver.

        Returns
        -------
        tuple of str
            The messages, in their order.
        """
        return tuple(self.recording.about.get("messages", ()))

    @property
    def codes(self) -> tuple[str, ...]:
        """Codes of the messages, for programs.

        Returns
        -------
        tuple of str
            Of each of `messages` its code, such as `overdamped`; empty where it has none.
        """
        return tuple(self.recording.about.get("codes", ()))

    @property
    def verification(self) -> dict[str, Any] | None:
        """Comparison with the same run, solved more finely.

        Returns
        -------
        dict or None
            Its `conclusion` (`confirmed`; `sensitive` where the amplitudes agree and the places at
            the end do not; `not confirmed`), and `peaks` and `final` of both runs; None where it
            was not asked for.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> run = rf.simulate(rf.load(), speed=185.0, stop=0.2, verify=True)
        >>> run.verification["conclusion"], run.verification["finer"]
        ('confirmed', {'solver.tolerance': 0.0001})
        """
        return self.recording.about.get("verification")

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a signal by its name.

        Parameters
        ----------
        name : str
            One of `names`.

        Returns
        -------
        numpy.ndarray
            The signal in SI units, shape (n,).

        Raises
        ------
        KeyError
            If it was not recorded; the message gives the nearest name.
        """
        if name not in self.recording.columns:
            near = difflib.get_close_matches(name, self.names, 1, 0.0)[0]
            raise KeyError(f"{name!r} was not recorded; the nearest name is {near}")
        return self.recording.columns[name]

    def dataframe(self) -> pd.DataFrame:
        """Return the signals as a table over the time.

        Returns
        -------
        pandas.DataFrame
            A column a signal, indexed by the time [s]; the units are in its `attrs`.

        Raises
        ------
        InputError
            If pandas is not installed.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> table = rf.simulate(rf.load(), speed=100.0, stop=0.1).dataframe()
        >>> table.index.name, table.attrs["units"]["disc[1].x"]
        ('t', 'm')
        """
        pd = optional("pandas", "study", "dataframe")
        table = pd.DataFrame(dict(self.recording.columns), pd.Index(self.t, name="t"))
        table.attrs["units"] = {"t": "s", **self.units}
        return table

    def dataset(self) -> xr.Dataset:
        """Return the signals as variables over the time.

        Returns
        -------
        xarray.Dataset
            A variable a signal, each with its unit, and a description of the run in `attrs`.

        Raises
        ------
        InputError
            If xarray is not installed.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> data = rf.simulate(rf.load(), speed=100.0, stop=0.1).dataset()
        >>> data["disc[1].x"].attrs["units"], data.attrs["machine"]
        ('m', 'zigulic2003')
        """
        xr = optional("xarray", "study", "dataset")
        variables = {
            name: ("t", column, {"units": self.units[name]})
            for name, column in self.recording.columns.items()
        }
        about = {k: v for k, v in self.recording.about.items() if isinstance(v, (str, float, int))}
        return xr.Dataset(variables, {"t": ("t", self.t, {"units": "s"})}, about)

    @cached_property
    def peaks(self) -> Peaks:
        """Peaks over the speed of every part whose amplitude is recorded, after the start-up of 2
        s.

        An amplitude that is largest at an edge of the run has no peak.

        Returns
        -------
        Peaks
            A tuple of `Peak`; where it is empty, printing it, or its attribute `why`, gives the
            reason.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> run = rf.simulate(rf.load(), speed=([0, 12], [220, 150]), tolerance=1e-2)
        >>> [(p.part, p.axis, round(p.speed, -1)) for p in run.peaks][-2:]
        [('disc[3]', 'x', 170.0), ('disc[3]', 'y', 200.0)]
        >>> rf.simulate(rf.load(), speed=([0, 1], [220, 200]), tolerance=1e-2).peaks
        no peaks: the run ends within the start-up, 2 s
        """
        if self.points is None:
            return Peaks((), "the run was read from its folder, which does not hold its amplitudes")
        t, c = self.points.t, self.points.columns
        amplitudes = [name for name in c if name.endswith((".x_amp", ".y_amp"))]
        result = []
        for name in amplitudes:
            at = peak_index(t, c["w"], c[name], PEAKS_AFTER)
            if at is not None:
                part, _, quantity = name.rpartition(".")
                values = float(c[name][at]), float(c["w"][at]), float(t[at])
                result.append(Peak(part, quantity[0], *values))
        if not amplitudes:
            return Peaks(
                (), "the machine has no disc, body or sensor, whose motion could have a peak"
            )
        return Peaks(result, "" if result else why_no_peak(t, c["w"], PEAKS_AFTER))

    def orbit(self, place: str | None = None, speed: float | None = None, turns: int = 4) -> Orbit:
        """Return the orbit of a part over consecutive turns.

        Parameters
        ----------
        place : str, optional
            Name of the part. By default the disc that moves most.
        speed : float, optional
            Speed [rad/s] to which the turns are nearest. By default the last.
        turns : int
            Number of turns.

        Returns
        -------
        Orbit
            The path [m] and the speed [rad/s].

        Raises
        ------
        TooFewTurns, TooFewRows
            If the recording is too short or too coarse.
        """
        from .. import vibration

        last = float(self.speed[-1])
        return vibration.orbit(*self._signal(place), last if speed is None else speed, turns=turns)

    def spectrum(
        self, place: str | None = None, speed: float | None = None, turns: int = 16
    ) -> FullSpectrum:
        """Return the full spectrum of a part: amplitudes of its forward and backward orders.

        Parameters
        ----------
        place : str, optional
            Name of the part. By default the disc that moves most.
        speed : float, optional
            Speed [rad/s] to which the turns are nearest. By default the last.
        turns : int
            Number of turns; the resolution is 1 / turns orders.

        Returns
        -------
        FullSpectrum
            Amplitudes 0-p [m] over signed orders [1].

        Raises
        ------
        TooFewTurns
            If the recording is too short.
        """
        from .. import vibration

        last = float(self.speed[-1])
        at = last if speed is None else speed
        return vibration.full_spectrum(*self._signal(place), at, turns=turns)

    def orders(
        self, place: str | None = None, orders: Sequence[float] = (0.5, 1.0, 2.0), turns: int = 4
    ) -> OrderTrack:
        """Return the vectors of orders of a part through the run.

        Parameters
        ----------
        place : str, optional
            Name of the part. By default the disc that moves most.
        orders : sequence of float
            Multiples of the speed of rotation [1].
        turns : int
            Number of turns of a block.

        Returns
        -------
        OrderTrack
            Complex amplitudes 0-p [m], a row a turn.

        Raises
        ------
        TooFewTurns, TooFewRows
            If the recording is too short or too coarse.
        ValueError
            If a block cannot hold an order.
        """
        from .. import vibration

        return vibration.order_track(*self._signal(place), orders, turns=turns)

    def plot(
        self,
        kind: str = "bode",
        place: str | None = None,
        speed: float | None = None,
        *,
        is_pp: bool = False,
    ) -> Figure:
        """Draw the run as `rotor-fmu plot` does.

        Parameters
        ----------
        kind : str
            `bode`, `polar`, `orbit`, `cascade`, `poincare`, `contact-angle`, `contact-force`,
            `energy`, `spectrum` or `whirl`.
        place : str, optional
            Name of the part. By default the disc that moves most.
        speed : float, optional
            Speed of an orbit or a spectrum [rad/s]. By default the last.
        is_pp : bool
            Whether amplitudes are peak-to-peak rather than 0-p.

        Returns
        -------
        matplotlib.figure.Figure
            The picture.

        Raises
        ------
        InputError
            If there is no such kind of picture.
        """
        from ..report.signal_plots import KINDS
        from ..report.view import View

        if kind not in KINDS:
            raise InputError(f"kind = {kind!r}: must be one of {', '.join(KINDS)}")
        return shown(KINDS[kind](View(self._seen, place, speed, is_pp)))

    def save(self, folder: Path | str) -> Path:
        """Write `recording.npz` into a folder, for `read_run`, `rotor-fmu plot` and reports.

        Parameters
        ----------
        folder : Path or str
            The folder; it is made if need be.

        Returns
        -------
        Path
            The file written.
        """
        path = Path(folder) / "recording.npz"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.recording.save(path)
        return path

    @cached_property
    def _seen(self) -> Recorded:
        return Recorded(self.recording, str(self.recording.about.get("machine", "run")))

    def _signal(self, place: str | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.t, self._seen.phi, self._seen.place(place).z

    def _facts(self) -> dict[str, str]:
        machine = str(self.recording.about.get("machine", "-"))
        facts = {"machine": machine, "status": self.status}
        if len(self.t):
            first, last = self.speed[0], self.speed[-1]
            facts["time"] = f"{self.t[0]:g} to {self.t[-1]:g} s, {len(self.t)} rows"
            facts["speed"] = f"{first:.4g} to {last:.4g} rad/s"
        if not self.peaks:
            facts["peaks"] = f"none: {self.peaks.why}"
        for p in self.peaks[-2:]:
            facts[f"peak of {p.part}.{p.axis}"] = (
                f"{p.amplitude * 1e6:.4g} µm at {p.speed:.4g} rad/s"
            )
        return facts

    def __repr__(self) -> str:
        return f"Result({'; '.join(f'{key}: {fact}' for key, fact in self._facts().items())})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(key)}</th><td>{html.escape(fact)}</td></tr>"
            for key, fact in self._facts().items()
        )
        return f"<table>{rows}</table>{self._picture()}"

    def _picture(self) -> str:
        from ..runs.run_plots import motion
        from ..runs.views import place_of

        if len(self.t) < 3 or place_of(self.recording.columns) is None:
            return ""
        image = base64.b64encode(png(motion(self.recording, ""))).decode()
        return f'<img src="data:image/png;base64,{image}" alt="displacement over time">'


def read_run(folder: Path | str) -> Result:
    """Read a run from the folder that `rotor-fmu run-down` or `Result.save` left.

    Parameters
    ----------
    folder : Path or str
        The folder, or the recording in it.

    Returns
    -------
    Result
        The run.

    Raises
    ------
    InputError
        If there is no recording, or it cannot be read.

    Examples
    --------
    >>> import tempfile, rotor_fmu as rf
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = rf.simulate(rf.load(), speed=100.0, stop=0.1).save(folder)
    ...     rf.read_run(folder).machine.name
    'zigulic2003'
    """
    path = Path(folder)
    recording = load_recording(path / "recording.npz" if path.is_dir() else path)
    toml = str(recording.about.get("toml", ""))
    try:
        machine = Machine(parse_rotor(toml), toml)
    except QuantityError:
        return Result(recording)
    return Result(recording, machine=machine)
