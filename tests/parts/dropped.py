"""A drop into two touchdown bearings, with a bearing told by tables: its equations written anew
for CVODE (SUNDIALS). They share the matrices of shaft and bodies with this project, and no law.

Of a race of inertia J under friction T, its surface at the radius R + s:

    J w' = (R + s) T - drag w / sqrt(w^2 + w_s^2) - damping w
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numba import njit
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.touchdown_bearing import TouchdownBearing
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble
from scipy.interpolate import PchipInterpolator
from sksundae.cvode import CVODE

from ..dense import dense_matrices

SPEED, RATE, STOP = 400.0, -100.0, 1.0  # rad/s, rad/s2, s
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
OF_A_RACE = (
    "journal_radius", "clearance", "mu", "k", "c", "delta_c", "v_s", "race_inertia", "race_drag",
    "race_damping", "race_w_s",
)  # fmt: skip
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


class Equations:
    """y' = f(t, y) with y = (x and y of all dofs and housings, their velocities, race speeds)."""

    def __init__(self, rotor: Rotor) -> None:
        structure = assemble(rotor)
        M, C, K, G, _ = dense_matrices(structure)
        inverse = np.linalg.inv(M)
        self.size = n = len(M) // 2
        housings = [part for part in rotor.parts if part.KIND == "housing"]
        names = [housing.name for housing in housings]
        first = len(structure.weight)
        races = [part for part in rotor.parts if isinstance(part, TouchdownBearing)]
        ends = [(2 * (r.node - 1), first + names.index(r.housing)) for r in races]
        (seal,) = (part for part in rotor.parts if isinstance(part, LinearBearing))
        speeds = np.array(seal.speed)
        pieces = [
            PchipInterpolator(speeds, np.broadcast_to(getattr(seal, name), speeds.shape))
            for name in COEFFICIENTS
        ]
        fall = [structure.weight.imag, -rotor.gravity * np.array([h.mass for h in housings])]
        self._given = (
            inverse,
            inverse @ C,
            inverse @ K,
            inverse @ G,
            np.concatenate([np.zeros(n), *fall]),
            structure.unbalances.dof.astype(np.int64),
            structure.unbalance,
            np.array(ends),
            np.array([[getattr(race, name) for name in OF_A_RACE] for race in races]),
            2 * (seal.node - 1),
            speeds,
            np.array([piece.c for piece in pieces]),
        )

    def slope(self, t: float, state: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` with the derivative of the state."""
        _slope(t, state, out, *self._given)


@njit
def _slope(
    t, state, out, inverse, C, K, G, weight, places, unbalance, ends, races, seal, at, table
):
    n = len(inverse) // 2
    q, v = state[: 2 * n], state[2 * n : 4 * n]
    omega, theta = SPEED + RATE * t, SPEED * t + RATE * t * t / 2
    f = weight.copy()
    for i in range(len(places)):
        pull = unbalance[i] * np.exp(1j * theta) * (omega**2 - 1j * RATE)
        f[places[i]] += pull.real
        f[n + places[i]] += pull.imag
    # a cubic between any two speeds of the table
    piece = min(max(np.searchsorted(at, omega) - 1, 0), len(at) - 2)
    k = np.zeros(8)
    for power in range(4):
        k = k * (omega - at[piece]) + table[:, power, piece]
    x, y = seal, n + seal
    f[x] -= k[0] * q[x] + k[1] * q[y] + k[4] * v[x] + k[5] * v[y]
    f[y] -= k[2] * q[x] + k[3] * q[y] + k[6] * v[x] + k[7] * v[y]
    for j in range(len(races)):
        radius, clearance, mu, stiffness, c, delta_c, v_s, inertia, drag, viscous, w_s = races[j]
        dof, end = ends[j]
        w = state[4 * n + j]
        torque = -drag * w / math.hypot(w, w_s) - viscous * w
        d_x, d_y = q[dof] - q[end], q[n + dof] - q[n + end]
        u_x, u_y = v[dof] - v[end], v[n + dof] - v[n + end]
        r = math.hypot(d_x, d_y)
        depth = r - clearance
        if depth > 0:
            e_x, e_y = d_x / r, d_y / r
            grown = min(1.0, depth / delta_c)
            normal = max(0.0, stiffness * depth + c * grown * (u_x * e_x + u_y * e_y))
            sliding = u_y * e_x - u_x * e_y + radius * omega - (radius + clearance) * w
            rubbing = mu * normal * sliding / math.hypot(sliding, v_s)
            f_x, f_y = -normal * e_x + rubbing * e_y, -normal * e_y - rubbing * e_x
            f[dof] += f_x
            f[n + dof] += f_y
            f[end] -= f_x
            f[n + end] -= f_y
            torque += (radius + clearance) * rubbing
        out[4 * n + j] = torque / inertia
    out[: 2 * n] = v
    out[2 * n : 4 * n] = inverse @ f - C @ v - omega * (G @ v) - K @ q - 0.5 * RATE * (G @ q)


def journals(rotor: Rotor, q: np.ndarray) -> np.ndarray:
    """Displacements of both journals, complex of shape (times, 2) [m]; q: of all dofs."""
    nodes = [part.node for part in rotor.parts if isinstance(part, TouchdownBearing)]
    return q[:, [2 * (node - 1) for node in nodes]]


def by_cvode(rotor: Rotor, times: np.ndarray, rtol: float = 1e-7) -> tuple[np.ndarray, np.ndarray]:
    """The journals' orbits [m] and the races' speeds [rad/s] at the times [s]."""
    equations = Equations(rotor)
    n = equations.size
    at_start = Simulation(rotor, speed=SPEED, rate=RATE, warn=lambda message: None).motion
    q, v = at_start.q[:n], at_start.v[:n]
    start = np.concatenate([q.real, q.imag, v.real, v.imag, np.zeros(2)])
    atol = np.repeat([1e-4 * rtol, 1e-1 * rtol, rtol], [2 * n, 2 * n, 2])
    solver = CVODE(equations.slope, rtol=rtol, atol=atol, max_num_steps=10**8)
    y = solver.solve(times, start).y
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
