"""Judge the machines that are drawn, the rig and the examples, and keep the rows for the pages.

`python -m tests.population [processes]`; by default 2.
"""

import csv
import json
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from rotor_fmu.model.kernels.library import find, here
from rotor_fmu.model.settings import choose

from papers.integrators import tolerances

from .. import known
from . import bearings
from .judge import TOLERANCES, errors, judged
from .machines import FAST, KINDS, drawn
from .truth import truth

STORE = Path("build/population")


def _is_slow(seed: int) -> bool:
    return KINDS[seed % len(KINDS)] == "touchdown"


# Fast journals that hop in touchdown bearings are left out: CVODE takes many minutes for each.
MACHINES = (
    *range(17 * len(KINDS)),
    *(seed for seed in range(FAST, FAST + 2 * len(KINDS)) if not _is_slow(seed)),
)
# Of the machines with bearings that CVODE's equations know nothing of: in `MACHINES` from here on.
BEARINGS = 10**6
MACHINES += tuple(BEARINGS + seed for seed in range(3 * len(bearings.KINDS)))


def of_a_machine(seed: int) -> list[tolerances.Row]:
    """A machine at each tolerance."""
    if seed < BEARINGS:
        group, case = "drawn" if seed < FAST else "fast", drawn(seed)
        exact = truth(case)
    else:
        group, case = "bearings", bearings.drawn(seed - BEARINGS)
        exact = bearings.truth(case)
    result = [(t, judged(case, exact, choose(tolerance=t))) for t in TOLERANCES]
    return [
        tolerances.Row(group, case.name, t, *vars(run).values(), exact.condition)
        for t, run in result
    ]


def known_machines() -> Iterator[tolerances.Row]:
    """The rig's windows and the examples at each tolerance."""
    for group, runs in (("rig", known.rig_windows()), ("examples", known.examples())):
        for run in runs:
            exact = run.exact()
            condition = known.condition(run, exact)
            for tolerance in TOLERANCES:
                status, orbit = run.solve(choose(tolerance=tolerance))
                yield tolerances.Row(
                    group, run.name, tolerance, status, *errors(orbit, exact), condition
                )


def drawn_machines(processes: int) -> list[tolerances.Row]:
    """Each of the machines at each tolerance; those that an earlier, stopped call has made with the
    same kernels are taken from `STORE`."""
    library = find(here() or "none")
    store = STORE / f"{library.stem if library else 'none'}.jsonl"
    store.parent.mkdir(parents=True, exist_ok=True)
    made = {}
    if store.exists():
        lines = map(json.loads, store.read_text(encoding="utf-8").splitlines())
        made = {seed: [tolerances.Row(*row) for row in rows] for seed, rows in lines}
    # CVODE takes longest for races
    left = sorted({*MACHINES} - {*made}, key=lambda seed: (_is_slow(seed), seed))
    with ProcessPoolExecutor(processes) as pool, store.open("a", encoding="utf-8") as file:
        for seed, rows in zip(left, pool.map(of_a_machine, left), strict=True):
            made[seed] = rows
            file.write(json.dumps([seed, rows]) + "\n")
            file.flush()
            worst = max(rows, key=lambda row: row.conditioned)
            print(f"{worst.name}: {worst.conditioned:.2g} at {worst.tolerance:g}, {worst.status}")
            sys.stdout.flush()
    return [row for seed in MACHINES for row in made[seed]]


def main(processes: int = 2) -> None:
    """Judge everything, keep the rows where `docs/integrators.md` finds them, print its table."""
    result = [*drawn_machines(processes), *known_machines()]
    with tolerances.TABLE.open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(tolerances.Row._fields)
        lines.writerows(row.cells() for row in result)
    for line in (tolerances.head(), *tolerances.table(tolerances.rows())):
        print(*line, sep=" | ")


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main(*map(int, sys.argv[1:]))
