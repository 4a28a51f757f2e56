"""The native FMU in numbers: python -m benchmarks.native [--wide] [--numba]

Instantiation, the run-down under a C master, the size, the build of an FMU of another machine.
--wide: what a library for x86-64-v3 (AVX2, FMA left out) would gain; --numba: the library beside
numba's own code for the same processor, which compiles for minutes. CPU time; medians of what was
measured in turn.
"""

import argparse
import dataclasses
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from rotor_fmu.model.kernels.library import here

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.library import build
from rotor_fmu.library.build import LibraryError
from rotor_fmu.library.platforms import PLATFORMS

from .native_master import CMaster, children_cpu, median_ratio

REPETITIONS = 7
ROOT = Path(__file__).parents[1]
OTHER = ROOT / "examples" / "drop" / "compressor.toml"
# AVX2 and all that came with it, without fused products, which round otherwise
WIDE = "+avx,+avx2,+bmi,+bmi2,+f16c,+lzcnt,+movbe,+popcnt,+sse3,+ssse3,+sse4.1,+sse4.2"
_NUMBA = """
import time, sys
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
def run():
    sim = Simulation(rig(), choose(), speed=400.0)
    begun = time.process_time()
    for i in range(1000):
        sim.advance(i * 0.04 + 0.04, 400.0 - 0.4 * i)
    return time.process_time() - begun
run()
print(run())
"""


def built_for_another_machine(folder: Path) -> float:
    """CPU seconds from the command's start to its end."""
    script = "from rotor_fmu.cli import main; main()"
    options = ("build", "--native", "--platform", "here", "--rotor", OTHER, "--out", folder)
    begun = children_cpu()
    command = [sys.executable, "-c", script, *map(str, options)]
    subprocess.run(command, check=True, capture_output=True)
    return children_cpu() - begun


def wide_library(folder: Path) -> Path:
    """The library of this machine's platform for x86-64-v3."""
    name = here()
    assert name is not None
    wide = dataclasses.replace(PLATFORMS[name], features=WIDE)
    target = folder / f"wide{wide.suffix}"
    build.link(wide, build.objects(wide, build.kernels(), folder), target)
    return target


def run_down_of(code: str) -> float:
    """CPU seconds of the run-down in Python by the library or by numba."""
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "ROTOR_FMU_KERNELS": code}
    done = subprocess.run(
        [sys.executable, "-c", _NUMBA],
        env={**os.environ, **generic},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def rows(master: CMaster, folder: Path) -> list[tuple[str, str]]:
    """What is measured always."""
    start = statistics.median(master.run("start") for _ in range(REPETITIONS))
    whole = median_ratio(
        REPETITIONS, lambda: master.process_cpu("rundown"), lambda: master.run("bare")
    )
    build = statistics.median(built_for_another_machine(folder) for _ in range(3))
    result = [
        ("instantiate to first step, from C", f"{start / 1e3:.2f} ms"),
        ("run-down in a C master, whole process, over the kernels alone", f"{whole:.3f}"),
        ("build of an FMU of another machine", f"{build:.2f} s"),
    ]
    try:
        fmu = build_native(folder / "all", machine_of())
        result.append(("an FMU with all five platforms", f"{fmu.stat().st_size / 1e6:.2f} MB"))
    except LibraryError as error:
        result.append(("an FMU with all five platforms", str(error)))
    return result


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--wide", action="store_true")
    parser.add_argument("--numba", action="store_true")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        master = CMaster(folder)
        result = rows(master, folder)
        if asked.wide:
            wide = wide_library(folder)
            gain = median_ratio(
                REPETITIONS, lambda: master.run("bare", wide), lambda: master.run("bare")
            )
            result.append(
                ("run-down by the library for x86-64-v3, over the one for all", f"{gain:.3f}")
            )
    if asked.numba:
        ratio = median_ratio(
            REPETITIONS, lambda: run_down_of("library"), lambda: run_down_of("numba")
        )
        result.append(("run-down by the library, over numba's code", f"{ratio:.3f}"))
    print("| the native FMU | |\n| --- | ---: |")
    for text, value in result:
        print(f"| {text} | {value} |")


if __name__ == "__main__":
    main()
