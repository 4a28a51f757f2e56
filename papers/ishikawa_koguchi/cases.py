"""What the impact experiments share: integrators as cases, progress, the end of a command."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from papers.integrators import members, spectral
from papers.integrators.members import Scheme
from rotor_fmu.errors import InputError, check_one_of

from ..integrators.schemes_command import Row, parse_scheme, remarks
from .impact.stepping.march import IMPACTS
from .result_table import ResultTable

# Paper B's sections 3.1.1 to 3.1.5, whose results are its Figures 3 to 7, and 3.2.
PAPER_BARS = ("newmark", "newmark=0.5,0.5", "hht=0.5", "moderate-dissipation", "transient-fidelity")
PAPER_RATCHET = ("moderate-dissipation", "transient-fidelity", "newmark")
FIGURE_8_OPENING = 0.0200008
# What Abaqus takes where nothing is said.
_OWN_IMPACT = {"transient-fidelity": "average-time"}
Result = TypeVar("Result")
console = Console(highlight=False, markup=False, soft_wrap=True)


@dataclass(frozen=True)
class ImpactCase:
    """An integrator under the name that the user gave it, and how it treats impacts."""

    name: str
    scheme: Scheme
    impact: str

    @property
    def label(self) -> str:
        """For tables and legends."""
        return self.name if self.impact == "no" else f"{self.name}, {self.impact}"

    @property
    def slug(self) -> str:
        """For the names of files."""
        return "".join(c if c.isalnum() or c in ".-" else "_" for c in self.label.replace(" ", ""))


def cases(names: Sequence[str], impact: str | None) -> list[ImpactCase]:
    """Integrators by the names of `papers.integrators schemes`; impact: `None`: each one's own.

    Raises `InputError` for what cannot make an implicit step.
    """
    if impact is not None:
        check_one_of(f"--impact {impact}", impact, IMPACTS)
    result = {}
    for text in names:
        name, method = parse_scheme(text)
        if not isinstance(method, Scheme):
            raise InputError(
                f"--scheme {text}: is not of the generalized-alpha family, whose step this is"
            )
        result[name] = ImpactCase(name, method, impact or _OWN_IMPACT.get(name, "no"))
    return list(result.values())


def flags(case: ImpactCase) -> list[str]:
    """What a user should know of these parameters before believing a run."""
    result = remarks(Row(case.name, case.scheme, 0.0, spectral.survey(case.scheme)))
    rebound = abs(members.rebound(case.scheme))
    if case.impact == "no" and rebound > 1.001:
        result.append(
            f"a contact point that touches for one step leaves {rebound:.3g} times faster"
        )
    return result


def positive(option: str, values: Sequence[float], unit: str = "s") -> Sequence[float]:
    """The values, each above zero and finite; `InputError` otherwise."""
    for value in values:
        if not 0 < value < math.inf:
            raise InputError(f"{option} {value:g} {unit}: must be > 0 and finite")
    return values


def carried_out(
    title: str, jobs: Sequence[tuple[str, float, Callable[[Callable[[float], None]], Result]]]
) -> list[tuple[Result, float]]:
    """Results and wall times [s] of jobs (label, end [s], run of a progress callback)."""
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    results = []
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=sum(end for _, end, _ in jobs))
        done = 0.0
        for label, end, run in jobs:
            bar.update(task, description=label)
            began = time.perf_counter()

            def progress(t: float, done: float = done) -> None:
                bar.update(task, completed=done + t)

            result = run(progress)
            results.append((result, time.perf_counter() - began))
            done += end
            bar.update(task, completed=done)
    return results


def finish(
    reports: Sequence[ResultTable], chosen: Sequence[ImpactCase], failures: Sequence[str], out: Path
) -> dict[str, Any]:
    """Print the tables, what is to be said of the parameters, and where things are.

    Returns the tables' rows, the remarks by case, and a status: `failed: ` and what ended early and
    was not meant to.
    """
    remarked = {case.label: result for case in chosen if (result := flags(case))}
    for report in reports:
        report.print(console)
    for label, result in remarked.items():
        console.print(f"{label}: {'; '.join(result)}.")
    console.print(f"written to {out}")
    return {
        "rows": [row for report in reports for row in report.rows],
        "remarks": remarked,
        "status": f"failed: {'; '.join(failures)}" if failures else "ok",
        "out": str(out),
    }
