"""The native FMU under a C master, beside its kernels by themselves."""

import resource
import shutil
import statistics
import subprocess
from collections.abc import Callable
from pathlib import Path

import fmpy
from rotor_fmu.model.kernels.library import here
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native

SPEED, RATE = 400.0, -10.0
_HERE = Path(__file__).parent


class CMaster:
    """The native FMU of the rig in a folder, and the C master's program."""

    def __init__(self, folder: Path) -> None:
        platform = here()
        assert platform is not None, "there is no native library for this machine"
        self.fmu = build_native(folder, machine_of(), platforms=[platform])
        unpacked = folder / "native"
        fmpy.extract(str(self.fmu), str(unpacked))
        described = fmpy.read_model_description(str(unpacked))
        outputs = [
            v.valueReference
            for v in described.modelVariables
            if v.causality == "output" and v.type == "Real"
        ]
        inputs = [v for v in described.modelVariables if v.causality == "input"]
        self.library = next((unpacked / "binaries" / platform).iterdir())
        self.idle = folder / "idle"
        self._program = folder / "master"
        compile_c(_HERE / "master.c", self._program, "-ldl", "-lm")
        block = folder / "block"
        simulation = Simulation(rig(), choose(), speed=SPEED)
        block.write_bytes(simulation._block.tobytes())
        self._about = [f"file://{unpacked}/resources", described.guid, str(block)]
        self._counts = [str(len(inputs)), str(outputs[0]), str(len(outputs))]

    def run(self, what: str, library: Path | None = None) -> float:
        """What the master prints; see `master.c`."""
        command = [self._program, library or self.library, *self._about, what, *self._counts]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        return float(done.stdout)

    def process_cpu(self, what: str) -> float:
        """CPU time of the whole process, from its start to its end [s]."""
        before = children_cpu()
        self.run(what)
        return children_cpu() - before

    def idle_fmu(self) -> Path:
        """A folder with the same FMU, whose library computes nothing."""
        shutil.copytree(self.library.parents[2], self.idle, dirs_exist_ok=True)
        target = self.idle / "binaries" / self.library.parent.name / self.library.name
        compile_c(_HERE / "idle.c", target, "-shared", "-fPIC")
        return self.idle


def compile_c(source: Path, target: Path, *options: str) -> None:
    subprocess.run(["cc", "-O2", "-o", str(target), str(source), *options], check=True)


def children_cpu() -> float:
    """CPU time of all processes that this one has waited for [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def medians(repetitions: int, *calls: Callable[[], float]) -> list[float]:
    """Medians of some measurements, made in turn so that all see the same machine."""
    rounds = [[call() for call in calls] for _ in range(repetitions)]
    return [statistics.median(of) for of in zip(*rounds, strict=True)]


def median_ratio(repetitions: int, one: Callable[[], float], other: Callable[[], float]) -> float:
    """Median of the ratios of two measurements, made in turn."""
    return statistics.median(one() / other() for _ in range(repetitions))
