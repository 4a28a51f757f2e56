"""A drop into two touchdown bearings, with a bearing given by tables, and CVODE's solution."""

from pathlib import Path

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.touchdown_bearing import TouchdownBearing
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import Simulation

from .equations import Equations, solved

SPEED, RATE, STOP = 400.0, -100.0, 1.0  # rad/s, rad/s2, s
COMPRESSOR = Path(__file__).parents[2] / "examples" / "drop" / "compressor.toml"
SEAL = """
[[linear_bearing]]
z = 0.34
kxx = [2e4, 3e4, 5e4]
kxy = [1e3, 2e3, 4e3]
kyx = [-1e3, -3e3, -4e3]
kyy = [3e4, 3e4, 4e4]
cxx = [200.0, 150.0, 100.0]
cyy = [200.0, 180.0, 100.0]
speed = [250.0, 330.0, 420.0]
"""


def machine(mu: float = 0.15) -> Rotor:
    """The compressor of the example with a seal in its middle that follows the speed."""
    text = COMPRESSOR.read_text(encoding="utf-8").replace("mu = 0.15", f"mu = {mu}")
    return parse_rotor(text + SEAL)


def journals(rotor: Rotor, q: np.ndarray) -> np.ndarray:
    """Displacements of both journals, complex of shape (times, 2) [m]; q: of all dofs."""
    nodes = [part.node for part in rotor.parts if isinstance(part, TouchdownBearing)]
    return q[:, [2 * (node - 1) for node in nodes]]


def by_cvode(rotor: Rotor, times: np.ndarray, rtol: float = 1e-7) -> tuple[np.ndarray, np.ndarray]:
    """The journals' orbits [m] and the races' speeds [rad/s] at the times [s]."""
    equations = Equations(rotor, SPEED, RATE)
    n = equations.size
    at_start = Simulation(rotor, speed=SPEED, rate=RATE, warn=lambda message: None).motion
    y = solved(equations, at_start.q[:n], at_start.v[:n], times, rtol)
    return journals(rotor, y[:, :n] + 1j * y[:, n : 2 * n]), y[:, 4 * n :]


def by_simulation(
    rotor: Rotor, times: np.ndarray, settings: Settings
) -> tuple[np.ndarray, np.ndarray, Simulation]:
    """The same of a run of this project, and the run."""
    sim = Simulation(rotor, settings, speed=SPEED, rate=RATE, warn=lambda message: None)
    seen, races = [], []
    for t in times:
        sim.advance(t, SPEED + RATE * sim.time)
        seen.append(sim.motion.q.copy())
        races.append([sim.read(f"touchdown_bearing[{k}].race") for k in (1, 2)])
    return journals(rotor, np.array(seen)), np.array(races), sim
