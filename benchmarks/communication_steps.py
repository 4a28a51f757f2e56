"""What the communication step does to a run with constant inputs:
python benchmarks/communication_steps.py [NAME=VALUE ...]

Prints a Markdown table: for each communication step, the largest difference from the run with the
shortest one at the tenths of the first second at 200 rad/s, of disc 3 and of the last bearing's
force; in the last line, unequal steps. NAME=VALUE are Reals of the FMU, `solver.h=1e-4` and such.
"""

import shutil
import sys
import tempfile
from itertools import cycle
from pathlib import Path

import fmpy
import numpy as np

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build

STEPS: dict[str, tuple[float, ...]] = {
    f"{h * 1e3:g}": (h,) for h in (1e-5, 2e-5, 1e-4, 5e-4, 1e-3, 4e-3, 0.02, 0.1)
}
STEPS["0.01 .. 53, in turn"] = (1e-5, 0.03, 2e-4, 0.01679, 0.053)
SHOWN = ("disc[3].x", "disc[3].y", "bearing[2].fn", "solver.steps")
FACTORS = (1e6, 1e6, 1.0)


def tenths(folder, description, steps, settings):
    """What is shown at t = 0.1, 0.2 ... 1 s, shape (10, 3), and the solver's steps."""
    refs = {v.name: v.valueReference for v in description.modelVariables}
    fmu = fmpy.instantiate_fmu(folder, description, "CoSimulation")
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    for name, value in {"speed": 200.0, **settings}.items():
        fmu.setReal([refs[name]], [value])
    fmu.exitInitializationMode()
    rows, t, lengths = [], 0.0, cycle(steps)
    for tenth in range(1, 11):
        end = tenth / 10
        while end - t > 1e-9:
            step = min(next(lengths), end - t)
            fmu.doStep(t, step)
            t += step
        *values, taken = fmu.getReal([refs[name] for name in SHOWN])
        rows.append(values)
    fmu.terminate()
    fmu.freeInstance()
    return np.array(rows) * FACTORS, int(taken)


def main(*settings):
    chosen = {name: float(value) for name, value in (s.split("=") for s in settings)}
    with tempfile.TemporaryDirectory() as place:
        folder = fmpy.extract(str(build(Path(place), machine_of())))
    description = fmpy.read_model_description(folder)
    print("| communication step [ms] | solver's steps | x [um] | y [um] | force [N] |")
    print("| --- | --- | --- | --- | --- |")
    reference = None
    for name, steps in STEPS.items():
        values, taken = tenths(folder, description, steps, chosen)
        reference = values if reference is None else reference
        cells = " | ".join(f"{size:.2g}" for size in np.abs(values - reference).max(axis=0))
        print(f"| {name} | {taken} | {cells} |", flush=True)
    shutil.rmtree(folder)


if __name__ == "__main__":
    main(*sys.argv[1:])
