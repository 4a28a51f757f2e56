"""The drive train and the rotor through CoFMPy, from cofmpy.json in this folder; prints CSV.
Needs cofmupy.

    python with_cofmpy.py [STOP in seconds] [jacobi|gauss_seidel]
"""

import argparse
import contextlib
import json
import os
import sys
from pathlib import Path

from cofmupy import Coordinator
from cofmupy.wrappers import FmuXHandler

STEP = 0.002  # [s]
SHOWN = {"drive": ("w", "tau_motor"), "rotor": ("tau_load",)}

# CoFMPy 1.0.0 takes the smallest of the FMUs' default steps, but as text, and stops there
FmuXHandler.default_step_size = property(lambda self: None, lambda self, value: None)


def main(stop: float, method: str) -> None:
    """Run to `stop` [s] and print every tenth of a second."""
    os.chdir(Path(__file__).resolve().parent)
    system = json.loads(Path("cofmpy.json").read_text(encoding="utf-8"))
    coordinator = Coordinator()
    with contextlib.redirect_stdout(sys.stderr):
        coordinator.start({**system, "cosim_method": method})
    print("time", *(f"{name}.{v}" for name in SHOWN for v in SHOWN[name]), sep=",")
    for step in range(1, round(stop / STEP) + 1):
        outputs = coordinator.master.do_step(STEP)
        if step % 50 == 0:
            row = [outputs[name][v][0] for name in SHOWN for v in SHOWN[name]]
            print(step / 500, *map(repr, row), sep=",")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="The drive train and the rotor through CoFMPy.")
    parser.add_argument("stop", nargs="?", type=float, default=60.0, help="end of the run [s]")
    parser.add_argument("method", nargs="?", choices=("jacobi", "gauss_seidel"), default="jacobi")
    main(**vars(parser.parse_args()))
