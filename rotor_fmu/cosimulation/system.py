"""A rotor's FMU and a drive as one system, for masters: an SSP package (SSD with connectors,
terminals and units, parameters as SSV), and OSP's system structure with power bonds.

Neither holds the solver's enumerations: libcosim does not support them and aborts.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, register_namespace

from ..files import unfinished
from ..fmi.packing.archive import write_archive, xml_bytes
from ..fmi.packing.machine_files import Machine
from ..fmi.terminals import SHAFT, Terminal, shaft_terminal, terminals_element, terminals_of
from ..fmi.variables import Variable, unit
from ..model.structure.assembly import assemble
from . import ALGORITHMS

_SSP = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACES = {
    "ssd": f"{_SSP}Description",
    "ssv": f"{_SSP}ParameterValues",
    "ssc": f"{_SSP}Common",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
}
_OSP = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
_EXTENSION = "application/x-ssp-parameter-set"
_TERMINALS = "rotor-fmu.terminals"  # type of the annotation; SSP has no element for terminals
_LOST = 1e-8  # share of a machine's kinetic energy that a step of ECCO may lose
_ENDS = ("startElement", "startConnector", "endElement", "endConnector")  # of a connection
# Powers of inertia and time with which a drive's parameters grow, so that its motion stays the same
_POWERS = {
    "J_motor": (1, 0),
    "k": (1, -2),
    "c": (1, -1),
    "kp": (1, -1),
    "ki": (1, -2),
    "tau_max": (1, -2),
    "h": (0, 1),
}
SSP_NAME, OSP_NAME = "System.ssp", "OspSystemStructure.xml"
# Of libcosim's ECCO: the shortest and the longest step, relative to the communication step, and the
# rates and gains by which the step changes. They are low because the error of the power passes
# through 0 twice in an oscillation of the joint, where the step must not grow. libcosim relates the
# relative tolerance to the error itself, which would hide large errors; so it is close to 0.
_SHORTEST, _LONGEST = 0.01, 10.0
_ECCO = {
    "SafetyFactor": 1.0,
    "MinimumChangeRate": 0.95,
    "MaximumChangeRate": 1.05,
    "ProportionalGain": 0.05,
    "IntegralGain": 0.05,
    "RelativeTolerance": 1e-12,
}


@dataclass(frozen=True)
class Component:
    """An FMU of a system: its name in the system, its file, its variables, the values of parameters
    and inputs at the start, and its terminals."""

    name: str
    fmu: Path
    variables: Sequence[Variable]
    values: Mapping[str, float] = field(default_factory=dict)
    terminals: Sequence[Terminal] = ()

    def connectable(self) -> list[Variable]:
        """Return the variables that a system may connect or set."""
        return [v for v in self.variables if v.causality != "local" and v.kind != "Enumeration"]

    def settable(self) -> dict[str, Variable]:
        """Return the inputs and parameters by name."""
        return {v.name: v for v in self.connectable() if v.causality in ("input", "parameter")}


class Bond(NamedTuple):
    """A power bond: two connections between two components, whose variables' product is a power;
    each is (component, output, component, input)."""

    name: str
    forth: tuple[str, str, str, str]
    back: tuple[str, str, str, str]


@dataclass(frozen=True)
class System:
    """Components and their connections; step: communication step [s]; stop: end [s]; algorithm: of
    libcosim, one of `ALGORITHMS`; tolerance: energy [J] that a bond may lose in a step of ECCO."""

    name: str
    components: Sequence[Component]
    bonds: Sequence[Bond]
    step: float
    stop: float
    algorithm: str = ALGORITHMS[0]
    tolerance: float = 1e-6

    def write(self, out: Path) -> tuple[Path, Path]:
        """Write the SSP package and OSP's file into a folder that holds the FMUs, and return their
        paths. Raises `OSError` if one cannot be written."""
        contents = {"SystemStructure.ssd": xml_bytes(self.ssd())}
        for component in self.components:
            contents[f"resources/{component.fmu.name}"] = component.fmu.read_bytes()
            contents[f"resources/{component.name}.ssv"] = xml_bytes(ssv(component))
        package = write_archive(out / SSP_NAME, contents)
        structure = out / OSP_NAME
        with unfinished(structure) as part:
            part.write_bytes(xml_bytes(self.osp()))
        return package, structure

    def ssd(self) -> Element:
        """Return the system structure description of SSP 1.0."""
        root = _element("ssd:SystemStructureDescription", version="1.0", name=self.name)
        system = _sub(root, "ssd:System", name=self.name)
        elements = _sub(system, "ssd:Elements")
        for component in self.components:
            _add_component(elements, component)
        connections = _sub(system, "ssd:Connections")
        for bond in self.bonds:
            for connection in (bond.forth, bond.back):
                ends = dict(zip(_ENDS, connection, strict=True))
                _sub(connections, "ssd:Connection", **ends)
        used = [v for c in self.components for v in c.connectable()]
        _add_units(_sub(root, "ssd:Units"), used)
        experiment = _sub(root, "ssd:DefaultExperiment", startTime="0.0", stopTime=repr(self.stop))
        annotations = _sub(experiment, "ssd:Annotations")
        annotation = _sub(annotations, "ssc:Annotation", type="com.opensimulationplatform")
        algorithm = _sub(annotation, "osp:Algorithm")
        _sub(algorithm, "osp:FixedStepAlgorithm", baseStepSize=repr(self.step))
        return root

    def osp(self) -> Element:
        """Return OSP's system structure."""
        root = Element("OspSystemStructure", {"xmlns": _OSP, "version": "0.1"})
        texts = {"StartTime": "0.0", "BaseStepSize": repr(self.step), "Algorithm": self.algorithm}
        for name, text in texts.items():
            SubElement(root, name).text = text
        simulators = SubElement(root, "Simulators")
        for component in self.components:
            given = {"name": component.name, "source": component.fmu.name}
            simulator = SubElement(simulators, "Simulator", given, stepSize=repr(self.step))
            values = SubElement(simulator, "InitialValues")
            for name, value in component.values.items():
                of = component.settable()[name]
                entry = SubElement(values, "InitialValue", variable=name)
                SubElement(entry, of.kind, value=_xml_value(of, value))
        connections = SubElement(root, "Connections")
        for bond in self.bonds:
            for start, output, end, taken in (bond.forth, bond.back):
                connection = SubElement(connections, "VariableConnection", powerBond=bond.name)
                given = {"simulator": start, "name": output, "causality": "output"}
                SubElement(connection, "Variable", given)
                given = {"simulator": end, "name": taken, "causality": "input"}
                SubElement(connection, "Variable", given)
        configuration = SubElement(root, "EccoConfiguration")
        steps = {
            "StepSize": self.step,
            "MinimumStepSize": _SHORTEST * self.step,
            "MaximumStepSize": _LONGEST * self.step,
            "AbsoluteTolerance": self.tolerance,
        }
        for name, value in (steps | _ECCO).items():
            SubElement(configuration, name).text = repr(value)
        return root


