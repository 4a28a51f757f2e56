"""modelDescription.xml beyond what pythonfmu writes, made from the variable table."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from ..model.quantities import ALL, SPEED
from .variables import Variable, unit

_ORDER = (
    "CoSimulation",
    "UnitDefinitions",
    "TypeDefinitions",
    "LogCategories",
    "DefaultExperiment",
    "ModelVariables",
    "ModelStructure",
)


def guid(table: Sequence[Variable], content: str) -> str:
    """Identifier that follows the interface and the code behind it, and nothing else."""
    return str(uuid.uuid5(uuid.NAMESPACE_URL, f"rotor-fmu {content} {table!r}"))


def complete(root: Element, table: Sequence[Variable], generated: str) -> Element:
    """Add units, limits, dependencies and initial unknowns to pythonfmu's description `root`."""
    root.set("generationDateAndTime", generated)
    root.append(unit_definitions(table))
    for element, variable in zip(root.iterfind("ModelVariables/*"), table, strict=True):
        _describe(element, variable)
    kept = [child for child in root if child.tag != "ModelStructure"]
    root[:] = sorted([*kept, _model_structure(table)], key=lambda child: _ORDER.index(child.tag))
    return root


def _describe(element: Element, variable: Variable) -> None:
    value = element[0]
    if variable.kind == "Real":
        shown = unit(variable.unit)
        value.set("unit", shown.name)
        if shown.display:
            value.set("displayUnit", shown.display[0])
        if variable.nominal is not None:
            value.set("nominal", repr(variable.nominal))
    if variable.kind != "Boolean":
        for key, limit in (("min", variable.low), ("max", variable.high)):
            if limit is not None:
                value.set(key, repr(limit))


def unit_definitions(table: Sequence[Variable]) -> Element:
    """The units that variables have."""
    definitions = Element("UnitDefinitions")
    for used in map(unit, dict.fromkeys(v.unit for v in table if v.kind == "Real")):
        node = SubElement(definitions, "Unit", name=used.name)
        SubElement(node, "BaseUnit", {base: str(exponent) for base, exponent in used.base.items()})
        if used.display:
            name, factor = used.display
            SubElement(node, "DisplayUnit", name=name, factor=repr(factor))
    return definitions


def reached_by(table: Sequence[Variable], variable: Variable) -> list[int]:
    """Places in the table of the inputs that reach a variable within an instant.

    At an instant the motion is a state, and so is the speed of a rotor that a torque drives.
    """
    inputs = [i for i, other in enumerate(table) if other.causality == "input"]
    if variable.reached_by == ALL:
        return inputs
    return [i for i in inputs if table[i].name == variable.reached_by == SPEED]


def _model_structure(table: Sequence[Variable]) -> Element:
    """Outputs with what they depend on within an instant, and the initial unknowns."""
    structure = Element("ModelStructure")
    outputs = SubElement(structure, "Outputs")
    for index, variable in enumerate(table, 1):
        if variable.causality == "output":
            depends = " ".join(str(1 + place) for place in reached_by(table, variable))
            SubElement(outputs, "Unknown", index=str(index), dependencies=depends)
    unknowns = SubElement(structure, "InitialUnknowns")
    for index, variable in enumerate(table, 1):
        if variable.causality == "output":
            SubElement(unknowns, "Unknown", index=str(index))
    return structure
