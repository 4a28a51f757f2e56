"""Twenty run-downs that differ by a hundred-thousandth of a radian in the unbalance's phase."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from .problem import PEAKS_AFTER, RATE, SPEED, run_down
from .store import Store

RUNS = 20
PHASE = 1e-5  # standard deviation [rad]
TOLERANCE = 1e-4


def scatter(store: Store, is_quick: bool, report: Callable[[str, float], None]) -> None:
    """Fill the section `scatter`: X and Y [m], and steps in the false state, of every run."""
    phases = np.random.default_rng(2003).normal(0.0, PHASE, (RUNS, 3))
    problem = run_down()
    if is_quick:
        problem = replace(problem, stop=4.0)
        phases = phases[:3]
    for number, phase in enumerate(phases):
        if str(number) in store.section("scatter"):
            continue
        report("scatter of twenty runs", number / len(phases))
        rotor = problem.rotor
        for i, angle in enumerate(phase, 1):
            rotor = rotor.with_value(f"disc[{i}].phase", float(angle))
        simulation = Simulation(
            rotor, choose(tolerance=TOLERANCE), speed=SPEED, rate=RATE, warn=lambda message: None
        )
        disc = f"disc[{len(rotor.discs)}]"
        x_peak = y_peak = 0.0
        for t in problem.times[1:]:
            simulation.advance(t, SPEED + RATE * simulation.time)
            if t > PEAKS_AFTER:
                x_peak = max(x_peak, simulation.read(f"{disc}.x_amp"))
                y_peak = max(y_peak, simulation.read(f"{disc}.y_amp"))
        row = {"x_peak": x_peak, "y_peak": y_peak, "trapped": simulation.read("solver.trapped")}
        store.keep("scatter", str(number), row)
