"""Simulations that begin where they are put: in a cycle of the false state, or before an impact."""

import math

import numpy as np
from rotor_fmu.model.simulation import Simulation

from .cycles import Cycle
from .one_axis import X, Y, axis_of


def put(simulation: Simulation, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> None:
    """Put a simulation into a state; complex displacements [m], velocities [m/s] and the
    accelerations that generalized-alpha carries along [m/s2], shape (n + housings + 1,)."""
    motion = simulation.motion
    motion.q[:], motion.v[:] = q, v
    motion.a[:] = motion.v_dot[:] = 0.0
    # no time: forces and accelerations of the equation of motion follow
    drive = simulation.read("tau" if simulation.is_free else "w")
    simulation.advance(simulation.time, drive)
    motion.a[:] = a


def plant(simulation: Simulation, contact: int, direction: int, cycle: Cycle) -> None:
    """Put a simulation at rest into a cycle of the false state, at its first letter.

    The static load at right angles turns and shortens the chord on which the journal bounces.
    """
    axes = [axis_of(simulation.rotor, contact, d) for d in (X, Y)]
    axis, other = axes[direction], axes[1 - direction]
    tilt = cycle.tilt(axis.across)
    unit = (1.0, 1j)[direction]
    motion = simulation.motion
    # ground does not move
    q, v, a = (
        array + unit * math.cos(tilt) * np.append(change, 0.0)
        for array, change in zip((motion.q, motion.v, motion.a), cycle.state, strict=True)
    )
    if direction == X:
        lift = math.copysign(axis.clearance * math.sin(tilt), axis.across) - other.rest
        q += 1j * lift * np.append(other.static[0], 0.0)
    put(simulation, q, v, a)
