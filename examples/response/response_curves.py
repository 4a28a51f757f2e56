"""Response curves with their unstable parts, of the Jeffcott rotor that rubs and of the rig, and
the map of jumps: jeffcott.png, rig.png, jumps.png.

python response_curves.py [FOLDER for the pictures]
"""

from pathlib import Path

from rotor_fmu.examples import example_folder, script_arguments

import rotor_fmu as rf
from rotor_fmu.plotting.figure_style import save

HERE = Path(__file__).resolve().parent


def draw(folder: Path) -> None:
    """All three."""
    jeffcott = rf.load(example_folder("jeffcott_rub") / "jeffcott.toml")
    rub = rf.response(jeffcott, speed=(60.0, 240.0))
    save(rub.figure(["disc"]), folder / "jeffcott.png")

    folds = rub.fold_curve("contact[1].mu", 0.005, 0.12)
    save(rub.fold_figure("contact[1].mu", folds), folder / "jumps.png")

    rig = rf.response(rf.load(), speed=(100.0, 400.0))
    save(rig.figure(), folder / "rig.png")


if __name__ == "__main__":
    draw(Path(*script_arguments() or [str(HERE)]))
