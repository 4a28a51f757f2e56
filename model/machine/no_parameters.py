"""What a machine file has and no parameter is: why a name of it cannot be given another value."""

import re
from collections import Counter
from collections.abc import Collection
from dataclasses import fields

from ..quantities import quantities
from .names import spelled
from .operating_speeds import Operation
from .rotor import Rotor

_OF_THE_SHAFT = ("material", "section")
_OF_THE_MACHINE = ("gravity_angle", "inclination")


def why_no_parameter(rotor: Rotor, name: str, known: Collection[str]) -> str:
    """Return why a name is none of the parameters `known`, and which of its part are, or how it is
    spelled as one; empty where the machine has nothing of this name."""
    head, _, own = name.rpartition(".")
    counts = Counter[str]()
    alike = Counter(part.KIND for part in rotor.parts)
    for where, part in rotor.named_parts():
        counts[part.KIND] += 1
        names = {where, spelled(part.KIND, counts[part.KIND]), getattr(part, "name", "")}
        if alike[part.KIND] == 1:
            names.add(part.KIND)
        right, keys = f"{where}.{own}", {f.name for f in fields(part)}
        # where a node is given, a position may be in its place
        if not head or head not in names or (own if own != "z" else "node") not in keys:
            continue
        if right in known:
            return f"is called {right}"
        others = [n for n in known if n.startswith(f"{where}.")]
        given = getattr(part, own, None)
        what = "has a list for it" if given and isinstance(given, tuple) else "fixes it"
        return f"is no parameter: the machine file {what}; {_those_of(where, others)}"
    kind = re.split(r"[.\[]", head)[0]
    if kind in alike and not any(n.startswith(f"{kind}[") for n in known):
        return f"is no parameter: a {kind} has none"
    if kind in _OF_THE_SHAFT or (kind == "shaft" and name not in known):
        others = [n for n in known if n.startswith("shaft.")]
        return f"is no parameter: the machine file fixes it; {_those_of('the shaft', others)}"
    if name in _OF_THE_MACHINE or (head == "operation" and own in quantities(Operation)):
        others = [n for n in known if "." not in n]
        return f"is no parameter: the machine file fixes it; {_those_of('the machine', others)}"
    return ""


def _those_of(where: str, parameters: list[str]) -> str:
    if not parameters:
        return f"{where} has none"
    if len(parameters) == 1:
        return f"that of {where} is {parameters[0].rpartition('.')[2]}"
    return f"those of {where} are {', '.join(n.rpartition('.')[2] for n in parameters)}"
