"""This project: fixed steps, adaptive ones, and error-controlled ones."""

from functools import partial

import numpy as np
from rotor_fmu.model import settings
from rotor_fmu.model.settings import Settings, choose
from rotor_fmu.model.simulation import Simulation, StepFailure

from ..problem import PEAKS_AFTER, RATE, SPEED, Diverged, Method, Orbit, Problem

PROGRAM = "this project"
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def methods() -> list[Method]:
    """The error-controlled mode and radau5 at their tolerances, the other presets, and small fixed
    steps."""
    controlled = [
        Method(PROGRAM, f"tolerance = {t:g}", partial(solve, choose(tolerance=t)), tolerance=t)
        for t in TOLERANCES
    ]
    chosen = {
        f"radau5, tolerance = {t:g}": choose(tolerance=t, method="radau5") for t in TOLERANCES
    }
    chosen |= {name: choose(name) for name in settings.PRESETS if name != settings.DEFAULT_PRESET}
    chosen |= {f"robust, h = {h:g} s": choose("robust", h=h) for h in (1e-4,)}
    chosen |= {f"moderate, h = {h:g} s": choose("moderate", h=h) for h in (2.5e-4, 1e-4, 5e-5)}
    return controlled + [method(name, choice) for name, choice in chosen.items()]


def method(name: str, choice: Settings) -> Method:
    """One choice of settings under a name."""
    return Method(PROGRAM, name, partial(solve, choice))


def solve(choice: Settings, problem: Problem) -> Orbit:
    """March through the problem as the FMU does, one communication step a sample."""
    number = len(problem.rotor.discs)
    simulation = Simulation(
        problem.rotor, choice, speed=SPEED, rate=RATE, warn=lambda message: None
    )
    at = [simulation.names.index(f"disc[{number}].{what}") for what in ("x", "y", "x_amp", "y_amp")]
    rows = np.empty((len(problem.times), 4))
    rows[0] = simulation.observed[at]
    try:
        for i, t in enumerate(problem.times[1:], 1):
            simulation.advance(t, SPEED + RATE * simulation.time)
            rows[i] = simulation.observed[at]
    except StepFailure as error:
        raise Diverged(str(error)) from error
    steps = int(simulation.read("solver.steps"))
    disc = rows[:, 0] + 1j * rows[:, 1]
    late = rows[problem.times > PEAKS_AFTER]
    return Orbit(disc, steps, *late[:, 2:].max(axis=0)) if len(late) else Orbit(disc, steps)
