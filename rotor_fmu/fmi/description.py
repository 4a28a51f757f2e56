"""modelDescription.xml of FMI 2.0 and of FMI 3.0, made from the machine and its variable table."""

import math
import uuid
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

from ..about import RELEASED, __version__
from ..model.machine.rotor import Rotor
from ..model.parts.base import ReleaseElement
from ..model.quantities import ALL
from ..model.settings import Settings
from ..model.structure.assembly import assemble
from .variables import Variable, unit

CATEGORIES = {
    "logAll": "all messages",
    **{
        f"logStatus{status}": f"messages with the status {status.lower()}"
        for status in ("Warning", "Discard", "Error", "Fatal", "Pending")
    },
}
# FMI 3.0 wants the time among the variables.
TIME = Variable("time", "Real", "independent", "time", "s")
_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}
# The order of the elements in FMI 2.0.
_ORDER = (
    *("CoSimulation", "UnitDefinitions", "TypeDefinitions", "LogCategories"),
    *("DefaultExperiment", "ModelVariables", "ModelStructure"),
)


@dataclass(frozen=True)
class Described:
    """The contents of a description besides the variables.

    rotor: the machine; identifier: the model identifier, which the FMU's libraries are named after;
    guid: see `guid`; tool: what generated it; needs_python: whether it runs in the Python of its
    host; sources: the files that a host compiles, where there are no libraries; step: the fixed
    step length of an FMU for real time [s].
    """

    rotor: Rotor
    identifier: str
    guid: str = ""
    tool: str = f"rotor-fmu {__version__}"
    needs_python: bool = False
    sources: tuple[str, ...] = ()
    step: float | None = None


@dataclass(frozen=True)
class Experiment:
    """The default experiment, all inputs and parameters at their start values: its end and its
    communication step [s]."""

    stop: float
    step: float


_PERIODS, _POINTS = 60.0, 1000


def default_experiment(rotor: Rotor) -> Experiment:
    """Return about sixty periods of the machine's lowest mode, until it settles, at 1000 points."""
    lowest = float(assemble(rotor).numbers[0].lowest_omega)
    wanted = _PERIODS * 2 * math.pi / lowest
    decade = 10.0 ** math.floor(math.log10(wanted))
    stop = next(float(f"{n * decade:.6g}") for n in (1, 2, 5, 10) if n * decade >= wanted)
    return Experiment(stop, float(f"{stop / _POINTS:.6g}"))


def summary(rotor: Rotor, is_free: bool) -> str:
    """Return a machine in a sentence: its name, its parts, what drives it."""
    counted = Counter(
        part.KIND
        for part in rotor.parts
        if not any(isinstance(e, ReleaseElement) for e in part.elements("", rotor.material.density))
    )
    parts = ", ".join(_counted(kind.replace("_", " "), n) for kind, n in counted.items())
    drive = "a torque" if is_free else "its speed"
    return f"{rotor.name}: a flexible rotor with {parts}, driven by {drive}"


def _counted(noun: str, count: int) -> str:
    if count == 1:
        return f"1 {noun}"
    if noun.endswith("y"):
        return f"{count} {noun[:-1]}ies"
    return f"{count} {noun}{'es' if noun.endswith('s') else 's'}"


def guid(table: Sequence[Variable], content: str) -> str:
    """Return the identifier that follows the interface and the code behind it, and nothing else."""
    return str(uuid.uuid5(uuid.NAMESPACE_URL, f"rotor-fmu {content} {table!r}"))


def description(of: Described, table: Sequence[Variable], fmi: int) -> Element:
    """Return the description of an FMU; fmi: 2 or 3."""
    return _fmi3(of, table) if fmi == 3 else _fmi2(of, table)


def _root(of: Described, is_free: bool, **attributes: str) -> Element:
    return Element(
        "fmiModelDescription",
        attributes,
        modelName=of.rotor.name or of.identifier,
        description=summary(of.rotor, is_free),
        author="The rotor-fmu authors",
        version=__version__,
        copyright="The rotor-fmu authors",
        license="MIT",
        generationTool=of.tool,
        generationDateAndTime=RELEASED,
        variableNamingConvention="structured",
    )


