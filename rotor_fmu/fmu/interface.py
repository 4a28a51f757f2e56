"""The FMU's variables: one table, from which the description, the slave, the command line and the
documents are made."""

from __future__ import annotations

from ..model.machine.rotor import Rotor
from ..model.march.observe import observed_names
from ..model.structure.assembly import assemble
from .solver_parameters import solver_parameters
from .variables import Variable


def interface(rotor: Rotor, is_free: bool = False) -> tuple[Variable, ...]:
    """All variables of a rotor's FMU: inputs, parameters, then what the model computes in the order
    of `observed_names`.

    is_free: a torque drives the rotor, and its speed is a state; otherwise the speed is prescribed.
    """
    return (*_inputs(rotor, is_free), *_parameters(rotor, is_free), *_observed(rotor, is_free))


def _inputs(rotor: Rotor, is_free: bool) -> list[Variable]:
    def load(name: str, axis: str, where: str) -> Variable:
        """An external force on a body along an axis [N]."""
        direction = "to the right (+x)" if axis == "x" else "upwards (+y)"
        return Variable(
            f"{name}.f{axis}",
            "Real",
            "input",
            f"external force on {where}, {direction}",
            "N",
            0.0,
            nominal=10.0,
        )

    drive = Variable(
        "speed",
        "Real",
        "input",
        "speed of rotation about z, x towards y; continued until the next communication point as "
        "speed_continuation says",
        "rad/s",
        400.0,
        nominal=100.0,
    )
    if is_free:
        drive = Variable(
            "tau_drive",
            "Real",
            "input",
            "torque of the drive on the rotor about z, x towards y",
            "N.m",
            0.0,
            nominal=0.1,
        )
    table = [drive]
    for i, disc in enumerate(rotor.discs, 1):
        where = f"disc {i} at z = {rotor.nodes[disc.node - 1]:g} m"
        table += [load(f"disc[{i}]", axis, where) for axis in "xy"]
    if rotor.coupling is not None:
        where = f"the coupling at z = {rotor.nodes[rotor.coupling.node - 1]:g} m"
        table += [load("coupling", axis, where) for axis in "xy"]
    return table


def _parameters(rotor: Rotor, is_free: bool) -> list[Variable]:
    def real(name: str, unit: str, start: float, text: str, low: float | None = 0.0) -> Variable:
        nominal = abs(start) or 1.0
        return Variable(
            name, "Real", "parameter", text, unit, float(start), low=low, nominal=nominal
        )

    prescribed = [
        real(
            "speed_rate",
            "rad/s2",
            0.0,
            "rate of the speed over the first communication step, when there is no earlier value",
            low=None,
        ),
        Variable(
            "speed_continuation",
            "Integer",
            "parameter",
            "the speed between two communication points: 0 linear (continues the last change), "
            "1 hold (for an input that jumps)",
            start=0,
            low=0,
            high=1,
            choices=("linear", "hold"),
        ),
    ]
    free = [real("w_start", "rad/s", 400.0, "speed of rotation at the start", low=None)]
    table = free if is_free else prescribed
    for j, b in enumerate(rotor.bearings, 1):
        table += [
            real(f"bearing[{j}].{name}", unit, getattr(b, name), f"bearing {j}: {text}")
            for name, unit, text in (
                ("clearance", "m", "radial clearance"),
                ("mu", "1", "coefficient of friction"),
                ("k", "N/m", "contact stiffness"),
                ("c", "N.s/m", "contact damping"),
                ("kx", "N/m", "horizontal stiffness of the housing's springs"),
                ("ky", "N/m", "vertical stiffness of the housing's springs"),
                ("cx", "N.s/m", "horizontal damping of the housing"),
                ("cy", "N.s/m", "vertical damping of the housing"),
                ("mass", "kg", "mass of the housing"),
            )
        ]
    for i, disc in enumerate(rotor.discs, 1):
        table += [
            real(f"disc[{i}].e", "m", disc.e, f"disc {i}: eccentricity of the centre of mass"),
            real(
                f"disc[{i}].phase", "rad", disc.phase, f"disc {i}: angle of the eccentricity", None
            ),
        ]
    return [
        *table,
        real("shaft.eta_v", "s", rotor.eta_v, "viscous internal damping of the shaft"),
        real("shaft.eta_h", "1", rotor.eta_h, "hysteretic internal damping of the shaft"),
        Variable(
            "shaft.rotating_damping",
            "Boolean",
            "parameter",
            "whether the internal damping turns with the shaft (Zorzi and Nelson)",
            start=rotor.rotating_damping,
        ),
        real("gravity", "m/s2", rotor.gravity, "gravity, downwards (-y)"),
        *solver_parameters(),
    ]


