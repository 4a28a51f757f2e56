"""What a rotor in oil films costs, a step and its linear answers: python -m benchmarks.films

The rig's shaft at 150 rad/s in two journal bearings in the place of its clearances, over elements
and pads of each, beside the rig itself. CPU time of a step at a tolerance of 1e-3, the median of
three runs of a second; of a Campbell diagram and a response to unbalance at `SPEEDS`, on pads that
stand and that tilt, the median of three.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import math
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from rotor_fmu.model.linear import campbell, unbalance_response
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

SPEED = 150.0  # rad/s
SETTLED, SECONDS = 0.2, 1.0  # s
ELEMENTS = (16, 32, 64, 128)
SPEEDS = np.linspace(20.0, 400.0, 25)  # rad/s
PADS: dict[str, dict[str, Any]] = {
    "plain": {},
    "two pads": {"pads": (0.5 * math.pi, 1.5 * math.pi), "arc": math.pi - 0.35},
    "four pads": {"pads": tuple((0.5 + i / 2) * math.pi for i in range(4)), "arc": 1.3},
}


def in_films(**values: Any) -> Rotor:
    """The rig's shaft in two such films."""
    given = {"journal_radius": 0.02, "length": 0.02, "clearance": 1e-4, "viscosity": 0.05, **values}
    films = [JournalBearing(node=bearing.node, **given) for bearing in rig().bearings]
    return rig().with_parts(Bearing).with_parts(JournalBearing, *films)


def step_cost(rotor: Rotor) -> float:
    """CPU time of a step [us]."""
    costs = []
    for _ in range(3):
        run = Simulation(rotor, choose(tolerance=1e-3), speed=SPEED, warn=lambda message: None)
        run.advance(SETTLED, SPEED)
        steps, began = run.read("solver.steps"), time.process_time()
        run.advance(SETTLED + SECONDS, SPEED)
        cpu = time.process_time() - began
        costs.append(1e6 * cpu / (run.read("solver.steps") - steps))
    return statistics.median(costs)


def cost_of(analyse: Callable[[Rotor, np.ndarray], object], rotor: Rotor) -> float:
    """CPU time of a linear answer at all `SPEEDS` [s]."""
    costs = []
    for _ in range(3):
        began = time.process_time()
        analyse(rotor, SPEEDS)
        costs.append(time.process_time() - began)
    return statistics.median(costs)


def main() -> None:
    """Print the tables."""
    print("bearings", *(f"{count} elements" for count in ELEMENTS), sep=" | ")
    for name, shape in PADS.items():
        costs = (step_cost(in_films(points=float(count), **shape)) for count in ELEMENTS)
        print(name, *(f"{us:.1f} us" for us in costs), sep=" | ", flush=True)
    print(f"short, in closed form: {step_cost(in_films(short=True)):.1f} us")
    print(f"the rig in its clearances: {step_cost(rig()):.1f} us")
    four = PADS["four pads"]
    tilting = {**four, "preload": 0.3, "tilting": True, "pivot_stiffness": 1e9}
    for name, shape in (("plain", {}), ("four pads", four), ("four that tilt", tilting)):
        rotor = in_films(**shape)
        curve, response = cost_of(campbell, rotor), cost_of(unbalance_response, rotor)
        print(f"{name}: Campbell diagram {curve:.2f} s, response to unbalance {response:.2f} s")


if __name__ == "__main__":
    main()
