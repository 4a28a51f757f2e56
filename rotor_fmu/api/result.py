"""The result of a run: its recorded signals, their evaluation, and pictures."""

import base64
import html
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..display import Display, current, in_its_units
from ..errors import check_one_of, path_of, switch
from ..plotting.notebook import png, shown
from ..runs import check_options
from ..runs.measuring_points import bearings_of, last_of_the_largest
from ..runs.recording import RECORDING, load_recording
from ..runs.run_down import Run
from .machine import Machine
from .peaks import Peaks, peaks_of
from .recorded_signals import RecordedSignals

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..vibration import FullSpectrum, Orbit, OrderTrack


@dataclass(frozen=True, repr=False)
class Result(RecordedSignals):
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

    points: Run | None = None
    machine: Machine | None = field(default=None)

    @cached_property
    def peaks(self) -> Peaks:
        """Peaks over the speed of every part whose amplitude is recorded, after the start-up: the
        time of 125 turns at the run's highest speed, but at most a fifth of the run.

        An amplitude that is largest at an edge of the run has no peak. Where there is none,
        printing the peaks, or their attribute `why`, gives the reason.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> run = rf.simulate(rf.load(), speed=([0, 12], [220, 150]), tolerance=1e-2)
        >>> [(p.part, p.axis, round(p.speed, -1)) for p in run.peaks][-2:]
        [('disc[3]', 'x', 170.0), ('disc[3]', 'y', 200.0)]
        >>> rf.simulate(rf.load(), speed=([0, 1], [220, 220]), tolerance=1e-2).peaks
        no peaks: the speed is constant
        """
        return peaks_of(self.points)

    def orbit(
        self, place: str | None = None, speed: float | None = None, turns: int = 4
    ) -> "Orbit":
        """Return the orbit of a part over consecutive turns.

        Parameters
        ----------
        place : str, optional
            Name of the part. By default the one that moves most.
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

        return vibration.orbit(*self._signal(place), self._or_last(speed), turns=turns)

    def spectrum(
        self, place: str | None = None, speed: float | None = None, turns: int = 16
    ) -> "FullSpectrum":
        """Return the full spectrum of a part: amplitudes of its forward and backward orders.

        Parameters
        ----------
        place : str, optional
            Name of the part. By default the one that moves most.
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

        return vibration.full_spectrum(*self._signal(place), self._or_last(speed), turns=turns)

    def orders(
        self, place: str | None = None, orders: Sequence[float] = (0.5, 1.0, 2.0), turns: int = 4
    ) -> "OrderTrack":
        """Return the vectors of orders of a part through the run.

        Parameters
        ----------
        place : str, optional
            Name of the part. By default the one that moves most.
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

    @in_its_units
    def plot(
        self,
        kind: str = "bode",
        place: str | None = None,
        speed: float | None = None,
        *,
        is_pp: bool = False,
    ) -> "Figure":
        """Draw the run as `rotor-fmu plot` does.

        Parameters
        ----------
        kind : str
            `bode`, `polar`, `orbit`, `cascade`, `poincare`, `contact-angle`, `contact-force`,
            `energy`, `spectrum`, `whirl` or `centerline`.
        place : str, optional
            Name of the part. By default the one that moves most, or is pressed most.
        speed : float, optional
            Speed of an orbit or a spectrum [rad/s]. By default that of the largest 1x
            after the start-up.
        is_pp : bool
            Whether amplitudes are peak-to-peak rather than 0-p.

        Returns
        -------
        matplotlib.figure.Figure
            The picture.

        Raises
        ------
        InputError
            If there is no such kind of picture, nor such a place, or the run never had such a
            speed, or an argument does not change this kind.
        """
        from ..run_pictures.signal_plots import KINDS
        from ..run_pictures.view import View

        check_one_of(f"kind = {kind!r}", kind, KINDS)
        check_options(kind, place=place, speed=speed, is_pp=switch("is_pp", is_pp))
        return shown(KINDS[kind](View(self.recording, place, speed, is_pp)))

    def _signal(self, place: str | None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return self.t, self.recording.phi, self.recording.place(place).z

    @property
    def shown_units(self) -> str:
        """The units that pictures show, of the machine's file if the recording holds it."""
        return self.recording.shown_units

    def _or_last(self, speed: float | None) -> float:
        return float(self.speed[-1]) if speed is None else speed

    @in_its_units
    def _facts(self) -> dict[str, str]:
        d, per, unit = current(), 1.0, "rad/s"
        if d != Display():  # else in SI units, as the signals are
            per, unit = d.speed, d.speed_unit
        machine = str(self.recording.about.get("machine", "-"))
        facts = {"machine": machine, "status": self.status}
        if len(self.t):
            first, last = self.speed[0], self.speed[-1]
            facts["time"] = f"{self.t[0]:g} to {self.t[-1]:g} s, {len(self.t)} rows"
            facts["speed"] = f"{per * first:.4g} to {per * last:.4g} {unit}"
        if not self.peaks:
            facts["peaks"] = f"none: {self.peaks.why}"
        bearings = bearings_of(self.recording.rotor)
        sizes = [(p.amplitude, p.part in bearings) for p in self.peaks]
        part = self.peaks[last_of_the_largest(sizes)].part if sizes else None
        for p in (p for p in self.peaks if p.part == part):
            size = f"{p.amplitude * d.small:.4g} {d.small_unit}"
            facts[f"peak of {p.part}.{p.axis}"] = f"{size} at {per * p.speed:.4g} {unit}"
        return facts

    def __repr__(self) -> str:
        return f"Result({'; '.join(f'{key}: {fact}' for key, fact in self._facts().items())})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(key)}</th><td>{html.escape(fact)}</td></tr>"
            for key, fact in self._facts().items()
        )
        return f"<table>{rows}</table>{self._picture()}"

    @in_its_units
    def _picture(self) -> str:
        from ..run_pictures.run_folder import motion

        place = self.recording.probe
        if len(self.t) < 3 or place is None:
            return ""
        image = base64.b64encode(png(motion(self.recording, place, ""))).decode()
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
    file = path_of("folder", folder)
    recording = load_recording(file / RECORDING if file.is_dir() else file)
    rotor = recording.rotor
    machine = None if rotor is None else Machine(rotor, str(recording.about["toml"]))
    return Result(recording, machine=machine)
