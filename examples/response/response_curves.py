"""Response curves with their unstable parts, of the Jeffcott rotor that rubs and of the rig, and
the map of jumps: jeffcott.png, rig.png, jumps.png.

python response_curves.py [FOLDER for the pictures]
"""

import sys
from pathlib import Path

import rotor_fmu as rf
from rotor_fmu.plotting.figure_style import BLUE, new_figure, save

HERE = Path(__file__).resolve().parent


def draw(folder: Path) -> None:
    """All three."""
    jeffcott = rf.load(HERE.parent / "jeffcott_rub" / "jeffcott.toml")
    rub = rf.response(jeffcott, speed=(60.0, 240.0))
    save(rub.figure(["disc"]), folder / "jeffcott.png")

    folds = rub.fold_curve("contact[1].mu", 0.005, 0.12)
    figure, axes = new_figure(6.4, 4.0)
    axes.plot(folds.second, folds.first, color=BLUE, lw=1.8)
    axes.fill_between(folds.second, folds.first, folds.first.max(), color=BLUE, alpha=0.12)
    axes.annotate("no rub above", (0.07, 203.5))
    axes.set(xlabel="contact[1].mu [1]", ylabel="speed of the upper jump [rad/s]")
    save(figure, folder / "jumps.png")

    rig = rf.response(rf.load(), speed=(100.0, 400.0))
    save(rig.figure(), folder / "rig.png")


if __name__ == "__main__":
    draw(Path(*(sys.argv[1:] or [str(HERE)])))
