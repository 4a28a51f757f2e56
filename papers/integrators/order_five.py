"""What an error costs with generalized-alpha and with Radau IIA: the rows that
`benchmarks.order_five` makes, and what the page of integrators says of them."""

import csv
from collections.abc import Sequence
from itertools import pairwise
from math import exp, log
from pathlib import Path
from statistics import median
from typing import NamedTuple

TABLE = Path(__file__).parent / "order_five.csv"
METHODS = ("generalized-alpha", "radau5")
ERRORS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)  # at which the costs are compared


class Row(NamedTuple):
    """A run: machine, method, tolerance [1], largest error of an orbit over its size [1], CPU time
    [s], steps."""

    machine: str
    method: str
    tolerance: float
    error: float
    cpu: float
    steps: int

    def cells(self) -> tuple[object, ...]:
        """Its cells in the table."""
        return (
            *(self.machine, self.method, f"{self.tolerance:g}"),
            *(f"{self.error:.3g}", f"{self.cpu:.3g}", self.steps),
        )


def rows() -> list[Row]:
    """The rows that were kept."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return [
            Row(m, method, float(t), float(e), float(cpu), int(n))
            for m, method, t, e, cpu, n in list(csv.reader(file))[1:]
        ]


def cost(curve: Sequence[Row], error: float) -> float | None:
    """CPU time at which a curve reaches an error [s], between its points as a power of it; of an
    error above all of its own that of its cheapest point, None of one below. Of points that a
    cheaper one is better than, none counts."""
    best: list[Row] = []
    for row in sorted(curve, key=lambda row: row.cpu):
        if not best or row.error < best[-1].error:
            best.append(row)
    if best and error >= best[0].error:
        return best[0].cpu
    for coarse, fine in pairwise(best):
        if fine.error <= error <= coarse.error:
            share = log(coarse.error / error) / log(coarse.error / fine.error)
            return exp(log(coarse.cpu) + share * log(fine.cpu / coarse.cpu))
    return None


def ratio(rows: Sequence[Row], machine: str, error: float) -> float | None:
    """CPU time of radau5 over that of generalized-alpha at the same error [1], if both have it."""
    alpha, radau = (
        cost([row for row in rows if (row.machine, row.method) == (machine, method)], error)
        for method in METHODS
    )
    return radau / alpha if alpha and radau else None


def _power(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def head() -> list[str]:
    """The table's head."""
    return ["machine", *(_power(error) for error in ERRORS)]


def table(rows: Sequence[Row]) -> list[list[str]]:
    """For each machine the ratios of CPU time at some errors."""
    machines = dict.fromkeys(row.machine for row in rows)
    return [
        [name, *("-" if (r := ratio(rows, name, e)) is None else f"{r:.2f}" for e in ERRORS)]
        for name in machines
    ]


def tolerance_head(rows: Sequence[Row]) -> list[str]:
    """The head of `tolerance_table`."""
    return ["machine", "method", *(_power(tolerance) for tolerance in _tolerances(rows))]


def _tolerances(rows: Sequence[Row]) -> list[float]:
    return sorted({row.tolerance for row in rows}, reverse=True)


def tolerance_table(rows: Sequence[Row]) -> list[list[str]]:
    """For each machine and method the error, in tolerances, and the CPU time [ms] at each
    tolerance."""
    results = {row[:3]: f"{row.error / row.tolerance:.2g}; {1e3 * row.cpu:.3g}" for row in rows}
    return [
        [machine, method, *(results.get((machine, method, t), "-") for t in _tolerances(rows))]
        for machine in dict.fromkeys(row.machine for row in rows)
        for method in METHODS
    ]


def in_words(rows: Sequence[Row]) -> dict[str, str]:
    """The sentences about the table: the ratios at each error, and from which error on the median
    machine is cheaper with radau5."""
    machines = dict.fromkeys(row.machine for row in rows)
    medians = {}
    for error in ERRORS:
        ratios = [r for machine in machines if (r := ratio(rows, machine, error)) is not None]
        if ratios:
            medians[error] = (median(ratios), max(ratios))
    said = ", ".join(f"{middle:.2f} at {_power(error)}" for error, (middle, _) in medians.items())
    worst = ", ".join(f"{most:.2f} at {_power(error)}" for error, (_, most) in medians.items())
    cheaper = [error for error, (middle, _) in medians.items() if middle < 1.0]
    return {
        "five_machines": str(len(machines)),
        "five_words": f"Median {said};\nworst {worst}.",
        "five_from": _power(max(cheaper)) if cheaper else "none that was measured",
    }
