"""What a third order would give: `python -m benchmarks.order`.

The cheapest third order that there is, and one without loss of damping: the run-down with steps h
and h / 2, extrapolated by Richardson from its values at the same times, for the cost of both. No
step that is made of such steps can be better than this. Beside it error control at its default;
the truth is error control at 1e-6.
"""

import time
from dataclasses import replace

import numpy as np
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import Settings, choose
from rotor_fmu.model.simulation import Simulation

STOP, EVERY = 40.0, 4e-3
SPEED, RATE = 400.0, -10.0


def orbit(settings: Settings) -> tuple[np.ndarray, float]:
    """The last disc's path at every 4 ms [m], and the CPU time that it took [s]."""
    run = Simulation(rig(), settings, speed=SPEED, rate=RATE)
    x, y = (run.names.index(f"disc[3].{axis}") for axis in "xy")
    path = np.empty(round(STOP / EVERY) + 1, complex)
    path[0] = complex(run.observed[x], run.observed[y])
    begun = time.process_time()
    for n in range(1, len(path)):
        run.advance(n * EVERY, SPEED + RATE * (n - 1) * EVERY)
        path[n] = complex(run.observed[x], run.observed[y])
    return path, time.process_time() - begun


def main() -> None:
    """Print the table."""
    orbit(choose("controlled", tolerance=1e-2))  # compiles
    truth, _ = orbit(choose("controlled", tolerance=1e-6))

    def show(name: str, path: np.ndarray, seconds: float) -> None:
        error = np.abs(path - truth) * 1e6
        rms = np.sqrt((error**2).mean())
        print(f"{name:38s} {error.max():8.3f} um  rms {rms:7.3f} um  {seconds:5.2f} s", flush=True)

    show("error control, 1e-3", *orbit(choose("controlled", tolerance=1e-3)))
    fitted = choose("controlled")
    schemes = {
        "spectral radius 0.2": lambda h: choose("robust", h=h),
        "spectral radius 0.3, fitted": lambda h: replace(fitted, mode="fixed", h=h),
    }
    for scheme, settings in schemes.items():
        print(scheme)
        before = None
        for h in (1e-3, 5e-4, 2.5e-4, 1.25e-4):
            path, seconds = orbit(settings(h))
            show(f"  h = {h * 1e3:g} ms", path, seconds)
            if before is not None:
                coarse, its_seconds = before
                third = (4.0 * path - coarse) / 3.0
                show(
                    f"  extrapolated from {2e3 * h:g} and {h * 1e3:g} ms",
                    third,
                    seconds + its_seconds,
                )
            before = path, seconds


if __name__ == "__main__":
    main()
