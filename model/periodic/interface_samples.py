"""The motion of the interfaces in a run, sampled."""

from typing import NamedTuple

import numpy as np

from ..simulation import Simulation


class InterfaceSamples(NamedTuple):
    """Motion of all m interfaces with s internal states at n instants: t [s], shape (n,); complex
    relative displacements d [m] and velocities v [m/s], shape (n, m); internal states, shape (n,
    s)."""

    t: np.ndarray
    d: np.ndarray
    v: np.ndarray
    states: np.ndarray


def sample(run: Simulation) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Return the motion of a run's interfaces at the present time: a row of `InterfaceSamples`."""
    # plain: a field of a record array takes longer than all else here
    motion, interfaces = run.motion, np.asarray(run.structure.interfaces)
    node, housing = interfaces["dof"], interfaces["end"]
    d, v = (z[node] - z[housing] for z in (motion.q, motion.v))
    return run.time, d, v, motion.internal_state.copy()
