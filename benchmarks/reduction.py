"""What component modes cost in accuracy: python -m benchmarks.reduction

Disc 3 from the horizontal resonance on, 190 to 180 rad/s in a second at h = 0.1 ms: the largest
distance from the run with the whole shaft, over the number of modes kept.
"""

import numpy as np
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

MODES = (1, 2, 4, 6)


def orbit(modes):
    """Disc 3 every 10 ms, shape (100,) [m]."""
    settings = choose("robust", h=1e-4, reduction=modes)
    sim = Simulation(rig(), settings, speed=190.0, rate=-10.0)
    seen = []
    for i in range(100):
        sim.advance(0.01 * (i + 1), 190.0 - 0.1 * i)
        seen.append(complex(sim.read("disc[3].x"), sim.read("disc[3].y")))
    return np.array(seen)


def main():
    whole = orbit(0)
    print("| modes kept | largest distance [um] |\n| ---: | ---: |")
    for modes in MODES:
        print(f"| {modes} | {1e6 * np.abs(orbit(modes) - whole).max():.2g} |")


if __name__ == "__main__":
    main()
