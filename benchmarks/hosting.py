"""What the FMU's face adds: communication steps, the start of a process, memory."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from rotor_fmu.job import fmu_in, prepare
from rotor_fmu.run_down import run_direct, run_fmu

from .problem import Diverged, Missing, beginning
from .race import PEERS
from .store import Store

COMMUNICATION = (0.002, 0.01, 0.04, 0.1)  # [s]
NONE = "Python, NumPy, SciPy and numba alone"
DEFAULT_STEP = 0.04  # of the FMU's default experiment [s]

# A master of its own: nothing but FMPy, the signal and what is asked for.
_MASTER = """
import sys
import fmpy, numpy
speed = numpy.array([(0.0, 400.0), (40.0, 0.0)], dtype=[("time", float), ("speed", float)])
fmpy.simulate_fmu(sys.argv[1], stop_time=float(sys.argv[2]), output_interval=float(sys.argv[3]),
    input=speed, output=["phi", "tau", "disc[3].x", "disc[3].y"])
"""
_ALONE = """
import sys
from benchmarks.hosting import peak_memory, run_alone
run_alone(sys.argv[1])
print(peak_memory())
"""


def hosting(
    store: Store, repetitions: int, is_quick: bool, report: Callable[[str, float], None]
) -> None:
    """Fill the sections `communication` (CPU seconds through FMPy and directly), `process` (wall
    and CPU seconds from its start to the result) and `memory` (peak, bytes)."""
    stop = 4.0 if is_quick else 40.0
    with tempfile.TemporaryDirectory() as folder:
        job = prepare(None, None, [], None, stop, None)
        fmu = fmu_in(Path(folder), job.toml)
        run_fmu(fmu, replace(job, stop=0.1))
        for step in COMMUNICATION:
            name = f"{step:g} s"
            if name in store.section("communication"):
                continue
            report(f"through FMPy: {name}", 0.0)
            plan = replace(job, step=step)
            runs = {"fmpy_cpu_s": [], "direct_cpu_s": []}
            for _ in range(repetitions):
                runs["fmpy_cpu_s"].append(_cpu(partial(run_fmu, fmu, plan)))
                runs["direct_cpu_s"].append(_cpu(partial(run_direct, job.rotor, plan)))
            store.keep("communication", name, {"step": step, **runs})
        if not store.section("process"):
            command = [sys.executable, "-c", _MASTER, str(fmu), str(stop), str(DEFAULT_STEP)]
            _started(command)
            report("a process of its own", 0.0)
            measured = [_started(command)[:2] for _ in range(repetitions)]
            row = {"wall_s": [m[0] for m in measured], "cpu_s": [m[1] for m in measured]}
            store.keep("process", "fmpy", row)
    for program in (NONE, *(peer.PROGRAM for peer in PEERS)):
        if program not in store.section("memory"):
            report(f"peak memory: {program}", 0.0)
            output = _started([sys.executable, "-c", _ALONE, program])[2]
            store.keep("memory", program, {"peak": int(output.split()[-1])})


def run_alone(program: str) -> None:
    """The first of a program's methods that gets through the beginning of the run-down, if any."""
    for peer in PEERS:
        with contextlib.suppress(Missing):
            for method in peer.methods() if program == peer.PROGRAM else ():
                with contextlib.suppress(Diverged):
                    method.solve(beginning())
                    return


def peak_memory() -> int:
    """Largest resident memory of this process so far [bytes]."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage's figure also counts the process from which this one came
        line = next(x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        return 1024 * int(line.split()[1])
    import resource  # not on Windows

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


def _cpu(call: Callable[[], object]) -> float:
    begun = time.process_time()
    call()
    return time.process_time() - begun


def _started(command: list[str]) -> tuple[float, float, str]:
    """Wall and CPU seconds of a process, and its output."""
    before = os.times()
    begun = time.perf_counter()
    root = Path(__file__).parent.parent
    done = subprocess.run(command, check=True, capture_output=True, text=True, cwd=root)
    wall = time.perf_counter() - begun
    after = os.times()
    cpu = after.children_user - before.children_user
    cpu += after.children_system - before.children_system
    return wall, cpu, done.stdout
