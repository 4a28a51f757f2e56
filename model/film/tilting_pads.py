"""Tilting pads: the tilt at which the moments about each pivot balance.

A pad that turns by an angle about its pivot, in the direction e from the bearing's centre, moves
its own centre by -i e s, s = R times the angle: its tilt [m]. So its film is that of a fixed pad
and a journal at d + i e s that moves with v + i e s'. With the force F of film and wall on the
journal, and the friction f of the wall, which acts at the pad's surface, near the pivot,

    J / R^2 s'' = G,    G = Re(conj(i e) F) + f

J: moment of inertia of the pad about its pivot. A pad without inertia has G = 0: a film's load is
the gradient of a convex function of the velocities, so that G never grows with s', and one s'
balances it. Where there is no pressure on either side of the pivot any s' would: the pad stays.

A pivot of stiffness k that is displaced outwards by u moves the pad's centre by e u, and so the
journal in its film back by as much: k u + c u' = -Re(conj(e) F), without mass. The damping c is
next to nothing; without it, a film that hardly bears would not say how fast its pivot returns.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..contact.rubbing import Friction, contact_tangent, friction
from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from .bearing_film import PAD, pad_of, pad_slopes
from .rough_contact import sliding_of, touch

ITERATIONS = 80
CONVERGED = 1e-7  # of the search's scale: the error left is of second order in it
_NOTHING = 1e-12  # of a film's force
_ROUNDING = 8.0 * 2.0**-53  # of where a journal is in a bearing
REACH = 0.2  # of a clearance, that a step of Newton's method tilts a pad


class _Share(NamedTuple):
    """`parts.law.Weights` without a law's states."""

    displacement: float
    velocity: float


class Balance(NamedTuple):
    """Forces on a pad: force on the journal [N]; moment: G [N]; p_d, q_d, p_v, q_v: of the force,
    by the journal's displacement and velocity; g_d, g_v: of G, which changes by Re(conj(g) z);
    force_by_tilt, force_by_rate, by_tilt, by_rate: derivatives of force and G by s and s'."""

    force: complex
    moment: float
    p_d: complex
    q_d: complex
    p_v: complex
    q_v: complex
    g_d: complex
    g_v: complex
    force_by_tilt: complex
    force_by_rate: complex
    by_tilt: float
    by_rate: float


class PadSearch(NamedTuple):
    """A search for the motion of a pad in an unknown y, and the condition on G: tilt + by_tilt y
    [m], rate + by_rate y [m/s], G = inertia (y - free); scale: of y; reach: of the first step;
    negligible: a G that counts as 0 [N]."""

    tilt: float
    by_tilt: float
    rate: float
    by_rate: float
    inertia: float
    free: float
    scale: float
    reach: float
    negligible: float


@jit
def row_of(bearing, i):
    """Return the index of a pad's row of `PAD` in the tables."""
    return bearing.table + 1 + len(PAD) * i


@jit
def across_of(bearing, tables, i):
    """Return the direction i e across a pad's pivot."""
    at = row_of(bearing, i)
    return complex(-tables[at + PAD.pivot_y], tables[at + PAD.pivot_x])


@jit
def set_tilt(bearing, tables, i, tilt, rate):
    """Set the tilt of a pad [m], and its rate [m/s]."""
    at = row_of(bearing, i)
    tables[at + PAD.tilt] = tilt
    tables[at + PAD.rate] = rate


@jit
def set_pivot_displacement(bearing, tables, i, pivot_displacement, pivot_velocity):
    """Set the outward displacement of a pad's pivot [m], and its velocity [m/s]."""
    at = row_of(bearing, i)
    tables[at + PAD.pivot_displacement] = pivot_displacement
    tables[at + PAD.pivot_velocity] = pivot_velocity


