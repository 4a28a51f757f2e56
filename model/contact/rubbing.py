"""A journal that rubs: friction, and the force of a contact with its tangent.

    v_t = Im(conj(e) d') + R spin;    mu_t = mu(v_t) v_t / sqrt(v_t^2 + v_s^2)
    force on the journal  F = -(1 + i mu_t) n e;    the housing gets -F

with Stribeck's friction, mu(v) = mu + mu_rise exp(-(v / v_stribeck)^2). In a worn housing g stands
for e (`wall`).

Smoothed like that nothing sticks: under a side load a journal creeps at a share of v_s. With a
tangential stiffness k_t it does: a spring of elongation z, with a damper c_t, holds the journal
within the cone of friction (Kelvin and Voigt's element in series with Coulomb's),

    f = k_t z + c_t z',    z' = v_t where |f| <= mu(v_t) n, else such that f = +- mu(v_t) n

and friction is f along -i e; mu_t is f / n. Over a step z = free + b z' (`protocol.law`), so that
what it would be if it stuck is known, and is mapped back onto the cone where it lies beyond.
"""

from __future__ import annotations

import math

from ..kernels.compiled import called, compiled
from ..kernels.functions import exponential, modulus
from .wall import touch


@compiled
def friction(part, v_t):
    """mu_t, the signed coefficient of friction at a sliding speed [m/s], and its derivative."""
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


@compiled
def _largest_friction(part, v_t):
    """mu(v_t) and its derivative."""
    if part.mu_rise == 0.0:
        return part.mu, 0.0
    x = v_t / part.v_stribeck
    rise = part.mu_rise * exponential(-x * x)
    return part.mu + rise, -2.0 * x / part.v_stribeck * rise


@compiled
def rub(part, n, v_t, b, free):
    """Friction under a normal force n [N] at a sliding speed [m/s], z = free + b z'; b = 0 at an
    instant.

    Returns mu_t [1], its derivative by v_t [s/m], that of the friction force by n [1], and z [m].
    """
    if part.k_t == 0.0:
        mu_t, slope = friction(part, v_t)
        return mu_t, slope, mu_t, free
    stiffness = part.k_t * b + part.c_t
    if n <= 0.0:
        return 0.0, 0.0, 0.0, part.c_t * free / stiffness
    stuck = part.k_t * free + stiffness * v_t
    mu, falls = _largest_friction(part, v_t)
    if abs(stuck) <= mu * n:
        return stuck / n, stiffness / n, 0.0, free + b * v_t
    sense = 1.0 if stuck > 0.0 else -1.0
    slid = (sense * mu * n * b + part.c_t * free) / stiffness
    return sense * mu, sense * falls, sense * mu, slid


@compiled
def stretching(part, rubbing, z):
    """z' [m/s] of a contact that sticks, at a friction force [N]; without a spring 0."""
    return (rubbing - part.k_t * z) / part.c_t if part.k_t > 0.0 else 0.0


@compiled
def stretched(part, z):
    """Elastic energy of the tangential spring [J]."""
    return 0.5 * part.k_t * z * z


@compiled
def outward(gradient):
    """How steep the clearance is where it is touched [1], and its unit normal in the frame along
    e."""
    if gradient.imag == 0.0:  # round
        return 1.0, complex(1.0, 0.0)
    steep = modulus(gradient)
    return steep, gradient * (1.0 / steep)


@compiled
def rubbing_force(part, d, d_dot, surface, z):
    """Contact with a surface past which the journal's own moves with the speed `surface` [m/s] if
    its centre rests; z: elongation of the tangential spring [m].

    Returns the complex force on the journal [N], the normal force, the friction force, the
    damping's share in n [N], the penetration [m], its rate and the sliding speed [m/s].
    """
    delta, rate, n, n_k, _, _, e, local, gradient, _, _ = touch(part, d, d_dot)
    if delta <= 0.0:
        return 0.0j, 0.0, 0.0, 0.0, delta, 0.0, 0.0
    steep, normal = outward(gradient)
    v_t = (normal.conjugate() * local).imag + surface
    if n <= 0.0:
        return 0.0j, 0.0, 0.0, -n_k, delta, rate, v_t
    pressure = n * steep
    mu_t, _, _, _ = rub(part, pressure, v_t, 0.0, z)
    force = -complex(pressure, mu_t * pressure) * normal * e
    return force, pressure, mu_t * pressure, n - n_k, delta, rate, v_t


@called
def _column(z, z_v, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, by_n, give):
    """dF in the frame along e by a displacement z and a velocity z_v."""
    steep, normal = outward(gradient)
    d_gradient = complex(h * z.imag, h * z.real + h_b * z.imag)
    d_rate = (d_gradient.conjugate() * local + gradient.conjugate() * z_v).real
    d_n = n_a * (gradient.conjugate() * z).real + c * d_rate
    d_steep = (normal.conjugate() * d_gradient).real
    d_normal = (d_gradient - normal * d_steep) * (1.0 / steep)
    d_sliding = (d_normal.conjugate() * local + normal.conjugate() * z_v).imag
    pressure = n * steep
    d_pressure = d_n * steep + n * d_steep
    d_friction = give * (by_n * d_pressure + pressure * by_v * d_sliding)
    along = d_n * gradient + n * d_gradient
    return -(along + 1j * (d_friction * normal + mu_t * pressure * d_normal))


@compiled
def contact_tangent(e, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, by_n, give, by_d, by_v_dot):
    """The pair p, q of a contact that `touch` describes, with the friction that `rub` does; give:
    what the surface that is rubbed leaves of a change of the friction force [1]."""
    if gradient.imag != 0.0:
        by_a = _column(
            by_d + 0j, by_v_dot + 0j, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, by_n, give
        )
        by_b = _column(
            1j * by_d, 1j * by_v_dot, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, by_n, give
        )
        return 0.5 * (by_a - 1j * by_b), 0.5 * (by_a + 1j * by_b) * e * e
    # round: n by a displacement along e and along i e
    w_n = local.real
    n_b = c * local.imag * h_b
    given = give * by_n
    slope = give * n * by_v
    t_aa = by_d * -n_a + by_v_dot * -c
    t_ab = by_d * (mu_t * n * h_b - n_b)
    t_ba = by_d * (-given * n_a) + by_v_dot * (-given * c)
    t_bb = by_d * (-given * n_b + slope * w_n * h_b - n * h_b) + by_v_dot * -slope
    # rotated back: e (T (conj(e) z)), a real 2x2 matrix written as p z + q conj(z)
    p = 0.5 * complex(t_aa + t_bb, t_ba - t_ab)
    q = 0.5 * complex(t_aa - t_bb, t_ba + t_ab)
    return p, q * e * e


@compiled
def rubbing_tangent(part, d, d_dot, surface, by_d, by_v, b, free):
    """Force of a contact on the journal [N], its tangent p, q, and z [m]; see `rub`."""
    delta, _, n, _, n_a, c, e, local, gradient, h, h_b = touch(part, d, d_dot)
    if delta <= 0.0 or n <= 0.0:
        return 0.0j, 0.0j, 0.0j, rub(part, 0.0, 0.0, b, free)[3]
    steep, normal = outward(gradient)
    v_t = (normal.conjugate() * local).imag + surface
    mu_t, slope, by_n, z = rub(part, n * steep, v_t, b, free)
    p, q = contact_tangent(
        e, local, n, n_a, c, gradient, h, h_b, mu_t, slope, by_n, 1.0, by_d, by_v
    )
    return -complex(n * steep, mu_t * n * steep) * normal * e, p, q, z
