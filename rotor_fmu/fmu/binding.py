"""Values of the FMU's variables -> a `Simulation`: what the slave and the command line share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ..model.machine.rotor import Rotor
from ..model.simulation import Simulation
from .solver_parameters import is_solvers, settings_of
from .variables import Variable

# Parameters of the run itself, neither the rotor's nor the solver's.
_OF_THE_RUN = ("speed_rate", "speed_continuation", "w_start")


def load_names(rotor: Rotor) -> tuple[tuple[str, str], ...]:
    """Names of the inputs (x, y) of the external forces, in the order of `Structure.load_dof`."""
    bodies = [f"disc[{i}]" for i in range(1, len(rotor.discs) + 1)]
    if rotor.coupling is not None:
        bodies.append("coupling")
    return tuple((f"{body}.fx", f"{body}.fy") for body in bodies)


def changed_rotor(rotor: Rotor, table: Sequence[Variable], values: Mapping[str, float]) -> Rotor:
    """The rotor with those of its parameters that differ from their start values."""
    parameters = [v for v in table if v.causality == "parameter" and not is_solvers(v.name)]
    return rotor.with_values(
        {
            v.name: values[v.name]
            for v in parameters
            if v.name not in _OF_THE_RUN and values[v.name] != v.start
        }
    )


def build_simulation(
    rotor: Rotor,
    table: Sequence[Variable],
    values: Mapping[str, float],
    warn: Callable[[str], None],
    tolerance: float | None = None,
) -> Simulation:
    """The simulation that an FMU with these values of its inputs and parameters stands for; its
    time is counted from the start.

    tolerance: the experiment's [1], which a value of the FMU's own overrides. Raises `RotorError`,
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
    loads = np.array([complex(values[x], values[y]) for x, y in load_names(rotor)])
    changed = changed_rotor(rotor, table, values)
    settings = settings_of(values, tolerance, warn)
    return Simulation(changed, settings, loads=loads, warn=warn, **drive)
