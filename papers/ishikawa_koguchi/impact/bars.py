"""Two elastic bars that meet end to end (paper B, section 3.1; Czekanski and Meguid 2001).

Both move towards each other at the same speed v, with an opening g between them. Along a bar it is
the wave equation: the ends that meet have the velocity v until t0 = g / (2 v), 0 for 2 L / c, the
time in which the wave runs to the far end and back, then -v.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.schemes.family import Scheme

from .plane import solid, to_band
from .stepping.contacts import FlatStops
from .stepping.failures import ImpactError
from .stepping.march import INCREMENT_CAP, Run, march
from .stepping.stepper import Instant
from .stepping.structure import Elastic

T_END = 0.04  # paper B's [s]
# Where the errors are taken, from the impact on [s]: all of it, the plateau, after the release.
WINDOWS = {"all": (0.0, 0.035), "plateau": (0.004, 0.018), "released": (0.024, 0.035)}
_SAMPLES = 20_001


@dataclass(frozen=True)
class Bars:
    """Geometry [m], material [Pa, 1, kg/m3], mesh of a bar, speed v [m/s] and opening g [m].

    is_lumped: diagonal mass matrices. penalty: stiffness of a node pair [N/m], None for a hard
    contact. (Paper B's UL, UF, UM are m, N, kg here.)
    """

    length: float = 10.0
    height: float = 1.0
    thickness: float = 1.0
    E: float = 1000.0
    nu: float = 0.0
    density: float = 0.001
    nx: int = 40
    ny: int = 4
    opening: float = 0.01
    speed: float = 1.0
    is_lumped: bool = True
    penalty: float | None = None

    def __post_init__(self) -> None:
        for name in ("length", "height", "speed"):
            value = getattr(self, name)
            if not 0 < value < math.inf:
                raise ImpactError(f"{name} = {value:g}: must be > 0 and finite")
        if not 0 <= self.opening < math.inf:
            raise ImpactError(f"opening = {self.opening:g} m: must be >= 0 and finite")
        if self.penalty is not None and not 0 < self.penalty < math.inf:
            raise ImpactError(f"penalty = {self.penalty:g} N/m: must be > 0 and finite")
        for name in ("nx", "ny"):
            if getattr(self, name) < 1:
                raise ImpactError(f"{name} = {getattr(self, name)} elements: must be at least 1")

    @property
    def wave_speed(self) -> float:
        """c = sqrt(E / density) [m/s], exact for nu = 0."""
        return math.sqrt(self.E / self.density)

    @property
    def t_impact(self) -> float:
        """t0 [s]."""
        return self.opening / (2 * self.speed)

    @property
    def t_release(self) -> float:
        """t0 + 2 L / c [s]."""
        return self.t_impact + 2 * self.length / self.wave_speed

    @property
    def contact_force(self) -> float:
        """Between the bars while they touch: density c v times the section [N]."""
        section = self.height * self.thickness
        return self.density * self.wave_speed * self.speed * section

    @property
    def energy(self) -> float:
        """Of both bars [J]."""
        mass = self.density * self.length * self.height * self.thickness
        return mass * self.speed**2

    def tip_velocity(self, t: np.ndarray) -> np.ndarray:
        """Velocity [m/s] of the left bar's end by the wave equation at times t [s]."""
        released = np.where(t < self.t_release, 0.0, -self.speed)
        return np.where(t < self.t_impact, self.speed, released)


def build(bars: Bars) -> tuple[Elastic, Instant, np.ndarray]:
    """The structure, its motion at t = 0, and the unknowns of the left bar's end along x.

    Raises `ImpactError` for bars that cannot be.
    """
    x = np.linspace(-bars.length, 0.0, bars.nx + 1)
    y = np.linspace(0.0, bars.height, bars.ny + 1)
    material = (bars.E, bars.nu, bars.density, bars.thickness)
    left = solid(x, y, *material, is_lumped=bars.is_lumped)
    right = solid(x + bars.length, y, *material, is_lumped=bars.is_lumped)
    half = 2 * len(left.points)
    ends = 2 * left.columns[-1], half + 2 * right.columns[0]
    B = np.zeros((2 * half, bars.ny + 1))
    for j, (of_left, of_right) in enumerate(zip(*ends, strict=True)):
        B[of_left, j], B[of_right, j] = -1.0, 1.0
    compliance = 0.0 if bars.penalty is None else 1 / bars.penalty
    contacts = FlatStops(B, np.full(bars.ny + 1, bars.opening), np.full(bars.ny + 1, compliance))
    mass = to_band([left.mass, right.mass])
    stiffness = to_band([left.stiffness, right.stiffness])
    structure = Elastic(mass, stiffness, np.zeros(2 * half), contacts, bars.energy)
    v = np.zeros(2 * half)
    v[:half:2], v[half::2] = bars.speed, -bars.speed
    q = np.zeros(2 * half)
    start = Instant(0.0, q, v, np.zeros_like(q), np.zeros_like(q), np.zeros(bars.ny + 1))
    return structure, start, ends[0]


@dataclass(frozen=True)
class BarsRun:
    """A run of the bars; run.seen has the columns tip velocity [m/s] (left bar, mean over its end),
    momentum of the left bar and of both [N s], opening (mean) [m]."""

    bars: Bars
    run: Run

    @property
    def t(self) -> np.ndarray:
        """Times [s], one an increment, the start first."""
        return self.run.t

    @property
    def tip_velocity(self) -> np.ndarray:
        """Of the left bar's end [m/s]."""
        return self.run.seen[:, 0]

    @property
    def contact_force(self) -> np.ndarray:
        """Between the bars [N]."""
        return self.run.force.sum(axis=1)

    @property
    def is_complete(self) -> bool:
        """Whether the run reached into all of `WINDOWS`."""
        return self.run.is_done and self.t[-1] > self.bars.t_impact + WINDOWS["released"][0]

    def rms_error(self, window: str = "all") -> float:
        """Root mean square of the tip velocity's error [m/s] in one of `WINDOWS`, over time, with
        straight lines between the increments."""
        t, velocity = self._within(window)
        return float(np.sqrt(np.mean((velocity - self.bars.tip_velocity(t)) ** 2)))

    @property
    def mean_after_release(self) -> float:
        """Mean tip velocity [m/s] after the release; -v is right."""
        return float(np.mean(self._within("released")[1]))

    def _within(self, window: str) -> tuple[np.ndarray, np.ndarray]:
        first, last = (self.bars.t_impact + part for part in WINDOWS[window])
        t = np.linspace(first, min(last, self.t[-1]), _SAMPLES)
        return t, np.interp(t, self.t, self.tip_velocity)

    @property
    def energy_change(self) -> float:
        """Energy at the end over that at the start, less one [1]."""
        return float(self.run.energy[-1] / self.run.energy[0] - 1)


def run_bars(
    bars: Bars,
    scheme: Scheme,
    dt: float,
    impact: str = "no",
    t_end: float = T_END,
    cap: int = INCREMENT_CAP,
    progress: Callable[[float], None] = lambda t: None,
) -> BarsRun:
    """Let the bars meet; dt, t_end [s]; see `march` for the rest and for what it raises."""
    structure, start, tip = build(bars)
    half = len(start.q) // 2
    B = structure.contacts.B

    def observe(motion: Instant) -> tuple[float, ...]:
        momentum = structure.inertia(motion.v)
        left, right = momentum[:half:2].sum(), momentum[half::2].sum()
        opening = structure.contacts.openings(B.T @ motion.q).mean()
        return motion.v[tip].mean(), left, left + right, opening

    run = march(structure, scheme, start, dt, t_end, impact, observe, cap, progress)
    return BarsRun(bars, run)
