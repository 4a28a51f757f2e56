"""Steps of Radau IIA through a period: the machine's modes, with the forces of its interfaces at
the three points of each step solved for by Newton's method."""

from __future__ import annotations

import numpy as np

from .. import backend
from . import entry_points
from .linear_structure import Condensed


def run(
    machine: Condensed,
    speed: float,
    mean: np.ndarray,
    steps: entry_points.Lengths,
    by_loads: np.ndarray,
    begin: np.ndarray,
    near: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What is seen at the points of all steps, shape (steps, 3, 2 b), from real amplitudes at the
    begin on, those at the end, and which steps were not solved, shape (steps,); near: what is seen
    of a motion nearby."""
    sizes = {"steps": len(near), "lengths": len(steps.along), "modes": len(begin), "b": machine.b}
    block, data = machine.laws.block_of_steps(**sizes)
    given = entry_points.Period(machine.B, mean, by_loads, near, np.zeros(len(near), bool), begin)
    for group, values in ((data.lengths, steps), (data.period, given)):
        for target, source in zip(group, values, strict=True):
            target[...] = source
    data.work.places[...] = np.arange(3 * machine.b)
    backend.bound(entry_points.step_through, block)(float(speed))
    period = data.period
    return period.y.copy(), period.state.copy(), period.unsolved.copy()
