"""The equilibrium in which every run starts, for analyses that need nothing else of a run."""

from __future__ import annotations

import numpy as np

from .machine.rotor import Rotor
from .simulation import Simulation


def rest(rotor: Rotor) -> np.ndarray:
    """Return the displacements at rest under the weight, without spin and friction, complex, shape
    (n + housings + 1,) as in `Motion` [m]. Raises `EquilibriumError`."""
    return Simulation(rotor).motion.q.copy()
