"""A journal that rubs: friction, and the force of a contact with its tangent.

    v_t = Im(conj(e) d') + R spin;    mu_t = mu(v_t) v_t / sqrt(v_t^2 + v_s^2)
    force on the journal  F = -(1 + i mu_t) n e;    the housing gets -F

with Stribeck's friction, mu(v) = mu + mu_rise exp(-(v / v_stribeck)^2). In a worn housing g stands
for e (`wall`).

Smoothed like that nothing sticks: under a side load a journal creeps at a share of v_s. With a
tangential stiffness k_t it does: a spring of elongation z, with a damper c_t, holds the journal
within the cone of friction (Kelvin and Voigt's element in series with Coulomb's),

    f = k_t z + c_t z',    z' = v_t where |f| <= mu(v_t) n, else such that f = +- mu(v_t) n

and friction is f along -i e; mu_t is f / n. Over a step z = free + b z' (`parts.law`), so that
its value without sliding is known, and is mapped back onto the cone where it lies outside.
"""

import math
from typing import NamedTuple

from ..kernels.functions import exponential, modulus, scaled
from ..kernels.jit import jit, jit_not_inlined
from .wall import touch


@jit
def friction(part, v_t):
    """Return mu_t, the signed coefficient of friction at a sliding speed [m/s], and its
    derivative."""
    root = math.sqrt(v_t * v_t + part.v_s * part.v_s)
    s_t = v_t / root
    mu = part.mu
    by_v = part.v_s * part.v_s / (root * root * root)
    if part.mu_rise == 0.0:
        return mu * s_t, mu * by_v
    x = v_t / part.v_stribeck
    rise = part.mu_rise * exponential(-x * x)
    mu += rise
    return mu * s_t, mu * by_v - 2.0 * x / part.v_stribeck * rise * s_t


@jit
def _largest_friction(part, v_t):
    """Return mu(v_t) and its derivative."""
    if part.mu_rise == 0.0:
        return part.mu, 0.0
    x = v_t / part.v_stribeck
    rise = part.mu_rise * exponential(-x * x)
    return part.mu + rise, -2.0 * x / part.v_stribeck * rise


class Friction(NamedTuple):
    """Friction at a wall: its coefficient mu_t [1], signed, with its derivative by the sliding
    speed [s/m]; the derivative of the friction force by the normal force [1]; the elongation z of
    the tangential spring [m]."""

    coefficient: float
    by_sliding: float
    by_normal: float
    elongation: float


@jit
def rub(part, n, v_t, b, free):
    """Return the `Friction` under a normal force n [N] at a sliding speed [m/s], z = free + b z'; b
    = 0 at an instant."""
    if part.k_t == 0.0:
        mu_t, slope = friction(part, v_t)
        return Friction(mu_t, slope, mu_t, free)
    stiffness = part.k_t * b + part.c_t
    if n <= 0.0:
        return Friction(0.0, 0.0, 0.0, part.c_t * free / stiffness)
    stuck = part.k_t * free + stiffness * v_t
    mu, falls = _largest_friction(part, v_t)
    if abs(stuck) <= mu * n:
        return Friction(stuck / n, stiffness / n, 0.0, free + b * v_t)
    sense = 1.0 if stuck > 0.0 else -1.0
    slid = (sense * mu * n * b + part.c_t * free) / stiffness
    return Friction(sense * mu, sense * falls, sense * mu, slid)


@jit
def stretching(part, rubbing, z):
    """Return z' [m/s] of a contact that sticks, at a friction force [N]; 0 without a spring."""
    return (rubbing - part.k_t * z) / part.c_t if part.k_t > 0.0 else 0.0


@jit
def stretched(part, z):
    """Return the elastic energy of the tangential spring [J]."""
    return 0.5 * part.k_t * z * z


@jit
def outward(gradient):
    """Return the slope of the clearance at the contact [1], and its unit normal in e's frame."""
    if gradient.imag == 0.0:  # round
        return 1.0, complex(1.0, 0.0)
    steep = modulus(gradient)
    return steep, gradient * (1.0 / steep)


class Rubbing(NamedTuple):
    """A contact at an instant: complex force on the journal [N]; its normal force and friction
    force [N]; the damping's share in n [N]; penetration [m], its rate and the sliding speed
    [m/s]."""

    force: complex
    normal: float
    friction: float
    damping: float
    penetration: float
    rate: float
    sliding: float


