"""What an error costs with generalized-alpha and with Radau IIA: python -m benchmarks.order_five

Five machines, each for half a second to two seconds from its start, at several tolerances of both
methods. Error: largest distance of the contacts' nodes from a run of Radau IIA at a tolerance of
1e-8, over the largest displacement; that those of generalized-alpha fall with its tolerance too
shows that both find the same motion. CPU time: the least of some runs. Writes
`papers/integrators/order_five.csv`, of which docs/explanation/integrators.md is made.
"""

import csv
import os
import sys

os.environ["OMP_NUM_THREADS"] = "1"

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from papers.integrators.order_five import METHODS, TABLE, Row, head, table
from rotor_fmu.machine_file.loading import machine_text

EXAMPLES = Path(__file__).parents[1] / "examples"
TOLERANCES = tuple(10.0**-i for i in range(1, 8))
FINEST = 1e-8
SAMPLES_PER_SECOND = 500
REPETITIONS = 2


@dataclass(frozen=True)
class Run:
    """A machine at speed + rate t [rad/s] from its start until `stop` [s]."""

    name: str
    rotor: Rotor
    speed: float
    rate: float
    stop: float

    def solve(self, method: str, tolerance: float) -> tuple[np.ndarray, float, int]:
        """Orbits of the nodes that may touch [m], CPU time [s], steps."""
        given = {} if method == METHODS[0] else {"method": method}
        simulation = Simulation(
            self.rotor,
            choose(tolerance=tolerance, **given),
            speed=self.speed,
            rate=self.rate,
            warn=lambda message: None,
        )
        dofs = simulation.structure.interfaces.dof
        orbit = []
        began = time.process_time()
        for t in np.linspace(0.0, self.stop, 1 + round(SAMPLES_PER_SECOND * self.stop))[1:]:
            simulation.advance(t, self.speed + self.rate * simulation.time, rate=self.rate)
            orbit.append(simulation.motion.q[dofs].copy())
        cpu = time.process_time() - began
        return np.array(orbit), cpu, int(simulation.read("solver.steps"))


def runs() -> list[Run]:
    """The machines."""

    def read(file: str, more: str = "") -> Rotor:
        return parse_rotor(machine_text("file", EXAMPLES / file) + more)

    return [
        Run("rig", rig(), 400.0, -10.0, 2.0),
        Run("jeffcott_rub", read("jeffcott_rub/jeffcott.toml"), 120.0, 0.0, 1.0),
        Run("from_ross", read("from_ross/rubbing.toml"), 335.0, 12.0, 1.0),
        Run("drop", read("drop/compressor.toml"), 1000.0, 0.0, 0.4),
        Run(
            "magnetic_bearing, off",
            read("magnetic_bearing/compressor.toml", "\n[start]\ny = 0.0\n"),
            600.0,
            0.0,
            0.4,
        ),
    ]


def measured(run: Run) -> list[Row]:
    """The rows of a machine."""
    exact, _, _ = run.solve(METHODS[1], FINEST)
    size = np.abs(exact - exact[0]).max()
    rows = []
    for method in METHODS:
        for tolerance in TOLERANCES:
            results = [run.solve(method, tolerance) for _ in range(REPETITIONS)]
            orbit, _, steps = results[0]
            error = float(np.abs(orbit - exact).max() / size)
            cpu = min(cpu for _, cpu, _ in results)
            rows.append(Row(run.name, method, tolerance, error, cpu, steps))
            print(*rows[-1], sep="  ", flush=True)
    return rows


def main(*names: str) -> None:
    """Measure all machines and keep the rows, or print those of some."""
    rows = [row for run in runs() if not names or run.name in names for row in measured(run)]
    if not names:
        with TABLE.open("w", encoding="utf-8", newline="") as file:
            lines = csv.writer(file, lineterminator="\n")
            lines.writerow(Row._fields)
            lines.writerows(row.cells() for row in rows)
    for line in (head(), *table(rows)):
        print(*line, sep=" | ")


if __name__ == "__main__":
    main(*sys.argv[1:])