@jit_not_inlined
def pad_balance(bearing, tables, kinematics, i):
    """Return the `Balance` of a pad in its present position."""
    pad, work = pad_of(bearing, tables, kinematics, i)
    across = across_of(bearing, tables, i)
    back = across.conjugate()
    force, p_d, q_d, p_v, q_v = pad_slopes(bearing, pad, work, kinematics.speed)
    rubs, rubs_by_d, rubs_by_v, by_sliding, slid = 0.0, 0.0j, 0.0j, 0.0, 0.0j
    at = touch(bearing, pad)
    if at.penetration > 0.0 and at.normal > 0.0:
        mu, slope = friction(bearing, sliding_of(bearing, pad, at, kinematics))
        rubs = mu * at.normal
        force -= complex(at.normal, rubs) * at.direction
        rubbing = Friction(mu, slope, mu, 0.0)
        p, q = contact_tangent(at, rubbing, 1.0, _Share(1.0, 0.0))
        rubs_by_d = _friction_gradient(at, p, q) - 1j * at.direction * (at.curvature * at.normal)
        p_d += p
        q_d += q
        p, q = contact_tangent(at, rubbing, 1.0, _Share(0.0, 1.0))
        rubs_by_v = _friction_gradient(at, p, q)
        p_v += p
        q_v += q
        by_sliding = slope * at.normal
        slid = 1j * at.direction * by_sliding
    g_d = across * p_d.conjugate() + back * q_d + rubs_by_d
    g_v = across * p_v.conjugate() + back * q_v + rubs_by_v
    return Balance(
        *(force, (back * force).real + rubs, p_d, q_d, p_v, q_v, g_d, g_v),
        *(p_d * across + q_d * back, p_v * across + q_v * back + slid),
        (g_d.conjugate() * across).real,
        (g_v.conjugate() * across).real + (back * slid).real - by_sliding,
    )


@jit
def _friction_gradient(at, p, q):
    """Return the derivative of a wall's friction, -Im(conj(e) dF), of dF = p z + q conj(z), as g:
    it changes by Re(conj(g) z)."""
    e = at.direction
    return -1j * e * p.conjugate() + 1j * e.conjugate() * q


@jit
def next_iterate(y, residual, slope, low, high, reach, scale):
    """Return the next y of a search for the root of a residual that falls with y: by Newton's
    method, in steps of at most `reach`, between the known bounds; and the new bounds and reach."""
    if residual > 0.0:
        low = y
    else:
        high = y
    step = reach if residual > 0.0 else -reach
    if slope < 0.0 and abs(residual) < -slope * reach:
        step = -residual / slope
    else:
        reach *= 2.0
    ahead = y + step
    if abs(step) > CONVERGED * scale and not low < ahead < high:
        ahead = 0.5 * (low + high)
    return ahead, low, high, reach


@jit_not_inlined
def solve_pad(bearing, tables, kinematics, i, search):
    """Return y of a `PadSearch`, the derivative of G - inertia (y - free) by it, and the `Balance`
    there, and move the pad there. By Newton's method, kept between values on both sides of the
    root."""
    y, reach = 0.0, search.reach
    low, high = -math.inf, math.inf
    for _ in range(ITERATIONS):
        set_tilt(
            *(bearing, tables, i, search.tilt + search.by_tilt * y),
            search.rate + search.by_rate * y,
        )
        at = pad_balance(bearing, tables, kinematics, i)
        residual = at.moment - search.inertia * (y - search.free)
        slope = search.by_tilt * at.by_tilt + search.by_rate * at.by_rate - search.inertia
        if abs(residual) <= search.negligible:
            return y, slope, at
        ahead, low, high, reach = next_iterate(y, residual, slope, low, high, reach, search.scale)
        step = ahead - y
        y = ahead
        if abs(step) <= CONVERGED * search.scale:
            break
    force_by_y = search.by_tilt * at.force_by_tilt + search.by_rate * at.force_by_rate
    set_tilt(
        *(bearing, tables, i, search.tilt + search.by_tilt * y), search.rate + search.by_rate * y
    )
    return y, slope, with_force_change(at, step * force_by_y)


@jit
def with_force_change(at, change):
    """Return a `Balance` with its force changed."""
    return Balance(
        *(at.force + change, 0.0, at.p_d, at.q_d, at.p_v, at.q_v, at.g_d, at.g_v),
        *(at.force_by_tilt, at.force_by_rate, at.by_tilt, at.by_rate),
    )


@jit
def speed_of(bearing, kinematics):
    """Return a velocity scale of the film [m/s]."""
    return bearing.clearance * abs(kinematics.speed) + modulus(kinematics.velocity)


@jit
def negligible_force(bearing, speed):
    """Return a force that is negligible beside that of a film with surfaces of this speed, or
    rounding of a wall's force [N]."""
    slender = bearing.journal_radius / bearing.clearance
    film = bearing.viscosity * speed * bearing.length * slender * slender * slender
    return _NOTHING * film + _ROUNDING * bearing.k * bearing.clearance


@jit
def if_bearing(at, negligible):
    """Return a `Balance`, or, if its force is negligible [N], that of a pad that bears nothing:
    what is left vanishes with a high power of the way to where the film ruptures."""
    if modulus(at.force) > negligible:
        return at
    return Balance(0.0j, 0.0, 0.0j, 0.0j, 0.0j, 0.0j, 0.0j, 0.0j, 0.0j, 0.0j, 0.0, 0.0)


