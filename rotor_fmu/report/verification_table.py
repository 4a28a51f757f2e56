"""The comparison of a run with a finer one, in words and tables."""

from collections.abc import Mapping
from typing import Any


def rows_of(figures: Mapping[str, Any]) -> list[tuple[str, float, float, float]]:
    """Return rows of quantity, this run and the finer one [um], and their difference [%]; figures:
    `runs.verification.Verification.figures`."""
    return [
        (f"{c['name']}, {title}", 1e6 * c["value"], 1e6 * c["finer"], 100 * c["difference"])
        for title, compared in (("largest", figures["peaks"]), ("at the end", figures["final"]))
        for c in compared
    ]


def headline_of(figures: Mapping[str, Any]) -> str:
    """Return the conclusion and the finer run it is based on; figures:
    `runs.verification.Verification.figures`."""
    changed = ", ".join(f"{name} = {value:g}" for name, value in figures["finer"].items())
    return f"{figures['conclusion']}, by the same run with {changed}: {figures['finer_status']}"


def text_of(figures: Mapping[str, Any]) -> str:
    """Return `runs.verification.Verification.figures` as a table of plain text."""
    lines = [f"{'verification':20s} {headline_of(figures)}"]
    lines.append(f"  {'':26s} {'this run':>12s} {'finer':>12s} {'difference':>12s}")
    lines += [
        f"  {name:26s} {value:9.5g} um {other:9.5g} um {difference:10.3g} %"
        for name, value, other, difference in rows_of(figures)
    ]
    return "\n".join(lines) + "\n"
