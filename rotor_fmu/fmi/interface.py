"""The FMU's variables: one table, from which the description, the slave, the command line and the
documents are made."""

from dataclasses import replace
from math import isfinite

from ..model.machine.names import Name
from ..model.machine.rotor import Rotor
from ..model.parts import PARTS
from ..model.parts.base import BASE, PortElement
from ..model.quantities import Quantity
from ..model.time_loop.observe import observed
from ..operating_speeds import operating_speeds
from .coupling_parameters import coupling_variables
from .solver_parameters import solver_parameters
from .variables import Variable

_BY_DERIVATIVE = "by its derivative in an FMI 2.0 FMU without Python"
_HELD = f"held until the next communication point, or continued {_BY_DERIVATIVE}"
_TORQUE = "tau_drive"  # the input that drives a free rotor
_DIRECTIONS = (("x", "to the right (+x)"), ("y", "upwards (+y)"))


def interface(rotor: Rotor, is_free: bool = False) -> tuple[Variable, ...]:
    """Return all variables of a rotor's FMU: inputs, parameters, then what the model computes in
    the order of `observe.observed`.

    is_free: a torque drives the rotor, and its speed is a state; otherwise the speed is prescribed.
    """
    return (*_inputs(rotor, is_free), *_parameters(rotor, is_free), *_observed(rotor, is_free))


def _inputs(rotor: Rotor, is_free: bool) -> list[Variable]:
    if is_free:
        text = f"torque of the drive on the rotor about z, x towards y; {_HELD}"
        drive = Variable(_TORQUE, "Real", "input", text, "N.m", 0.0, nominal=0.1)
    else:
        text = (
            "speed of rotation about z, x towards y; continued until the next communication point "
            f"as speed_continuation says, or {_BY_DERIVATIVE}"
        )
        rated = operating_speeds(rotor).rated
        drive = Variable("speed", "Real", "input", text, "rad/s", rated, nominal=100.0)
    return [drive, *(load for port in ports(rotor) for load in _loads(rotor, *port))]


def ports(rotor: Rotor) -> list[tuple[str, PortElement]]:
    """Return where external forces act, with their parts' names, in the order of
    `Structure.load_dof`."""
    return rotor.elements_of_kind(PortElement)


def _loads(rotor: Rotor, name: str, port: PortElement) -> list[Variable]:
    """Return the external forces on a port along both axes, or the waves of a line [N], or the
    acceleration of the base [m/s2]."""
    of, what, unit, nominal = "a", f"acceleration of {port.where}", "m/s2", 1.0
    if port.node != BASE:
        where = f"{port.where} at z = {rotor.nodes[port.node - 1]:g} m"
        acts = "incoming wave of the line" if port.impedance else "external force"
        of, what, unit, nominal = "f", f"{acts} on {where}", "N", 10.0
    texts = {axis: f"{what}, {direction}; {_HELD}" for axis, direction in _DIRECTIONS}
    return [
        Variable(f"{name}.{of}{axis}", "Real", "input", text, unit, 0.0, nominal=nominal)
        for axis, text in texts.items()
    ]


def _parameters(rotor: Rotor, is_free: bool) -> list[Variable]:
    prescribed = [
        _real(
            "speed_rate",
            "rad/s2",
            0.0,
            "rate of the speed over the first communication step, when there is no earlier value",
            low=None,
        ),
        Variable(
            "speed_continuation",
            "Enumeration",
            "parameter",
            "the speed between two communication points: 0 linear (continues the last change), "
            "1 hold (for an input that jumps)",
            start=0,
            low=0,
            high=1,
            choices=("linear", "hold"),
        ),
    ]
    start = operating_speeds(rotor).rated if is_free else 0.0
    free = [_real("w_start", "rad/s", start, "speed of rotation at the start", low=None)]
    return [
        *(free if is_free else prescribed),
        *(parameter_variable(*parameter) for parameter in rotor.parameters().values()),
        *coupling_variables(is_free),
        *solver_parameters(),
    ]


def parameter_variable(name: Name, quantity: Quantity, value: float | bool) -> Variable:
    """Return the variable of a number of the machine."""
    text = f"{_part_of(name)}{quantity.text}"
    if quantity.is_switch:
        return Variable(str(name), "Boolean", "parameter", text, start=value)
    rule = quantity.rule
    low, high = (limit if isfinite(limit) else None for limit in (rule.least, rule.most))
    variable = _real(str(name), quantity.unit, float(value), text, low)
    return replace(
        variable, high=high, is_low_excluded=rule.is_strict, is_tunable=quantity.is_tunable
    )


# Quantities under these headings are of the machine itself.
_WITHOUT_PART = {"", "shaft", "solver", "energy", *(kind.KIND for kind in PARTS)}


def _part_of(name: Name) -> str:
    if name.number:
        return f"{name.kind} {name.number}: "
    return "" if name.kind in _WITHOUT_PART else f"{name.kind}: "


def _real(name: str, unit: str, start: float, text: str, low: float | None) -> Variable:
    nominal = abs(start) or 1.0
    return Variable(name, "Real", "parameter", text, unit, start, low=low, nominal=nominal)


# Outputs only where they are states or follow from an input.
_OUTPUTS_IF_FREE = ("w", "a")
# Torques that follow, at an instant, from the drive's and the speed, a state, if the rotor is free.
_DRIVEN_IF_FREE = ("tau", "tau_wave")
# Units of the derivatives by the drive: by the speed, and of a free rotor by the torque.
_BY_DRIVE = {
    "dphi_ddrive": ("s", "rad/(N.m)"),
    "dw_ddrive": ("1", "rad/(N.m.s)"),
    "dtau_ddrive": ("N.m.s/rad", "1"),
    "dtau_load_ddrive": ("N.m.s/rad", "1"),
}


def _observed(rotor: Rotor, is_free: bool) -> list[Variable]:
    table = []
    for name, output in observed(rotor):
        is_output = output.is_output or (is_free and str(name) in _OUTPUTS_IF_FREE)
        is_driven = is_free and str(name) in _DRIVEN_IF_FREE
        by = _TORQUE if is_driven else output.reached_by
        causality, text = "output" if is_output else "local", f"{_part_of(name)}{output.text}"
        unit = _BY_DRIVE.get(str(name), (output.unit, output.unit))[is_free]
        variable = Variable(
            str(name), output.kind, causality, text, unit, nominal=output.nominal, reached_by=by
        )
        table.append(variable)
    return table