def ssv(component: Component) -> Element:
    """Return the parameter set of a component: all inputs and parameters, with their units."""
    root = _element("ssv:ParameterSet", version="1.0", name=component.name)
    parameters = _sub(root, "ssv:Parameters")
    for name, variable in component.settable().items():
        if variable.start is None and name not in component.values:
            continue
        value = component.values.get(name, variable.start)
        entry = _sub(parameters, "ssv:Parameter", name=name)
        attributes = {"value": _xml_value(variable, value)} | _unit_of(variable)
        _sub(entry, f"ssv:{variable.kind}", **attributes)
    _add_units(_sub(root, "ssv:Units"), component.settable().values())
    return root


def _xml_value(variable: Variable, value: float | None) -> str:
    if variable.kind == "Boolean":
        return "true" if value else "false"
    return repr(float(value or 0.0)) if variable.kind == "Real" else str(int(value or 0))


def _add_component(elements: Element, component: Component) -> None:
    source, kind = f"resources/{component.fmu.name}", "application/x-fmu-sharedlibrary"
    element = _sub(elements, "ssd:Component", name=component.name, source=source, type=kind)
    connectors = _sub(element, "ssd:Connectors")
    for variable in component.connectable():
        connector = _sub(connectors, "ssd:Connector", name=variable.name, kind=variable.causality)
        _sub(connector, f"ssc:{variable.kind}", **_unit_of(variable))
    bindings, values = _sub(element, "ssd:ParameterBindings"), f"resources/{component.name}.ssv"
    _sub(bindings, "ssd:ParameterBinding", type=_EXTENSION, source=values)
    annotations = _sub(element, "ssd:Annotations")
    annotation = _sub(annotations, "ssc:Annotation", type=_TERMINALS)
    annotation.append(terminals_element(component.terminals))


