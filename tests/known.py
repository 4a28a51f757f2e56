"""The paper's rig and the examples, run by error control and by CVODE.

Of the rig the windows of `windows`; of the examples runs from their start, at a given speed. CVODE
takes equations written anew (`benchmarks.equations`, `parts.equations`). The condition of a run is
the largest change of its orbits over that of the start, a shift of the rotor sideways.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.machine_file.loading import machine_text

from .parts import dropped
from .parts.equations import Equations, solved
from .validation.windows import SPEEDS_HZ, Window, windows

EXAMPLES = Path(__file__).parents[1] / "examples"
SHIFT = 1e-8  # [m], of orbits of some 300 um
RTOL = 1e-8
RTOL_OF_EXAMPLES = 1e-7  # of these nothing knows the Jacobian


@dataclass(frozen=True)
class Run:
    """A machine at speed + rate t [rad/s] until `stop` [s]; what is looked at are its nodes where
    it may touch."""

    name: str
    rotor: Rotor
    speed: float
    rate: float
    stop: float

    @property
    def times(self) -> np.ndarray:
        """Two thousand a second [s]."""
        return np.linspace(0.0, self.stop, 1 + round(2000 * self.stop))

    def exact(self, shift: float = 0.0) -> np.ndarray:
        """CVODE's orbits of the nodes, complex of shape (times, contacts) [m]; shift: of the rotor
        at the start [m]."""
        equations = Equations(self.rotor, self.speed, self.rate)
        n, start = equations.size, self._simulation().motion
        q = start.q[:n].copy()
        q[: 2 * len(self.rotor.nodes) : 2] += shift
        y = solved(equations, q, start.v[:n], self.times, RTOL_OF_EXAMPLES)
        return self._at_contacts(y[:, :n] + 1j * y[:, n : 2 * n])

    def solve(self, settings: Settings) -> tuple[str, np.ndarray]:
        """Status and orbits of this project's run."""
        said: list[str] = []
        sim = self._simulation(settings, said=said)
        seen = []
        for t in self.times:
            sim.advance(t, self.speed + self.rate * sim.time)
            seen.append(sim.motion.q.copy())
        return said[-1] if said else "ok", self._at_contacts(np.array(seen))

    def _simulation(self, *settings: Settings, said: list[str] | None = None) -> Simulation:
        warn = (lambda message: None) if said is None else said.append
        return Simulation(self.rotor, *settings, speed=self.speed, rate=self.rate, warn=warn)

    def _at_contacts(self, q: np.ndarray) -> np.ndarray:
        nodes = [p.node for p in self.rotor.parts if hasattr(p, "clearance")]
        return q[:, [2 * (node - 1) for node in nodes]]


@dataclass(frozen=True)
class RigWindow:
    """A stretch of the rig's run-down; what is looked at is its last disc."""

    name: str
    window: Window

    def exact(self, shift: float = 0.0) -> np.ndarray:
        """CVODE's orbit [m]; shift: of everything at the start [m]."""
        return self.window.reference(RTOL, shift)

    def solve(self, settings: Settings) -> tuple[str, np.ndarray]:
        """Status and orbit of this project's run."""
        return "ok", self.window.orbit(settings)[0]


def condition(run: Run | RigWindow, exact: np.ndarray) -> float:
    """How many times a shift at the start the orbits change by; they are `exact` without it [1]."""
    return np.abs(run.exact(SHIFT) - exact).max() / SHIFT


def rig_windows() -> Iterator[RigWindow]:
    """The paper's rig before, at, between and far below its peaks."""
    for hz, window in zip(SPEEDS_HZ, windows(), strict=True):
        yield RigWindow(f"rig at {hz:g} Hz", window)


def examples() -> Iterator[Run]:
    """The examples: a rub, a run-up into seals, drops from the air into touchdown bearings."""
    in_the_air = "\n[start]\ny = 0.0\n"

    def read(file: str, more: str = "") -> Rotor:
        return parse_rotor(machine_text("file", EXAMPLES / file) + more)

    yield Run("jeffcott_rub", read("jeffcott_rub/jeffcott.toml"), 120.0, 0.0, 0.3)
    yield Run("from_ross", read("from_ross/rubbing.toml"), 335.0, 12.0, 1.0)
    yield Run("drop", read("drop/compressor.toml"), 1000.0, 0.0, 0.4)
    yield Run("drop with a seal", dropped.machine(), dropped.SPEED, dropped.RATE, dropped.STOP)
    off = read("magnetic_bearing/compressor.toml", in_the_air)
    yield Run("magnetic_bearing, off", off, 600.0, 0.0, 0.4)