def _is_free(table: Sequence[Variable]) -> bool:
    return any(variable.name == "tau_drive" for variable in table)


def _abilities(of: Described, **others: bool) -> dict[str, str]:
    """Return the capability flags of both versions, and `others`."""
    attributes = {
        "needsExecutionTool": of.needs_python,
        "canHandleVariableCommunicationStepSize": True,
        "canBeInstantiatedOnlyOncePerProcess": False,
    }
    named = {"modelIdentifier": of.identifier} | {
        name: str(can).lower() for name, can in (attributes | others).items()
    }
    # pythonfmu's wrapper refuses derivatives before it asks the slave
    return named if of.needs_python else named | {"maxOutputDerivativeOrder": "2"}


def _common(root: Element, of: Described) -> None:
    categories = SubElement(root, "LogCategories")
    for name, text in CATEGORIES.items():
        SubElement(categories, "Category", name=name, description=text)
    experiment = default_experiment(of.rotor)
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(experiment.stop),
        stepSize=repr(of.step or experiment.step),
        tolerance=repr(Settings.tolerance),
    )


def _attributes(variable: Variable, reference: int) -> dict[str, str]:
    """Return the attributes of a variable that both versions have, in FMI 2.0's order."""
    is_parameter = variable.causality == "parameter"
    variability = "continuous" if variable.kind == "Real" else "discrete"
    if is_parameter:
        variability = "tunable" if variable.is_tunable else "fixed"
    attributes = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.text,
        "causality": variable.causality,
        "variability": variability,
    }
    if is_parameter or variable.is_observed:
        attributes["initial"] = "exact" if is_parameter else "calculated"
    return attributes


def _start(variable: Variable) -> dict[str, str]:
    if variable.start is None:
        return {}
    start = variable.start
    if variable.kind == "Boolean":
        return {"start": "true" if start else "false"}
    return {"start": repr(float(start)) if variable.kind == "Real" else str(start)}


def _limits(variable: Variable) -> dict[str, str]:
    """Return units and limits: in FMI 2.0 beside the start value, in 3.0 on the variable."""
    attributes = {}
    if variable.kind == "Real":
        shown = unit(variable.unit)
        attributes["unit"] = shown.name
        if shown.display:
            attributes["displayUnit"] = shown.display[0]
        if variable.nominal is not None:
            attributes["nominal"] = repr(variable.nominal)
    if variable.kind == "Enumeration":
        attributes["declaredType"] = variable.type_name
    if variable.kind != "Boolean":
        for key, limit in (("min", variable.least), ("max", variable.high)):
            if limit is not None:
                attributes[key] = repr(limit)
    return attributes


def _fmi2(of: Described, table: Sequence[Variable]) -> Element:
    is_free = _is_free(table)
    root = _root(of, is_free, fmiVersion="2.0", guid=of.guid)
    abilities = _abilities(
        of,
        # pythonfmu's wrapper refuses derivatives before it asks the slave
        canInterpolateInputs=not of.needs_python,
        canNotUseMemoryManagementFunctions=True,
        canGetAndSetFMUstate=True,
        canSerializeFMUstate=True,
    )
    simulated = SubElement(root, "CoSimulation", abilities)
    if of.sources:
        files = SubElement(simulated, "SourceFiles")
        for name in of.sources:
            SubElement(files, "File", name=name)
    _common(root, of)
    variables = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(table):
        element = SubElement(variables, "ScalarVariable", _attributes(variable, reference))
        SubElement(element, variable.kind, _start(variable))
    SubElement(root, "ModelStructure")
    return complete(root, table, RELEASED)


def complete(root: Element, table: Sequence[Variable], generated: str) -> Element:
    """Add units, limits, dependencies and initial unknowns to a description of FMI 2.0, as
    pythonfmu writes one."""
    root.set("generationDateAndTime", generated)
    root.append(unit_definitions(table))
    root.extend(type_definitions(table, 2))
    for element, variable in zip(root.iterfind("ModelVariables/*"), table, strict=True):
        for key, value in _limits(variable).items():
            element[0].set(key, value)
    parts = [child for child in root if child.tag != "ModelStructure"]
    parts.append(_model_structure(table))
    root[:] = sorted(parts, key=lambda child: _ORDER.index(child.tag))
    return root


