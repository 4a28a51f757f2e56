"""The machine's equations of motion written anew, for integrators that are not this project's.

Real coordinates, dense matrices (`tests.dense`), the contact law in its own words, and nothing of
the code that steps in time:

    q' = v,    M v' = f(t) + B F(d, d', Omega) - (C + Omega G) v - (K + 1/2 Omega' G) q

with q = (x of rotor and housings, y of rotor and housings) and, at a bearing, d = B^T q the
journal's displacement relative to its housing. Right-hand side and Jacobian are compiled.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.reduction import component_modes, reduced

from papers.dense_machine import clearance_contacts
from tests.dense import dense_matrices

_BEARING = ("journal_radius", "clearance", "k", "c", "delta_c", "mu", "v_s")


class Coefficients(NamedTuple):
    """What the compiled functions take; every matrix is multiplied by M^-1 from the left and, the
    planes being coupled by G alone, cut into blocks of N / 2, stored transposed.

    stiffness, damping: of the x and of the y plane, shape (2, N/2, N/2); gyroscopic: of x by y,
    shape (N/2, N/2), y by x being its negative; weight: shape (N,); unbalance: shape (N, 2), the
    factors of Omega^2 cos theta + Omega' sin theta and of Omega^2 sin theta - Omega' cos theta;
    response: to a force on a journal and its opposite on the housing, shape (bearings, N/2); nodes:
    journal's and housing's place in a plane, shape (bearings, 2); bearing: shape (bearings, 7) of
    `_BEARING`; speed: Omega at t = 0, Omega', theta at t = 0.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    gyroscopic: np.ndarray
    weight: np.ndarray
    unbalance: np.ndarray
    response: np.ndarray
    nodes: np.ndarray
    bearing: np.ndarray
    speed: np.ndarray


