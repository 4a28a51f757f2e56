"""Machines of contacts, linear bearings, seals and housings: their equations written anew for CVODE
(SUNDIALS). They share the matrices of shaft and bodies with this project, and no law.

Of a race of inertia J under friction T, its surface at the radius R + s:

    J w' = (R + s) T - drag w / sqrt(w^2 + w_s^2) - damping w
"""

import cmath
import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.parts.housing import Housing
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.touchdown_bearing import TouchdownBearing
from rotor_fmu.model.structure.assembly import assemble
from scipy.interpolate import PchipInterpolator
from sksundae.cvode import CVODE

from ..dense import dense_matrices

COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
OF_A_WALL = (
    *("journal_radius", "clearance", "mu", "k", "c", "delta_c", "v_s"),
    *("exponent", "mu_rise", "v_stribeck", "wear", "wear_angle", "wear_power"),
)
OF_A_RACE = ("race_inertia", "race_drag", "race_damping", "race_w_s")
Wall = Bearing | ClearanceContact | TouchdownBearing


class Equations:
    """y' = f(t, y) with y = (x and y of all dofs and housings, their velocities, the speeds
    of the walls, all but races at rest) at the speed of rotation speed + rate t [rad/s]."""

    def __init__(
        self,
        rotor: Rotor,
        speed: float,
        rate: float,
        unbalance: float = 1.0,
        base: np.ndarray | None = None,
        interval: float = 1.0,
    ) -> None:
        """base: acceleration x + i y [m/s2] at times `interval` [s] apart, linear in between."""
        structure = assemble(rotor)
        M, C, K, G, circulatory = dense_matrices(structure)
        inverse = np.linalg.inv(M)
        self.size = n = len(M) // 2
        first = len(structure.static_load)
        named = dict(rotor.named_parts())
        mounts = {
            (part.name if isinstance(part, Housing) else where): part
            for where, part in named.items()
            if isinstance(part, (Bearing, Housing))
        }
        names = list(mounts)

        def ends(parts: dict[str, Wall | LinearBearing]) -> np.ndarray:
            """Node and what it is held by, -1 for ground."""
            held = [where if isinstance(p, Bearing) else p.housing for where, p in parts.items()]
            at = [first + names.index(name) if name else -1 for name in held]
            nodes = [2 * (part.node - 1) for part in parts.values()]
            return np.array([nodes, at], int).T

        walls = {where: part for where, part in named.items() if isinstance(part, Wall)}
        bearings = {w: part for w, part in named.items() if isinstance(part, LinearBearing)}
        pull = -1j * cmath.exp(1j * rotor.gravity_angle) * math.cos(rotor.inclination)
        pull *= rotor.gravity
        masses = np.array([[part.mass, part.mass * part.mass_ratio] for part in mounts.values()])
        masses = masses.reshape(-1, 2)
        shaft = M[:first, :first:2].sum(axis=1)
        x_mass = np.concatenate([shaft, masses[:, 0]])
        y_mass = np.concatenate([shaft, masses[:, 1]])
        weight = np.concatenate([x_mass * pull.real, y_mass * pull.imag])
        turning = structure.numbers[0]
        speeds, cubics = _tables(list(bearings.values()))
        self.walls = list(walls.values())
        self._given = (
            np.array([speed, rate, turning.kappa_v, turning.kappa_h]),
            inverse,
            inverse @ C,
            inverse @ K,
            inverse @ G,
            inverse @ circulatory,
            weight,
            structure.unbalances.dof.astype(np.int64),
            unbalance * structure.unbalance,
            ends(walls),
            _values(self.walls, OF_A_WALL),
            _values(self.walls, OF_A_RACE),
            ends(bearings),
            speeds,
            cubics,
            np.concatenate([x_mass, y_mass]),
            np.zeros(0, complex) if base is None else base,
            interval,
        )
        assert len(weight) == 2 * n

    def slope(self, t: float, state: np.ndarray, out: np.ndarray) -> None:
        """Fill `out` with the derivative of the state."""
        _slope(t, state, out, *self._given)


def _values(walls: Sequence[Wall], names: Sequence[str]) -> np.ndarray:
    """What the walls say of these names, 0 where they do not, shape (walls, names)."""
    each = [[getattr(wall, name, 0.0) for name in names] for wall in walls]
    return np.array(each, float).reshape(len(walls), len(names))


def _tables(bearings: Sequence[LinearBearing]) -> tuple[np.ndarray, np.ndarray]:
    """Speeds at which cubics of the coefficients begin, of shape (bearings, pieces), and those,
    (bearings, pieces, 4, 8); constant beyond a table."""
    pieces = 2 + max([len(b.speed) for b in bearings], default=0)
    speeds = np.full((len(bearings), pieces), math.inf)
    cubics = np.zeros((len(bearings), pieces, 4, 8))
    for i, bearing in enumerate(bearings):
        output = np.array([np.ravel(getattr(bearing, name))[[0, -1]] for name in COEFFICIENTS])
        speeds[i, 0], cubics[i, 0, 3] = -math.inf, output[:, 0]
        at = np.array(bearing.speed)
        if len(at):
            values = [np.broadcast_to(getattr(bearing, n), at.shape) for n in COEFFICIENTS]
            speeds[i, 1 : 1 + len(at)] = at
            cubics[i, 1 : len(at)] = np.moveaxis(
                [PchipInterpolator(at, value).c for value in values], 0, -1
            ).swapaxes(0, 1)
            cubics[i, len(at), 3] = output[:, 1]
    return speeds, cubics


