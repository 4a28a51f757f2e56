"""Values of the FMU's variables -> a `Simulation`: what the slave and the command line share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ..model.machine.rotor import Rotor
from ..model.protocol.part import BASE
from ..model.settings import choose
from ..model.simulation import Simulation
from .interface import ports
from .variables import Variable

SOLVER = "solver."


def load_names(rotor: Rotor) -> tuple[tuple[str, str], ...]:
    """Names of the inputs (x, y) of the external forces and of the base's acceleration, in the
    order of `Structure.load_dof`."""
    kinds = ((name, "a" if port.node == BASE else "f") for name, port in ports(rotor))
    return tuple((f"{name}.{of}x", f"{name}.{of}y") for name, of in kinds)


def chosen_settings(
    table: Sequence[Variable], values: Mapping[str, float]
) -> dict[str, str | float]:
    """Arguments of `settings.choose` from the values of the solver's parameters by name;
    those that are left to the preset are left out."""
    chosen = {}
    for variable in table:
        if variable.causality != "parameter" or not variable.name.startswith(SOLVER):
            continue
        value = values[variable.name]
        if variable.is_unset_at_start and value == variable.start:
            continue
        name = variable.name.removeprefix(SOLVER)
        chosen["mode" if name == "adaptive" else name] = (
            variable.choices[int(value)] if variable.choices else value
        )
    return chosen


def changed_rotor(rotor: Rotor, table: Sequence[Variable], values: Mapping[str, float]) -> Rotor:
    """The rotor with those of its parameters that differ from their start values, all at once."""
    starts = {variable.name: variable.start for variable in table}
    names = [str(name) for name, _, _ in rotor.parameters()]
    return rotor.with_values({n: values[n] for n in names if values[n] != starts[n]})


def build_simulation(
    rotor: Rotor,
    table: Sequence[Variable],
    values: Mapping[str, float],
    start_time: float,
    warn: Callable[[str], None],
    tolerance: float | None = None,
) -> Simulation:
    """The simulation that an FMU with these values of its inputs and parameters stands for.

    start_time [s], where the rotor rests under the loads among the values; tolerance: the
    experiment's [1], which a value of the FMU's own overrides. Raises `QuantityError`,
    `SettingsError` and `EquilibriumError`.
    """
    if "tau_drive" in values:
        drive = {"speed": values["w_start"], "drive_torque": values["tau_drive"]}
    else:
        drive = {
            "speed": values["speed"],
            "rate": values["speed_rate"],
            "continues_speed": values["speed_continuation"] == 0,
        }
    changed = changed_rotor(rotor, table, values)
    settings = chosen_settings(table, values)
    if tolerance is not None:
        settings.setdefault("tolerance", tolerance)
    loads = np.array([complex(values[x], values[y]) for x, y in load_names(rotor)])
    return Simulation(changed, choose(**settings), t=start_time, loads=loads, warn=warn, **drive)
