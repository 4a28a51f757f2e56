"""The survey's cycles of the false state: predicted, planted in the rig, and watched."""

import time
from functools import cache
from pathlib import Path

from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.simulation import StepFailure

from papers.integrators.members import Scheme

from ..false_state import cycles as false_state
from ..false_state import one_axis
from ..false_state.planting import plant
from .grid import Experiment, Row
from .rotor import RUN_DOWN_RATE, STEPS, is_of_the_rotor, perturbed, work_of
from .sources import file_digest, source_digest

SPEEDS = (50.0, 120.0, 160.0, 185.0, 200.0, 220.0, 260.0, 300.0, 400.0)  # of planted cycles [rad/s]
PLANTED_FOR = 1.0  # [s]
_WATCHED = 0.2  # at its end [s]


@cache
def lasting_cycles(
    scheme: Scheme, h: float
) -> list[tuple[float, int, int, one_axis.Axis, false_state.Cycle]]:
    """The rig's lasting cycles at a step h [s], the one that bears most first: load that it bears
    [N], bearing, direction, axis, cycle."""
    result = []
    for bearing in range(len(rig().bearings)):
        for direction in (one_axis.X, one_axis.Y):
            axis = one_axis.axis_of(rig(), bearing, direction)
            for cycle in false_state.cycles(axis, scheme, h):
                bears = cycle.bears(axis)
                if bears > 0.0 and cycle.is_stable:
                    result.append((bears, bearing, direction, axis, cycle))
    return sorted(result, key=lambda entry: -entry[0])


def planted(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """The strongest predicted cycle planted at one of `SPEEDS`: whether it lasts for a second.

    trapped: share of the last 0.2 s; power: energy made then.
    """
    predicted = lasting_cycles(scheme, h)
    if not predicted:
        return {"status": "no cycle"}
    bears, bearing, direction, _, cycle = predicted[0]
    speed = SPEEDS[case]
    simulation = perturbed(scheme, h, 0.0, speed)
    begun = time.process_time()
    plant(simulation, bearing, direction, cycle)
    row: Row = {
        "bears": bears,
        "load": float(one_axis.unbalance_loads(simulation.structure, speed)[bearing].max()),
        "power_predicted": cycle.power,
        "word": f"{bearing + 1}{'xy'[direction]}:{cycle.word}",
    }
    try:
        simulation.advance(PLANTED_FOR - _WATCHED, speed)
        before = simulation.read("solver.trapped"), simulation.read("energy.residual")
        steps = simulation.read("solver.steps")
        simulation.advance(PLANTED_FOR, speed + RUN_DOWN_RATE * (PLANTED_FOR - _WATCHED))
    except StepFailure:
        return row | {"status": f"stalled at {simulation.time:.4g} s", **work_of(simulation, begun)}
    made = simulation.read("energy.residual") - before[1]
    trapped = (simulation.read("solver.trapped") - before[0]) / (
        simulation.read("solver.steps") - steps
    )
    return row | {
        "status": "ok",
        "trapped": trapped,
        "power": made / _WATCHED,
        **work_of(simulation, begun),
    }


def _version() -> str:
    code = source_digest("papers.integrators.false_state.planting")
    return f"{code} {file_digest(__file__)} {rig_toml()}"


PLANTED = Experiment(
    name="planted",
    steps=STEPS,
    cases=tuple(f"{speed:g} rad/s" for speed in SPEEDS),
    version=_version,
    run=planted,
    takes=is_of_the_rotor,
)
