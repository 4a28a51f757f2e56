"""What a step costs of a rotor in oil films: python -m benchmarks.films

The rig's shaft at 150 rad/s in two journal bearings in the place of its clearances, over elements
and pads of each, beside the rig itself. CPU time of a step at a tolerance of 1e-3, the median of
three runs of a second.
"""

from __future__ import annotations

import os

os.environ["OMP_NUM_THREADS"] = "1"

import math
import statistics
import time
from typing import Any

from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

SPEED = 150.0  # rad/s
SETTLED, SECONDS = 0.2, 1.0  # s
ELEMENTS = (16, 32, 64, 128)
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


def main() -> None:
    """Print the table."""
    print("bearings", *(f"{count} elements" for count in ELEMENTS), sep=" | ")
    for name, shape in PADS.items():
        costs = (step_cost(in_films(points=float(count), **shape)) for count in ELEMENTS)
        print(name, *(f"{us:.1f} us" for us in costs), sep=" | ", flush=True)
    print(f"short, in closed form: {step_cost(in_films(short=True)):.1f} us")
    print(f"the rig in its clearances: {step_cost(rig()):.1f} us")


if __name__ == "__main__":
    main()
