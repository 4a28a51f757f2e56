"""Radau IIA steps through a period in the machine's modes; Newton's method solves for the interface
forces at the three points of each step."""

import numpy as np

from .. import backend
from . import entry_points
from .linear_structure import CondensedMachine


def integrate_period(
    machine: CondensedMachine,
    speed: float,
    mean_tangent: np.ndarray,
    steps: entry_points.Propagators,
    load_response: np.ndarray,
    initial: np.ndarray,
    nearby: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return displacements and velocities of the interfaces at the points of all steps, shape
    (steps, 3, 2 b), the real amplitudes at the end from those at the begin, and which steps were
    not solved, shape (steps,); nearby: the interfaces' motion close to the one sought."""
    sizes = {
        "steps": len(nearby),
        "lengths": len(steps.diagonal),
        "modes": len(initial),
        "b": machine.b,
    }
    block, data = machine.laws.block_of_steps(**sizes)
    period_data = entry_points.Period(
        machine.B, mean_tangent, load_response, nearby, np.zeros(len(nearby), bool), initial
    )
    for group, values in ((data.propagators, steps), (data.period, period_data)):
        for target, source in zip(group, values, strict=True):
            target[...] = source
    data.work.columns[...] = np.arange(3 * machine.b)
    backend.bound(entry_points.step_through, block)(float(speed))
    period = data.period
    return period.y.copy(), period.state.copy(), period.unsolved.copy()
