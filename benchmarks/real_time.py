"""The mode for real time in numbers: python -m benchmarks.real_time [--steps N] [--core C]

How long the slowest steps of an FMU take beside the median, of the paper's rig, whose journals rub,
and of the compressor on magnetic bearings with a controller in the loop, in a C master; what the
limit of iterations costs a step of the rig; and what it does to the peaks of the run-down. The
clock on the wall tells only of a core of its own. CPU time leaves other processes out, but not
what they and interrupts throw out of the caches; the least of equal runs, step for step, does that.
"""

import argparse
import shutil
import statistics
import subprocess
import tempfile
from pathlib import Path

import fmpy
import numpy as np
from rotor_fmu.model.kernels.library import here
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.settings.table import MODES
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

from .native_master import compile_c

ROOT = Path(__file__).parents[1]
COMPRESSOR = ROOT / "examples" / "magnetic_bearing" / "compressor.toml"
STEP, REPETITIONS = 5e-5, 7
# speeds between which a machine goes up and down [rad/s], and the rate [rad/s2]
SWEEPS = {"rig": (1.0, 400.0, 10.0), "compressor": (1.0, 1400.0, 100.0)}
AXES = [(side, axis) for side in ("left", "right") for axis in "xy"]
RUBS = (185.0, 185.0, 0.0)  # a speed at which both journals of the rig touch


class Master:
    """An FMU for real time, and the C master's program."""

    def __init__(self, folder: Path, toml: str | None, core: int | None) -> None:
        platform = here()
        assert platform is not None, "there is no native library for this machine"
        folder.mkdir()
        fmu = build_native(folder, machine_of(toml, step=STEP), fmi=3, platforms=[platform])
        unpacked = fmpy.extract(str(fmu), str(folder / "fmu"))
        described = fmpy.read_model_description(unpacked)
        self._reference = {v.name: v.valueReference for v in described.modelVariables}
        library = next(Path(unpacked).glob("binaries/*/*"))
        program = folder / "real_time"
        compile_c(Path(__file__).with_suffix(".c"), program, "-ldl")
        pinned = ["taskset", "-c", str(core)] if core is not None else []
        token = described.instantiationToken
        self._command = [*pinned, program, library, f"{unpacked}/resources/", token, STEP]
        self._axes = []
        if "left_sensor.x" in self._reference:
            self._axes = [
                ",".join(
                    str(self._reference[f"{side}_{of}{axis}"])
                    for of in ("sensor.", "magnet.", "magnet.f")
                )
                for side, axis in AXES
            ]

    def run(
        self,
        steps: int,
        clock: str,
        sweep: tuple[float, ...],
        mode: str = "realtime",
        runs: int = 1,
    ) -> list[float]:
        """Median, quantiles 0.99, 0.999, 0.9999, longest and mean of a communication step [us], the
        least of equal runs step for step."""
        chosen = f"{self._reference['solver.adaptive']},{1 + list(MODES).index(mode)}"
        about = (steps, runs, clock, chosen, ",".join(map(str, sweep)), *self._axes)
        command = [str(word) for word in (*self._command, *about)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        return [float(word) for word in done.stdout.split()]


def peaks(mode: str) -> tuple[np.ndarray, float]:
    """Largest displacements of the rig's discs over the run-down in steps of 0.1 ms [m], and the
    residual [N]."""
    simulation = Simulation(rig(), choose("realtime", h=1e-4, mode=mode), speed=400.0)
    at = [i for i, name in enumerate(simulation.names) if name.endswith(("].x_amp", "].y_amp"))]
    largest = np.zeros(len(at))
    for i in range(4000):
        simulation.advance((i + 1) * 0.01, 400.0 - 0.1 * i, rate=-10.0)
        largest = np.maximum(largest, simulation.observed[at])
    return largest, simulation.read("solver.residual")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=10_000_000)
    parser.add_argument("--runs", type=int, default=3, help="equal runs, of each step the least")
    parser.add_argument("--core", type=int, help="the core that the master is bound to")
    asked = parser.parse_args()
    if asked.core is not None and shutil.which("taskset") is None:
        parser.error("--core: taskset is not installed")
    with tempfile.TemporaryDirectory() as name:
        of_rig = Master(Path(name) / "rig", None, asked.core)
        of_compressor = Master(Path(name) / "compressor", COMPRESSOR.read_text(), asked.core)
        print(f"{asked.steps} steps of {STEP:g} s; times over the median")
        print("\n| machine | clock | median | 99 % | 99.9 % | 99.99 % | slowest |")
        print("| --- | --- | ---: | ---: | ---: | ---: | ---: |")
        for machine, master in (("rig", of_rig), ("compressor", of_compressor)):
            for clock, runs in (("wall", 1), ("cpu", 1), ("cpu", asked.runs)):
                median, *others, _ = master.run(asked.steps, clock, SWEEPS[machine], runs=runs)
                shown = " | ".join(f"{other / median:.2f}" for other in others)
                of = f"{machine} | {clock}" + (f", least of {runs} runs" if runs > 1 else "")
                print(f"| {of} | {median:.2f} us | {shown} |", flush=True)
        ratios = []
        for _ in range(REPETITIONS):
            limited, free = (
                of_rig.run(200_000, "cpu", RUBS, mode)[-1] for mode in ("realtime", "fixed")
            )
            ratios.append(limited / free)
    limited_peaks, residual = peaks("realtime")
    free_peaks, _ = peaks("fixed")
    error = np.abs(limited_peaks / free_peaks - 1.0).max()
    print("\n| the rig, at most 4 iterations a step | |\n| --- | ---: |")
    cost = statistics.median(ratios)
    print(f"| step in which both journals touch, over a free-running one | {cost:.3f} |")
    print(f"| peaks of the run-down at 0.1 ms, off those without a limit by | {error:.2g} |")
    print(f"| its largest residual | {residual:.2g} N |")


if __name__ == "__main__":
    main()
