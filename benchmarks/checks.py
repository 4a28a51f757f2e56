"""What the checks cost that keep a run from being wrong in silence: python -m benchmarks.checks

In a run: the monitors for the false state, for what the integrator takes and for the work of a
cycle, called as often as a run-down of the rig makes steps, beside the CPU time of that run-down.
At the start: the survey of growing whirls, of the rig and of the examples.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: CPU time is time

import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from rotor_fmu.model.kernels.jit import jit
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.settings import Settings, choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.control import Control
from rotor_fmu.model.time_loop.monitors import monitor_losses, monitor_walls, monitor_work

from rotor_fmu.machine_file.loading import machine_text

EXAMPLES = Path(__file__).parents[1] / "examples"
TURNS = 5
STOP, INTERVAL = 40.0, 0.01  # of the run-down [s]
SETTINGS = {
    "tolerance 1e-2": choose(tolerance=1e-2),
    "the default": choose(),
    "robust": choose("robust"),
}


def _watched(steps, h, structure, control, motion, memory, work):
    """All watches but those that outputs need, once a step of length h [s]."""
    r = memory.record[0]
    doubtful = 0
    for _ in range(steps):
        r.t += h
        if monitor_work(structure, memory):
            doubtful += 1
        monitor_walls(structure, motion, memory)
        monitor_losses(structure, control, motion, memory, work)
    return doubtful


watched = jit(_watched, to_cache=False)


def run_down(settings: Settings) -> Simulation:
    """The rig's run-down at its end."""
    sim = _begun(rig(), settings)
    for i in range(round(STOP / INTERVAL)):
        sim.advance((i + 1) * INTERVAL, 400.0 - 10.0 * i * INTERVAL)
    return sim


def _begun(rotor: Rotor, settings: Settings) -> Simulation:
    return Simulation(rotor, settings, speed=400.0, rate=-10.0, warn=lambda message: None)


def seconds(call: Callable[[], object]) -> float:
    """Median CPU time of a call [s]."""
    call()
    taken = []
    for _ in range(TURNS):
        begin = time.process_time()
        call()
        taken.append(time.process_time() - begin)
    return statistics.median(taken)


def in_a_run() -> Iterator[tuple[str, int, float, float]]:
    """Settings, steps, CPU time of the run-down and of as many watches, two contacts closed [s]."""
    for name, settings in SETTINGS.items():
        steps = int(run_down(settings).read("solver.steps"))
        whole = seconds(partial(run_down, settings))
        run, numbers = _begun(rig(), settings)._run, settings.numbers
        names = [name for name in Control._fields if name not in Control._field_defaults]
        control = Control(**{name: numbers[name].item() for name in names})
        given = steps, STOP / steps, run.structure, control, run.motion, run.memory, run.work
        yield name, steps, whole, seconds(partial(watched, *given))


def at_the_start() -> Iterator[tuple[str, float]]:
    """A machine, and CPU time of a survey of its whirls [s]."""
    files = ("jeffcott_rub/jeffcott.toml", "drop/compressor.toml", "from_ross/rubbing.toml")
    machines = {f: parse_rotor(machine_text("file", EXAMPLES / f)) for f in files}
    machines = {"the rig": rig(), **machines}
    for name, rotor in machines.items():
        sim = _begun(rotor, choose())
        yield name, seconds(partial(sim._entry_points.survey, 400.0, True))


def main() -> None:
    """Print both tables."""
    for name, steps, whole, checks in in_a_run():
        print(
            f"run-down, {name:15s} {steps:8,} steps, {whole:6.3f} s; watches {checks:7.4f} s: "
            f"{100 * checks / whole:.2g} %"
        )
    for name, taken in at_the_start():
        print(f"survey, {name:30s} {1e3 * taken:6.2f} ms")


if __name__ == "__main__":
    main()
