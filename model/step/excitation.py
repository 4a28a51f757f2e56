"""Excitation of the rotor: spin, unbalance, static and external loads, and the torque that the
drive must supply."""

from typing import NamedTuple

from ..kernels.band import form, square
from ..kernels.functions import direction
from ..kernels.jit import jit
from ..structure.parameters import add_force


class Spin(NamedTuple):
    """Rotation at one instant: speed omega [rad/s], its rate alpha [rad/s2], angle theta [rad],
    direction exp(i theta) [1], and the speed at which surfaces slide on each other [rad/s]."""

    omega: float
    alpha: float
    theta: float
    direction: complex
    sliding: float


@jit
def spin_of(omega, alpha, theta):
    """Return the `Spin` of a speed [rad/s], its rate [rad/s2] and an angle [rad]."""
    return Spin(omega, alpha, theta, direction(theta), omega)


@jit
def static_spin(omega):
    """Return the `Spin` for the equilibrium at a speed [rad/s]: no unbalance, no friction."""
    return Spin(omega, 0.0, 0.0, 0.0j, 0.0)


@jit
def circulation(structure, omega):
    """Return kappa [1] of the circulatory term -i kappa K_shaft (Zorzi and Nelson 1977): its
    hysteresis is that of whirls slower than the rotation, see `linear.system_at_speed`."""
    numbers = structure.numbers[0]
    kappa = numbers.kappa_v * omega
    if omega > 0.0:
        kappa += numbers.kappa_h
    elif omega < 0.0:
        kappa -= numbers.kappa_h
    return kappa


@jit
def free_fall_acceleration(structure, loads):
    """Return the acceleration of a free body relative to the base [m/s2]: gravity less the base's
    acceleration, which is among the loads."""
    numbers = structure.numbers[0]
    g = numbers.gravity * complex(numbers.down_x, numbers.down_y)
    return g - loads[numbers.base_load] if numbers.base_load >= 0 else g


@jit
def at_place(place, z):
    """Return the value of z, shape (n,) or longer, at an unbalance or a probe on the shaft."""
    value = z[place.dof]
    if place.offset != 0.0:
        value += place.offset * z[place.slope]
    return value


@jit
def at_load(structure, i, z):
    """Return the value of z, shape (n,) or longer, at a load on the shaft."""
    value = z[structure.load_dof[i]]
    arm = structure.load_arms[i]
    if arm.offset != 0.0:
        value += arm.offset * z[arm.slope]
    return value


@jit
def add_applied(structure, spin, loads, f):
    """Add to f, shape (n,) [N, N.m], the static load, unbalance and external loads; loads:
    complex, shape (bodies,) [N]. Unbalance: m e exp(i (theta + phi)) (Omega^2 - i Omega')."""
    for i in range(len(structure.static_load)):
        f[i] += structure.static_load[i]
    turning = spin.direction * complex(spin.omega * spin.omega, -spin.alpha)
    for i in range(len(structure.unbalance)):
        add_force(structure.unbalances[i], structure.unbalance[i] * turning, f)
    for i in range(len(loads)):
        add_load(structure, i, loads[i], f)


@jit
def add_load(structure, i, load, f):
    """Add one external load to f, shape (n,) [N, N.m]."""
    if structure.load_dof[i] >= 0:
        f[structure.load_dof[i]] += load
        arm = structure.load_arms[i]
        if arm.offset != 0.0:
            f[arm.slope] += arm.offset * load
    else:
        for j in range(len(structure.static_load)):
            f[j] -= structure.mass_sum[j] * load


@jit
def internal_torque(structure, q, v, omega):
    """Return the torque by which the drive sustains the rotating internal damping [N.m], 0 if it
    does not rotate. With f = -eta K_s v + i kappa K_s q it is Re(f^H i q)."""
    kappa = circulation(structure, omega)
    eta_v = structure.numbers[0].kappa_v
    if kappa == 0.0 and eta_v == 0.0:
        return 0.0
    n = len(structure.static_load)
    by_velocity = form(structure.K_shaft, v[:n], q[:n]).imag
    by_displacement = square(structure.K_shaft, q[:n])
    return eta_v * by_velocity + kappa * by_displacement


@jit
def drive_torque(structure, loads, q, v, a, spin, friction_torque):
    """Return the torque that the drive must supply to keep the prescribed speed [N.m].

    q, v, a: shape (n,) or longer; friction_torque: braking torque of the interfaces [N.m]. It
    follows from Lagrange's equation of the angle of rotation, including the gyroscopic reaction,
    which is of second order in the slopes.
    """
    n = len(structure.static_load)
    torque = structure.numbers[0].inertia * spin.alpha + friction_torque
    g = free_fall_acceleration(structure, loads)
    for i in range(len(structure.unbalance)):
        arm = structure.unbalance[i] * spin.direction
        torque += (arm.conjugate() * at_place(structure.unbalances[i], a)).imag
        torque += (g.conjugate() * arm).imag
    torque -= 0.5 * form(structure.G, q[:n], a[:n]).imag
    return torque + internal_torque(structure, q, v, spin.omega)
