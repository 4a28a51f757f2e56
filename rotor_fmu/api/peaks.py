"""Peaks of a run: where the displacements of its parts are largest over the speed."""

from collections.abc import Iterable
from typing import NamedTuple

from ..runs.peaks import peak_index, start_up, why_no_peak
from ..runs.run_down import Run


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

    def __new__(cls, peaks: Iterable[Peak], why: str = "") -> "Peaks":
        """Make the peaks, or none with the reason."""
        made = super().__new__(cls, peaks)
        made.why = why
        return made

    def __repr__(self) -> str:
        return super().__repr__() if self else f"no peaks: {self.why}"


def peaks_of(run: Run | None) -> Peaks:
    """Return the peaks of a run, None where it was read from its folder."""
    if run is None:
        return Peaks((), "the run was read from its folder, which does not hold its amplitudes")
    t, c = run.t, run.columns
    amplitudes = [name for name in c if name.endswith((".x_amp", ".y_amp"))]
    result = []
    for name in amplitudes:
        at = peak_index(t, c["w"], c[name])
        if at is not None:
            part, _, quantity = name.rpartition(".")
            values = float(c[name][at]), float(c["w"][at]), float(t[at])
            result.append(Peak(part, quantity[0], *values))
    if not amplitudes:
        return Peaks((), "the machine has no disc, body or sensor, whose motion could have a peak")
    late = t > start_up(t, c["w"])
    largest = max(float(c[name][late].max(initial=0.0)) for name in amplitudes)
    return Peaks(result, "" if result else why_no_peak(t, c["w"], run.status, largest))
