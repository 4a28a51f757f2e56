"""Judge the machines that are drawn, the rig and the examples, and keep the rows for the pages.

`python -m tests.population [machines] [processes]`; by default 204 and 2.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor

import numpy as np
from rotor_fmu.model.settings import choose

from papers.integrators import tolerances

from .. import known
from .judge import TOLERANCES, errors, judged
from .machines import KINDS, drawn
from .truth import truth

MACHINES = 17 * len(KINDS)


def of_a_machine(seed: int) -> list[tolerances.Row]:
    """A machine at each tolerance."""
    case = drawn(seed)
    exact = truth(case)
    found = [(t, judged(case, exact, choose(tolerance=t))) for t in TOLERANCES]
    return [
        tolerances.Row("drawn", case.name, t, *vars(run).values(), exact.condition)
        for t, run in found
    ]


def known_machines() -> Iterator[tolerances.Row]:
    """The rig's windows and the examples at each tolerance."""
    for group, runs in (("rig", known.rig_windows()), ("examples", known.examples())):
        for run in runs:
            exact = run.exact()
            condition = known.condition(run, exact)
            for tolerance in TOLERANCES:
                status, orbit = run.found(choose(tolerance=tolerance))
                yield tolerances.Row(
                    group, run.name, tolerance, status, *errors(orbit, exact), condition
                )


def main(machines: int = MACHINES, processes: int = 2) -> None:
    """Judge everything, keep the rows for `docs/explanation/integrators.md`, print its table."""
    found = [*known_machines()]
    with ProcessPoolExecutor(processes) as pool:
        for rows in pool.map(of_a_machine, range(machines)):
            found += rows
            worst = max(rows, key=lambda row: row.conditioned)
            print(f"{worst.name}: {worst.conditioned:.2g} at {worst.tolerance:g}, {worst.status}")
            sys.stdout.flush()
    with tolerances.TABLE.open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(tolerances.Row._fields)
        lines.writerows(row._replace(status=row.status.split(" since")[0]).told() for row in found)
    for line in (tolerances.head(), *tolerances.table(tolerances.rows())):
        print(*line, sep=" | ")


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main(*map(int, sys.argv[1:]))
