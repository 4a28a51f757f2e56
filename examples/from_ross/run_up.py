"""The rotor from ROSS runs up and rubs in the seals added to it: run_up.png.

python run_up.py [FOLDER for the picture]
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.machine_file.loading import machine_text
from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save

HERE = Path(__file__).resolve().parent
CLEARANCE = 0.15e-3  # of the seals [m]
START, STOP = 310.0, 380.0  # rad/s


def machine(file: str) -> Rotor:
    """A machine file of this folder with what it extends."""
    return parse_rotor(machine_text("file", HERE / file))


def without_contacts(rotor: Rotor) -> Rotor:
    """The same machine as ROSS knows it."""
    return replace(rotor, parts=tuple(part for part in rotor.parts if part.KIND != "contact"))


def run_up(rotor: Rotor, *names: str, duration: float = 6.0) -> dict[str, np.ndarray]:
    """Quantities over a run-up, by their names, and the speed as `w`."""
    rate = (STOP - START) / duration
    sim = Simulation(rotor, choose("robust", rho=0.9, h=5e-5), speed=START, rate=rate)
    history = []
    for t in np.linspace(0, duration, round(2000 * duration) + 1):
        sim.advance(t, START + rate * sim.time)
        history.append([sim.read(name) for name in ("w", *names)])
    return dict(zip(("w", *names), np.transpose(history), strict=True))


def draw(path: Path) -> None:
    """Run-up with the seals in front of the run-up without."""
    rotor = machine("rubbing.toml")
    rubs = run_up(rotor, "disc.y", "contact[1].fn")
    free = run_up(without_contacts(rotor), "disc.y")
    figure, first = new_figure(6.4, 5.6)
    first.remove()
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    axes.plot(free["w"], 1e3 * free["disc.y"], color="#cccccc", linewidth=0.4)
    axes.plot(rubs["w"], 1e3 * rubs["disc.y"], color=BLUE, linewidth=0.4)
    axes.plot([], color="#cccccc", linewidth=3, label="as ROSS has it")
    axes.plot([], color=BLUE, linewidth=3, label="with the seals of rubbing.toml")
    for side in (1, -1):
        label = "clearance" if side == 1 else None
        axes.axhline(side * 1e3 * CLEARANCE, color=ORANGE, linestyle=":", label=label)
    axes.set(ylabel="y of the first disc [mm]")
    axes.legend(frameon=False, loc="upper left")
    below.plot(rubs["w"], rubs["contact[1].fn"], color=BLUE, linewidth=0.4)
    below.set(xlabel="speed [rad/s]", ylabel="normal force [N]")
    for each in (axes, below):
        each.grid(color=GREY, alpha=0.3, linewidth=0.6)
        each.spines[["top", "right"]].set_visible(False)
    save(figure, path)


if __name__ == "__main__":
    draw(Path(*script_arguments() or [str(HERE)]) / "run_up.png")
