"""The FMU's variables as a Markdown table, for people."""

from __future__ import annotations

import re
from collections.abc import Sequence

from .interface import UNITS, Variable


def markdown(table: Sequence[Variable]) -> str:
    """One row a variable; those of discs and bearings once, as `disc[i]` and `bearing[j]`."""
    rows = [
        "| variable | causality | unit | start | what it is |",
        "| --- | --- | --- | --- | --- |",
    ]
    for variable in table:
        name, text = variable.name, variable.text
        if name.startswith(("disc[", "bearing[")) and "[1]" not in name:
            continue
        name = name.replace("disc[1]", "disc[i]").replace("bearing[1]", "bearing[j]")
        text = text.replace("disc 1", "disc i").replace("bearing 1", "bearing j")
        text = re.sub(r" at z = \S+ m", "", text)
        cells = [f"`{name}`", variable.causality, _unit(variable), _start(variable), text]
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def _unit(variable: Variable) -> str:
    if variable.kind != "Real":
        return variable.kind
    display = UNITS[variable.unit].display
    return f"{variable.unit} ({display[0]})" if display else variable.unit


def _start(variable: Variable) -> str:
    if variable.start is None:
        return ""
    if variable.kind == "Boolean":
        return str(variable.start).lower()
    return f"{variable.start:g}"
