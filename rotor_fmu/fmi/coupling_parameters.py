"""The FMU's parameters that a master of a coupled system sets: what ends a step early,
sensitivities, the line through which a torque drives. Each is a number of the run's record; 0 asks
for nothing."""

from typing import NamedTuple

from ..model.quantities import NOT_NEGATIVE, Quantity
from .variables import Variable


class CouplingParameter(NamedTuple):
    """A parameter: its name, the field of `RECORD` that takes it, what it is, and whether it is for
    rotors that a torque drives only."""

    name: str
    field: str
    quantity: Quantity
    is_for_torque: bool = False


SENSITIVITIES = "solver.sensitivities"
_ALL = (
    CouplingParameter(
        "limit.displacement",
        "limit_displacement",
        Quantity(
            "m",
            "distance of a probe from the axis beyond which a communication step ends early; 0: no "
            "limit",
            NOT_NEGATIVE,
        ),
    ),
    CouplingParameter(
        "limit.force",
        "limit_force",
        Quantity(
            "N",
            "force of a bearing, contact or seal beyond which a communication step ends early; 0: "
            "no limit",
            NOT_NEGATIVE,
        ),
    ),
    CouplingParameter(
        "limit.contact",
        "stops_at_contact",
        Quantity(
            "1",
            "whether a communication step ends early where a contact closes or opens, as far as "
            "the host allows it",
            is_switch=True,
        ),
    ),
    CouplingParameter(
        "tau_impedance",
        "drive_impedance",
        Quantity(
            "N.m.s/rad",
            "characteristic impedance Z of the line that drives the rotor: its torque is tau_drive "
            "- Z w, solved within the steps; the reflected wave is tau_drive - 2 Z w, which the "
            "other end takes with its sign reversed; 0: none",
            NOT_NEGATIVE,
        ),
        is_for_torque=True,
    ),
    CouplingParameter(
        SENSITIVITIES,
        "has_sensitivities",
        Quantity(
            "1",
            "whether the sensitivities of the outputs to the inputs are calculated with every step",
            is_switch=True,
        ),
    ),
)


def coupling_parameters(is_free: bool) -> tuple[CouplingParameter, ...]:
    """Return the parameters of an FMU; is_free: whether a torque drives its rotor."""
    return tuple(each for each in _ALL if is_free or not each.is_for_torque)


def coupling_variables(is_free: bool) -> list[Variable]:
    """Return them as variables of the FMU."""
    return [
        Variable(name, "Boolean", "parameter", of.text, start=False)
        if of.is_switch
        else Variable(name, "Real", "parameter", of.text, of.unit, 0.0, low=0.0, nominal=1.0)
        for name, _, of, _ in coupling_parameters(is_free)
    ]
