"""The FMU's variables as a table for people."""

import re
from collections.abc import Sequence

from ...cells import markdown_table
from ..variables import Variable, unit

_HEAD = ("variable", "causality", "unit", "start", "what it is")


def rows(table: Sequence[Variable]) -> list[tuple[str, ...]]:
    """Return the head and rows; variables of parts that there are several of once, as `disc[i]`."""
    listed: list[tuple[str, ...]] = [_HEAD]
    for variable in table:
        name, text = variable.name, variable.text
        numbered = re.match(r"(\w+)\[(\d+)\]", name)
        if numbered:
            kind, number = numbered.groups()
            if number != "1":
                continue
            name = name.replace(f"{kind}[1]", f"{kind}[i]")
            text = text.replace(f"{kind} 1", f"{kind} i")
        text = re.sub(r" at z = \S+ m", "", text)
        listed.append((name, variable.causality, _unit(variable), _start(variable), text))
    return listed


def markdown(table: Sequence[Variable]) -> str:
    """Return the table in Markdown."""
    head, *body = rows(table)
    return markdown_table(head, ((f"`{name}`", *rest) for name, *rest in body)) + "\n"


def _unit(variable: Variable) -> str:
    if variable.kind != "Real":
        return variable.kind
    display = unit(variable.unit).display
    return f"{variable.unit} ({display[0]})" if display else variable.unit


def _start(variable: Variable) -> str:
    if variable.start is None:
        return ""
    if variable.kind == "Boolean":
        return str(variable.start).lower()
    if variable.choices:
        return variable.choices[int(variable.start)]
    return f"{variable.start:g}"