@njit
def _slope(
    t, state, out, turning, inverse, C, K, G, circulatory, weight, places, unbalance, ends, walls,
    races, held, speeds, cubics, masses, base, interval,
):  # fmt: skip
    n = len(inverse) // 2
    q, v = state[: 2 * n], state[2 * n : 4 * n]
    omega, rate = turning[0] + turning[1] * t, turning[1]
    theta = turning[0] * t + rate * t * t / 2
    f = weight.copy()
    if len(base) > 1:
        at = min(int(t / interval), len(base) - 2)
        moved = base[at] + (t / interval - at) * (base[at + 1] - base[at])
        f[:n] -= masses[:n] * moved.real
        f[n:] -= masses[n:] * moved.imag
    for i in range(len(places)):
        pull = unbalance[i] * np.exp(1j * theta) * (omega**2 - 1j * rate)
        f[places[i]] += pull.real
        f[n + places[i]] += pull.imag
    for j in range(len(held)):
        piece = np.searchsorted(speeds[j], omega) - 1
        since = omega - speeds[j, piece] if piece > 0 else 0.0
        k = np.zeros(8)
        for power in range(4):
            k = k * since + cubics[j, piece, power]
        dof, end = held[j]
        x, y, u_x, u_y = _relative(q, v, dof, end)
        f_x = -(k[0] * x + k[1] * y + k[4] * u_x + k[5] * u_y)
        f_y = -(k[2] * x + k[3] * y + k[6] * u_x + k[7] * u_y)
        _push(f, dof, end, f_x, f_y)
    for j in range(len(walls)):
        radius, clearance, mu, stiffness, c, delta_c, v_s = walls[j, :7]
        exponent, mu_rise, v_stribeck, wear, wear_angle, wear_power = walls[j, 7:]
        inertia, drag, viscous, w_s = races[j]
        dof, end = ends[j]
        w = state[4 * n + j]
        torque = 0.0
        d_x, d_y, u_x, u_y = _relative(q, v, dof, end)
        r = math.hypot(d_x, d_y)
        gap, by_angle = clearance, 0.0
        if wear > 0.0:
            half = 0.5 * (math.atan2(d_y, d_x) - wear_angle)
            gap += wear * (math.cos(half) ** 2) ** wear_power
            by_angle = -wear * wear_power * (math.cos(half) ** 2) ** (wear_power - 1)
            by_angle *= math.cos(half) * math.sin(half)
        depth = r - gap
        if depth > 0:
            # gradient of the depth: along the radius 1, across it -s'(psi) / r
            e_x, e_y = d_x / r, d_y / r
            g_x, g_y = e_x + by_angle / r * e_y, e_y - by_angle / r * e_x
            steep = math.hypot(g_x, g_y)
            n_x, n_y = g_x / steep, g_y / steep
            grown = min(1.0, depth / delta_c)
            rate_of_depth = u_x * g_x + u_y * g_y
            pressed = stiffness * depth**exponent + c * grown * rate_of_depth
            normal = steep * max(0.0, pressed)
            sliding = u_y * n_x - u_x * n_y + radius * omega - (radius + clearance) * w
            coefficient = mu + mu_rise * math.exp(-((sliding / v_stribeck) ** 2))
            rubbing = coefficient * normal * sliding / math.hypot(sliding, v_s)
            _push(f, dof, end, -normal * n_x + rubbing * n_y, -normal * n_y - rubbing * n_x)
            torque = (radius + clearance) * rubbing
        if inertia > 0.0:
            torque -= drag * w / math.hypot(w, w_s) + viscous * w
            out[4 * n + j] = torque / inertia
        else:
            out[4 * n + j] = 0.0
    out[: 2 * n] = v
    kappa = turning[2] * omega + turning[3] * np.sign(omega)
    out[2 * n : 4 * n] = inverse @ f - C @ v - omega * (G @ v) - K @ q - 0.5 * rate * (G @ q)
    if kappa != 0.0:
        out[2 * n : 4 * n] -= kappa * (circulatory @ q)


@njit
def _relative(q, v, dof, end):
    n = len(q) // 2
    x, y, u_x, u_y = q[dof], q[n + dof], v[dof], v[n + dof]
    if end >= 0:
        x, y, u_x, u_y = x - q[end], y - q[n + end], u_x - v[end], u_y - v[n + end]
    return x, y, u_x, u_y


@njit
def _push(f, dof, end, f_x, f_y):
    n = len(f) // 2
    f[dof] += f_x
    f[n + dof] += f_y
    if end >= 0:
        f[end] -= f_x
        f[n + end] -= f_y


def solved(
    equations: Equations, q: np.ndarray, v: np.ndarray, times: np.ndarray, rtol: float
) -> np.ndarray:
    """CVODE's states at the times [s] from the complex displacements [m] and velocities [m/s] of
    all dofs and housings; its absolute tolerance is relative to 0.1 mm."""
    n = equations.size
    start = np.concatenate([q.real, q.imag, v.real, v.imag, np.zeros(len(equations.walls))])
    atol = np.repeat([1e-4 * rtol, 1e-1 * rtol, rtol], [2 * n, 2 * n, len(equations.walls)])
    solver = CVODE(equations.slope, rtol=rtol, atol=atol, max_num_steps=10**8)
    return solver.solve(times, start).y
