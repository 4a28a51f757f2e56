"""Values of the FMU's variables -> a `Simulation`: shared by the slave and the command line."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..model.machine.rotor import Rotor
from ..model.message_templates import Message
from ..model.parts.base import BASE
from ..model.simulation import CouplingOptions, Simulation
from ..model.time_loop.recorder import Record
from .coupling_parameters import coupling_parameters
from .interface import ports
from .solver_parameters import settings_of
from .variables import Variable, start_values


def load_names(rotor: Rotor) -> tuple[tuple[str, str], ...]:
    """Return the names of the inputs (x, y) of the external forces and of the base's acceleration,
    in the order of `Structure.load_dof`."""
    kinds = ((name, "a" if port.node == BASE else "f") for name, port in ports(rotor))
    return tuple((f"{name}.{of}x", f"{name}.{of}y") for name, of in kinds)


def changed_rotor(rotor: Rotor, table: Sequence[Variable], values: Mapping[str, float]) -> Rotor:
    """Return the rotor with all of its numbers that differ from their start values."""
    starts = {name: of.value for name, of in rotor.numbers().items()}
    given = {name: values[name] for name in starts if name in values}
    starts |= start_values(table)
    return rotor.with_values({n: value for n, value in given.items() if value != starts[n]})


def coupling_options(values: Mapping[str, float]) -> CouplingOptions:
    """Return what values of the FMU's parameters ask of a run beside its motion: limits at which it
    ends, sensitivities, the line that drives a free rotor."""
    asked = coupling_parameters("tau_drive" in values)
    options: dict[str, Any] = {of.field: values.get(of.name, 0.0) for of in asked}
    return CouplingOptions(**options)


def build_simulation(
    rotor: Rotor,
    table: Sequence[Variable],
    values: Mapping[str, float],
    warn: Callable[[Message], None],
    record: Record | Sequence[str] = (),
) -> Simulation:
    """Return the simulation that an FMU with these values of its inputs and parameters stands for,
    at rest under the loads among them; its time is counted from the start.

    record: signals to record at every step (`Simulation`). Raises `QuantityError`, `SettingsError`
    and `EquilibriumError`.
    """
    loads = np.array([complex(values[x], values[y]) for x, y in load_names(rotor)])
    changed = changed_rotor(rotor, table, values)
    settings = settings_of(values, warn)
    is_free = "tau_drive" in values
    return Simulation(
        changed,
        settings,
        speed=values["w_start" if is_free else "speed"],
        rate=0.0 if is_free else values["speed_rate"],
        continues_speed=is_free or values["speed_continuation"] == 0,
        drive_torque=values.get("tau_drive"),
        loads=loads,
        record=record,
        coupling=coupling_options(values),
        warn=warn,
    )
