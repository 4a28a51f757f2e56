"""Values of the FMU's variables -> a `Simulation`: what the slave and the command line share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ..model.machine.rotor import Rotor
from ..model.settings import choose
from ..model.simulation import Simulation
from .variables import Variable

SOLVER = "solver."
# Parameters of the run itself, neither the rotor's nor the solver's.
_OF_THE_RUN = ("speed_rate", "speed_continuation", "w_start")


def load_names(rotor: Rotor) -> tuple[tuple[str, str], ...]:
    """Names of the inputs (x, y) of the external forces, in the order of `Structure.load_dof`."""
    bodies = [f"disc[{i}]" for i in range(1, len(rotor.discs) + 1)]
    if rotor.coupling is not None:
        bodies.append("coupling")
    return tuple((f"{body}.fx", f"{body}.fy") for body in bodies)


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
    """The rotor with those of its parameters that differ from their start values."""
    for variable in table:
        name = variable.name
        is_the_rotors = variable.causality == "parameter" and not name.startswith(SOLVER)
        if is_the_rotors and name not in _OF_THE_RUN and values[name] != variable.start:
            rotor = rotor.with_value(name, values[name])
    return rotor


def build_simulation(
    rotor: Rotor,
    table: Sequence[Variable],
    values: Mapping[str, float],
    start_time: float,
    warn: Callable[[str], None],
    tolerance: float | None = None,
) -> Simulation:
    """The simulation that an FMU with these values of its inputs and parameters stands for.

    start_time [s]; tolerance: the experiment's [1], which a value of the FMU's own overrides.
    Raises `RotorError`, `SettingsError` and `EquilibriumError`.
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
    return Simulation(changed, choose(**settings), t=start_time, warn=warn, **drive)
