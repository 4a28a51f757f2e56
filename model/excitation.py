"""What acts on the rotor from outside: spin, unbalance, gravity, external loads, and what the drive
must supply for it."""

from __future__ import annotations

import cmath
from typing import NamedTuple

from .band import add_product
from .compiled import compiled


class Spin(NamedTuple):
    """Rotation at one instant: speed omega [rad/s], its rate alpha [rad/s2], angle theta [rad]."""

    omega: float
    alpha: float
    theta: float


@compiled
def circulation(structure, omega):
    """kappa [1] of the circulatory term -i kappa K_shaft (Zorzi and Nelson 1977)."""
    kappa = structure.eta_v * omega
    if omega > 0.0:
        kappa += structure.eta_h
    elif omega < 0.0:
        kappa -= structure.eta_h
    return kappa


@compiled
def add_applied(structure, spin, loads, f):
    """f += gravity, unbalance and external loads, shape (n,) [N, N.m]; loads: complex, shape
    (bodies,) [N]. Unbalance: m e exp(i (theta + phi)) (Omega^2 - i Omega')."""
    for i in range(len(structure.weight)):
        f[i] += structure.weight[i]
    turning = cmath.exp(1j * spin.theta) * complex(spin.omega * spin.omega, -spin.alpha)
    for i in range(len(structure.unbalance)):
        f[structure.unbalance_dof[i]] += structure.unbalance[i] * turning
    for i in range(len(loads)):
        f[structure.load_dof[i]] += loads[i]


@compiled
def internal_torque(structure, q, v, omega, scratch):
    """Torque by which the drive sustains the rotating internal damping [N.m]; 0 if it does not
    rotate. With f = -eta K_s v + i kappa K_s q it is Re(conj(f) i q)."""
    kappa = circulation(structure, omega)
    if kappa == 0.0 and structure.eta_v == 0.0:
        return 0.0
    n = structure.M.shape[1]
    for i in range(n):
        scratch[i] = 0.0
    add_product(-structure.eta_v, structure.K_shaft, v, scratch)
    add_product(1j * kappa, structure.K_shaft, q, scratch)
    torque = 0.0
    for i in range(n):
        torque += (scratch[i].conjugate() * 1j * q[i]).real
    return torque


@compiled
def drive_torque(structure, q, v, a, spin, friction_torque, scratch):
    """Torque that the drive must supply to keep the prescribed speed [N.m].

    q, v, a: shape (n,); friction_torque: sum of R F_t over the bearings [N.m]. From Lagrange's
    equation of the angle of rotation, gyroscopic reaction (second order in the slopes) included.
    """
    n = structure.M.shape[1]
    torque = structure.inertia * spin.alpha + friction_torque
    turning = cmath.exp(1j * spin.theta)
    for i in range(len(structure.unbalance)):
        arm = structure.unbalance[i] * turning
        torque += (arm.conjugate() * a[structure.unbalance_dof[i]]).imag
        torque += structure.gravity * arm.real
    for i in range(n):
        scratch[i] = 0.0
    add_product(1.0, structure.G, a, scratch)
    for i in range(n):
        torque -= 0.5 * (q[i].conjugate() * scratch[i]).imag
    return torque + internal_torque(structure, q, v, spin.omega, scratch)
