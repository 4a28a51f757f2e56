"""What only a process of its own can tell: from its start to the result, without numba, memory."""

import contextlib
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from rotor_fmu.model.settings import choose

from .peers import project
from .problem import Diverged, Missing, beginning, timed
from .race import PEERS
from .store import Store

WARM, COLD = "warm", "first on a machine"
INTERPRETED = "this project without numba, h = 0.0001 s"
NOTHING = "Python, NumPy, SciPy and numba alone"
_COMMUNICATION = 0.04  # step of the run-down through the FMU [s]

# A master of its own: nothing but FMPy, the signal and what is asked for.
_MASTER = """
import sys
import fmpy, numpy
speed = numpy.array([(0.0, 400.0), (40.0, 0.0)], dtype=[("time", float), ("speed", float)])
fmpy.simulate_fmu(sys.argv[1], stop_time=float(sys.argv[2]), output_interval=float(sys.argv[3]),
    input=speed, output=["phi", "tau", "disc[3].x", "disc[3].y"])
"""
_MEMORY = """
import sys
from benchmarks.processes import peak_memory, run_alone
run_alone(sys.argv[1])
print(peak_memory())
"""
_STEP = """
from benchmarks.processes import step_alone
print(step_alone())
"""


def processes(
    store: Store,
    fmu: Path,
    repetitions: int,
    is_quick: bool,
    report: Callable[[str, float], None],
) -> None:
    """Fill the sections `process` (wall and CPU seconds of an FMPy master, each run's), `step cost`
    of the interpreted model, and `memory` (peak, bytes)."""
    master = ["-c", _MASTER, str(fmu), "4" if is_quick else "40", str(_COMMUNICATION)]
    with tempfile.TemporaryDirectory() as cache:
        plan = {WARM: (repetitions, {}), COLD: (1, {"ROTOR_FMU_CACHE": cache})}
        for name, (times, environment) in plan.items():
            if name in store.section("process"):
                continue
            report(f"a process of its own: {name}", 0.0)
            if name == WARM:
                _started(master, environment)
            runs = [_started(master, environment) for _ in range(times)]
            row = {"wall_s": [run[0] for run in runs], "cpu_s": [run[1] for run in runs]}
            store.keep("process", name, row)
    if INTERPRETED not in store.section("step cost"):
        report("a step without numba", 0.3)
        output = _started(["-c", _STEP], {"NUMBA_DISABLE_JIT": "1"})[2]
        cost = {"h": 1e-4, "us": [float(output.split()[-1])], "failed": None}
        store.keep("step cost", INTERPRETED, cost)
    for program in (NOTHING, *(peer.PROGRAM for peer in PEERS if _is_here(peer))):
        if program not in store.section("memory"):
            report(f"peak memory: {program}", 0.6)
            output = _started(["-c", _MEMORY, program], {})[2]
            store.keep("memory", program, {"peak": int(output.split()[-1])})


def run_alone(program: str) -> None:
    """The first of a program's methods that gets through the beginning of the run-down, if any."""
    for peer in PEERS:
        for method in peer.methods() if program == peer.PROGRAM else ():
            with contextlib.suppress(Diverged):
                method.solve(beginning())
                return


def step_alone() -> float:
    """Microseconds a step of this project, as this process runs it."""
    seconds, result = timed(project.method("", choose("robust", h=1e-4)).solve, beginning())
    return 1e6 * seconds / result.steps


def peak_memory() -> int:
    """Largest resident memory of this process so far [bytes]."""
    status = Path("/proc/self/status")
    if status.exists():  # getrusage's figure also counts the process from which this one came
        line = next(x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        return 1024 * int(line.split()[1])
    import resource  # not on Windows

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else 1024 * peak


def _is_here(peer: ModuleType) -> bool:
    try:
        peer.methods()
    except Missing:
        return False
    return True


def _started(arguments: list[str], environment: dict[str, str]) -> tuple[float, float, str]:
    """Wall and CPU seconds of a Python process, and its output."""
    before = os.times()
    begun = time.perf_counter()
    done = subprocess.run(
        [sys.executable, *arguments],
        check=True,
        capture_output=True,
        text=True,
        cwd=Path(__file__).parent.parent,
        env=os.environ | environment,
    )
    wall = time.perf_counter() - begun
    after = os.times()
    cpu = after.children_user - before.children_user
    cpu += after.children_system - before.children_system
    return wall, cpu, done.stdout
