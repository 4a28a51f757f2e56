"""A journal that touches its pads: where the film is thinner than the surfaces' roughness, they
touch, pad by pad, by the law of `wall` with the friction of `rubbing`."""

from typing import NamedTuple

from ..contact.rubbing import Friction, contact_tangent, friction
from ..contact.wall import Touch, elastic, pressed
from ..kernels.jit import jit, jit_not_inlined
from .bearing_film import pad_count, pad_of, thinnest


@jit
def touch(bearing, pad):
    """Return the `Touch` of a journal with a pad; all but the penetration is 0 without one."""
    gap, along, curvature = thinnest(pad)
    delta = bearing.roughness - gap
    if delta <= 0.0 or bearing.k == 0.0:
        return Touch(-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0j, 0.0j, 0.0j, 0.0, 0.0)
    velocity = along.conjugate() * pad.velocity
    n, n_k, stiffness, damping = pressed(bearing, delta, velocity.real)
    return Touch(
        *(delta, velocity.real, n, n_k, stiffness, damping),
        *(along, velocity, 1.0 + 0.0j, 0.0, curvature),
    )


@jit
def sliding_of(bearing, pad, at, kinematics):
    """Return the velocity at which a journal slides on a pad that it touches [m/s]: the surface of
    a tilting pad moves too."""
    return at.velocity.imag + bearing.journal_radius * kinematics.sliding_speed - pad.turning


class WallState(NamedTuple):
    """Rubbing of a journal on its pads: force [N], normal force and friction, which brakes it, of
    all pads [N], and the powers of the contact's damping and of friction [W]."""

    force: complex
    normal: float
    friction: float
    damped: float
    rubbed: float


@jit_not_inlined
def wall_state(bearing, tables, kinematics):
    """Return the `WallState` of a bearing."""
    force, normal, braking, damped, rubbed = 0.0j, 0.0, 0.0, 0.0, 0.0
    for i in range(pad_count(bearing, tables)):
        pad, _ = pad_of(bearing, tables, kinematics, i)
        at = touch(bearing, pad)
        if at.penetration <= 0.0:
            continue
        sliding = sliding_of(bearing, pad, at, kinematics)
        rubs = friction(bearing, sliding)[0] * at.normal
        force -= complex(at.normal, rubs) * at.direction
        normal += at.normal
        braking += rubs
        damped += (at.normal - at.elastic) * at.rate
        rubbed += rubs * sliding
    return WallState(force, normal, braking, damped, rubbed)


@jit_not_inlined
def wall_tangent(bearing, tables, kinematics, weights):
    """Return the force of the wall on the journal [N] and its tangent p, q; see `parts.law`."""
    force = p = q = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad, _ = pad_of(bearing, tables, kinematics, i)
        at = touch(bearing, pad)
        if at.penetration <= 0.0 or at.normal <= 0.0:
            continue
        sliding = sliding_of(bearing, pad, at, kinematics)
        mu, slope = friction(bearing, sliding)
        force -= complex(at.normal, mu * at.normal) * at.direction
        p_pad, q_pad = contact_tangent(at, Friction(mu, slope, mu, 0.0), 1.0, weights)
        p += p_pad
        q += q_pad
    return force, p, q


@jit_not_inlined
def wall_energy(bearing, tables, kinematics):
    """Return the elastic energy of the contacts [J]."""
    energy = 0.0
    for i in range(pad_count(bearing, tables)):
        pad, _ = pad_of(bearing, tables, kinematics, i)
        delta = bearing.roughness - thinnest(pad)[0]
        if delta > 0.0 and bearing.k > 0.0:
            energy += elastic(bearing, delta)[0] * delta / (bearing.exponent + 1.0)
    return energy


@jit_not_inlined
def breaks(bearing, tables, kinematics):
    """Return whether a journal without contact stiffness is where its surfaces would touch."""
    if bearing.k > 0.0:
        return False
    for i in range(pad_count(bearing, tables)):
        if thinnest(pad_of(bearing, tables, kinematics, i)[0])[0] < bearing.roughness:
            return True
    return False
