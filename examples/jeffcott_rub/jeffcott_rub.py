"""The rub of this folder's Jeffcott rotor over the speed, up and down: response.png.

python jeffcott_rub.py [FOLDER for the picture]

Lengths in clearances, speeds in the natural frequency, as the closed form has them.
"""

import math
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save

HERE = Path(__file__).resolve().parent
OMEGA, CLEARANCE = 100.0, 1e-3  # natural frequency [rad/s], clearance [m]
ZETA, BETA, MU, E = 0.1, 4.0, 0.05, 0.5


def rubbing(speed: np.ndarray, sign: int) -> np.ndarray:
    """Radius of the full annular rub, the larger (sign 1) or the smaller; nan where none is."""
    s, d = 1 + BETA - speed**2, 2 * ZETA * speed + MU * BETA
    a, b = s * s + d * d, BETA * (s + MU * d)
    c = (1 + MU**2) * BETA**2 - (E * speed**2) ** 2
    root = b * b - a * c
    r = (b + sign * np.sqrt(np.where(root >= 0, root, np.nan))) / a
    return np.where(r >= 1, r, np.nan)


def free(speed: np.ndarray) -> np.ndarray:
    """Radius without contact; nan where it would be larger than the clearance."""
    r = E * speed**2 / np.abs(1 - speed**2 + 2j * ZETA * speed)
    return np.where(r <= 1, r, np.nan)


def sweep(start: float, stop: float, steps: int, settle: float = 150.0) -> np.ndarray:
    """Radius at speeds one after another, each held for `settle` [1 / OMEGA]; shape (steps, 2)."""
    rotor = parse_rotor((HERE / "jeffcott.toml").read_text(encoding="utf-8"))
    sim = Simulation(
        rotor, choose("robust", rho=0.9, h=1e-4), speed=start * OMEGA, continues_speed=False
    )
    result = []
    for speed in np.linspace(start, stop, steps):
        sim.advance(sim.time + settle / OMEGA, speed * OMEGA)
        radii = []
        for _ in range(40):
            sim.advance(sim.time + 2 * math.pi / (10 * speed * OMEGA), speed * OMEGA)
            radii.append(math.hypot(sim.read("disc.x"), sim.read("disc.y")) / CLEARANCE)
        result.append((speed, np.mean(radii)))
    return np.array(result)


def draw(path: Path) -> None:
    """Closed form and both sweeps."""
    up, down = sweep(0.6, 2.4, 91), sweep(2.4, 0.6, 91)
    speed = np.linspace(0.6, 2.4, 4001)
    figure, axes = new_figure(6.4, 4.4)
    axes.axhline(1, color=GREY, linestyle=":", label="clearance")
    axes.plot(speed, free(speed), color=GREY, label="closed form, stable")
    axes.plot(speed, rubbing(speed, 1), color=GREY)
    axes.plot(speed, rubbing(speed, -1), "--", color=GREY, label="closed form, unstable")
    axes.plot(*up.T, ">", color=BLUE, markersize=4, label="speed stepped up")
    axes.plot(*down.T, "<", color=ORANGE, markersize=4, mfc="none", label="speed stepped down")
    axes.set(
        xlabel="speed / natural frequency [1]",
        ylabel="radius of whirl / clearance [1]",
        ylim=(0, None),
    )
    axes.legend(frameon=False, loc="upper left")
    save(figure, path)


if __name__ == "__main__":
    draw(Path(*script_arguments() or [str(HERE)]) / "response.png")
