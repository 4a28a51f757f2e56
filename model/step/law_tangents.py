"""Derivatives of the laws' forces and internal states along a derivative of the machine's motion.

The tangents with respect to displacement and velocity are the laws' own; those with respect to
speed and internal states are central differences.
"""

from typing import NamedTuple

from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..parts.law import Kinematics, Weights
from .laws import kinematics, law_rates, law_tangent_called, relative

# Step of the finite differences, as a share of the size of the law's argument.
_SHARE = 1e-6
_NONE = 1e-3  # share of a law's length below which a state is none: at rest it is rounding


class Change(NamedTuple):
    """A derivative of a law's kinematics: of its displacement, of its velocity, of both the speed
    and the sliding speed, and of the angle; omega: frequency that scales velocities [rad/s]."""

    displacement: complex
    velocity: complex
    speed: float
    angle: float
    omega: float


@jit
def _shift(moving, change, step):
    """Return `Kinematics` displaced by a step along a derivative."""
    faster = step * change.speed
    return Kinematics(
        moving.displacement + step * change.displacement,
        moving.velocity + step * change.velocity,
        moving.speed + faster,
        moving.sliding_speed + faster,
        moving.angle + step * change.angle,
    )


@jit
def _difference_step(interface, moving, change, state, d_state):
    """Return the step of a central difference along a derivative; 0 if the derivative is 0."""
    size = modulus(change.displacement) / interface.length
    size = max(size, modulus(change.velocity) / (interface.length * change.omega))
    size = max(size, abs(change.speed) / max(abs(moving.speed), 1.0))
    for k in range(interface.states):
        is_small = abs(state[k]) < _NONE * interface.length
        scale = interface.length if is_small else abs(state[k])
        size = max(size, abs(d_state[k]) / scale)
    return _SHARE / size if size > 0.0 else 0.0


@jit_not_inlined
def force_by_rest(laws, interface, moving, d_spin, rate, state, d_state, work):
    """Return the derivative of a law's force along the rotation, d_spin, and along its internal
    states; the other arguments as in `states_along`."""
    change = Change(0j, 0j, d_spin[0], d_spin[2], 1.0)
    step = _difference_step(interface, moving, change, state, d_state)
    if step == 0.0:
        return 0.0j
    weights = Weights(1.0, 0.0, rate)
    first = interface.internal_state
    shifted = work.shifted[first:]
    for k in range(interface.states):
        shifted[k] = state[k] + step * d_state[k]
    above, _, _ = law_tangent_called(
        laws, interface, _shift(moving, change, step), weights, shifted, work.above[first:]
    )
    for k in range(interface.states):
        shifted[k] = state[k] - step * d_state[k]
    below, _, _ = law_tangent_called(
        laws, interface, _shift(moving, change, -step), weights, shifted, work.below[first:]
    )
    return (above - below) * (0.5 / step)


@jit_not_inlined
def states_along(laws, interface, moving, change, rate, state, d_state, are_rates, work, out):
    """Fill out with the derivative of the internal states at the end of a step, or of their rates
    if are_rates, along a `Change`; rate: as in `Weights`; state, d_state: the predicted states and
    their derivative."""
    step = _difference_step(interface, moving, change, state, d_state)
    first = interface.internal_state
    shifted = work.shifted[first:]
    for side in range(2):
        signed = step if side == 0 else -step
        for k in range(interface.states):
            shifted[k] = state[k] + signed * d_state[k]
        moved = _shift(moving, change, signed)
        into = work.above[first:] if side == 0 else work.below[first:]
        if are_rates:
            law_rates(laws, interface, moved, shifted, into)
        else:
            law_tangent_called(laws, interface, moved, Weights(1.0, 0.0, rate), shifted, into)
    for k in range(interface.states):
        difference = work.above[first + k] - work.below[first + k]
        out[first + k] = difference * (0.5 / step) if step > 0.0 else 0.0


@jit
def change_of(interface, motion, d_spin, omega):
    """Return the `Change` of an interface along a derivative of the motion and of the rotation;
    omega: see `Change`."""
    d, v = relative(interface, motion.q), relative(interface, motion.v)
    return Change(d, v, d_spin[0], d_spin[2], omega)


@jit
def linearize_laws(structure, spin, rate, motion, free, work):
    """Fill work.by_law at a motion; free: predicted internal states."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        moving = kinematics(interface, spin, motion.q, motion.v)
        first = interface.internal_state
        out = work.above[first:]
        _, p, q = law_tangent_called(
            structure.laws, interface, moving, Weights(1.0, 0.0, rate), free[first:], out
        )
        work.by_law[j, 0], work.by_law[j, 1] = p, q
        _, p, q = law_tangent_called(
            structure.laws, interface, moving, Weights(0.0, 1.0, rate), free[first:], out
        )
        work.by_law[j, 2], work.by_law[j, 3] = p, q
