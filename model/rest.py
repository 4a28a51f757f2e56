"""Where a machine rests: the start of every run, for analyses that need no more of it."""

from __future__ import annotations

import numpy as np

from .machine.rotor import Rotor
from .simulation import Simulation


def rest(rotor: Rotor) -> np.ndarray:
    """Displacements at rest under the weight, without spin and friction, complex, shape
    (n + housings + 1,) as in `Motion` [m]. Raises `EquilibriumError`."""
    return Simulation(rotor).motion.q.copy()
