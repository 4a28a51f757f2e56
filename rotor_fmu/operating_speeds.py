"""At which speeds a machine is run: as its file says, else as its lowest natural frequency says."""

import math
from dataclasses import dataclass
from functools import lru_cache

from .model.machine.rotor import Rotor
from .model.structure.assembly import assemble

# Highest speed of a machine whose file says none, in its lowest natural frequencies, and the turns
# of a run over all speeds: those of paper A's rig.
_ABOVE_LOWEST, _TURNS = 2.0, 4000 / math.pi


@dataclass(frozen=True)
class OperatingSpeeds:
    """Speeds [rad/s] and rates [rad/s2] of a machine: where its FMU starts, where a run-up ends,
    where a run-down begins, and how quickly the speed changes, without sign."""

    rated: float
    highest: float
    trip: float
    run_up_rate: float
    run_down_rate: float


def operating_speeds(rotor: Rotor) -> OperatingSpeeds:
    """Return how a machine is run."""
    given = rotor.operation
    speeds = list(given.speeds.values())
    rated = given.rated_speed or given.maximum_continuous_speed or given.trip_speed
    rated = rated or _default(rotor)
    highest = given.service_speed or rated
    trip = given.trip_speed or max([highest, *speeds])
    up = given.run_up_rate or highest**2 / (4 * math.pi * _TURNS)
    down = given.run_down_rate or trip**2 / (4 * math.pi * _TURNS)
    return OperatingSpeeds(rated, highest, trip, up, down)


@lru_cache(maxsize=64)
def _default(rotor: Rotor) -> float:
    """A speed above the first critical one [rad/s], of two digits."""
    return float(f"{_ABOVE_LOWEST * float(assemble(rotor).numbers[0].lowest_omega):.2g}")
