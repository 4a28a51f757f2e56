"""What a step costs: python benchmarks/step_cost.py

Prints, for each preset, the median over several runs of the CPU time of a step through the model
alone, and of the whole run-down through FMPy, all warm.
"""

import statistics
import sys
import tempfile
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

from model.settings import PRESETS
from rotor_fmu.job import fmu_in, prepare
from rotor_fmu.run_down import run_direct, run_fmu

REPETITIONS = 5


def cpu(call):
    """CPU seconds of a call, and its result."""
    begun = time.process_time()
    result = call()
    return time.process_time() - begun, result


def main():
    with tempfile.TemporaryDirectory() as folder:
        print(f"{'preset':16s} {'steps':>8s} {'us a step':>10s} {'Newton':>7s} {'FMPy [s]':>9s}")
        for preset in PRESETS:
            job = prepare(None, preset, [], None, 40.0, None)
            coarse = replace(job, step=0.4)
            fmu = fmu_in(Path(folder), job.toml)
            run_fmu(fmu, replace(job, stop=0.1))
            alone, hosted = [], []
            for _ in range(REPETITIONS):
                seconds, run = cpu(partial(run_direct, job.rotor, coarse))
                steps = run.columns["solver.steps"][-1]
                newton = run.columns["solver.newton"][-1] / steps
                alone.append(seconds / steps * 1e6)
                hosted.append(cpu(partial(run_fmu, fmu, job))[0])
            print(
                f"{preset:16s} {steps:8.0f} {statistics.median(alone):10.2f} {newton:7.2f} "
                f"{statistics.median(hosted):9.2f}"
            )


if __name__ == "__main__":
    sys.exit(main())
