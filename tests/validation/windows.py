"""Stretches of the rig's run-down, each begun from one state by this project and by CVODE.

CVODE (SUNDIALS) solves the equations of `benchmarks.equations`, which share the matrices with this
project and nothing of its time integration.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.settings import Settings, choose
from rotor_fmu.model.simulation import Simulation
from sksundae.cvode import CVODE

from benchmarks import equations

SPEED, RATE = 400.0, -10.0  # of the run-down: [rad/s] at its start, [rad/s2]
SPEEDS_HZ = (60.0, 31.4, 27.5, 15.0)  # before, at and between the peaks, and far below them
DURATION, STOPS = 0.2, 41  # of a window [s]; points at which orbits are compared
STOP = 0.04  # between two of the run that leads to the windows [s]
ATOL = 1e-4  # displacements below it [m] are known to as much as it is, relative to it


def rig() -> Rotor:
    """The paper's rig."""
    return parse_rotor(rig_toml())


@dataclass(frozen=True)
class Window:
    """A stretch of the run-down: its beginning [s], and a simulation's snapshot and state there."""

    begin: float
    snapshot: np.ndarray
    machine: equations.Equations
    state: np.ndarray

    @property
    def times(self) -> np.ndarray:
        """Where orbits are compared, from the beginning of the window [s]."""
        return np.linspace(0.0, DURATION, STOPS)

    def reference(self, rtol: float, shift: float = 0.0) -> np.ndarray:
        """Orbit of the last disc [m] by CVODE; shift: of every displacement at the start [m]."""
        coefficients, size = self.machine.coefficients, self.machine.size

        def slope(t, state, out):
            equations.slope(t, state, out, coefficients)

        def jacobian(t, state, _, out):
            equations.jacobian(t, state, out, coefficients)

        atol = np.repeat([ATOL * rtol, 1e3 * ATOL * rtol], size)  # [m], [m/s]
        start = self.state + np.repeat([shift, 0.0], size)
        solver = CVODE(slope, jacfn=jacobian, rtol=rtol, atol=atol, max_num_steps=10**8)
        return self.machine.disc(solver.solve(self.times, start).y)

    def orbit(self, settings: Settings) -> tuple[np.ndarray, int]:
        """Orbit of the last disc [m] by this project, and the steps it took."""
        sim = Simulation(rig(), settings, t=self.begin, speed=SPEED + RATE * self.begin, rate=RATE)
        sim.restore(self.snapshot)
        sim._run.memory.record[0].h = settings.h  # a state brings its own wished length along
        before = sim.read("solver.steps")
        result = [_last_disc(sim)]
        for t in self.begin + self.times[1:]:
            sim.advance(t, SPEED + RATE * sim.time)
            result.append(_last_disc(sim))
        return np.array(result), int(sim.read("solver.steps") - before)


def _last_disc(sim: Simulation) -> complex:
    number = len(sim.rotor.discs)
    return complex(sim.read(f"disc[{number}].x"), sim.read(f"disc[{number}].y"))


def windows() -> Iterator[Window]:
    """The windows, from one run-down with steps of 0.1 ms that leads to them."""
    sim = Simulation(rig(), choose("robust", h=1e-4), speed=SPEED, rate=RATE)
    for hz in SPEEDS_HZ:
        begin = (SPEED - 2 * math.pi * hz) / -RATE
        for t in np.linspace(sim.time, begin, 1 + math.ceil((begin - sim.time) / STOP))[1:]:
            sim.advance(t, SPEED + RATE * sim.time)
        speed = SPEED + RATE * begin
        machine = equations.equations(sim.rotor, speed, RATE, sim.read("phi"))
        state = equations.real_state(sim.motion.q, sim.motion.v)
        yield Window(begin, sim.snapshot(), machine, state)