@dataclass(frozen=True)
class Equations:
    """A machine whose speed changes linearly: compiled coefficients, mass matrix, shape (N, N), and
    where to find the discs' x in q; their y follow N / 2 later."""

    coefficients: Coefficients
    mass: np.ndarray
    disc_dof: np.ndarray

    @property
    def size(self) -> int:
        """Degrees of freedom N; a state (q, v) has twice as many numbers."""
        return len(self.mass)

    def slope(self, t: float, state: np.ndarray) -> np.ndarray:
        """(q', v') of a state (q, v) at time t [s]."""
        out = np.empty(len(state))
        slope(t, state, out, self.coefficients)
        return out

    def jacobian(self, t: float, state: np.ndarray) -> np.ndarray:
        """d(q', v') / d(q, v), shape (2N, 2N)."""
        out = np.zeros((len(state), len(state)))
        jacobian(t, state, out, self.coefficients)
        return out

    def disc(self, states: np.ndarray, number: int = -1) -> np.ndarray:
        """Orbit x + i y [m] of a disc (from 0; the last) in states of shape (times, 2N)."""
        at = self.disc_dof[number]
        return states[..., at] + 1j * states[..., at + self.size // 2]


def real_state(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(q, v) in real coordinates of a motion's complex displacements and velocities: rotor then
    housings, without ground."""
    q, v = q[:-1], v[:-1]
    return np.concatenate([q.real, q.imag, v.real, v.imag])


def equations(
    rotor: Rotor, speed: float, rate: float, theta: float = 0.0, modes: int = 0
) -> Equations:
    """The equations of a rotor with internal damping at rest, at speed + rate t [rad/s].

    theta: angle of rotation at t = 0 [rad]; modes: component modes of the shaft that are kept, 0:
    all of the shaft. Raises `ValueError` for rotating damping
    and for contacts with ground.
    """
    if rotor.rotating_damping:
        raise ValueError("shaft.rotating_damping = true: these equations do not have it")
    structure = assemble(rotor)
    discs = np.array([2 * (disc.node - 1) for disc in rotor.discs])
    if modes:
        discs = np.searchsorted(component_modes(structure, modes)[0], discs)
        structure = reduced(structure, modes)
    M, C, K, G, _ = dense_matrices(structure)
    size, contacts = len(M), clearance_contacts(structure)
    half, n, nb = size // 2, len(structure.static_load), len(contacts)
    if (contacts.end == half).any():
        raise ValueError("a contact with a stator that does not move: not in these equations")

    weight = np.zeros(size)
    weight[half : half + n] = structure.static_load.imag
    weight[half + n :] = -rotor.gravity * structure.housings.mass
    unbalance = np.zeros((size, 2))
    for dof, u in zip(structure.unbalances.dof, structure.unbalance, strict=True):
        unbalance[dof] += (u.real, -u.imag)
        unbalance[half + dof] += (u.imag, u.real)
    nodes = np.column_stack([contacts.dof, contacts.end]).astype(np.int64)
    push = np.zeros((half, nb))
    push[nodes, np.arange(nb)[:, None]] = (1.0, -1.0)

    def blocks(matrix: np.ndarray) -> np.ndarray:
        x, y = slice(half), slice(half, size)
        return np.stack([solved(matrix[x, x]).T, solved(matrix[y, y]).T])

    def solved(matrix: np.ndarray) -> np.ndarray:
        return np.linalg.solve(M[:half, :half], matrix)

    coefficients = Coefficients(
        stiffness=np.ascontiguousarray(blocks(K)),
        damping=np.ascontiguousarray(blocks(C)),
        gyroscopic=np.ascontiguousarray(solved(G[:half, half:]).T),
        weight=np.linalg.solve(M, weight),
        unbalance=np.linalg.solve(M, unbalance),
        response=np.ascontiguousarray(solved(push).T),
        nodes=nodes,
        bearing=np.array([[c[name] for name in _BEARING] for c in contacts]).reshape(nb, 7),
        speed=np.array([speed, rate, theta]),
    )
    return Equations(coefficients, M, discs)


@numba.njit(cache=True)
def contact(bearing, x, y, x_dot, y_dot, omega, tangent):
    """Force (F_x, F_y) [N] on a journal at (x, y) [m] with velocity (x_dot, y_dot) [m/s].

    tangent, shape (2, 4), is filled with dF/d(x, y, x_dot, y_dot). n presses the journal away from
    the wall, friction mu n s brakes it, s = v_t / sqrt(v_t^2 + v_s^2).
    """
    radius, clearance, k, c, delta_c, mu, v_s = bearing
    tangent[:] = 0.0
    r = math.hypot(x, y)
    depth = r - clearance
    if depth <= 0.0:
        return 0.0, 0.0
    ex, ey = x / r, y / r
    share = min(1.0, depth / delta_c)
    depth_rate = x_dot * ex + y_dot * ey
    n = k * depth + c * share * depth_rate
    if n <= 0.0:
        return 0.0, 0.0
    across = y_dot * ex - x_dot * ey
    v_t = across + radius * omega
    root = math.hypot(v_t, v_s)
    s = v_t / root
    # gradients with respect to (x, y, x_dot, y_dot); a turn of e is (-ey, ex) / r per metre across
    stiffness = k + (c * depth_rate / delta_c if depth < delta_c else 0.0)
    damping = c * share
    slope = mu * v_s * v_s / root**3
    for i in range(4):
        radial = (ex, ey, 0.0, 0.0)[i]
        turn = (-ey / r, ex / r, 0.0, 0.0)[i]
        rate = turn * across + (0.0, 0.0, ex, ey)[i]
        d_n = stiffness * radial + damping * rate
        d_v_t = -turn * depth_rate + (0.0, 0.0, -ey, ex)[i]
        d_f = mu * s * d_n + n * slope * d_v_t
        # F = -n e - mu n s t with e' = turn t, t' = -turn e
        along = -d_n + mu * n * s * turn
        aside = -d_f - n * turn
        tangent[0, i] = along * ex - aside * ey
        tangent[1, i] = along * ey + aside * ex
    f = mu * n * s
    return -n * ex + f * ey, -n * ey - f * ex


@numba.njit(cache=True)
def slope(t, state, out, coefficients):
    """Fill out with (q', v') at time t [s]."""
    stiffness, damping, gyroscopic, weight, unbalance, response, nodes, bearing, speed = (
        coefficients
    )
    size = len(weight)
    half = size // 2
    rate = speed[1]
    omega = speed[0] + rate * t
    theta = speed[2] + (speed[0] + 0.5 * rate * t) * t
    cos, sin = math.cos(theta), math.sin(theta)
    along = omega * omega * cos + rate * sin
    across = omega * omega * sin - rate * cos
    for i in range(size):
        out[i] = state[size + i]
        out[size + i] = weight[i] + unbalance[i, 0] * along + unbalance[i, 1] * across
    for plane in range(2):
        start, other = plane * half, (1 - plane) * half
        sign = 1.0 - 2.0 * plane
        force = out[size + start : size + start + half]
        for j in range(half):
            q, v = state[start + j], state[size + start + j]
            turned = sign * (omega * state[size + other + j] + 0.5 * rate * state[other + j])
            of_q, of_v, of_turn = stiffness[plane, j], damping[plane, j], gyroscopic[j]
            for i in range(half):
                force[i] -= of_q[i] * q + of_v[i] * v + of_turn[i] * turned
    tangent = np.empty((2, 4))
    for b in range(len(bearing)):
        journal, housing = nodes[b]
        x, y, x_dot, y_dot = relative_motion(state, journal, housing)
        f_x, f_y = contact(bearing[b], x, y, x_dot, y_dot, omega, tangent)
        if f_x != 0.0 or f_y != 0.0:
            for i in range(half):
                out[size + i] += response[b, i] * f_x
                out[size + half + i] += response[b, i] * f_y


@numba.njit(cache=True)
def relative_motion(state, journal, housing):
    """(x, y, x', y') of a journal relative to its housing."""
    size = len(state) // 2
    half = size // 2
    return (
        state[journal] - state[housing],
        state[half + journal] - state[half + housing],
        state[size + journal] - state[size + housing],
        state[size + half + journal] - state[size + half + housing],
    )


@numba.njit(cache=True)
def jacobian(t, state, out, coefficients):
    """Fill out, shape (2N, 2N), with d(q', v') / d(q, v) at time t [s]."""
    stiffness, damping, gyroscopic, weight, _, response, nodes, bearing, speed = coefficients
    size = len(weight)
    half = size // 2
    omega = speed[0] + speed[1] * t
    out[:] = 0.0
    for i in range(size):
        out[i, size + i] = 1.0
    for plane in range(2):
        start, other = plane * half, (1 - plane) * half
        sign = 1.0 - 2.0 * plane
        for i in range(half):
            row = out[size + start + i]
            for j in range(half):
                turn = sign * gyroscopic[j, i]
                row[start + j] = -stiffness[plane, j, i]
                row[size + start + j] = -damping[plane, j, i]
                row[other + j] = -0.5 * speed[1] * turn
                row[size + other + j] = -omega * turn
    tangent = np.empty((2, 4))
    for b in range(len(bearing)):
        journal, housing = nodes[b]
        x, y, x_dot, y_dot = relative_motion(state, journal, housing)
        f_x, f_y = contact(bearing[b], x, y, x_dot, y_dot, omega, tangent)
        if f_x == 0.0 and f_y == 0.0:
            continue
        for variable in range(4):
            first = variable * half
            for i in range(half):
                for plane in range(2):
                    change = response[b, i] * tangent[plane, variable]
                    out[size + plane * half + i, first + journal] += change
                    out[size + plane * half + i, first + housing] -= change
