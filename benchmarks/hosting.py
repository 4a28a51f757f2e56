"""What the FMU's face adds: the cost of a run through FMPy over the communication step."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rotor_fmu.runs.job import Job, prepare
from rotor_fmu.runs.run_down import run_direct, run_fmu

from .problem import timed
from .store import Store

COMMUNICATION = (0.002, 0.01, 0.04, 0.1)  # [s]


def default_job(stop: float) -> Job:
    """The run-down with the default preset, to `stop` [s]."""
    return prepare(None, None, [], None, stop, None)


def hosting(
    store: Store,
    fmu: Path,
    repetitions: int,
    is_quick: bool,
    report: Callable[[str, float], None],
) -> None:
    """Fill the section `communication`: CPU seconds through FMPy and directly, each run's."""
    job = default_job(4.0 if is_quick else 40.0)
    run_fmu(fmu, replace(job, stop=0.1))
    for number, step in enumerate(COMMUNICATION):
        name = f"{step:g} s"
        if name in store.section("communication"):
            continue
        report(f"through FMPy: communication step {name}", number / len(COMMUNICATION))
        plan = replace(job, step=step)
        runs: dict[str, list[float]] = {"fmpy_cpu_s": [], "direct_cpu_s": []}
        for _ in range(repetitions):
            runs["fmpy_cpu_s"].append(timed(run_fmu, fmu, plan)[0])
            runs["direct_cpu_s"].append(timed(run_direct, plan)[0])
        store.keep("communication", name, {"step": step, **runs})
