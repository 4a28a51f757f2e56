"""Terminals of an FMU: which of its variables make one joint, as FMI 3.0 describes them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

from .variables import Variable

SHAFT = "shaft"
_FREE = {"w": "w", "phi": "phi", "a": "a", "tau": "tau_drive"}
# for a drive that takes the whole torque, or that holds the rotor's inertia itself
_DRIVEN = {"w": "speed", "phi": "phi", "tau": "tau", "tau_load": "tau_load"}
_OF_BODIES = ("fx", "fy", "x", "y")
_OF_LINES = (*_OF_BODIES, "wave_x", "wave_y")  # whose fx, fy are waves too


@dataclass(frozen=True)
class Terminal:
    """A terminal: its name and kind, and its variables by the names of its members."""

    name: str
    kind: str
    members: Mapping[str, str]
    text: str = ""


def shaft_terminal(members: Mapping[str, str]) -> Terminal:
    """Return the end of a shaft as a rotational flange."""
    text = "the driven end: motion one way, torque the other"
    return Terminal(SHAFT, "rotational.flange", members, text)


def terminals_of(table: Sequence[Variable]) -> list[Terminal]:
    """Return the terminals of a machine: the shaft's driven end, each body's forces and
    displacements, and each line's waves."""
    names = {variable.name for variable in table}
    inputs = {variable.name for variable in table if variable.causality == "input"}
    ports = sorted(name.removesuffix(".fx") for name in inputs if name.endswith(".fx"))
    terminals = [shaft_terminal(_FREE if "tau_drive" in names else _DRIVEN)]
    for port in ports:
        kind, known = ("line", _OF_LINES) if f"{port}.wave_x" in names else ("body", _OF_BODIES)
        members = {m: f"{port}.{m}" for m in known if f"{port}.{m}" in names}
        terminals.append(Terminal(port, kind, members))
    return terminals


def terminals_element(terminals: Iterable[Terminal]) -> Element:
    """Return FMI 3.0's element with terminals, whose members are matched by their names."""
    group = Element("Terminals")
    for terminal in terminals:
        element = SubElement(
            group, "Terminal", name=terminal.name, matchingRule="bus", terminalKind=terminal.kind
        )
        if terminal.text:
            element.set("description", terminal.text)
        for member, variable in terminal.members.items():
            given = {"memberName": member, "variableName": variable, "variableKind": "signal"}
            SubElement(element, "TerminalMemberVariable", given)
    return group
