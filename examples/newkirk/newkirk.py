"""The rotor of this folder at speeds about its critical one: spiral.png and growth.png.

python newkirk.py [FOLDER for the pictures]
"""

import cmath
import math
from pathlib import Path
from typing import NamedTuple, cast

import numpy as np
from matplotlib.projections.polar import PolarAxes
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.heated_contact import HeatedContact
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_panels, save

HERE = Path(__file__).resolve().parent
BELOW, ABOVE = 0.985, 1.03  # of the critical speed
SETTLES = 4.0  # s, until the rotor turns steadily with the bow that it has
RPM = 30.0 / math.pi


class History(NamedTuple):
    """Times [s], the disc's vibration at the speed of rotation [m], amplitude and angle from the
    shaft's mark as a complex number, and the bow [m] alike, shape (n,) each."""

    t: np.ndarray
    vibration: np.ndarray
    bow: np.ndarray


def rotor() -> Rotor:
    """The machine of this folder."""
    return parse_rotor((HERE / "rotor.toml").read_text(encoding="utf-8"))


def critical(machine: Rotor) -> complex:
    """The root of the lowest bending mode, at its own speed [1/s]."""
    still = modes(machine, 0.0, count=1).eigenvalues[0]
    roots = modes(machine, abs(still.imag), count=2).eigenvalues
    return complex(max(roots, key=lambda root: root.imag))


def run(machine: Rotor, speed: float, seconds: float, every: float) -> History:
    """Hold a speed [rad/s]."""
    sim = Simulation(machine, choose(), speed=speed, warn=lambda _: None)
    rows = []
    for t in np.arange(SETTLES, seconds + 0.5 * every, every):
        sim.advance(float(t), speed)
        vibration, bow = (
            cmath.rect(sim.read(size), sim.read(angle))
            for size, angle in (("disc.x_1x", "disc.x_1x_phase"), ("ring.bow", "ring.bow_angle"))
        )
        rows.append((t, vibration, bow))
    t, vibration, bow = np.array(rows).T
    return History(t.real, vibration, bow)


def rate(history: History) -> complex:
    """Growth [1/s] and spiral [rad/s] of a bow: c (exp(rate t) - 1), at three even times."""
    last = len(history.t) - 1
    first, second, third = history.bow[[0, last // 2, last]]
    return cmath.log((third - second) / (second - first)) / (history.t[last // 2] - history.t[0])


def expected(machine: Rotor, speed: np.ndarray) -> np.ndarray:
    """The same of a Jeffcott rotor with this critical speed and damping (Kellenberger 1980)."""
    ring, root = machine.of_kind(HeatedContact)[0], critical(machine)
    s, damping = speed / abs(root), -root.real / abs(root)
    heat = ring.mu * ring.k * ring.journal_radius * speed  # per deflection [W/m]
    return ring.bow_per_heat * heat / (1 - s**2 + 2j * damping * s) - ring.bow_decay


def draw_spirals(path: Path, machine: Rotor) -> None:
    """The disc's vibration, seen from the shaft, below the critical speed and above."""
    figure, _ = new_panels(7.0, 3.9, 1)
    figure.clear()  # its axes are not polar
    root = abs(critical(machine))
    for i, (s, seconds, color) in enumerate(((BELOW, 304.0, ORANGE), (ABOVE, 304.0, BLUE)), 1):
        speed = s * root
        history = run(machine, speed, seconds, 4.0)
        axes = cast(PolarAxes, figure.add_subplot(1, 2, i, projection="polar"))
        z = history.vibration
        axes.plot(np.angle(z), 1e6 * np.abs(z), color=color, lw=1.2)
        minutes = np.flatnonzero(np.isclose((history.t - SETTLES) % 60.0, 0.0))
        axes.plot(np.angle(z[minutes]), 1e6 * np.abs(z[minutes]), "o", color=color, ms=3.5)
        for k in (minutes[0], minutes[-1]):
            axes.annotate(
                f"{(history.t[k] - SETTLES) / 60.0:.0f} min",
                (np.angle(z[k]), 1e6 * np.abs(z[k])),
                textcoords="offset points",
                xytext=(8, -3),
                fontsize=8,
            )
        side = "below" if s < 1.0 else "above"
        axes.set_title(f"{speed * RPM:.0f} rpm, {side} the critical speed", fontsize=9)
        axes.set_xlabel("Amplitude [um], angle from the shaft's mark", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.set_rlabel_position(60.0)
        axes.grid(color="#dddddd", linewidth=0.6)
    save(figure, path)


def draw_rates(path: Path, machine: Rotor) -> None:
    """Growth over the speed, run and of the closed form."""
    figure, panels = new_panels(6.4, 3.8, 1)
    axes, root = panels[0], abs(critical(machine))
    speeds = np.linspace(0.75, 1.25, 400) * root
    axes.axhline(0.0, color=GREY, lw=0.8)
    axes.axvline(root * RPM, color=GREY, lw=0.8, ls=":")
    per_minute = 60.0 * expected(machine, speeds).real
    axes.plot(speeds * RPM, per_minute, color=BLUE, lw=1.2, label="closed form")
    at = np.array([0.8, 0.86, 0.9, 0.94, 0.97, 0.985, 1.0, 1.02, 1.05, 1.1, 1.2]) * root
    seen = [rate(run(machine, w, 64.0, 10.0)).real * 60.0 for w in at]
    axes.plot(at * RPM, seen, "o", color=ORANGE, ms=4, label="integrated")
    axes.annotate(
        " critical speed", (root * RPM, axes.get_ylim()[0]), color=GREY, fontsize=8, va="bottom"
    )
    axes.set_xlabel("Speed [rpm]")
    axes.set_ylabel("Growth of the bow [1/min]")
    axes.legend(frameon=False, fontsize=8)
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """The pictures, and the speed at which the spiral begins."""
    machine = rotor()
    draw_spirals(Path(out) / "spiral.png", machine)
    draw_rates(Path(out) / "growth.png", machine)
    root = critical(machine)
    speeds = np.linspace(0.5, 1.0, 5001) * abs(root)
    growth = expected(machine, speeds).real
    begins = speeds[np.flatnonzero(growth > 0.0)[0]]
    print(f"spirals outwards from {begins * RPM:.0f} rpm to the critical {abs(root) * RPM:.0f} rpm")


if __name__ == "__main__":
    main(*script_arguments())
