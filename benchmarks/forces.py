"""What acts on the machine beside M, C and K, for programs that want matrices and a force."""

import math
from typing import NamedTuple

import numba
import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.structure.assembly import assemble

from papers.dense_machine import rest
from tests.dense import dense_matrices

from .equations import contact, equations


class Forces(NamedTuple):
    """Of the compiled functions below: half of G that couples x to y, shape (N/2, N/2); weight,
    shape (N,); unbalance, shape (N, 2); journals' and housings' places, shape (bearings, 2);
    bearings' quantities, shape (bearings, 7); Omega at t = 0, Omega', theta at t = 0."""

    gyroscopic: np.ndarray
    weight: np.ndarray
    unbalance: np.ndarray
    nodes: np.ndarray
    bearing: np.ndarray
    speed: np.ndarray


class Machine(NamedTuple):
    """M, C, K (transient stiffness of the gyroscopic terms included) and G, each (N, N); forces;
    displacements at rest, shape (N,) [m]; place of the last disc's x in q."""

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    G: np.ndarray
    forces: Forces
    rest: np.ndarray
    disc: int


def machine(rotor: Rotor, speed: float, rate: float) -> Machine:
    """A rotor at speed + rate t [rad/s], rate in [rad/s2]."""
    structure = assemble(rotor)
    M, C, K, G, _ = dense_matrices(structure)
    half = len(M) // 2
    written = equations(rotor, speed, rate)
    c = written.coefficients
    forces = Forces(
        np.ascontiguousarray(G[:half, half:]),
        M @ c.weight,
        M @ c.unbalance,
        c.nodes,
        c.bearing,
        c.speed,
    )
    still = rest(rotor)[:-1]  # without ground
    at_rest = np.concatenate([still.real, still.imag])
    disc = int(written.disc_dof[-1])
    return Machine(M, C, K + 0.5 * rate * G, G, forces, at_rest, disc)


@numba.njit(cache=True)
def relative(q, v, journal, housing):
    """(x, y, x', y') of a journal relative to its housing."""
    half = len(q) // 2
    return (
        q[journal] - q[housing],
        q[half + journal] - q[half + housing],
        v[journal] - v[housing],
        v[half + journal] - v[half + housing],
    )


@numba.njit(cache=True)
def fill_force(t, q, v, forces, out):
    """Fill out, shape (N,), with weight, unbalance and contact forces at time t [s]."""
    _, weight, unbalance, nodes, bearing, speed = forces
    half = len(q) // 2
    omega = speed[0] + speed[1] * t
    theta = speed[2] + (speed[0] + 0.5 * speed[1] * t) * t
    cos, sin = math.cos(theta), math.sin(theta)
    along = omega * omega * cos + speed[1] * sin
    across = omega * omega * sin - speed[1] * cos
    for i in range(2 * half):
        out[i] = weight[i] + unbalance[i, 0] * along + unbalance[i, 1] * across
    tangent = np.empty((2, 4))
    for b in range(len(bearing)):
        journal, housing = nodes[b]
        x, y, x_dot, y_dot = relative(q, v, journal, housing)
        f_x, f_y = contact(bearing[b], x, y, x_dot, y_dot, omega, tangent)
        out[journal] += f_x
        out[housing] -= f_x
        out[half + journal] += f_y
        out[half + housing] -= f_y


@numba.njit(cache=True)
def add_gyroscopic(t, v, forces, out):
    """out -= Omega G v."""
    gyroscopic, speed = forces[0], forces[5]
    half = len(v) // 2
    omega = speed[0] + speed[1] * t
    for i in range(half):
        of_x = of_y = 0.0
        for j in range(half):
            of_x += gyroscopic[i, j] * v[j]
            of_y += gyroscopic[i, j] * v[half + j]
        out[i] -= omega * of_y
        out[half + i] += omega * of_x


@numba.njit(cache=True)
def fill_jacobian(t, q, v, of_q, of_v, forces, out):
    """Fill out, shape (N, N), with -(of_q d/dq + of_v d/dv) of `fill_force` - Omega G v."""
    gyroscopic, _, _, nodes, bearing, speed = forces
    half = len(q) // 2
    omega = speed[0] + speed[1] * t
    out[:] = 0.0
    for i in range(half):
        for j in range(half):
            out[i, half + j] = of_v * omega * gyroscopic[i, j]
            out[half + i, j] = -of_v * omega * gyroscopic[i, j]
    tangent = np.empty((2, 4))
    for b in range(len(bearing)):
        journal, housing = nodes[b]
        x, y, x_dot, y_dot = relative(q, v, journal, housing)
        contact(bearing[b], x, y, x_dot, y_dot, omega, tangent)
        for i in range(2):
            for j in range(2):
                change = -(of_q * tangent[i, j] + of_v * tangent[i, 2 + j])
                row, column = i * half, j * half
                out[row + journal, column + journal] += change
                out[row + housing, column + housing] += change
                out[row + journal, column + housing] -= change
                out[row + housing, column + journal] -= change
