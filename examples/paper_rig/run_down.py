"""The paper's rig runs down through both resonances of its horizontal and vertical bending:
run_down.png.

python run_down.py [FOLDER for the picture]
"""

import math
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save

HERE = Path(__file__).resolve().parent
SPEED, RATE, STOP = 400.0, -10.0, 40.0  # rad/s, rad/s2, s
PAPER = (29.4, 32.5)  # natural frequencies that the paper gives [Hz]
NAMES = ("disc[3].x_amp", "disc[3].y_amp", "bearing[1].psi")


def run(stop: float = STOP, every: float = 0.004) -> dict[str, np.ndarray]:
    """Amplitudes of disc 3 [m] and the contact angle [rad] over the speed `hz` [Hz]."""
    rotor = parse_rotor((HERE / "rig.toml").read_text(encoding="utf-8"))
    sim = Simulation(rotor, speed=SPEED, rate=RATE)
    rows = []
    for t in np.arange(round(stop / every) + 1) * every:
        sim.advance(t, SPEED + RATE * sim.time)
        rows.append([(SPEED + RATE * t) / (2 * math.pi), *map(sim.read, NAMES)])
    return dict(zip(("hz", *NAMES), np.transpose(rows), strict=True))


def peak(history: dict[str, np.ndarray], name: str) -> tuple[float, float]:
    """The largest amplitude [m] once the start is over, and its speed [Hz]."""
    late = history["hz"] < (SPEED + 2 * RATE) / (2 * math.pi)
    at = int(np.argmax(np.where(late, history[name], 0.0)))
    return float(history[name][at]), float(history["hz"][at])


def draw(history: dict[str, np.ndarray], path: Path) -> None:
    """Both amplitudes over the speed; below, where the journal touches its bearing."""
    figure, first = new_figure(6.4, 6.0)
    first.remove()
    axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    for name, colour, label in ((NAMES[0], BLUE, "horizontal"), (NAMES[1], ORANGE, "vertical")):
        axes.plot(history["hz"], 1e6 * history[name], color=colour, linewidth=1.2, label=label)
    for hz in PAPER:
        axes.axvline(hz, color=GREY, linestyle=":", linewidth=1.0)
    axes.plot([], color=GREY, linestyle=":", label="the paper's natural frequencies")
    axes.set(ylabel="amplitude of disc 3 [µm]", ylim=(0, None))
    axes.legend(frameon=False)
    below.plot(history["hz"], np.degrees(history[NAMES[2]]), ".", color=BLUE, markersize=1.0)
    below.set(
        xlabel="speed of rotation [Hz]", ylabel="contact angle [deg]", yticks=(0, 90, 180, 270, 360)
    )
    below.set_xlim(5, 60)
    for each in (axes, below):
        each.grid(color="#dddddd", linewidth=0.6)
        each.spines[["top", "right"]].set_visible(False)
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """The picture, and both peaks."""
    history = run()
    draw(history, Path(out) / "run_down.png")
    for name, axis in zip(NAMES, "xy", strict=False):
        size, hz = peak(history, name)
        print(f"{axis}: {1e6 * size:.1f} um at {hz:.2f} Hz")


if __name__ == "__main__":
    main(*script_arguments())
