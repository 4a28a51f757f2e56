"""Values that follow from the parameters of an assembled machine: damping, stiffness, static load,
unbalance, bow, inertia, characteristic lengths. Compiled, a function of the structure alone."""

import math

import numpy as np

from ..kernels.functions import direction
from ..kernels.jit import jit, jit_not_inlined
from ..kernels.kernel import interpreted
from ..parts import LAWS
from ..parts.law import dispatcher
from ..quantities import GRAVITY
from .structure import Structure

_length_of = dispatcher([law.length for law in LAWS], takes_tables=False)
_LEAST_OVER_COUPLED = 4.0  # with less than twice, the iterations of the speed do not converge
_weigh = dispatcher([law.weigh for law in LAWS])


@jit_not_inlined
def prepare(structure):
    """Fill in everything in a structure that depends on parameters."""
    numbers = structure.numbers[0]
    _prepare_shaft(structure, numbers)
    inertia = numbers.own_inertia
    for i in range(len(structure.unbalances)):
        u = structure.unbalances[i]
        structure.unbalance[i] = u.mass * u.e * direction(u.phase)
        inertia += u.spinning_mass * u.e * u.e
    numbers.inertia = inertia
    for k in range(len(structure.bows)):
        structure.bow[k] = structure.bows[k].amplitude * direction(structure.bows[k].phase)
    smallest = math.inf
    gravity = numbers.gravity * complex(numbers.down_x, numbers.down_y)
    for j in range(len(structure.interfaces)):
        _weigh(structure.laws, structure.interfaces[j], gravity)
        length = _length_of(structure.laws, structure.interfaces[j])
        structure.interfaces[j].length = length
        if length > 0.0:
            smallest = min(smallest, length)
    numbers.clearance = smallest if smallest < math.inf else numbers.small
    numbers.slowest = numbers.lowest_omega
    if numbers.is_supported == 0 and smallest < math.inf:
        # nothing but its weight brings it back: it swings in its clearance as a pendulum does
        numbers.slowest = min(numbers.slowest, math.sqrt(GRAVITY / smallest))
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].length == 0.0:
            structure.interfaces[j].length = numbers.clearance


@jit
def least_inertia(structure):
    """Return the moment of inertia about the axis [kg.m2] that a rotor needs for a torque to drive
    it: with U^2/m of its unbalances alone, their reaction would be all that a torque turns."""
    coupled = 0.0
    for i in range(len(structure.unbalances)):
        u = structure.unbalances[i]
        coupled += (u.mass * u.e) ** 2 / structure.M[u.dof, 0]
    return _LEAST_OVER_COUPLED * coupled


def lengths_of(structure: Structure) -> np.ndarray:
    """Return the length of each interface's law [m], 0 for a law without one."""
    length = interpreted(_length_of)
    return np.array([length(structure.laws, i) for i in structure.interfaces], dtype=float)


@jit
def elastic_share(eta_h):
    """Return the factor by which hysteretic damping scales the shaft stiffness (Zorzi and Nelson
    1977) [1]."""
    return (1.0 + eta_h) / math.sqrt(1.0 + eta_h * eta_h)


@jit
def add_force(place, force, f):
    """Add to f, shape (n,) [N, N.m], a force [N] at an unbalance or a constant force's place."""
    f[place.dof] += force
    if place.offset != 0.0:
        f[place.slope] += place.offset * force


@jit
def _prepare_shaft(structure, numbers):
    """Fill in damping, stiffness and static load."""
    share = elastic_share(numbers.eta_h)
    eta_v, mass_damping = numbers.eta_v, numbers.mass_damping
    gravity, down = numbers.gravity, complex(numbers.down_x, numbers.down_y)
    n, width = structure.M.shape
    for i in range(n):
        for d in range(width):
            structure.C[i, d] = (
                eta_v * structure.K_shaft[i, d] + mass_damping * structure.M_shaft[i, d]
            )
            structure.K[i, d] = share * structure.K_shaft[i, d] + structure.K_axial[i, d]
        structure.static_load[i] = gravity * structure.mass_sum[i] * down
    for i in range(len(structure.forces)):
        force = structure.forces[i]
        add_force(force, complex(force.fx, force.fy), structure.static_load)
    for i in range(len(structure.springs)):
        spring = structure.springs[i]
        structure.K[spring.dof, 0] += spring.stiffness
        structure.C[spring.dof, 0] += spring.damping
    numbers.kappa_v = numbers.eta_v if numbers.rotating_damping == 1 else 0.0
    hysteresis = math.sqrt(1.0 + numbers.eta_h * numbers.eta_h)
    numbers.kappa_h = numbers.eta_h / hysteresis if numbers.rotating_damping == 1 else 0.0
