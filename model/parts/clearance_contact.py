"""A journal in the clearance of its housing: penalty contact with damping and Coulomb friction.

d = u + i v [m] is the journal's displacement relative to the housing, e = d / |d| the direction of
contact, psi = arg d the contact angle (paper A, eqs 2 to 5, with its misprints mended):

    delta = |d| - s;    n = max(0, k delta + c min(1, delta / delta_c) delta')  while delta > 0
    v_t = Im(conj(e) d') + R Omega;    s_t = v_t / sqrt(v_t^2 + v_s^2)
    force on the journal  F = -(n + i mu n s_t) e;    the housing gets -F

The damping grows with the penetration: were it there at once, the force would jump at touch, and a
step that ends in the jump would have no solution.
"""

from __future__ import annotations

import math

from ..kernels.compiled import compiled


@compiled
def contact_force(bearing, d, d_dot, omega):
    """Contact of one bearing, a record of `assembly.CONTACT`.

    d [m], d_dot [m/s], omega [rad/s]. Returns the complex force on the journal [N], the normal
    force n [N], the penetration delta [m], its rate [m/s] and the sliding speed v_t [m/s].
    """
    r = math.sqrt(d.real * d.real + d.imag * d.imag)
    delta = r - bearing.clearance
    if delta <= 0.0:
        return 0.0j, 0.0, delta, 0.0, 0.0
    e = d * (1.0 / r)
    local = e.conjugate() * d_dot
    n = bearing.k * delta + bearing.c * min(1.0, delta / bearing.delta_c) * local.real
    v_t = local.imag + bearing.journal_radius * omega
    if n <= 0.0:
        return 0.0j, 0.0, delta, local.real, v_t
    s_t = v_t / math.sqrt(v_t * v_t + bearing.v_s**2)
    return -complex(n, bearing.mu * n * s_t) * e, n, delta, local.real, v_t


@compiled
def contact_tangent(bearing, d, d_dot, omega, by_position, by_velocity):
    """The force F on the journal [N] and its tangent by_position dF/dd + by_velocity dF/dd', as
    (F, p, q) with the complex pair of the real-linear map z -> p z + q conj(z) [N/m for weights of
    1 and 1, the second in N.s/m]."""
    r = math.sqrt(d.real * d.real + d.imag * d.imag)
    delta = r - bearing.clearance
    if delta <= 0.0:
        return 0.0j, 0.0j, 0.0j
    e = d * (1.0 / r)
    local = e.conjugate() * d_dot
    w_n = local.real
    k = bearing.k
    share = min(1.0, delta / bearing.delta_c)
    c = bearing.c * share
    n = k * delta + c * w_n
    if n <= 0.0:
        return 0.0j, 0.0j, 0.0j
    v_s = bearing.v_s
    mu = bearing.mu
    v_t = local.imag + bearing.journal_radius * omega
    root = math.sqrt(v_t * v_t + v_s * v_s)
    s_t = v_t / root
    slope = v_s * v_s / (root * root * root)
    # n by a displacement along e and along i e, in the frame of the contact
    n_a = k + (bearing.c / bearing.delta_c * w_n if share < 1.0 else 0.0)
    n_b = c * local.imag / r
    t_aa = by_position * -n_a + by_velocity * -c
    t_ab = by_position * (mu * n * s_t / r - n_b)
    t_ba = by_position * (-mu * s_t * n_a) + by_velocity * (-mu * s_t * c)
    t_bb = by_position * (-mu * s_t * n_b + mu * n * slope * w_n / r - n / r) + by_velocity * (
        -mu * n * slope
    )
    # rotated back: e (T (conj(e) z)), a real 2x2 matrix written as p z + q conj(z)
    p = 0.5 * complex(t_aa + t_bb, t_ba - t_ab)
    q = 0.5 * complex(t_aa - t_bb, t_ba + t_ab)
    return -complex(n, mu * n * s_t) * e, p, q * e * e


@compiled
def contact_angle(d):
    """psi in [0, 2 pi) [rad] of the journal's relative displacement d."""
    psi = math.atan2(d.imag, d.real)
    if psi < 0.0:
        psi += 2.0 * math.pi
    return psi if psi < 2.0 * math.pi else 0.0
