"""What every program is given, what it gives back, and how far that is from the truth."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from scipy.interpolate import CubicSpline

from . import equations

SPEED, RATE = 400.0, -10.0  # of the rig's run-down [rad/s], [rad/s2]
PEAKS_AFTER = 2.0  # the start's transient is over by then [s]


@dataclass(frozen=True)
class Problem:
    """A rotor at rest in its bearings that turns at SPEED + RATE t: to `stop` [s], its last disc's
    orbit looked at every `sample` [s]."""

    name: str
    rotor: Rotor
    stop: float
    sample: float

    @property
    def times(self) -> np.ndarray:
        """Where orbits are compared [s]."""
        return np.linspace(0.0, self.stop, round(self.stop / self.sample) + 1)

    def machine(self, modes: int = 0) -> equations.Equations:
        """The equations for programs that are not this project's, of all of the shaft or of so many
        component modes."""
        return equations.equations(self.rotor, SPEED, RATE, modes=modes)

    def start(self, modes: int = 0) -> np.ndarray:
        """Their state at rest."""
        still = Simulation(self.rotor, choose(reduction=modes)).motion.q
        return equations.real_state(still, 0 * still)


@dataclass(frozen=True)
class Orbit:
    """What a program result: orbit of the last disc at the problem's times, shape (times,), complex
    [m]; steps; X = max |x| and Y = max |y - y at rest| after `PEAKS_AFTER` [m], None if too short.
    """

    disc: np.ndarray
    steps: int
    x_peak: float | None = None
    y_peak: float | None = None


class Diverged(RuntimeError):
    """A program that gave up, or whose orbit left the machine; says when."""


class Missing(RuntimeError):
    """A program that is not installed; says which and why."""


@dataclass(frozen=True)
class Method:
    """One program with one choice of its settings.

    program: its name; setting: as a table shows it; solve: runs it; only_short: whether it is too
    slow for the whole run-down; tolerance: that of this project's error control, if that is on.
    """

    program: str
    setting: str
    solve: Callable[[Problem], Orbit]
    only_short: bool = False
    tolerance: float | None = None

    @property
    def name(self) -> str:
        """Program and setting."""
        return f"{self.program}, {self.setting}"


def run_down() -> Problem:
    """The rig's run-down, 40 s from 400 rad/s to rest."""
    return Problem("run-down", _rig(), 40.0, 0.04)


def beginning() -> Problem:
    """Its first fifth of a second, with hard impacts, for programs too slow for the whole."""
    return Problem("beginning", _rig(), 0.2, 0.01)


def _rig() -> Rotor:
    return parse_rotor(rig_toml())


def peaks(times: np.ndarray, disc: np.ndarray) -> tuple[float | None, float | None]:
    """X and Y [m] of an orbit, shape (times,), that begins at rest."""
    if times[-1] <= PEAKS_AFTER:
        return None, None
    late = times > PEAKS_AFTER
    x, y = disc.real, disc.imag - disc[0].imag
    return _largest(times[late], x[late]), _largest(times[late], y[late])


def _largest(times: np.ndarray, values: np.ndarray) -> float:
    """Largest size, between the samples too: of a cubic spline about the largest of them."""
    spline = CubicSpline(times, values)
    size = np.abs(values)
    near = times[size > 0.97 * size.max()]
    step = (times[-1] - times[0]) / (len(times) - 1)
    around = near[:, None] + step * np.linspace(-1, 1, 41)
    return float(np.abs(spline(np.clip(around, times[0], times[-1]))).max())


def orbit(problem: Problem, times: np.ndarray, disc: np.ndarray, steps: int) -> Orbit:
    """An `Orbit` from finer samples, by a cubic spline where they miss the problem's times (as
    they do after a program has shortened a step by itself); raises `Diverged`."""
    bad = ~(np.abs(disc) < 0.1 * problem.rotor.length)
    if bad.any():
        raise Diverged(f"diverged at t = {times[np.argmax(bad)]:.3g} s")
    tolerance = 1e-6 * problem.sample
    if times[-1] < problem.stop - tolerance:
        raise Diverged(f"ended at t = {times[-1]:.3g} s")
    at = np.minimum(np.searchsorted(times, problem.times - tolerance), len(times) - 1)
    has_all = np.abs(times[at] - problem.times).max() <= tolerance
    on_grid = disc[at] if has_all else CubicSpline(times, disc)(problem.times)
    return Orbit(on_grid, steps, *peaks(times, disc))


def timed(call: Callable[..., Any], *arguments: Any) -> tuple[float, Any]:
    """CPU seconds of this process for one call, such as a run, and what it returned."""
    begun = time.process_time()
    result = call(*arguments)
    return time.process_time() - begun, result
