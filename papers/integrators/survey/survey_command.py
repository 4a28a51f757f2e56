"""`python -m papers.integrators survey`: which integrator, at which step, survives contact."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from papers.integrators.members import Scheme
from rotor_fmu.errors import InputError, check_one_of, writable_folder
from rotor_fmu.output_options import with_output_options

from ..schemes_command import parse_scheme
from . import bounces, impact, planted, rotor
from .grid import TABLE, Experiment, Row, read_table, run_grid

EXPERIMENTS = {
    experiment.name: experiment
    for experiment in (
        rotor.RUN_DOWN,
        bounces.BOUNCE,
        planted.PLANTED,
        impact.ON_BARS,
        impact.ON_RATCHET,
    )
}
SCHEMES = (
    "newmark",
    "newmark=0.5,0.5",
    "transient-fidelity",
    "hht=0.1",
    "hht=0.3333333333333333",
    "moderate-dissipation",
    "hht=0.5",
    "wbz=-0.6",
    "wbz=-0.3",
    "wbz=-0.1",
    "wbz=0.08",
    "generalized-alpha=0.1,0.08",
    "generalized-alpha=0.15,0.1",
    *(f"chung-hulbert={i / 10:g}" for i in range(10)),
)
# Runs that take a quarter of a minute together.
QUICK_SCHEMES = ("newmark", "moderate-dissipation", "chung-hulbert=0.2")
QUICK = {
    "rotor": ((rotor.STEPS[0], rotor.STEPS[2]), rotor.RUN_DOWN.cases[:2]),
    "bounce": ((rotor.STEPS[6],), bounces.BOUNCE.cases[2:3]),
    "planted": ((rotor.STEPS[2],), planted.PLANTED.cases[:2]),
    "bars": (impact.BARS_STEPS[:1], impact.IMPACTS),
    "ratchet": (impact.RATCHET_STEPS[:1], impact.IMPACTS[:1]),
}


def chosen_schemes(names: Sequence[str]) -> dict[str, Scheme]:
    """Members of the generalized-alpha family by name; `InputError` for others."""
    result = {}
    for name in names:
        label, method = parse_scheme(name)
        if not isinstance(method, Scheme):
            raise InputError(f"--scheme {name}: cannot turn a rotor, only an oscillator")
        result[label] = method
    return result


def chosen_experiments(
    names: Sequence[str], steps: Sequence[float], is_quick: bool
) -> list[Experiment]:
    """The experiments named, with those of their step lengths [s] that are wanted.

    Raises `InputError` for what is not among them.
    """
    for name in names:
        check_one_of(f"--experiment {name}", name, EXPERIMENTS)
    result = [EXPERIMENTS[name] for name in dict.fromkeys(names or EXPERIMENTS)]
    if is_quick:
        result = [replace(e, steps=QUICK[e.name][0], cases=QUICK[e.name][1]) for e in result]
    for s in steps:
        if not any(_is_near(h, s) for experiment in result for h in experiment.steps):
            allowed = sorted({f"{h:.3g}" for e in result for h in e.steps}, key=float)
            raise InputError(f"--step {s:g} s: must be one of {', '.join(allowed)}")
    if steps:
        near = [tuple(h for h in e.steps if any(_is_near(h, s) for s in steps)) for e in result]
        result = [replace(e, steps=few) for e, few in zip(result, near, strict=True)]
    return result


def _is_near(h: float, asked: float) -> bool:
    return abs(h - asked) < 0.01 * h


@with_output_options
def survey(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/survey"),
    scheme: Annotated[
        list[str] | None,
        typer.Option(help="NAME=PARAMETERS as `schemes` takes them, repeatable; default: all."),
    ] = None,
    step: Annotated[
        list[float] | None, typer.Option(help="Step length in seconds, repeatable; default: all.")
    ] = None,
    experiment: Annotated[
        list[str] | None,
        typer.Option(help=f"One of {', '.join(EXPERIMENTS)}, repeatable; default: all."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A few runs of each kind.")] = False,
    jobs: Annotated[int | None, typer.Option(min=1, help="Processes; default: one a core.")] = None,
    table: Annotated[
        Path | None, typer.Option(help="Make the page of this table's rows, without any run.")
    ] = None,
) -> dict[str, Any]:
    """Run every integrator over the step lengths, on rotor, bars and ratchet; table and page.

    Stopped and started again it goes on where it was; runs of other code or settings are not used.
    """
    schemes = chosen_schemes(scheme or (QUICK_SCHEMES if quick else SCHEMES))
    experiments = chosen_experiments(experiment or (), step or (), quick)
    rows = read_table(table) if table is not None else None
    for name in EXPERIMENTS:
        if rows is not None and not any(row["experiment"] == name for row in rows):
            raise InputError(f"--table {table}: has no rows of {name}")
    writable_folder(out)
    if rows is None:
        rows = run_grid(experiments, schemes, out, jobs)
        typer.echo(f"{len(rows)} rows in {out / TABLE}")
    is_whole = table is not None or not (scheme or step or experiment or quick)
    report(rows, out, is_whole)
    return {"rows": rows, "out": str(out)}


def report(rows: Sequence[Row], out: Path, is_whole: bool) -> None:
    """Print a summary; of a whole survey write the page and its pictures too."""
    for line in summary(rows):
        typer.echo(line)
    if is_whole:
        # matplotlib loads slowly, and a user with bad input should not wait for it
        from .page import write_page

        typer.echo(f"written to {write_page(rows, out)}")


def summary(rows: Sequence[Row]) -> list[str]:
    """One line for each pair of experiment and scheme."""
    result: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        result.setdefault((row["experiment"], row["scheme"]), []).append(row)
    lines = []
    for (experiment, scheme), group in result.items():
        lines.append(f"{experiment:8s} {scheme:28s} {_in_short(group)}")
    return lines


def _in_short(group: Sequence[Row]) -> str:
    counts: dict[str, int] = {}
    for row in group:
        status = row["status"].split(" at ")[0]
        counts[status] = counts.get(status, 0) + 1
    errors = [row["error"] for row in group if "error" in row]
    least = f", error {min(errors):.2g} to {max(errors):.2g}" if errors else ""
    return ", ".join(f"{count} {status}" for status, count in counts.items()) + least
