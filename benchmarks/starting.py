"""What is paid before the first step, and what many contacts cost: python -m benchmarks.starting"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from rotor_fmu.model.linear.campbell import campbell
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from .growth import refined, with_bearings
from .problem import RATE, SPEED, run_down, timed
from .store import Store, median

FIRST = "first rf.simulate of a process, import to first step"
_MANY = 84  # elements of the machines in many bearings
STEP, STEPS = "a step, {count} bearings on 84 elements", 2000
_H = 1e-4  # [s]
_FIRST = """
import time
import rotor_fmu as rf
rf.simulate(rf.load(), speed=185.0, stop=0.001)
print(time.process_time())
"""
# what, the most that it may take [s of CPU]
GOALS = {
    "Simulation() at 600 elements": 0.3,
    "Simulation() at 1000 elements": 0.5,
    "survey of whirls at 28 elements": 0.015,
    "survey of whirls at 40 bearings on 84 elements": 0.3,
    "Campbell diagram of 25 speeds on 25 nodes": 3.0,
    FIRST: 0.4,
}


def starting(store: Store, repetitions: int, report: Callable[[str, float], None]) -> None:
    """Fill the section `starting`: CPU seconds of each, each run's."""
    for _ in range(repetitions):
        for name, measured in _all():
            row = store.section("starting").get(name, {"cpu_s": []})
            if len(row["cpu_s"]) < repetitions:
                report(name, 0.5)
                store.keep("starting", name, {"cpu_s": [*row["cpu_s"], measured()]})


def _all() -> Iterator[tuple[str, Callable[[], float]]]:
    rig = run_down().rotor
    for elements in (600, 1000):
        yield f"Simulation() at {elements} elements", partial(_begun, refined(rig, elements))
    yield "survey of whirls at 28 elements", partial(_surveyed, refined(rig, 28))
    dense = refined(rig, _MANY)
    for count in (16, 40):
        machine = with_bearings(dense, count)
        yield STEP.format(count=count), partial(_stepped, machine)
        if count == 40:
            yield (
                f"survey of whirls at {count} bearings on {_MANY} elements",
                partial(_surveyed, machine),
            )
    yield "Campbell diagram of 25 speeds on 25 nodes", partial(_diagram, refined(rig, 24))
    yield FIRST, _first


def _simulation(rotor: Rotor) -> Simulation:
    settings = choose("robust", h=_H)
    return Simulation(rotor, settings, speed=SPEED, rate=RATE, warn=lambda message: None)


def _begun(rotor: Rotor) -> float:
    return timed(_simulation, rotor)[0]


def _surveyed(rotor: Rotor) -> float:
    simulation = _simulation(rotor)
    return timed(simulation._entry_points.survey, SPEED, True)[0]


def _stepped(rotor: Rotor) -> float:
    simulation = _simulation(rotor)
    simulation.advance(STEPS * _H / 10, SPEED, rate=RATE)
    end = simulation.time + STEPS * _H
    return timed(partial(simulation.advance, rate=RATE), end, SPEED)[0] / STEPS


def _diagram(rotor: Rotor) -> float:
    return timed(campbell, rotor, np.linspace(0.0, SPEED, 25))[0]


def _first() -> float:
    """Of a process that finds its modules compiled to byte code, as installed ones are."""
    with tempfile.TemporaryDirectory() as cache:
        command = [sys.executable, "-X", f"pycache_prefix={cache}", "-c", _FIRST]
        environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
        for _ in range(2):
            done = subprocess.run(
                command, capture_output=True, text=True, check=True, env=environment
            )
        return float(done.stdout)


def goals(store: Store) -> Iterator[tuple[str, str, str, bool]]:
    """What is to be reached, with its figure."""
    rows = {name: median(row["cpu_s"]) for name, row in store.section("starting").items()}
    few, many = (rows.get(STEP.format(count=count)) for count in (16, 40))
    if few and many:
        what = "a step with 40 bearings on 84 elements, to one with 16"
        yield what, "at most 4 times", f"{many / few:.1f} times", many <= 4 * few
    for name, most in GOALS.items():
        if name in rows:
            unit = (1e3, "ms") if most < 0.1 else (1.0, "s")
            shown = f"{rows[name] * unit[0]:.3g} {unit[1]}"
            yield name, f"at most {most * unit[0]:g} {unit[1]} of CPU", shown, rows[name] <= most


def main() -> None:
    """Print the table."""
    for name, measured in _all():
        values = [measured() for _ in range(3)]
        print(f"| {name} | {median(values) * 1e3:.3g} ms |", flush=True)


if __name__ == "__main__":
    main()