@jit
def rubbing(part, kinematics, surface, z):
    """Return the `Rubbing` on a surface past which the journal's own moves with the speed `surface`
    [m/s] if its centre rests; z: elongation of the tangential spring [m]."""
    at = touch(part, kinematics)
    if at.penetration <= 0.0:
        return Rubbing(0.0j, 0.0, 0.0, 0.0, at.penetration, 0.0, 0.0)
    steep, normal = outward(at.gradient)
    v_t = (normal.conjugate() * at.velocity).imag + surface
    if at.normal <= 0.0:
        return Rubbing(0.0j, 0.0, 0.0, -at.elastic, at.penetration, at.rate, v_t)
    pressure = at.normal * steep
    braking = rub(part, pressure, v_t, 0.0, z).coefficient * pressure
    force = -complex(pressure, braking) * normal * at.direction
    damping = at.normal - at.elastic
    return Rubbing(force, pressure, braking, damping, at.penetration, at.rate, v_t)


@jit_not_inlined
def _column(at, rubs, friction_share, z, z_v):
    """Return dF in the frame along e by a displacement z and a velocity z_v; see
    `contact_tangent`."""
    steep, normal = outward(at.gradient)
    d_gradient = complex(at.skew * z.imag, at.skew * z.real + at.curvature * z.imag)
    d_rate = (d_gradient.conjugate() * at.velocity + at.gradient.conjugate() * z_v).real
    d_n = at.stiffness * (at.gradient.conjugate() * z).real + at.damping * d_rate
    d_steep = (normal.conjugate() * d_gradient).real
    d_normal = (d_gradient - normal * d_steep) * (1.0 / steep)
    d_sliding = (d_normal.conjugate() * at.velocity + normal.conjugate() * z_v).imag
    pressure = at.normal * steep
    d_pressure = d_n * steep + at.normal * d_steep
    d_friction = friction_share * (
        rubs.by_normal * d_pressure + pressure * rubs.by_sliding * d_sliding
    )
    along = d_n * at.gradient + at.normal * d_gradient
    return -(along + 1j * (d_friction * normal + rubs.coefficient * pressure * d_normal))


@jit
def contact_tangent(at, rubs, friction_share, weights):
    """Return the pair p, q of a contact, at: its `Touch`, rubs: its `Friction`; friction_share:
    share of a change of the friction force that remains when the rubbed surface yields [1];
    weights: see `parts.law`."""
    e, by_d, by_v = at.direction, weights.displacement, weights.velocity
    if at.gradient.imag != 0.0:
        by_a = _column(at, rubs, friction_share, by_d + 0j, by_v + 0j)
        by_b = _column(at, rubs, friction_share, 1j * by_d, 1j * by_v)
        return 0.5 * (by_a - 1j * by_b), 0.5 * (by_a + 1j * by_b) * e * e
    # round: n by a displacement along e and along i e
    n, bend = at.normal, at.curvature
    n_b = at.damping * at.velocity.imag * bend
    by_normal = friction_share * rubs.by_normal
    slope = friction_share * n * rubs.by_sliding
    t_aa = by_d * -at.stiffness + by_v * -at.damping
    t_ab = by_d * (rubs.coefficient * n * bend - n_b)
    t_ba = by_d * (-by_normal * at.stiffness) + by_v * (-by_normal * at.damping)
    t_bb = by_d * (-by_normal * n_b + slope * at.velocity.real * bend - n * bend) + by_v * -slope
    # rotated back: e (T (conj(e) z)), a real 2x2 matrix written as p z + q conj(z)
    p = scaled(0.5, complex(t_aa + t_bb, t_ba - t_ab))
    q = scaled(0.5, complex(t_aa - t_bb, t_ba + t_ab))
    return p, q * e * e


@jit
def rubbing_tangent(part, kinematics, weights, surface, b, free):
    """Return the force of a contact on the journal [N], its tangent p, q, and z [m]; see `rub`."""
    at = touch(part, kinematics)
    n = at.normal
    if at.penetration <= 0.0 or n <= 0.0:
        return 0.0j, 0.0j, 0.0j, rub(part, 0.0, 0.0, b, free).elongation
    steep, normal = outward(at.gradient)
    v_t = (normal.conjugate() * at.velocity).imag + surface
    rubs = rub(part, n * steep, v_t, b, free)
    p, q = contact_tangent(at, rubs, 1.0, weights)
    force = -complex(n * steep, rubs.coefficient * n * steep) * normal * at.direction
    return force, p, q, rubs.elongation
