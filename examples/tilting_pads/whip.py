"""The compressor of this folder up and down, in plain bearings and on tilting pads: whip.png.

python whip.py [FOLDER for the picture]
"""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rotor_fmu.examples import script_arguments

import rotor_fmu as rf
from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import legend_below, new_figure, save
from rotor_fmu.vibration import displacement_of

HERE = Path(__file__).resolve().parent
RPM = math.pi / 30  # rad/s
SLOW, FAST, SECONDS = 5000 * RPM, 10000 * RPM, 4.0
PLACE = "impeller_5"


class Sweep(NamedTuple):
    """A run over the speed [rad/s]: the largest distance of `PLACE` from its mean in four turns
    [m]."""

    speed: np.ndarray
    amplitude: np.ndarray


def machine(bearings: str) -> rf.Machine:
    """The compressor; bearings: `plain` or `tilting`."""
    return rf.load(HERE / f"{bearings}.toml")


def sweep(bearings: str, begin: float, end: float, seconds: float = SECONDS) -> Sweep:
    """Run the compressor from one speed [rad/s] to another."""
    run = rf.simulate(
        machine(bearings),
        speed=([0.0, 0.5, 0.5 + seconds], [begin, begin, end]),
        tolerance=1e-3,
        record=[f"{PLACE}.x", f"{PLACE}.y"],
        per_turn=32,
    )
    signal = run.recording.resampled(run.recording.place(PLACE))
    moved = displacement_of(signal)
    settled = moved.begin >= 0.5
    return Sweep(moved.speed[settled], 1e-6 * moved.s_max[settled])


def main(out: str = str(HERE)) -> None:
    """The picture, and the thresholds beside what the runs do."""
    runs = {
        "plain bearings, running up": (sweep("plain", SLOW, FAST), BLUE),
        "plain bearings, running down": (sweep("plain", FAST, SLOW), ORANGE),
        "tilting pads, running up": (sweep("tilting", SLOW, FAST), GREEN),
    }
    threshold = machine("plain").campbell(np.linspace(SLOW, FAST, 11), count=4).threshold
    figure, axes = new_figure()
    for label, (run, color) in runs.items():
        axes.plot(run.speed / RPM, 1e6 * run.amplitude, color=color, label=label)
    axes.axvline((threshold or math.nan) / RPM, color=GREY, ls=":", label="linear threshold")
    axes.set_xlabel("Rotational speed n [rpm]")
    axes.set_ylabel("Largest distance of impeller 5\nfrom its mean [µm]")
    axes.set_ylim(bottom=0)
    legend_below(figure, 2)
    save(figure, Path(out) / "whip.png")


if __name__ == "__main__":
    main(*script_arguments())
