"""Whether a journal that hits a wall ends in the false state: the survey's map of one impact."""

from functools import cache
from pathlib import Path

import numpy as np
from rotor_fmu.model.machine.toml import rig, rig_toml

from papers.integrators.members import Scheme

from ..false_state import bouncing, one_axis
from .grid import Experiment, Row
from .rotor import STEPS, is_of_the_rotor
from .sources import file_digest, source_digest

SPEEDS = (0.02, 0.05, 0.08, 0.12, 0.2, 0.4, 0.8)  # of the journal in its clearance [m/s]


@cache
def _axes() -> list[one_axis.Axis]:
    directions = one_axis.X, one_axis.Y
    bearings = range(len(rig().bearings))
    return [one_axis.axis_of(rig(), j, d) for j in bearings for d in directions]


@cache
def _shares(scheme: Scheme, h: float) -> np.ndarray:
    speeds = np.array(SPEEDS)
    shares = [bouncing.trapped_share(axis, scheme, h, speeds) for axis in _axes()]
    return np.max(shares, axis=0)


def bounce(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """Impacts at one of `SPEEDS`, on the walls of any bearing along x or y, no unbalance.

    trapped: share that ends in the false state, where it is largest.
    """
    return {"status": "ok", "trapped": float(_shares(scheme, h)[case])}


def _version() -> str:
    code = source_digest("papers.integrators.false_state.bouncing")
    return f"{code} {file_digest(__file__)} {rig_toml()}"


BOUNCE = Experiment(
    name="bounce",
    steps=STEPS,
    cases=tuple(f"{speed:g} m/s" for speed in SPEEDS),
    version=_version,
    run=bounce,
    takes=is_of_the_rotor,
)
