"""modelDescription.xml beyond what pythonfmu writes, made from the variable table."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

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

# Outputs that inputs reach within an instant.
DEPENDENT = ("tau", "tau_load", "a")


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


def _model_structure(table: Sequence[Variable]) -> Element:
    """Outputs with what they depend on within an instant, and the initial unknowns.

    At an instant the displacements are states, and no input reaches them; the contact forces depend
    on the speed through friction and damping, torque and angular acceleration on every input.
    """
    structure = Element("ModelStructure")
    inputs = [str(i) for i, v in enumerate(table, 1) if v.causality == "input"]
    outputs = SubElement(structure, "Outputs")
    for index, variable in enumerate(table, 1):
        if variable.causality == "output":
            depends = " ".join(inputs) if variable.name in DEPENDENT else ""
            SubElement(outputs, "Unknown", index=str(index), dependencies=depends)
    unknowns = SubElement(structure, "InitialUnknowns")
    for index, variable in enumerate(table, 1):
        if variable.causality == "output":
            SubElement(unknowns, "Unknown", index=str(index))
    return structure