def _unit_of(variable: Variable) -> dict[str, str]:
    """Return the attribute of a variable's unit; none where SSP, which wants integers as exponents,
    has no such unit."""
    has_unit = variable.kind == "Real" and unit(variable.unit).base is not None
    return {"unit": variable.unit} if has_unit else {}


def _add_units(units: Element, variables: Iterable[Variable]) -> None:
    for name in dict.fromkeys(v.unit for v in variables if _unit_of(v)):
        entry = _sub(units, "ssc:Unit", name=name)
        base = unit(name).base or {}
        _sub(entry, "ssc:BaseUnit", **{base: str(power) for base, power in base.items()})


def _qualified(name: str) -> str:
    space, _, tag = name.partition(":")
    return f"{{{_SPACES[space]}}}{tag}"


def _element(tag: str, /, **attributes: str) -> Element:
    for prefix, space in _SPACES.items():
        register_namespace(prefix, space)
    return Element(_qualified(tag), attributes)


def _sub(parent: Element, tag: str, /, **attributes: str) -> Element:
    return SubElement(parent, _qualified(tag), attributes)


def drive_system(machine: Machine, drive: Component, fmu: Path, step: float, stop: float) -> System:
    """Return a machine's FMU on a drive that holds its inertia, `J_rotor`. What else the drive's
    values leave open is that of its own machine in proportion: as many times larger as the inertia
    is, and quicker as the root of the ramp's rate is."""
    inertia = float(assemble(machine.rotor).numbers[0].inertia)
    given = {"J_rotor": inertia, **drive.values}
    drive = replace(
        drive,
        values=_in_proportion(drive.settable(), given) | given,
        terminals=[shaft_terminal({"w": "w", "tau_load": "tau_load"})],
    )
    speed = {"speed": drive.values.get("w_start", 0.0)}
    rotor = Component("rotor", fmu, machine.table, speed, terminals_of(machine.table))
    bond = Bond(
        SHAFT, (drive.name, "w", "rotor", "speed"), ("rotor", "tau_load", drive.name, "tau_load")
    )
    name = machine.rotor.name or "rotor"
    energy = 0.5 * inertia * drive.values.get("w_target", 0.0) ** 2
    system = System(name, (drive, rotor), (bond,), step, stop)
    return replace(system, tolerance=_LOST * energy) if energy else system


def falls_short(drive: Component, stop: float) -> str:
    """Say that a drive's torque and ramp do not bring it to its target by the end, even without
    load; empty where they do."""
    values = {name: v.start or 0.0 for name, v in drive.settable().items()}
    values |= drive.values
    target, torque, ramp = (values[name] for name in ("w_target", "tau_max", "ramp"))
    inertia = values["J_motor"] + values["J_rotor"]
    reached = abs(values["w_start"]) + min(ramp, torque / inertia) * stop
    if reached >= abs(target):
        return ""
    return (
        f"the {drive.name} reaches at most {reached:.4g} of {abs(target):.4g} rad/s by the end "
        f"at {stop:g} s: {torque:.3g} N.m accelerate {inertia:.3g} kg.m2, along a ramp of "
        f"{ramp:.3g} rad/s2"
    )


def _in_proportion(own: Mapping[str, Variable], given: Mapping[str, float]) -> dict[str, float]:
    """Return the drive's parameters for a given inertia `J_rotor` and rate `ramp`, of six digits;
    none below what the drive takes."""
    larger = given["J_rotor"] / (own["J_rotor"].start or 1.0)
    longer = math.sqrt((own["ramp"].start or 1.0) / given["ramp"])
    values = {
        name: (own[name].start or 0.0) * larger**of_inertia * longer**of_time
        for name, (of_inertia, of_time) in _POWERS.items()
    }
    return {name: max(float(f"{v:.6g}"), own[name].low or 0.0) for name, v in values.items()}
