"""Pictures of a coupled run: up on the magnetic bearings, and down in the touchdown bearings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import BLUE, GREEN, GREY, ORANGE, new_figure, save
from .system import Levitated

CLEARANCE = 0.25e-3  # of the touchdown bearings [m]
_LIFTED = 0.15  # how much of the lift is shown [s]
_BEFORE, _AFTER = 0.01, 0.6  # around the drop [s]


def write_pictures(run: Levitated, off: float, out: Path) -> None:
    """`run_up.png`, `orbit.png` and `drop.png`; off: when the bearings are switched off [s]."""
    save(run_up_figure(run, off), out / "run_up.png")
    save(orbit_figure(run, off), out / "orbit.png")
    save(drop_figure(run, off), out / "drop.png")


def _panels(width: float, height: float, rows: int, share: bool) -> tuple[Figure, list[Axes]]:
    figure, only = new_figure(width, height)
    only.remove()
    axes = list(figure.subplots(rows, 1, sharex=share))
    for each in axes:
        each.spines[["top", "right"]].set_visible(False)
        each.grid(color="#dddddd", linewidth=0.6)
        each.set_axisbelow(True)
    return figure, axes


def run_up_figure(run: Levitated, off: float) -> Figure:
    """The lift with the coils' currents; displacements over speed, through the critical speed."""
    figure, (lift, currents, swing) = _panels(6.4, 7.6, 3, False)
    first = run.t < _LIFTED
    t = 1e3 * run.t[first]
    lift.plot(t, 1e6 * run.rotor["left_magnet.y"][first], color=BLUE)
    lift.set(ylabel="Height y [µm]", xlim=(0, t[-1]))
    lift.set_title("Lifted out of the touchdown bearings", loc="left", fontsize=10)
    for name, colour, label in (("a", BLUE, "upper coil"), ("b", ORANGE, "lower coil")):
        currents.plot(t, run.control[f"left_iy{name}"][first], color=colour, label=label)
    currents.set(ylabel="Current [A]", xlabel="Time [ms]", xlim=(0, t[-1]))
    currents.legend(frameon=False)
    up = (run.t > _LIFTED) & (run.t < off)
    for name, colour, label in (
        ("body[1].x_amp", BLUE, "first impeller"),
        ("body[2].x_amp", ORANGE, "motor"),
    ):
        swing.plot(run.rotor["w"][up], 1e6 * run.rotor[name][up], color=colour, label=label)
    swing.set(xlabel="Speed [rad/s]", ylabel="Amplitude X [µm]", xlim=(0, None), ylim=(0, None))
    swing.set_title("Through the critical speed", loc="left", fontsize=10)
    swing.legend(frameon=False, loc="upper left")
    return figure


def orbit_figure(run: Levitated, off: float) -> Figure:
    """The journal in its left race after the drop, coloured by the time."""
    figure, axes = new_figure(5.6, 4.8)
    down = run.t >= off
    x, y = (1e3 * run.rotor[f"touchdown_bearing[1].{axis}"][down] for axis in "xy")
    angle = np.linspace(0, 2 * math.pi, 200)
    gap = 1e3 * CLEARANCE
    axes.plot(gap * np.cos(angle), gap * np.sin(angle), color=GREY)
    axes.plot(x, y, color=GREY, linewidth=0.4)
    dots = axes.scatter(x, y, c=1e3 * (run.t[down] - off), s=3, cmap="viridis", zorder=3)
    axes.annotate("switched off", (x[0], y[0]), (0.03, 0.03), color=ORANGE)
    axes.set(xlabel="x in the race [mm]", ylabel="y in the race [mm]", aspect="equal")
    figure.colorbar(dots, label="time since the switch-off [ms]")
    return figure


def drop_figure(run: Levitated, off: float) -> Figure:
    """Speeds of rotor and races, contact force, and where the energy goes, over the time."""
    figure, (speed, force, energy) = _panels(6.4, 7.2, 3, True)
    shown = run.t > off - _BEFORE
    t, rotor = 1e3 * (run.t[shown] - off), {k: v[shown] for k, v in run.rotor.items()}
    speed.plot(t, rotor["w"], color=GREY, label="rotor")
    speed.plot(t, rotor["touchdown_bearing[1].race"], color=BLUE, label="left race")
    speed.plot(t, rotor["touchdown_bearing[2].race"], "--", color=ORANGE, label="right race")
    speed.set(ylabel="Speed [rad/s]")
    force.plot(t, rotor["touchdown_bearing[1].fn"], color=BLUE, lw=0.7, label="left race")
    force.plot(t, run.control["left_fy"][shown], color=GREEN, lw=1.2, label="left magnet, upwards")
    force.set(ylabel="Force [N]")
    for name, colour, label in (
        ("friction_loss", ORANGE, "lost to friction"),
        ("races", BLUE, "in the races"),
        ("drag_loss", GREY, "lost to the races' drag"),
    ):
        energy.plot(
            t, rotor[f"energy.{name}"] - rotor[f"energy.{name}"][0], color=colour, label=label
        )
    energy.set(ylabel="Energy [J]", xlabel="Time since the switch-off [ms]")
    for axes in (speed, force, energy):
        axes.legend(frameon=False)
    return figure
