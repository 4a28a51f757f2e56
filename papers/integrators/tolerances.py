"""What a tolerance promises: errors of error-controlled runs, judged by CVODE or, of what its
equations know nothing of, by another integrator, over many machines.

The rows are kept beside this module; `python -m tests.population` makes them anew.
"""

import csv
import statistics
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

TABLE = Path(__file__).with_name("tolerances.csv")
TOLERANCES = (1e-2, 1e-3, 1e-4)
TEN = 10.0  # tolerances, times 1 + condition, that most orbits are within
TAME = 10.0  # condition below which a largest displacement is promised
GROUPS = {
    "drawn": "drawn at random",
    "fast": "drawn at random, fast",
    "bearings": "drawn at random, other bearings",
    "rig": "the rig, four windows",
    "examples": "examples",
}


class Row(NamedTuple):
    """A run: errors of the largest displacement, of the displacement's size, direction [rad] and
    place, relative to the largest, and the condition of the machine [1]."""

    group: str
    name: str
    tolerance: float
    status: str
    peak: float
    amplitude: float
    phase: float
    orbit: float
    condition: float

    @property
    def conditioned(self) -> float:
        """Error of the orbit in tolerances, over 1 + condition."""
        return self.orbit / self.tolerance / (1 + self.condition)

    def cells(self) -> tuple[str, ...]:
        """As text, with three digits."""
        return tuple(value if isinstance(value, str) else f"{value:.3g}" for value in self)


def rows() -> list[Row]:
    """Those that are kept."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return [
            Row._make(r[n] if n in ("group", "name", "status") else float(r[n]) for n in r)
            for r in csv.DictReader(file)
        ]


def of(result: Sequence[Row], group: str, tolerance: float) -> list[Row]:
    """The runs of a group at a tolerance that ended without a doubt."""
    return [r for r in result if (r.group, r.tolerance, r.status) == (group, tolerance, "ok")]


def head() -> list[str]:
    """The heads of `table`."""
    return [
        "machines",
        "tolerance",
        "`ok`",
        "largest displacement off by",
        "size, direction off by [tolerances], median",
        "orbit off by [tolerances]",
        "over 1 + condition",
    ]


def table(result: Sequence[Row]) -> list[list[str]]:
    """A row a group and tolerance: median and worst of the runs that ended well."""
    lines = []
    for group, title in GROUPS.items():
        for tolerance in TOLERANCES:
            runs = of(result, group, tolerance)
            count = sum(r.group == group and r.tolerance == tolerance for r in result)
            lines.append(
                [
                    title,
                    f"{tolerance:g}",
                    f"{len(runs)} of {count}",
                    _both([100 * r.peak for r in runs], " %"),
                    f"{statistics.median(r.amplitude for r in runs) / tolerance:.2g}, "
                    f"{statistics.median(r.phase for r in runs) / tolerance:.2g}",
                    _both([r.orbit / r.tolerance for r in runs]),
                    _both([r.conditioned for r in runs]),
                ]
            )
    return lines


def worst(result: Sequence[Row], count: int = 5) -> list[list[str]]:
    """The runs that ended well whose orbits are off most, each machine once."""
    runs = sorted((r for r in result if r.status == "ok"), key=lambda r: -r.conditioned)
    each = list({r.name: r for r in reversed(runs)}.values())[-1 : -count - 1 : -1]
    return [
        [
            r.name,
            f"{r.tolerance:g}",
            *(f"{v:.2g}" for v in (r.orbit / r.tolerance, r.condition, r.conditioned)),
        ]
        for r in each
    ]


def worst_head() -> list[str]:
    """The heads of `worst`."""
    return ["machine", "tolerance", "orbit off by [tolerances]", "condition", "over 1 + condition"]


def in_words(result: Sequence[Row]) -> dict[str, str]:
    """What the page says of them beside the tables, by the names in its template."""
    tame = [r for r in result if r.status == "ok" and r.condition < TAME]
    peaks = [100 * max(r.peak for r in tame if r.tolerance == t) for t in TOLERANCES]
    warned = [
        r.status.removeprefix("doubtful: ") if r.status.startswith("doubtful") else "failed"
        for r in result
        if r.status != "ok"
    ]
    conditions = [r.condition for r in result]
    return {
        "runs": str(len(result)),
        "above": str(sum(r.status == "ok" and r.conditioned > TEN for r in result)),
        "worst": f"{max(r.conditioned for r in result if r.status == 'ok'):.2g}",
        "machines": str(len({r.name for r in result if r.group == "drawn"})),
        "fast": str(len({r.name for r in result if r.group == "fast"})),
        "bearings": str(len({r.name for r in result if r.group == "bearings"})),
        "condition": f"{max(conditions):.2g}",
        "least_condition": f"{min(conditions):.2g}",
        "peaks": ", ".join(f"{peak:.2g} %" for peak in peaks),
        "doubtful": " and ".join(f"{warned.count(d)} {d}" for d in dict.fromkeys(warned)) or "none",
    }


def _both(values: Sequence[float], unit: str = "") -> str:
    return f"{statistics.median(values):.2g}, {max(values):.2g}{unit}"
