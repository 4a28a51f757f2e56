"""What follows from the numbers that a user may change once a machine is assembled: damping,
stiffness, weight, unbalance, inertia, the lengths that matter. Compiled, on the structure alone."""

from __future__ import annotations

import math

import numpy as np

from ..kernels.functions import direction
from ..kernels.jit import interpreted, jit
from ..parts import LAWS
from ..parts.law import dispatcher
from .structure import Structure

WEIGHT = 9.81  # m/s2; whether gravity or a base that is accelerated gives it

_length_of = dispatcher([law.length for law in LAWS], takes_tables=False)
_weigh = dispatcher([law.weigh for law in LAWS])


@jit
def prepare(structure):
    """Fill in all of a structure that depends on parameters."""
    numbers = structure.numbers[0]
    _prepare_shaft(structure, numbers)
    inertia = numbers.own_inertia
    for i in range(len(structure.unbalances)):
        u = structure.unbalances[i]
        structure.unbalance[i] = u.mass * u.e * direction(u.phase)
        inertia += u.spinning_mass * u.e * u.e
    numbers.inertia = inertia
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
    if numbers.is_held == 0 and smallest < math.inf:
        # nothing but its weight brings it back: it swings in its clearance as a pendulum does
        numbers.slowest = min(numbers.slowest, math.sqrt(WEIGHT / smallest))
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].length == 0.0:
            structure.interfaces[j].length = numbers.clearance


def lengths_of(structure: Structure) -> np.ndarray:
    """Return the length of its own that each interface's law has [m], 0 of those without."""
    length = interpreted(_length_of)
    return np.array([length(structure.laws, i) for i in structure.interfaces], dtype=float)


@jit
def elastic_share(eta_h):
    """What hysteretic damping makes of the shaft's stiffness (Zorzi and Nelson 1977) [1]."""
    return (1.0 + eta_h) / math.sqrt(1.0 + eta_h * eta_h)


@jit
def _prepare_shaft(structure, numbers):
    """Damping, stiffness and weight."""
    share = elastic_share(numbers.eta_h)
    n, width = structure.M.shape
    for i in range(n):
        for d in range(width):
            structure.C[i, d] = numbers.eta_v * structure.K_shaft[i, d]
            structure.K[i, d] = share * structure.K_shaft[i, d] + structure.K_axial[i, d]
        structure.weight[i] = (
            numbers.gravity * structure.mass_sum[i] * complex(numbers.down_x, numbers.down_y)
        )
    for i in range(len(structure.springs)):
        spring = structure.springs[i]
        structure.K[spring.dof, 0] += spring.stiffness
        structure.C[spring.dof, 0] += spring.damping
    numbers.kappa_v = numbers.eta_v if numbers.rotating_damping == 1 else 0.0
    hysteresis = math.sqrt(1.0 + numbers.eta_h * numbers.eta_h)
    numbers.kappa_h = numbers.eta_h / hysteresis if numbers.rotating_damping == 1 else 0.0
