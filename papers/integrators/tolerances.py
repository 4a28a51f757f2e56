"""What a tolerance promises: errors of error-controlled runs, judged by CVODE, over many machines.

The rows are kept beside this module; `python -m tests.population` makes them anew.
"""

from __future__ import annotations

import csv
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

TABLE = Path(__file__).with_name("tolerances.csv")
TOLERANCES = (1e-2, 1e-3, 1e-4)
GROUPS = {"random": "drawn at random", "rig": "the rig, four windows", "examples": "examples"}


class Row(NamedTuple):
    """A run: the largest displacement's error, that beyond 1 % of unbalance, the orbit's error, and
    the condition of the machine [1]."""

    group: str
    name: str
    tolerance: float
    status: str
    peak: float
    beyond: float
    orbit: float
    condition: float

    @property
    def conditioned(self) -> float:
        """Error of the orbit in tolerances, over 1 + condition."""
        return self.orbit / self.tolerance / (1 + self.condition)

    @property
    def by_condition(self) -> float:
        """Error of the orbit in tolerances, over the condition."""
        return self.orbit / self.tolerance / self.condition

    def told(self) -> tuple[str, ...]:
        """As text, with three digits."""
        return tuple(value if isinstance(value, str) else f"{value:.3g}" for value in self)


def rows() -> list[Row]:
    """Those that are kept."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return [
            Row._make(r[n] if n in ("group", "name", "status") else float(r[n]) for n in r)
            for r in csv.DictReader(file)
        ]


def of(found: Sequence[Row], group: str, tolerance: float) -> list[Row]:
    """The runs of a group at a tolerance that ended without a doubt."""
    return [r for r in found if (r.group, r.tolerance, r.status) == (group, tolerance, "ok")]


def head() -> list[str]:
    """The heads of `table`."""
    return [
        "machines",
        "tolerance",
        "`ok`",
        "peak off by",
        "beyond 1 % of unbalance",
        "orbit off by [tolerances]",
        "over 1 + condition",
    ]


def table(found: Sequence[Row]) -> list[list[str]]:
    """A row a group and tolerance: median and worst of the runs that ended well."""
    lines = []
    for group, title in GROUPS.items():
        for tolerance in TOLERANCES:
            runs = of(found, group, tolerance)
            count = sum(r.group == group and r.tolerance == tolerance for r in found)
            lines.append(
                [
                    title,
                    f"{tolerance:g}",
                    f"{len(runs)} of {count}",
                    _both([100 * r.peak for r in runs], " %"),
                    f"{100 * max(r.beyond for r in runs):.2g} %" if group == "random" else "-",
                    _both([r.orbit / r.tolerance for r in runs]),
                    _both([r.conditioned for r in runs]),
                ]
            )
    return lines


def in_words(found: Sequence[Row]) -> dict[str, str]:
    """What the page says of them beside the table, by the names in its template."""
    runs = {tolerance: of(found, "random", tolerance) for tolerance in TOLERANCES}
    doubts = [r.status.split(":")[0] for r in found if r.status != "ok"]
    return {
        "condition": f"{max(r.condition for r in found):.0f}",
        "worst_by_condition": f"{max(r.by_condition for r in found if r.status == 'ok'):.2g}",
        "worst_conditioned": f"{max(r.conditioned for r in found if r.status == 'ok'):.2g}",
        "peak_coarse": f"{100 * max(r.peak for r in runs[1e-2]):.2g}",
        "above_one": str(sum(r.peak > 0.01 for r in runs[1e-3])),
        "beyond_default": f"{100 * max(r.beyond for r in runs[1e-3]):.2g}",
        "doubtful": " and ".join(f"{doubts.count(d)} {d}" for d in dict.fromkeys(doubts)),
    }


def _both(values: Sequence[float], unit: str = "") -> str:
    return f"{statistics.median(values):.2g}, {max(values):.2g}{unit}"
