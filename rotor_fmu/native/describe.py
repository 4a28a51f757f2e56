"""modelDescription.xml of the native FMU, of FMI 2.0 and of FMI 3.0, from the variable table."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement

from ..about import RELEASED, __version__
from ..fmu.description import complete, reached_by, unit_definitions
from ..fmu.variables import Variable, unit
from ..model.settings import Settings

CATEGORIES = {
    "logAll": "all messages",
    "logStatusWarning": "messages with the status warning",
    "logStatusDiscard": "messages with the status discard",
    "logStatusError": "messages with the status error",
    "logStatusFatal": "messages with the status fatal",
    "logStatusPending": "messages with the status pending",
}
# FMI 3.0 wants the time among the variables.
TIME = Variable("time", "Real", "independent", "time", "s")
_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean"}


def description(name: str, guid: str, table: Sequence[Variable], fmi: int) -> Element:
    """The description of the FMU called `name`; fmi: 2 or 3."""
    return _fmi3(name, guid, table) if fmi == 3 else _fmi2(name, guid, table)


def _root(name: str, is_free: bool, **attributes: str) -> Element:
    drive = "a torque" if is_free else "its speed"
    return Element(
        "fmiModelDescription",
        attributes,
        modelName=name,
        description="Flexible rotor with discs that rubs in two clearance bearings with dry "
        f"friction, driven by {drive}",
        author="The rotor-fmu authors",
        version=__version__,
        copyright="The rotor-fmu authors",
        license="MIT",
        generationTool=f"rotor-fmu {__version__}",
        generationDateAndTime=RELEASED,
        variableNamingConvention="structured",
    )


def _is_free(table: Sequence[Variable]) -> bool:
    return any(variable.name == "tau_drive" for variable in table)


def _common(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    for name, text in CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text)
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime="40.0",
        stepSize="0.04",
        tolerance=repr(Settings.tolerance),
    )


def _attributes(variable: Variable, reference: int) -> dict[str, str]:
    """What both versions say of a variable, in FMI 2.0's order."""
    is_parameter = variable.causality == "parameter"
    variability = "continuous" if variable.kind == "Real" else "discrete"
    told = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.text,
        "causality": variable.causality,
        "variability": "fixed" if is_parameter else variability,
    }
    if is_parameter or variable.is_observed:
        told["initial"] = "exact" if is_parameter else "calculated"
    return told


def _start(variable: Variable) -> dict[str, str]:
    if variable.start is None:
        return {}
    start = variable.start
    if variable.kind == "Boolean":
        return {"start": "true" if start else "false"}
    return {"start": repr(float(start)) if variable.kind == "Real" else str(start)}


def _fmi2(name: str, guid: str, table: Sequence[Variable]) -> Element:
    is_free = _is_free(table)
    root = _root(name, is_free, fmiVersion="2.0", guid=guid)
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=name,
        needsExecutionTool="false",
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="false" if is_free else "true",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    _common(root)
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(table):
        element = SubElement(variables, "ScalarVariable", _attributes(variable, reference))
        SubElement(element, variable.kind, _start(variable))
    SubElement(root, "ModelStructure")
    return complete(root, table, RELEASED)


def _fmi3(name: str, token: str, table: Sequence[Variable]) -> Element:
    root = _root(name, _is_free(table), fmiVersion="3.0", instantiationToken=token)
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=name,
        needsExecutionTool="false",
        canHandleVariableCommunicationStepSize="true",
        canBeInstantiatedOnlyOncePerProcess="false",
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        hasEventMode="false",
    )
    root.append(unit_definitions(table))
    _common(root)
    variables = SubElement(root, "ModelVariables")
    structure = Element("ModelStructure")
    for reference, variable in enumerate((*table, TIME)):
        told = _attributes(variable, reference) | _start(variable) | _limits(variable)
        SubElement(variables, _TYPES[variable.kind], told)
    outputs = [i for i, v in enumerate(table) if v.causality == "output"]
    for reference in outputs:
        depends = " ".join(map(str, reached_by(table, table[reference])))
        SubElement(structure, "Output", valueReference=str(reference), dependencies=depends)
    for reference in outputs:
        SubElement(structure, "InitialUnknown", valueReference=str(reference))
    root.append(structure)
    return root


def _limits(variable: Variable) -> dict[str, str]:
    """Units and limits as FMI 3.0 has them, on the variable itself."""
    told = {}
    if variable.kind == "Real":
        shown = unit(variable.unit)
        told["unit"] = shown.name
        if shown.display:
            told["displayUnit"] = shown.display[0]
        if variable.nominal is not None:
            told["nominal"] = repr(variable.nominal)
    if variable.kind != "Boolean":
        for key, limit in (("min", variable.low), ("max", variable.high)):
            if limit is not None:
                told[key] = repr(limit)
    return told
