"""What the survey's table says: rows of one kind, medians, shares."""

import statistics
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from papers.integrators import members
from papers.integrators.members import Scheme

from .grid import Row

TITLES = {
    "newmark": "Newmark",
    "newmark=0.5,0.5": "Newmark 1/2, 1/2",
    "transient-fidelity": "HHT 0.05",
    "hht=0.1": "HHT 0.1",
    "hht=0.3333333333333333": "HHT 1/3",
    "moderate-dissipation": "HHT √2 - 1",
    "hht=0.5": "HHT 0.5",
    "wbz=-0.6": "WBZ -0.6",
    "wbz=-0.3": "WBZ -0.3",
    "wbz=-0.1": "WBZ -0.1",
    "wbz=0.08": "WBZ 0.08",
    "generalized-alpha=0.1,0.08": "gen.-alpha 0.1 / 0.08",
    "generalized-alpha=0.15,0.1": "gen.-alpha 0.15 / 0.1",
    **{f"chung-hulbert={i / 10:g}": f"Chung-Hulbert {i / 10:g}" for i in range(10)},
}


def title_of(label: str) -> str:
    """A scheme's name as it is written in pictures and tables."""
    return TITLES.get(label, label)


def scheme_of(row: Row) -> Scheme:
    """The scheme of a row."""
    return Scheme(row["alpha_m"], row["alpha_f"], row["beta"], row["gamma"])


@dataclass(frozen=True)
class Findings:
    """The rows of a survey's table."""

    rows: Sequence[Row]
    _groups: dict[tuple[str, ...], dict[tuple, list[Row]]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def of(self, experiment: str, **where: object) -> list[Row]:
        """Rows of an experiment in which the columns named have the values given."""
        columns = ("experiment", *where)
        if columns not in self._groups:
            groups = self._groups[columns] = defaultdict(list)
            for row in self.rows:
                groups[tuple(map(row.get, columns))].append(row)
        return list(self._groups[columns].get((experiment, *where.values()), ()))

    def schemes(self, experiment: str) -> list[str]:
        """Labels of the schemes that an experiment was run with, in the order of `TITLES`."""
        result = {row["scheme"] for row in self.of(experiment)}
        known = [label for label in TITLES if label in result]
        return known + sorted(result - set(known))

    def steps(self, experiment: str) -> list[float]:
        """Step lengths of an experiment, the longest first [s]."""
        return sorted({row["h"] for row in self.of(experiment)}, reverse=True)

    def nearest_step(self, experiment: str, h: float) -> float:
        """The step length of an experiment nearest to h [s]."""
        return min(self.steps(experiment), key=lambda step: abs(step - h))

    def trapped_share(self, scheme: str, h: float) -> float | None:
        """Share of the perturbed run-downs that fell into the false state [1]; None: none ended."""
        rows = self.of("rotor", scheme=scheme, h=h)
        ended = [row for row in rows if row["status"] in ("ok", "false state")]
        if not ended:
            return None
        return sum(row["status"] == "false state" for row in ended) / len(ended)

    def bounce_share(self, scheme: str, h: float, speed: float) -> float | None:
        """Share of the impacts, at the surveyed speed nearest to `speed` [m/s], that end in the
        false state [1]."""
        rows = self.of("bounce", scheme=scheme, h=h)
        if not rows:
            return None
        return min(rows, key=lambda row: abs(float(row["case"].split()[0]) - speed))["trapped"]

    def predictions(self) -> list[tuple[float, float, float]]:
        """Share of the run-downs in the false state, share predicted from one impact [1], step
        length [s], for each scheme and step with which the rotor gets to its end."""
        speed = self.impact_speed()
        result = []
        for scheme in self.schemes("rotor"):
            for h in self.steps("rotor"):
                seen = self.trapped_share(scheme, h)
                predicted = self.bounce_share(scheme, h, speed)
                if seen is not None and predicted is not None:
                    result.append((seen, predicted, h))
        return result

    def impact_speed(self) -> float:
        """Greatest speed of a journal in its clearance in the converged run-down [m/s]."""
        return max(row.get("impact_speed", 0.0) for row in self.of("rotor"))


def median(rows: Iterable[Row], column: str | Callable[[Row], float]) -> float | None:
    """Median of a column, or of a function of the rows; None without a value."""
    if callable(column):
        values = [column(row) for row in rows]
    else:
        values = [row[column] for row in rows if column in row]
    return statistics.median(values) if values else None


def spread(rows: Iterable[Row], column: str) -> tuple[float, float] | None:
    """Least and greatest value of a column; None without one."""
    values = [row[column] for row in rows if column in row]
    return (min(values), max(values)) if values else None


def false_state_power(row: Row) -> float:
    """Energy made for each second in the false state [W], of a run-down that fell into it."""
    return row["energy_made"] / (row["trapped"] * 40.0)


def rebound_of(row: Row) -> float:
    """Paper B's (12) as a restitution; see `schemes.rebound`."""
    return members.rebound(scheme_of(row))


def safe_schemes(findings: Findings) -> list[str]:
    """Integrators of which no run-down, no impact and no planted cycle is in the false state."""
    result = []
    for scheme in findings.schemes("rotor"):
        rows = findings.of("rotor", scheme=scheme)
        # a planted cycle may begin with a few steps in its state, but has to stay in it
        others = findings.of("bounce", scheme=scheme) + findings.of("planted", scheme=scheme)
        is_free = all(row["status"] == "ok" for row in rows)
        if is_free and not any(row.get("trapped", 0.0) > 0.0 for row in others):
            result.append(scheme)
    return result
