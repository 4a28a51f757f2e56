"""The compressor of this folder drops into its touchdown bearings: orbit.png and drop.png.

python drop.py [FOLDER for the pictures]
"""

import math
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.operating_speeds import operating_speeds
from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save

HERE = Path(__file__).resolve().parent
CLEARANCE = 0.25e-3  # m


def drop() -> Simulation:
    """The rotor at speed in the middle of its clearances, nothing driving it."""
    rotor = parse_rotor((HERE / "compressor.toml").read_text(encoding="utf-8"))
    speed = operating_speeds(rotor).rated
    return Simulation(rotor, choose("robust", h=1e-5), speed=speed, drive_torque=0.0)


def first_contact() -> float:
    """The time at which a journal first touches [s]."""
    sim = drop()
    while not sim.read("touchdown_bearing[1].contact"):
        sim.advance(sim.time + 1e-5, 0.0)
    return sim.time


def run(duration: float = 0.4, every: float = 1e-4) -> dict[str, np.ndarray]:
    """All that can be read, by name, and the time as `t`."""
    sim = drop()
    times = np.arange(round(duration / every) + 1) * every
    rows = []
    for t in times:
        sim.advance(t, 0.0)
        rows.append(sim.observed.copy())
    return {"t": times, **dict(zip(sim.names, np.transpose(rows), strict=True))}


def draw_orbit(history: dict[str, np.ndarray], path: Path) -> None:
    """The journal in its left race, coloured by the time, inside the circle of the clearance."""
    figure, axes = new_figure(5.6, 4.8)
    x, y = (1e3 * history[f"touchdown_bearing[1].{axis}"] for axis in "xy")
    angle = np.linspace(0, 2 * math.pi, 200)
    gap = 1e3 * CLEARANCE
    axes.plot(gap * np.cos(angle), gap * np.sin(angle), color=GREY)
    axes.plot(x, y, color=GREY, linewidth=0.4)
    dots = axes.scatter(x, y, c=1e3 * history["t"], s=3, cmap="viridis", zorder=3)
    axes.plot(0, 0, "+", color=ORANGE, zorder=4)
    axes.annotate("released", (0, 0), (0.02, 0.02), color=ORANGE)
    axes.set(xlabel="x in the race [mm]", ylabel="y in the race [mm]", aspect="equal")
    figure.colorbar(dots, label="time [ms]")
    save(figure, path)


def draw_time(history: dict[str, np.ndarray], path: Path) -> None:
    """Race speed, contact force and energy over the time."""
    figure, first = new_figure(6.4, 7.2)
    first.remove()
    speed, force, energy = figure.subplots(3, 1, sharex=True)
    t = 1e3 * history["t"]
    speed.plot(t, history["w"], color=GREY, label="rotor")
    speed.plot(t, history["touchdown_bearing[1].race"], color=BLUE, label="left race")
    speed.plot(t, history["touchdown_bearing[2].race"], "--", color=ORANGE, label="right race")
    speed.set(ylabel="speed [rad/s]")
    force.plot(
        t, history["touchdown_bearing[1].fn"], color=BLUE, linewidth=0.7, label="left bearing"
    )
    force.set(ylabel="normal force [N]")
    for name, colour, label in (
        ("friction_loss", ORANGE, "lost to friction"),
        ("races", BLUE, "in the races"),
        ("drag_loss", GREY, "lost to the races' drag"),
    ):
        energy.plot(t, history[f"energy.{name}"], color=colour, label=label)
    energy.set(ylabel="energy [J]", xlabel="time since release [ms]")
    for axes in (speed, force, energy):
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False)
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """Both pictures."""
    history = run()
    draw_orbit(history, Path(out) / "orbit.png")
    draw_time(history, Path(out) / "drop.png")
    lost = sum(value[-1] for name, value in history.items() if name.endswith("_loss"))
    print(
        f"first contact after {1e3 * first_contact():.2f} ms, free fall says "
        f"{1e3 * math.sqrt(2 * CLEARANCE / 9.81):.2f} ms"
    )
    print(
        f"largest force {history['touchdown_bearing[1].fn_peak'].max():.0f} N, {lost:.1f} J lost, "
        f"energy balance closes within {abs(history['energy.residual'][-1]):.1e} J"
    )


if __name__ == "__main__":
    main(*script_arguments())