@jit
def search_without_inertia(bearing, kinematics, tilt, b):
    """Return the `PadSearch` for the rate of a pad without inertia at the tilt + b rate [m]."""
    scale = speed_of(bearing, kinematics)
    reach = scale
    if b > 0.0:
        reach = min(reach, REACH * bearing.clearance / b)
    return PadSearch(tilt, b, 0.0, 1.0, 0.0, 0.0, scale, reach, negligible_force(bearing, scale))


@jit
def search_with_inertia(bearing, kinematics, tilt, free, b, mass):
    """Return the `PadSearch` for the rate of a pad of J / R^2 = mass [kg] at the end of a step of
    weight b > 0 [s], from its tilt and its rate before it."""
    scale = speed_of(bearing, kinematics) + abs(free)
    reach = min(scale, REACH * bearing.clearance / b)
    return PadSearch(
        tilt, b, 0.0, 1.0, mass / b, free, scale, reach, negligible_force(bearing, scale)
    )


@jit
def following(at, search, slope, by_d, by_v):
    """Return the pair p, q of a pad's force for `Weights` of displacement and velocity, while the
    pad follows as in its `PadSearch`."""
    p, q = by_d * at.p_d + by_v * at.p_v, by_d * at.q_d + by_v * at.q_v
    if slope < 0.0:
        g = by_d * at.g_d + by_v * at.g_v
        share = search.by_tilt * at.force_by_tilt + search.by_rate * at.force_by_rate
        share *= 0.5 / slope
        p -= share * g.conjugate()
        q -= share * g
    return p, q


@jit
def vibrating(at, mass, frequency):
    """Return p_d, q_d, p_v, q_v of a pad that follows the vibration of the journal at a frequency
    [rad/s]: its tilt fulfils G + frequency^2 mass tilt = 0; mass: J / R^2 [kg]."""
    by = (at.p_d, at.q_d, at.p_v, at.q_v)
    real = at.by_tilt + frequency * frequency * mass
    of_moment = (at.g_d, at.g_v, real, at.by_rate)
    return eliminated(by, at.force_by_tilt, at.force_by_rate, of_moment, frequency)


@jit
def on_pivot(by, outwards, stiffness, damping, frequency):
    """Return p_d, q_d, p_v, q_v of a pad, `by`, on a flexible pivot, a spring and a damper in
    series with its film: stiffness [N/m], damping [N.s/m]."""
    p_d, q_d, p_v, q_v = by
    back = outwards.conjugate()
    by_displacement, by_velocity = p_d * outwards + q_d * back, p_v * outwards + q_v * back
    g_d, g_v = outwards * p_d.conjugate() + back * q_d, outwards * p_v.conjugate() + back * q_v
    real, rate = (back * by_displacement).real - stiffness, (back * by_velocity).real - damping
    return eliminated(by, by_displacement, by_velocity, (g_d, g_v, real, rate), frequency)


@jit
def eliminated(by, by_s, by_x, balance, frequency):
    """Return p_d, q_d, p_v, q_v, `by`, of a force after elimination of an unknown s by a balance,
    all vibrating at a frequency [rad/s]: by_s, by_x: of the force by s and s'; balance: g_d, g_v,
    real, rate, of g_d z + g_v z' + real s + rate s' = 0."""
    p_d, q_d, p_v, q_v = by
    g_d, g_v, real, rate = balance
    square = frequency * frequency
    size = real * real + square * rate * rate
    if size == 0.0:  # nothing but squeezing holds it
        share = 0.5 / rate if rate < 0.0 else 0.0
        f, g = by_x * share, g_v
        return p_d, q_d, p_v - f * g.conjugate(), q_v - f * g
    # (f_s + i w f_x) conj(g_d + i w g_v) / (real + i w rate), where i is that of time
    u, w = 0.5 * real / size, -0.5 * rate / size
    p_in = by_s * g_d.conjugate() - square * (by_x * g_v.conjugate())
    q_in = by_s * g_d - square * (by_x * g_v)
    p_out = by_s * g_v.conjugate() + by_x * g_d.conjugate()
    q_out = by_s * g_v + by_x * g_d
    return (
        p_d - (u * p_in - square * w * p_out),
        q_d - (u * q_in - square * w * q_out),
        p_v - (w * p_in + u * p_out),
        q_v - (w * q_in + u * q_out),
    )
