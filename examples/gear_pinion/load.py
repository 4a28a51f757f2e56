"""From which speed on the pinion of this folder whirls under a part of its load: load.png.

python load.py [FOLDER for the picture]
"""

import math
from pathlib import Path

import numpy as np
from rotor_fmu.examples import script_arguments

import rotor_fmu as rf
from rotor_fmu.plotting.colors import BLUE, GREY
from rotor_fmu.plotting.figure_style import new_figure, save

HERE = Path(__file__).resolve().parent
RPM = math.pi / 30  # rad/s
FULL = 7020.0 - 19300.0j  # force of the mesh, x + i y [N]
SPEEDS = np.linspace(5000, 25000, 21) * RPM
OPERATING = 16000 * RPM, 18900 * RPM
SHARES = np.geomspace(0.005, 0.14, 12)


def machine(share: float) -> rf.Machine:
    """The pinion under a share of its load [1]."""
    force = share * FULL
    mesh = f'[[load]]\nname = "mesh"\nz = 0.21\nfx = {force.real}\nfy = {force.imag}\n'
    return rf.parse(rf.load(HERE / "pinion.toml").toml + mesh)


def threshold(share: float) -> float:
    """The speed from which on it whirls [rad/s]; NaN if it does not up to the highest one."""
    found = machine(share).campbell(SPEEDS, count=4).threshold
    return math.nan if found is None else found


def main(out: str = str(HERE)) -> None:
    """The picture."""
    figure, axes = new_figure()
    axes.semilogx(100 * SHARES, [threshold(share) / RPM for share in SHARES], "o-", color=BLUE)
    axes.axhspan(*(speed / RPM for speed in OPERATING), color=GREY, alpha=0.25, lw=0)
    axes.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    axes.set_xlabel("Load of the mesh [% of full load]")
    axes.set_ylabel("The pinion whirls above n [rpm]")
    save(figure, Path(out) / "load.png")


if __name__ == "__main__":
    main(*script_arguments())