# What the model computes, by the last part of the name: kind, causality, unit, nominal, text.
_TEXTS = {
    "phi": ("Real", "output", "rad", 100.0, "angle of rotation, integral of the speed"),
    "w": ("Real", "local", "rad/s", 100.0, "speed of rotation reached"),
    "a": ("Real", "local", "rad/s2", 10.0, "rate of the speed"),
    "tau": (
        "Real",
        "output",
        "N.m",
        0.1,
        "torque that the drive must supply to turn the rotor at its speed",
    ),
    "tau_load": (
        "Real",
        "output",
        "N.m",
        0.1,
        "what friction, whirl and unbalance take of it, tau - J a: the load of a partner that "
        "integrates the speed with the rotor's inertia J",
    ),
    "J": (
        "Real",
        "local",
        "kg.m2",
        0.01,
        "moment of inertia about the axis of rotation, eccentric masses included",
    ),
    "disc.x": ("Real", "output", "m", 1e-4, "displacement to the right"),
    "disc.y": ("Real", "output", "m", 1e-4, "displacement upwards, at rest below 0 by the sag"),
    "disc.x_amp": ("Real", "local", "m", 1e-4, "largest abs(x) over the last revolution"),
    "disc.y_amp": (
        "Real",
        "local",
        "m",
        1e-4,
        "largest abs(y - y at rest) over the last revolution",
    ),
    "bearing.psi": (
        "Real",
        "output",
        "rad",
        1.0,
        "contact angle, 0 to the right, 3 pi / 2 at the bottom",
    ),
    "bearing.fn": ("Real", "output", "N", 10.0, "normal contact force"),
    "bearing.ft": ("Real", "local", "N", 1.0, "friction force that brakes the rotor"),
    "bearing.x": ("Real", "local", "m", 1e-4, "journal relative to the housing, to the right"),
    "bearing.y": ("Real", "local", "m", 1e-4, "journal relative to the housing, upwards"),
    "bearing.housing_x": ("Real", "local", "m", 1e-4, "displacement of the housing to the right"),
    "bearing.housing_y": ("Real", "local", "m", 1e-6, "displacement of the housing upwards"),
    "bearing.contact": ("Boolean", "output", "1", None, "whether journal and housing touch"),
    "solver.h_last": ("Real", "local", "s", 1e-3, "length of the last step"),
    "solver.steps": ("Integer", "local", "1", None, "steps taken"),
    "solver.rejected": ("Integer", "local", "1", None, "steps rejected and repeated"),
    "solver.newton": ("Integer", "local", "1", None, "iterations of the contact problem"),
    "solver.error": (
        "Real",
        "local",
        "1",
        0.1,
        "error of the last step over the one tolerated, or as the indicator has it",
    ),
    "solver.h_min_used": ("Real", "local", "s", 1e-3, "shortest step length chosen"),
    "solver.h_max_used": ("Real", "local", "s", 1e-3, "longest step length chosen"),
    "solver.trapped": (
        "Integer",
        "local",
        "1",
        None,
        "steps in the false state, a journal jumping from wall to wall by the integrator's doing",
    ),
    "solver.trapped_at": (
        "Real",
        "local",
        "s",
        1.0,
        "time at which the false state was first seen; -1: never",
    ),
    "energy.kinetic": ("Real", "local", "J", 100.0, "kinetic energy, rotation included"),
    "energy.elastic": ("Real", "local", "J", 0.01, "elastic energy of shaft and housing springs"),
    "energy.gravity": ("Real", "local", "J", 0.01, "potential energy of gravity"),
    "energy.compression": ("Real", "local", "J", 1e-6, "elastic energy of the contacts"),
    "energy.drive_work": ("Real", "local", "J", 100.0, "work of the drive since the start"),
    "energy.external_work": (
        "Real",
        "local",
        "J",
        1.0,
        "work of the external forces since the start",
    ),
    "energy.structure_loss": ("Real", "local", "J", 1.0, "dissipated in the shaft since the start"),
    "energy.housing_loss": ("Real", "local", "J", 1.0, "dissipated in the housings' dampers"),
    "energy.contact_loss": ("Real", "local", "J", 0.1, "dissipated by the contacts' damping"),
    "energy.friction_loss": ("Real", "local", "J", 100.0, "dissipated by friction"),
    "energy.residual": (
        "Real",
        "local",
        "J",
        0.1,
        "energy that the integrator made (or, negative, lost)",
    ),
}


# Outputs only where they are states or follow from an input.
_OUTPUTS_IF_FREE = ("w", "a")


def _observed(rotor: Rotor, is_free: bool) -> list[Variable]:
    table = []
    for name in observed_names(assemble(rotor)):
        part, _, quantity = name.rpartition(".")
        kind_of_part, _, index = part.rstrip("]").partition("[")
        kind, causality, unit, nominal, text = _TEXTS[
            f"{kind_of_part}.{quantity}" if part else name
        ]
        if is_free and name in _OUTPUTS_IF_FREE:
            causality = "output"
        where = f"{kind_of_part} {index}: " if index else ""
        table.append(Variable(name, kind, causality, where + text, unit, nominal=nominal))
    return table
