"""The force of the left bearing of this folder's rotor, with its defect and without: spectrum.png.

python rolling_bearing.py [FOLDER for the picture]
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.rolling_bearing import RollingBearing, cage_ratio
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.operating_speeds import operating_speeds
from rotor_fmu.plotting.colors import BLUE, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_panels, save

HERE = Path(__file__).resolve().parent
EVERY, SETTLES, SAMPLES = 1e-3, 0.4, 1024  # s, s


def rotor(depth: float | None = None) -> Rotor:
    """The machine of this folder, its defect of another depth [m] if one is given."""
    whole = parse_rotor((HERE / "rotor.toml").read_text(encoding="utf-8"))
    if depth is None:
        return whole
    left, right = whole.of_kind(RollingBearing)
    return whole.with_parts(RollingBearing, replace(left, outer_depth=depth), right)


def spectrum(machine: Rotor, tolerance: float = 1e-2) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies over the rotor's [1] and amplitudes of the left bearing's upward force [N]."""
    settings, speed = choose("controlled", tolerance=tolerance), operating_speeds(machine).rated
    run = Simulation(machine, settings, speed=speed, warn=lambda _: None)
    run.advance(SETTLES, speed)
    force = np.empty(SAMPLES)
    for i in range(SAMPLES):
        run.advance(SETTLES + EVERY * (i + 1), speed)
        force[i] = run.read("left.fy")
    window = np.hanning(SAMPLES)
    amplitudes = 2.0 * np.abs(np.fft.rfft((force - force.mean()) * window)) / window.sum()
    return np.fft.rfftfreq(SAMPLES, EVERY) / (speed / (2.0 * math.pi)), amplitudes


def passing(machine: Rotor) -> float:
    """How many balls pass the defect in a revolution of the rotor [1]."""
    left = machine.of_kind(RollingBearing)[0]
    return float(left.count * interpreted(cage_ratio)(left))


def draw(path: Path) -> None:
    """Both spectra, the balls' passing marked."""
    figure, panels = new_panels(6.8, 5.4, 2, share_x=True)
    line = passing(rotor())
    for axes, machine, text in zip(
        panels,
        (rotor(), rotor(0.0)),
        ("left bearing, outer race damaged", "the same, sound"),
        strict=True,
    ):
        orders, amplitudes = spectrum(machine)
        for k in range(1, 6):
            axes.axvline(k * line, color=ORANGE if k == 1 else GREY, lw=0.8, ls=":")
        axes.semilogy(orders, np.maximum(amplitudes, 1e-6), color=BLUE, lw=0.8)
        axes.set_title(text, loc="left", fontsize=9)
        axes.set_ylabel("Force upwards [N]")
        axes.set_ylim(1e-4, 1e3)
        axes.set_yticks([1e-4, 1e-2, 1.0, 1e2], ["0.0001", "0.01", "1", "100"])
    panels[0].annotate(" a ball passes, and multiples", (line, 2e2), color=ORANGE, fontsize=8)
    panels[-1].set_xlabel("Frequency over the rotor's [1]")
    panels[-1].set_xlim(0.0, 20.0)
    save(figure, path)


def main(out: str = str(HERE)) -> None:
    """The picture, and the line that it is about."""
    draw(Path(out) / "spectrum.png")
    print(f"a ball passes the defect {passing(rotor()):.4f} times in a revolution")


if __name__ == "__main__":
    main(*script_arguments())