def unit_definitions(table: Sequence[Variable]) -> Element:
    """Return the units that variables have."""
    definitions = Element("UnitDefinitions")
    for used in map(unit, dict.fromkeys(v.unit for v in table if v.kind == "Real")):
        node = SubElement(definitions, "Unit", name=used.name)
        if used.base is not None:
            SubElement(node, "BaseUnit", {base: str(power) for base, power in used.base.items()})
        if used.display:
            name, factor = used.display
            SubElement(node, "DisplayUnit", name=name, factor=repr(factor))
    return definitions


def type_definitions(table: Sequence[Variable], fmi: int) -> list[Element]:
    """Return the element with the Enumerations' types, the names of their values among them; none
    where there is no Enumeration. fmi: 2 or 3."""
    definitions = Element("TypeDefinitions")
    for variable in table:
        if variable.kind != "Enumeration":
            continue
        if fmi == 3:
            node = SubElement(definitions, "EnumerationType", name=variable.type_name)
        else:
            simple = SubElement(definitions, "SimpleType", name=variable.type_name)
            node = SubElement(simple, "Enumeration")
        for value, name in enumerate(variable.choices):
            SubElement(node, "Item", name=name, value=str(value))
    return [definitions] if len(definitions) else []


def reached_by(table: Sequence[Variable], variable: Variable) -> list[int]:
    """Return the places in the table of the inputs that reach a variable within an instant.

    At an instant the motion is a state, and so is the speed of a rotor that a torque drives.
    """
    inputs = [i for i, other in enumerate(table) if other.causality == "input"]
    if variable.reached_by == ALL:
        return inputs
    own = f"{variable.name.rpartition('.')[0]}.{variable.reached_by}"
    return [i for i in inputs if table[i].name in (variable.reached_by, own)]


def _model_structure(table: Sequence[Variable]) -> Element:
    """Return the outputs with what they depend on at once, and the initial unknowns."""
    structure = Element("ModelStructure")
    places = [i for i, variable in enumerate(table) if variable.causality == "output"]
    if not places:  # a list of none is not valid
        return structure
    outputs = SubElement(structure, "Outputs")
    for i in places:
        depends = " ".join(str(1 + place) for place in reached_by(table, table[i]))
        SubElement(outputs, "Unknown", index=str(1 + i), dependencies=depends)
    unknowns = SubElement(structure, "InitialUnknowns")
    known = " ".join(str(1 + place) for place in given_at_start(table))
    for i in places:
        SubElement(unknowns, "Unknown", index=str(1 + i), dependencies=known)
    return structure


def given_at_start(table: Sequence[Variable]) -> list[int]:
    """Return the places in the table of what outputs depend on at the start: inputs and parameters,
    under which the machine comes to rest."""
    return [i for i, variable in enumerate(table) if not variable.is_observed]


def _fmi3(of: Described, table: Sequence[Variable]) -> Element:
    root = _root(of, _is_free(table), fmiVersion="3.0", instantiationToken=of.guid)
    abilities = _abilities(
        of,
        mightReturnEarlyFromDoStep=True,  # see `solver.max_iterations`
        canGetAndSetFMUState=True,
        canSerializeFMUState=True,
        hasEventMode=False,
    )
    if of.step is not None:
        abilities["fixedInternalStepSize"] = repr(of.step)
    SubElement(root, "CoSimulation", abilities)
    root.append(unit_definitions(table))
    root.extend(type_definitions(table, 3))
    _common(root, of)
    variables = SubElement(root, "ModelVariables")
    structure = Element("ModelStructure")
    for reference, variable in enumerate((*table, TIME)):
        attributes = _attributes(variable, reference) | _start(variable) | _limits(variable)
        SubElement(variables, _TYPES[variable.kind], attributes)
    outputs = [i for i, v in enumerate(table) if v.causality == "output"]
    for reference in outputs:
        depends = " ".join(map(str, reached_by(table, table[reference])))
        SubElement(structure, "Output", valueReference=str(reference), dependencies=depends)
    known = " ".join(map(str, given_at_start(table)))
    for reference in outputs:
        SubElement(structure, "InitialUnknown", valueReference=str(reference), dependencies=known)
    root.append(structure)
    return root
