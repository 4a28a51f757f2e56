"""What a response curve costs beside a study that steps through its speeds: python -m
benchmarks.response [harmonics ...]

Seconds of CPU; the second of two calls, the first of which compiles or loads the laws.
"""

import math
import sys
import time
from pathlib import Path

import numpy as np
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf

JEFFCOTT = Path(__file__).parents[1] / "examples" / "jeffcott_rub" / "jeffcott.toml"
TURNS = 30  # that each speed of the study is held


def stepped(machine: rf.Machine, low: float, high: float, count: int = 100) -> float:
    """CPU of speeds stepped up and down, each held for some turns."""
    before = time.process_time()
    speeds = np.linspace(low, high, count)
    run = Simulation(
        machine.rotor,
        choose(tolerance=1e-4),
        speed=low,
        continues_speed=False,
        warn=lambda message: None,
    )
    for speed in (*speeds, *speeds[::-1]):
        run.advance(run.time + TURNS * 2 * math.pi / speed, speed)
    return time.process_time() - before


def traced(machine: rf.Machine, low: float, high: float, harmonics: int) -> tuple[float, int, int]:
    """CPU of a curve with stability, its points, and the most harmonics that one has."""
    for _ in range(2):
        before = time.process_time()
        result = rf.response(machine, speed=(low, high), harmonics=harmonics)
        spent = time.process_time() - before
    return spent, len(result.points), max(p.orbit.H for p in result.points)


def main() -> None:
    """Print the table."""
    print(f"{'machine':12} {'speeds':>10} {'H <=':>5} {'points':>7} {'H':>4} {'CPU s':>7}")
    for name, machine, low, high, counts in (
        ("Jeffcott rub", rf.load(JEFFCOTT), 60.0, 240.0, [60]),
        ("rig", rf.load(), 100.0, 180.0, [int(a) for a in sys.argv[1:]] or [20, 40, 60]),
        ("rig", rf.load(), 100.0, 400.0, [60]),
    ):
        for harmonics in counts:
            spent, points, most = traced(machine, low, high, harmonics)
            row = f"{low:g}:{high:g}", harmonics, points, most
            print(f"{name:12} {row[0]:>10} {row[1]:5} {row[2]:7} {row[3]:4} {spent:7.2f}")
        spent = stepped(machine, low, high)
        print(f"{name:12} {f'{low:g}:{high:g}':>10} stepped both ways {spent:9.2f}")


if __name__ == "__main__":
    main()
