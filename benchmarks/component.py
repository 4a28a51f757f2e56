"""The WebAssembly component of an FMU in numbers: python -m benchmarks.component

What it adds to an FMU, what making it takes, and a run-down of the rig in wasmtime over that with
the native library of the same FMU. Needs Node.js, jco and wasmtime.
"""

import tempfile
import zipfile
from pathlib import Path

import fmpy
from rotor_fmu.model.kernels.library import here

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.library.component import make
from rotor_fmu.library.platforms import COMPONENT, PLATFORMS
from tests.native.component import Component

from .native_master import children_cpu, median_ratio
from .problem import timed

REPETITIONS = 5
# A run-down of 4 s, in which the rotor rubs.
SPEED, RATE, STEP, COUNT = 400.0, -10.0, 0.01, 400


def main() -> None:
    platform = here() or "linux64"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        before = children_cpu()
        make(folder / "core.wasm")
        taken = children_cpu() - before
        fmu = build_native(folder, machine_of(), fmi=3, platforms=[platform, COMPONENT.name])
        with zipfile.ZipFile(fmu) as archive:
            entries = {entry.filename.split("/")[1]: entry for entry in archive.infolist()[:2]}
        component, library = entries[COMPONENT.name], entries[PLATFORMS[platform].fmi3]
        compiling, machine = timed(Component, fmu)
        description = fmpy.read_model_description(str(fmu))
        native = fmpy.instantiate_fmu(fmpy.extract(str(fmu), str(folder / "fmu")), description)
        runs = (lambda: timed(_in_wasmtime, machine)[0], lambda: timed(_natively, native)[0])
        ratio = median_ratio(REPETITIONS, *runs)
    print("| | |\n| --- | ---: |")
    print(f"| the component | {component.file_size / 1e6:.1f} MB |")
    print(f"| in the FMU, compressed | {component.compress_size / 1e6:.2f} MB |")
    print(f"| the library of {platform} beside it | {library.compress_size / 1e6:.2f} MB |")
    print(f"| to make it, once for a version | {taken:.0f} s of CPU |")
    print(f"| to compile it in wasmtime, for each load | {compiling:.1f} s of CPU |")
    print(f"| the rig's run-down in wasmtime, over the native library's time | {ratio:.2f} |")


def _in_wasmtime(machine: Component) -> None:
    instance = machine.instantiate().start()
    for i in range(COUNT):
        instance.call("set-float64", [0], [SPEED + RATE * i * STEP])
        assert instance.call("do-step", i * STEP, STEP, True) != "error"
    instance.drop()


def _natively(fmu: fmpy.fmi3.FMU3Slave) -> None:
    fmu.enterInitializationMode(startTime=0.0)
    fmu.exitInitializationMode()
    for i in range(COUNT):
        fmu.setFloat64([0], [SPEED + RATE * i * STEP])
        fmu.doStep(i * STEP, STEP)
    fmu.reset()


if __name__ == "__main__":
    main()
